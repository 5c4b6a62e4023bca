"""`navbound predict flight`: what a person sees of the prediction of a planned flight."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from rich.table import Table

from navbound.cli.calls import call
from navbound.cli.parts import command_line, out_console
from navbound.errors import ConflictError, InputError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from navbound.records.prediction import ExpectedFlight


def predict_flight_command(plans: list[str], unused: Mapping[str, object], out: Path | None, json: bool) -> None:
    """Predict the flight of a plan; print it, or leave it in a folder too."""
    from navbound.run.expected import flight  # noqa: PLC0415

    if len(plans) != 1:
        raise InputError("constellation", ", ".join(plans), domain="one plan: navbound predict flight PLAN.toml")
    for name, value in unused.items():
        if value:
            raise ConflictError(name, because="a flight has place, time, satellites and requirement from its plan", value=value)
    expected = call("predict_flight", flight.predict_flight, plans[0], command=command_line())
    target = None if out is None else flight.write(expected, out)
    if json:
        sys.stdout.write(expected.record.model_dump_json(indent=1) + "\n")
        return
    show(expected.record)
    if target is not None:
        out_console.print(f"Written: {target}; its page: {target / flight.PAGE}", markup=False, highlight=False)


MOST_COLUMNS = 8
"""Of a table in a terminal of 80 columns, beside the first; a wider one is cut, and each piece has the first column."""


def show(record: ExpectedFlight) -> None:
    """One page: what the flight may count on, leg by leg."""
    from navbound.run.expected.page import sections  # noqa: PLC0415

    def say(text: str, style: str = "") -> None:
        out_console.print(text, style=style, markup=False, highlight=False)

    say(record.title, "bold")
    for sentence in record.words:
        say(sentence)
    for warning in record.warnings:
        say(f"Warning: {warning}", "yellow")
    for heading, rows in sections(record):
        if len(rows) > 1:
            print_table(heading, rows)
    for assumption in record.assumptions:
        say(f"  - {assumption}")


def print_table(heading: str, rows: Sequence[Sequence[str]]) -> None:
    """A table cut so that it fits a terminal; rows: the heads first."""
    pieces = -(-(len(rows[0]) - 1) // MOST_COLUMNS)
    width = -(-(len(rows[0]) - 1) // pieces)
    for begin in range(1, len(rows[0]), width):
        table = Table(title=heading if begin == 1 else f"{heading}, continued", title_justify="left")
        for k, cell in enumerate((rows[0][0], *rows[0][begin : begin + width])):
            table.add_column(cell, overflow="fold", no_wrap=k == 0)
        for row in rows[1:]:
            table.add_row(row[0], *row[begin : begin + width])
        out_console.print(table)
