"""`navbound show`, and how a run is printed."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from navbound.cli.parts import Json, err_console, out_console
from navbound.exit_status import of_verdict

if TYPE_CHECKING:
    from navbound.run.directory import Run

LISTED_FAULTS = 10
"""Faults that are printed at the end of a run; all of them are in its records."""


def show_command(
    run_directory: Annotated[Path, typer.Argument(help="A run directory.")],
    json: Json = False,
) -> None:
    """Print the verdict of a finished run."""
    from navbound.run import directory  # noqa: PLC0415
    from navbound.storage.folders import unfinished  # noqa: PLC0415

    run = directory.load(run_directory)
    began = unfinished(run_directory)
    if began:
        err_console.print(
            f"navbound: {run_directory}: a later job began here and has not finished ({', '.join(began[:3])}); this is the run before it.",
            markup=False,
            highlight=False,
            soft_wrap=True,
        )
    show(run, json=json)


def show(run: Run, *, json: bool) -> None:
    """Print a run and end with the status of its verdict."""
    if json:
        sys.stdout.write(run.summary.model_dump_json(indent=1) + "\n")
    else:
        _print(run)
    verdict = run.summary.verdict
    status = of_verdict(verdict.id, None if verdict.belief is None else verdict.belief.state)
    if status:
        raise typer.Exit(status)


def _print(run: Run) -> None:
    summary = run.summary
    out_console.print(summary.title, style="bold", markup=False)
    out_console.print(summary.verdict.words, markup=False, highlight=False)
    out_console.print("Assumed and found:", markup=False)
    for assumption in summary.assumptions:
        out_console.print(f"  - {assumption}", markup=False, highlight=False)
    rejected = sum(r.count for r in summary.rejected)
    if rejected:
        out_console.print(f"{rejected} rows or records were not used:", markup=False)
        for r in summary.rejected:
            where = "" if r.first_line is None else f", first in line {r.first_line}: {r.example}"
            out_console.print(f"  {r.count} x {r.reason} ({Path(r.file).name}{where})", markup=False, highlight=False)
    if summary.tracks:
        cautions, warnings = (sum(getattr(t, n) for t in summary.tracks) for n in ("n_cautions", "n_warnings"))
        unavailable = sum(t.n_unavailable for t in summary.tracks)
        out_console.print(
            f"Alerts: {cautions} cautions, {warnings} warnings, {unavailable} losses of monitoring, over {len(summary.tracks)} tracks."
        )
        for fault in summary.faults[:LISTED_FAULTS]:
            out_console.print(f"{fault.track}, {fault.kind}: {fault.words}", markup=False, highlight=False)
        if len(summary.faults) > LISTED_FAULTS:
            out_console.print(f"... and {len(summary.faults) - LISTED_FAULTS} more in summary.json.")
    if run.path is not None:
        out_console.print(f"Report: {run.report.resolve()}", markup=False, highlight=False, soft_wrap=True)
