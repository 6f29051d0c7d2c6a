"""The commands that compute: the planned analysis, power, the comparison of methods."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from experiment_app.commands.arguments import StudyArgument, require_ending
from experiment_app.commands.data import StudyFolder
from experiment_app.errors import UsageError
from experiment_app.terminal import out, problems, say, with_progress


def analyse(
    folder: StudyFolder,
    *,
    out_folder: Annotated[Path, Parameter(name="--out", help="Folder for tables, figures and report.")] = Path(
        "report"
    ),
    plan: Annotated[
        str | None,
        Parameter(
            help="A version of the study file whose plan is followed, instead of the one recorded with the runs."
        ),
    ] = None,
) -> int:
    """Follow the study file's planned analysis: tables, figures and one self-contained report.

    The study file is kept with every run, so the plan is the one made before the data. The report says when --plan
    names another.
    """
    from analysis.planned_analysis import analyse as planned_analysis
    from experiment_app.participants.derived import note_derived
    from protocols.study_file import read_study

    plan_text = None if plan is None else read_study(plan).text
    with out.status("Analysing"):
        outcome = planned_analysis(folder, out_folder, plan_text=plan_text)
    for warning in outcome.warnings:
        problems.print(f"Note: {warning}", style="yellow", markup=False)
    for sentence in outcome.headlines:
        out.print(sentence, markup=False)
    for path in outcome.paths:
        out.print(f"  {path}", markup=False)
    note_derived(folder, "report", "", out_folder)
    return 0


def power(
    study: StudyArgument,
    *,
    participants: Annotated[
        list[int] | None,
        Parameter(negative="", consume_multiple=True, help="Numbers of participants; by default the planned one."),
    ] = None,
    experiments: Annotated[int, Parameter(help="How many experiments to simulate.")] = 10_000,
    seed: Annotated[int, Parameter(help="The same seed gives the same table, however the work is split.")] = 1,
    shard: Annotated[str, Parameter(help="Do the i-th of n parts only, as 1/8, for many machines.")] = "1/1",
    part: Annotated[Path | None, Parameter(name="--out", help="Write this part's counts (JSON) for --combine.")] = None,
    combine: Annotated[
        list[Path] | None,
        Parameter(negative="", consume_multiple=True, help="Join parts written with --out; nothing is simulated."),
    ] = None,
    plot: Annotated[Path | None, Parameter(help="Also draw power against participants (PNG).")] = None,
    workers: Annotated[int, Parameter(help="Processes; 0 for as many as there are cores.")] = 0,
    dask: Annotated[str, Parameter(help="Address of a dask scheduler that spreads the work over a cluster.")] = "",
) -> int:
    """How often each planned test would be significant, for the study's simulated observers.

    Every experiment goes through the study's own design and planned analysis.
    """
    import os

    from analysis.power.study import (
        dask_client,
        join_parts,
        power_figure,
        power_notes,
        read_part,
        simulate_power,
        write_part,
    )
    from experiment_app.checking.check import checked_study

    require_ending("--out", part, "counts are JSON", "part1.json")
    require_ending("--plot", plot, "the picture is a PNG", "power.png")
    file = checked_study(study)
    notes = power_notes(file.text)
    if combine:
        result, missing = join_parts([read_part(path) for path in combine])
        notes += missing
    else:
        first, slash, last = shard.partition("/")
        if not (slash and first.isdecimal() and last.isdecimal() and 1 <= int(first) <= int(last)):
            raise UsageError(f"--shard {shard}: write i/n with i from 1 to n, as 1/8.")
        result = simulate_power(
            file.text, participants or (), experiments=experiments, seed=seed, shard=(int(first), int(last)),
            workers=workers or os.cpu_count() or 1, client=dask_client(dask) if dask else None,
            progress=lambda parts, count: with_progress(parts, count, "Simulating experiments"),
        )  # fmt: skip
    for row in result.table.to_dict("records"):
        name = f"t test of {row['name']}" if row["test"] == "t" else row["name"].replace(":", " x ")
        limits = f"[{row['ci_low']:.3f}, {row['ci_high']:.3f}]"
        out.print(f"{row['participants']:>5} participants  {name:<28} {row['power']:.3f}  {limits}", markup=False)
    out.print(f"Power with 95 % limits from {result.table['experiments'].iloc[0]} experiments.", markup=False)
    for note in notes:
        problems.print(f"Note: {note}", style="yellow", markup=False)
    for path in (part and write_part(part, result), plot and power_figure(plot, result)):
        if path:
            out.print(f"  {path}", markup=False)
    return 0


def compare_methods(
    *actors: Annotated[str, Parameter(help="Names of actors, or folders of one person's captures.")],
    captures: Annotated[
        Path | None,
        Parameter(help="Folder of captures on which the poulaine's rebuilding is tested; by default the shared ones."),
    ] = None,
    out_folder: Annotated[Path, Parameter(name="--out", help="Folder for tables, figures and report.")] = Path(
        "methods"
    ),
) -> int:
    """Compare the ways of making a walk with captured walks: joint angles, foot slide, rebuilt poulaines, pictures."""
    from experiment_app.comparing_methods import compared_methods

    if not actors:
        raise UsageError("name at least one actor, as gaitlab compare-methods F1.")
    report = compared_methods(actors, out_folder, captures, say, with_progress)
    for sentence in report.headlines:
        out.print(sentence, markup=False)
    for path in report.paths:
        out.print(f"  {path}", markup=False)
    return 0
