"""Two runs beside each other as a page that opens without a network. It draws and computes nothing else."""

from __future__ import annotations

from importlib.resources import files
from itertools import groupby
from typing import TYPE_CHECKING, Any

from jinja2 import Environment, StrictUndefined

from navbound.time import utc_text

if TYPE_CHECKING:
    from navbound.records.comparison import ChangedWords, Comparison

WIDTH, LEFT, ROW = 1040.0, 150.0, 22.0
LISTED_NUMBERS = 400
"""Numbers on the page; all of them are in the record."""
MOST_ROWS = 30
"""Tracks of the picture of changes."""


def page(record: Comparison) -> str:
    """The page as text."""
    template = files("navbound.report").joinpath("comparison.html.j2").read_text(encoding="utf-8")
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters |= {"number": number, "when": utc_text, "signed": signed}
    return environment.from_string(template).render(
        record=record,
        picture=_picture([c for c in record.changes if c.column == "alert"]),
        numbers=record.numbers[:LISTED_NUMBERS],
        left_out=max(0, len(record.numbers) - LISTED_NUMBERS),
    )


def number(value: float | None) -> str:
    """Six digits: what is compared was computed, not measured."""
    return "none" if value is None else f"{value:.6g}".replace("-", "\N{MINUS SIGN}")


def signed(value: float | None) -> str:
    """The same with its sign."""
    return "" if value is None else f"{'+' if value > 0 else ''}{number(value)}"


def _picture(changes: list[ChangedWords]) -> dict[str, Any] | None:
    """When the alert was another one: a row a track, a bar a change."""
    if not changes:
        return None
    tracks = [(track, list(of)) for track, of in groupby(changes, lambda change: change.track)][:MOST_ROWS]
    first = min(c.start_ns for _, of in tracks for c in of)
    span = max(max(c.end_ns for _, of in tracks for c in of) - first, 1_000_000_000)

    def x(time_ns: int) -> float:
        return round(LEFT + (WIDTH - LEFT - 10.0) * (time_ns - first) / span, 1)

    rows = [
        (
            track,
            round(ROW * k + 8.0, 1),
            [
                (
                    x(c.start_ns),
                    max(round(x(c.end_ns) - x(c.start_ns), 1), 2.0),
                    f"{c.a or 'none'} to {c.b or 'none'}, {utc_text(c.start_ns)}",
                )
                for c in of
            ],
        )
        for k, (track, of) in enumerate(tracks)
    ]
    return {
        "width": WIDTH,
        "height": ROW * len(rows) + 30.0,
        "rows": rows,
        "left": LEFT,
        "first": utc_text(first),
        "last": utc_text(first + span),
    }
