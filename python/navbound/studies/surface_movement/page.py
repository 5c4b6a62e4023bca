"""The surface-movement study as one page that opens without a network. It draws what the study holds and computes nothing."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.resources import files
from typing import TYPE_CHECKING

import numpy as np
from jinja2 import Environment, StrictUndefined

from navbound.studies.surface_movement.table import HEADINGS, bias_words, held

if TYPE_CHECKING:
    from navbound.studies.surface_movement.records import Cell, Curve, Errors, Study

WIDTH, HEIGHT = 360.0, 240.0
LEFT, BOTTOM, TOP, RIGHT = 52.0, 34.0, 10.0, 10.0
LOWEST_DECADE = -6
COLOURS = ("#fde0c5", "#cfe3cd", "#a3cfa6", "#73b57c", "#459a58", "#1d7a3b")
"""From no bias to the largest of the grid."""
DARK_FROM = 4
"""Words on these are white."""


@dataclass(frozen=True)
class Box:
    """One cell of a heat map."""

    words: str
    colour: str
    dark: bool
    title: str
    empty: bool


@dataclass(frozen=True)
class Row:
    """One row of a heat map."""

    name: str
    first: bool
    boxes: list[Box]


@dataclass(frozen=True)
class Map:
    """One heat map."""

    title: str
    times: list[str]
    rows: list[Row]


@dataclass(frozen=True)
class Tick:
    """A mark on an axis."""

    at: float
    words: str


@dataclass(frozen=True)
class Plot:
    """One diagram: paths and points in pixels."""

    title: str
    x_words: str
    y_words: str
    x_ticks: list[Tick]
    y_ticks: list[Tick]
    lines: list[tuple[str, str]]
    """Class and points."""
    points: list[tuple[float, float]]


def html(study: Study) -> str:
    """The page."""
    template = files("navbound").joinpath("studies/surface_movement/page.html.j2").read_text(encoding="utf-8")
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    shown = ("accuracy", "single", "multi", "monitor")
    return environment.from_string(template).render(
        study=study,
        held=held(study),
        maps=[_map(study, quantity, "A") for quantity in shown] + [_map(study, "monitor", "B")],
        curves=[_curve(c) for c in study.curves if c.phase in {"NTW", "ATW"} and (c.case == "A" or c.mode == "F2")],
        errors=[_errors(e, study) for e in study.errors],
        colours=list(zip(COLOURS, [f"{b:g}" for b in sorted(study.configuration.grid.bias_m)], strict=False)),
        width=WIDTH,
        height=HEIGHT,
        left=LEFT,
        bottom=HEIGHT - BOTTOM,
        top=TOP,
        right=WIDTH - RIGHT,
    )


def _map(study: Study, quantity: str, case: str) -> Map:
    cells = [c for c in study.cells if c.quantity == quantity and c.case == case]
    times = sorted({c.coasting_s for c in cells})
    by_place = {(c.phase, c.mode, c.coasting_s): c for c in cells}
    biases = sorted(study.configuration.grid.bias_m)
    rows = [
        Row(f"{p.id} {b.mode}", k == 0, [_box(by_place.get((p.id, b.mode, t)), biases) for t in times])
        for p in study.phases
        for k, b in enumerate(study.before)
    ]
    title = f"{HEADINGS[quantity]}, case {case}"
    return Map(title, ["before" if t == 0 else f"{t:g} s" for t in times], rows)


def _box(cell: Cell | None, biases: list[float]) -> Box:
    if cell is None:
        return Box("", "none", dark=False, title="no geometry has a value", empty=True)
    unit = "decades of margin" if cell.quantity == "monitor" else "m"
    worst = "no value at one epoch at least" if cell.worst_m is None else f"worst without bias {cell.worst_m:.2f} {unit}"
    share = "" if cell.quantity == "monitor" else f"; {100 * cell.share:.0f} % of epochs within the limit without bias"
    title = f"{cell.phase} {cell.mode} {cell.coasting_s:g} s: {worst}{share}"
    if cell.bias_m is None:
        return Box("-", "none", dark=False, title=title, empty=True)
    place = round((len(COLOURS) - 1) * biases.index(cell.bias_m) / max(1, len(biases) - 1))
    return Box(bias_words(cell), COLOURS[place], dark=place >= DARK_FROM, title=title, empty=False)


def _x(value: float, low: float, high: float) -> float:
    return round(LEFT + (value - low) / (high - low) * (WIDTH - LEFT - RIGHT), 2)


def _y(value: float, low: float, high: float) -> float:
    return round(HEIGHT - BOTTOM - (value - low) / (high - low) * (HEIGHT - TOP - BOTTOM), 2)


def _path(x: list[float], y: list[float]) -> str:
    return " ".join(f"{a:g},{b:g}" for a, b in zip(x, y, strict=True))


def _ticks(high: float) -> list[float]:
    step = next(s for s in (0.5, 1.0, 2.0, 5.0, 10.0, 50.0, 1e6) if high / s <= 8)
    return [float(v) for v in np.arange(0.0, high + 1e-9, step)]


def _curve(curve: Curve) -> Plot:
    high = curve.error_m[-1]
    x = [_x(e, 0.0, high) for e in curve.error_m]

    def line(values: list[float]) -> str:
        return _path(x, [_y(max(LOWEST_DECADE, float(np.log10(max(v, 1e-300)))), LOWEST_DECADE, 0.0) for v in values])

    return Plot(
        f"{curve.phase}, {curve.mode}, case {curve.case}",
        "range error, m",
        "missed detection",
        [Tick(_x(v, 0.0, high), f"{v:g}") for v in _ticks(high)],
        [Tick(_y(d, LOWEST_DECADE, 0.0), f"1e{d}" if d else "1") for d in range(LOWEST_DECADE, 1)],
        [("limit", line(curve.limit)), ("monitor", line(curve.monitor))],
        [],
    )


def _errors(errors: Errors, study: Study) -> Plot:
    high = 1.05 * max(*errors.hpl_m, *errors.hpe_m, 1.0)
    diagonal = _path([_x(0.0, 0.0, high), _x(high, 0.0, high)], [_y(0.0, 0.0, high), _y(high, 0.0, high)])
    bias = max(study.configuration.grid.bias_m)
    return Plot(
        f"{errors.mode}, before coasting, {bias:g} m of bias",
        "horizontal error (simulated), m",
        "HPL, m",
        [Tick(_x(v, 0.0, high), f"{v:g}") for v in _ticks(high)],
        [Tick(_y(v, 0.0, high), f"{v:g}") for v in _ticks(high)],
        [("diagonal", diagonal)],
        [(_x(e, 0.0, high), _y(v, 0.0, high)) for e, v in zip(errors.hpe_m, errors.hpl_m, strict=True)],
    )
