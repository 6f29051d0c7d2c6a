"""How the report looks: light and calm on a screen, plain on paper."""

STYLE = """
:root { --ink: #1f2933; --soft: #5f6c7b; --line: #e3e8ef;
        --paper: #ffffff; --wash: #f6f8fb; --accent: #2b6cb0;
        --warn: #975a16; --warnwash: #fffaf0; }
* { box-sizing: border-box; }
body { margin: 0; background: var(--wash); color: var(--ink);
       font: 16px/1.6 system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
main { max-width: 70rem; margin: 2rem auto; padding: 2.5rem 3rem 3rem; background: var(--paper);
       border: 1px solid var(--line); border-radius: 10px; }
h1 { font-size: 1.9rem; line-height: 1.25; margin: 0 0 .3rem; letter-spacing: -.01em; }
h2 { font-size: 1.3rem; margin: 2.6rem 0 .7rem; padding-top: .9rem; border-top: 1px solid var(--line); }
h3 { font-size: 1.03rem; margin: 1.7rem 0 .4rem; }
p { margin: .5rem 0; max-width: 46rem; }
.kind { color: var(--soft); margin: 0 0 1.2rem; }
.simulated { background: #ebf4ff; border-left: 4px solid var(--accent); padding: .7rem 1rem; margin: 1rem 0;
             border-radius: 0 6px 6px 0; max-width: none; }
.warnings { background: var(--warnwash); border-left: 4px solid #dd9b3f; padding: .6rem 1rem; margin: 1rem 0;
            border-radius: 0 6px 6px 0; color: #5f3d0c; }
.warnings ul { margin: .2rem 0; }
ul { padding-left: 1.25rem; margin: .5rem 0; }
li { margin: .25rem 0; }
.headlines li { margin: .45rem 0; }
.facts { display: flex; flex-wrap: wrap; gap: 0 2.4rem; margin: 1rem 0 .4rem; padding: 0; }
.facts div { min-width: 6rem; }
.facts dt { color: var(--soft); font-size: .82rem; }
.facts dd { margin: 0; font-size: 1.3rem; font-variant-numeric: tabular-nums; }
.scroll { overflow-x: auto; margin: .7rem 0 .3rem; }
table { border-collapse: collapse; font-size: .84rem; font-variant-numeric: tabular-nums; width: 100%; }
th { font-weight: 600; color: var(--soft); border-bottom: 1.5px solid #b8c2cf; padding: .3rem .42rem;
     vertical-align: bottom; }
td { border-bottom: 1px solid var(--line); padding: .26rem .42rem; white-space: nowrap; }
thead { border-top: 1.5px solid #b8c2cf; }
td.left:first-child { white-space: normal; }
.left { text-align: left; } .right { text-align: right; }
tr.found td { font-weight: 600; }
tbody tr:hover { background: var(--wash); }
.note, figcaption { color: var(--soft); font-size: .86rem; max-width: 46rem; }
figure { margin: 1.4rem 0 1.9rem; }
figure img { max-width: min(100%, 41rem); height: auto; display: block; }
figure.check { margin: .6rem 0 1rem; }
figure.check img { max-width: 100%; }
h1.measure { margin-top: 3.4rem; padding-top: 1.6rem; border-top: 3px solid var(--line); }
figcaption b { color: var(--ink); font-weight: 600; }
details { margin: .6rem 0; }
summary { cursor: pointer; color: var(--accent); font-size: .93rem; }
code, .hash { font: .85em ui-monospace, "DejaVu Sans Mono", Consolas, monospace; overflow-wrap: anywhere; }
.provenance td { white-space: normal; vertical-align: top; }
.provenance td:first-child { white-space: nowrap; color: var(--soft); }
@media (max-width: 46rem) { main { margin: 0; border: 0; border-radius: 0; padding: 1.2rem; } }
@media print {
  body { background: none; font-size: 10.5pt; }
  main { margin: 0; padding: 0; border: 0; max-width: none; }
  h2 { break-after: avoid; } h3 { break-after: avoid; }
  figure, tr, .simulated, .warnings { break-inside: avoid; }
  .scroll { overflow: visible; } table { font-size: 8pt; } td, th { padding: .12rem .35rem; }
  figure img { max-width: 14cm; }
  details::details-content { content-visibility: visible; display: block; } summary { display: none; }
}
"""
