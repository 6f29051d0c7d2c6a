"""The texts of an exported data set: its README, and the study files the runs were recorded with."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from analysis.exports.runs import ExportedRun

KINDS = {
    "bids": "in the Brain Imaging Data Structure (https://bids.neuroimaging.io), behavioural",
    "psych-ds": "in Psych-DS (https://psych-ds.github.io)",
    "csv": "as CSV tables (RFC 4180, UTF-8)",
    "parquet": "as Parquet tables",
}


def study_files(runs: Sequence[ExportedRun]) -> Iterator[tuple[str, bytes]]:
    """Every version of the study file that a run was recorded with, by name; the first is plainly `study.yaml`."""
    texts = dict.fromkeys((str(run.header["study_hash"]), str(run.header["study_text"])) for run in runs)
    for number, (digest, text) in enumerate(texts):
        yield ("study.yaml" if not number else f"study-{digest[:12]}.yaml"), text.encode("utf-8")


def readme(runs: Sequence[ExportedRun], to: str) -> bytes:
    """What the data are, how they came about, and what to know before using them."""
    study = runs[0].study
    people = len({run.participant for run in runs})
    kind = runs[0].kind
    warning = {
        "real": "",
        "pilot": "**These are pilot runs**, recorded to try the study out. They are no results.\n\n",
        "simulated": "**These are simulated participants.** They are no results.\n\n",
    }[kind]
    text = (
        f"# {study.get('title', study.get('study'))}\n\n{warning}"
        f"{' '.join(str(study.get('about', '')).split())}\n\n"
        f"Participants: {people}, runs: {len(runs)}, {KINDS[to]}.\n\n"
        "Everything here was made by gaitlab from one append-only journal a run; the study file with factors, texts, "
        "seeds and the planned analysis comes with it. Lengths are in m, times in s since the run began, step "
        "frequencies in steps/min, walk ratios in m·min.\n\n"
        "Good to know:\n\n"
        "- A trial that was interrupted was done again: `attempt` counts, and rows with `counts` = true are those to "
        "analyse. Training trials have `practice` = true.\n"
        "- A run that was continued later has several sittings; times between sittings follow the computer's clock.\n"
        "- Measures that begin with `measured_` come from the walker as it was drawn, the others from the response.\n"
        "- Answers to open questions are as they were typed.\n"
    )
    return text.encode("utf-8")
