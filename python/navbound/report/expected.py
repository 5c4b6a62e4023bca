"""A prediction of a flight as a page that opens without a network: time line, route and tables. It draws and computes nothing else."""

from __future__ import annotations

import math
from importlib.resources import files
from typing import TYPE_CHECKING, Any, NamedTuple

from jinja2 import Environment, StrictUndefined

from navbound.units import METRES_PER_NM, shortening

if TYPE_CHECKING:
    from collections.abc import Sequence

    import polars as pl

    from navbound.records.prediction import ExpectedFlight

WIDTH, HEIGHT, LEFT, RIGHT, BAND = 1040.0, 380.0, 64.0, 14.0, 26.0
MAP_HEIGHT = 420.0
COLOURS = {
    "gnss": "#2a6fb0",
    "dme_dme": "#3a8f5c",
    "vor_dme": "#8a7a1f",
    "coasting": "#c0561f",
    "aligning": "#8d6bb0",
    "stopped": "#a02030",
}
STEP_POINTS = 900
"""Points of a line: more than a screen shows."""


class Section(NamedTuple):
    """A heading and a table, headings of columns first."""

    heading: str
    rows: Sequence[tuple[str, ...]]


def page(
    record: ExpectedFlight, seconds: pl.DataFrame, shown: pl.DataFrame, sections: Sequence[Section], warned: Sequence[str] = ()
) -> str:
    """The page as text; cells with one of the words `warned` are marked."""
    template = files("navbound.report").joinpath("expected.html.j2").read_text(encoding="utf-8")
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    return environment.from_string(template).render(
        record=record,
        sections=sections,
        line=_time_line(record, seconds, shown),
        route=_route(record, seconds),
        colours={mode: colour for mode, colour in COLOURS.items() if mode in set(seconds["mode"])},
        warned=warned,
        departure=f"{record.departure_utc} UTC" if record.departure_utc else "of no date",
    )


def _thinned(table: pl.DataFrame) -> pl.DataFrame:
    return table.gather_every(max(1, table.height // STEP_POINTS))


def _time_line(record: ExpectedFlight, seconds: pl.DataFrame, shown: pl.DataFrame) -> dict[str, Any]:
    """Circle, total error, level and RNP over time on a logarithmic scale, and the mode beneath."""
    duration = max(record.duration_s, 1.0)
    values = [
        v for c in ("anp_circle_m", "tse_accuracy_m", "rnp_m") for v in seconds[c].to_list() if v is not None and math.isfinite(v) and v > 0
    ]
    values += [v for v in shown["hpl_m"].to_list() if v is not None and math.isfinite(v) and v > 0]
    low, high = math.floor(math.log10(min(values, default=1.0))), math.ceil(math.log10(max(values, default=10.0)))
    high = max(high, low + 1)
    floor = HEIGHT - BAND - 40.0

    def x(time_s: float) -> float:
        return round(LEFT + (WIDTH - LEFT - RIGHT) * time_s / duration, 1)

    def y(value: float) -> float:
        return round(floor - (floor - 12.0) * (math.log10(value) - low) / (high - low), 1)

    def lines(table: pl.DataFrame, column: str) -> list[str]:
        """A line a run of numbers: it is broken where there is none."""
        runs: list[list[str]] = [[]]
        for time_s, value in zip(table["time_s"], table[column], strict=True):
            if value is not None and math.isfinite(value) and value > 0:
                runs[-1].append(f"{x(time_s)},{y(value)}")
            elif runs[-1]:
                runs.append([])
        return [" ".join(run) for run in runs if len(run) > 1]

    thin = _thinned(seconds)
    return {
        "width": WIDTH,
        "height": HEIGHT,
        "left": LEFT,
        "right": WIDTH - RIGHT,
        "floor": floor,
        "series": [
            (name, lines(table, column))
            for name, column, table in (
                ("rnp", "rnp_m", thin),
                ("total", "tse_accuracy_m", thin),
                ("anp", "anp_circle_m", thin),
                ("level", "hpl_m", shown),
            )
        ],
        "rows": [(y(10.0**k), _metres(10.0**k)) for k in range(low, high + 1)],
        "times": [(x(t), f"{t / 60:.0f}") for t in _ticks(duration)],
        "band": floor + 8.0,
        "modes": [
            (x(a), round(max(x(b) - x(a), 0.5), 1), COLOURS.get(mode, "#6b7785"), f"{mode} {a / 60:.1f} to {b / 60:.1f} min")
            for a, b, mode in _runs(seconds)
        ],
        "outages": [
            (x(o.start_s), round(x(o.end_s) - x(o.start_s), 1), f"{o.what} {' '.join(o.names)}")
            for o in record.outages
            if o.what != "stations"
        ],
    }


def _metres(value: float) -> str:
    return f"{value / 1000:g} km" if value >= 1000 else f"{value:g} m"


def _ticks(duration_s: float) -> list[float]:
    step = next((s for s in (600.0, 1200.0, 1800.0, 3600.0, 7200.0) if duration_s / s <= 13), 14_400.0)
    return [k * step for k in range(int(duration_s // step) + 1)]


def _runs(seconds: pl.DataFrame) -> list[tuple[float, float, str]]:
    runs: list[tuple[float, float, str]] = []
    for time_s, mode in zip(seconds["time_s"], seconds["mode"], strict=True):
        if runs and runs[-1][2] == mode:
            runs[-1] = (runs[-1][0], time_s + 1.0, mode)
        else:
            runs.append((time_s, time_s + 1.0, mode))
    return runs


def _route(record: ExpectedFlight, seconds: pl.DataFrame) -> dict[str, Any]:
    """The route, north up, coloured by mode; longitudes are shortened by the cosine of the middle latitude."""
    lat, lon = seconds["lat_rad"].to_list(), seconds["lon_rad"].to_list()
    # Longitudes counted from the first, so that 180 degrees is no edge.
    south, north = min(lat), max(lat)
    shortened = shortening((south + north) / 2)
    east = [math.remainder(each - lon[0], math.tau) * shortened for each in lon]
    west = min(east)
    wide, tall = max(max(east) - west, 1e-6), max(north - south, 1e-6)
    edge = 40.0
    scale = min((WIDTH - 2 * edge) / wide, (MAP_HEIGHT - 2 * edge) / tall)

    middle = (WIDTH - wide * scale) / 2

    def at(k: int) -> tuple[float, float]:
        return round(middle + (east[k] - west) * scale, 1), round(MAP_HEIGHT - edge - (lat[k] - south) * scale, 1)

    lines = []
    for a, b, mode in _runs(seconds):
        rows = range(int(a), min(int(b), seconds.height - 1) + 1, max(1, seconds.height // STEP_POINTS))
        # The run ends where the next begins.
        points = [at(k) for k in (*rows, min(int(b), seconds.height - 1))]
        lines.append((COLOURS.get(mode, "#6b7785"), " ".join(f"{px},{py}" for px, py in points), mode))
    marks = list[tuple[float, float, str, str]]()
    for leg in record.legs:
        px, py = at(min(int(leg.start_s), seconds.height - 1))
        # A name over another would be no name.
        crowded = any(abs(px - x) < 40 and abs(py - y) < 11 for x, y, name, _ in marks if name)
        marks.append((px, py, "" if crowded else leg.leg.split("-")[0], "" if leg.status in {"kept", "no_rnp"} else "bad"))
    length_nm = record.length_m / METRES_PER_NM
    return {"width": WIDTH, "height": MAP_HEIGHT, "lines": lines, "marks": marks, "words": f"{length_nm:.0f} NM, north up"}
