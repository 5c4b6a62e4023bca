"""`navbound show`, and how a run is printed."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from navbound.cli.parts import Json, err_console, out_console
from navbound.exit_status import of_verdict
from navbound.units import METRES_PER_NM
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from navbound.records.procedure import ProcedureFlown
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


def _print_procedure(flight: ProcedureFlown, name: str) -> None:
    """Legs and answers of one flight against a procedure."""
    from rich.table import Table  # noqa: PLC0415  (only where a procedure was flown)

    table = Table(title=f"{name}{f', {flight.line}' if flight.line else ''}")
    for heading in ("leg", "RNP", "from", "n", "mean, m", "95 %, m", "largest, m", "/ RNP", "inside", "bound inside", "in turns"):
        table.add_column(heading, overflow="fold")
    for leg in flight.legs:
        rnp = "unknown" if leg.rnp_m is None else f"{leg.rnp_m / METRES_PER_NM:.3g}"
        sizes = [_metres(value) for value in (leg.mean_m, leg.p95_m, leg.max_abs_m)]
        ratio = "-" if leg.rnp_m is None or leg.max_abs_m is None else f"{leg.max_abs_m / leg.rnp_m:.3f}"
        inside = f"{leg.n_inside}" if leg.rnp_m is not None else "-"
        bound = f"{leg.n_bound_inside} of {leg.n_bound}" if leg.n_bound else "-"
        name = f"{leg.fix or '-'} {leg.terminator}"
        table.add_row(name, rnp, leg.rnp_origin.replace("_", " "), str(leg.n), *sizes, ratio, inside, bound, str(leg.n_transition))
    out_console.print(table)
    for number, answer in enumerate(flight.answers, 1):
        out_console.print(f"  {number}. {answer}", markup=False, highlight=False)


def _metres(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"


def _print(run: Run) -> None:
    summary = run.summary
    out_console.print(summary.title, style="bold", markup=False)
    first, *beside = summary.verdict.sentences
    out_console.print(first, markup=False, highlight=False)
    for sentence in beside:
        out_console.print(f"  - {sentence}", markup=False, highlight=False)
    for flight in summary.procedures:
        _print_procedure(flight, summary.name_of(flight.track))
    out_console.print("Assumed and found:", markup=False)
    for assumption in summary.assumptions:
        out_console.print(f"  - {assumption}", markup=False, highlight=False)
    rejected = sum(r.count for r in summary.rejected)
    if rejected:
        out_console.print(f"{counted(rejected, 'row or record was', 'rows or records were')} not used:", markup=False)
        for r in summary.rejected:
            line = "" if r.first_line is None else f" in line {r.first_line}"
            where = f", first{line}: {r.example}" if line or r.example else ""
            out_console.print(f"  {r.count} x {r.reason} ({Path(r.file).name}{where})", markup=False, highlight=False)
    if summary.tracks:
        cautions, warnings = (sum(getattr(t, n) for t in summary.tracks) for n in ("n_cautions", "n_warnings"))
        unavailable = sum(t.n_unavailable for t in summary.tracks)
        out_console.print(
            f"Alerts: {counted(cautions, 'caution')}, {counted(warnings, 'warning')}, "
            f"{counted(unavailable, 'loss of monitoring', 'losses of monitoring')}, over {counted(len(summary.tracks), 'track')}."
        )
        for fault in summary.faults[:LISTED_FAULTS]:
            out_console.print(f"{summary.name_of(fault.track)}, {fault.kind}: {fault.words}", markup=False, highlight=False)
        if len(summary.faults) > LISTED_FAULTS:
            out_console.print(f"... and {len(summary.faults) - LISTED_FAULTS} more in summary.json.")
    if run.path is not None:
        out_console.print(f"Report: {run.report.resolve()}", markup=False, highlight=False, soft_wrap=True)
