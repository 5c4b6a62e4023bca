"""One procedure as a page that opens without a network: plan, profile and the table of legs. It draws and computes nothing else."""

from __future__ import annotations

import math
from importlib.resources import files
from typing import TYPE_CHECKING, Any, NamedTuple

from jinja2 import Environment, StrictUndefined

from navbound.procedures.legs import ORIGINS, STATES
from navbound.procedures.picture import altitude_words, picture
from navbound.units import METRES_PER_FT, METRES_PER_NM
from navbound.words.plurals import agreeing

if TYPE_CHECKING:
    from navbound.procedures import VerticalPath
    from navbound.procedures.findings import Finding
    from navbound.procedures.legs import Leg, Procedure
    from navbound.procedures.picture import Picture
    from navbound.vertical import Surface

HEADINGS = (
    "seq",
    "fix",
    "leg",
    "part",
    "RNP, NM",
    "RNP from",
    "length, NM",
    "radius, NM",
    "altitude, ft",
    "angle",
    "speed, kt",
    "remark",
    "line",
)
WIDTH, HEIGHT, EDGE = 1040.0, 620.0, 60.0
PROFILE_HEIGHT = 260.0
STEPS = 40
"""Of the vertical path in the profile. [1]"""


def cells(leg: Leg) -> tuple[str, ...]:
    """One leg in the units of the screen; a number that does not exist is a dash."""
    end = "-" if not math.isfinite(leg.length_m) else f"{leg.length_m / METRES_PER_NM:.2f}"
    coded = "" if leg.rnp_coded_m is None or not leg.rnp_differs else f" (field {leg.rnp_coded_m / METRES_PER_NM:.3g})"
    rnp = f"{leg.rnp_m / METRES_PER_NM:.3g}" if math.isfinite(leg.rnp_m) else "-"
    speed = "" if leg.speed_kt is None else f"{ {'-': '≤ ', '+': '≥ '}.get(leg.speed_description, '') }{leg.speed_kt:g}"
    return (
        f"{leg.sequence:03d}",
        leg.fix or "-",
        f"{leg.terminator}{' ' + leg.turn if leg.turn else ''}{' fly-over' if leg.fly_over else ''}",
        leg.part,
        rnp + coded,
        ORIGINS[leg.rnp_origin] if leg.has_path else "",
        end,
        "" if leg.radius_m is None else f"{leg.radius_m / METRES_PER_NM:.3f}",
        altitude_words(leg),
        "" if leg.vertical_angle_rad is None else f"{math.degrees(leg.vertical_angle_rad):.2f}°",
        speed,
        "" if leg.state in {"full", "point"} else STATES[leg.state],
        str(leg.line),
    )


class Note(NamedTuple):
    """A sentence beside the table."""

    text: str
    is_warning: bool


class Heights(NamedTuple):
    """Vertical path and obstacle clearance surface of an approach, where it has them, and what is said of them."""

    path: VerticalPath | None
    surface: Surface | None
    words: tuple[str, ...]


def notes(procedure: Procedure, findings: list[Finding], heights: Heights) -> list[Note]:
    """What a reader must know beside the table."""
    notes = [Note(text, is_warning=False) for text in heights.words]
    if procedure.levels:
        names = ", ".join(f"RNP {x.rnp_m / METRES_PER_NM:.3g}" for x in procedure.levels)
        selected = f"; selected: {procedure.line}." if procedure.line else "; none selected."
        notes.append(Note(f"Lines of minima: {names}{selected}", is_warning=False))
    warnings = []
    n = procedure.n_without_rnp
    if n:
        warnings = [
            f"{n} of {sum(x.has_path for x in procedure.legs)} legs with a path {agreeing(n, 'has', 'have')} no RNP and "
            f"{agreeing(n, 'is', 'are')} not judged; "
            "select a line or allow defaults."
        ]
    differing = [x for x in procedure.legs if x.rnp_differs]
    warnings += [
        f"Leg to {x.fix}: the field has RNP {x.rnp_coded_m / METRES_PER_NM:.3g}, {ORIGINS[x.rnp_origin]}"
        + (f" RNP {x.rnp_m / METRES_PER_NM:.3g}." if math.isfinite(x.rnp_m) else ".")
        for x in differing
        if x.rnp_coded_m is not None
    ]
    warnings += [f"Line {f.line}, leg {f.sequence}: {f.words}." for f in findings]
    return notes + [Note(text, is_warning=True) for text in (*warnings, *procedure.notes, *procedure.doubts)]


def page(procedure: Procedure, findings: list[Finding], heights: Heights) -> str:
    """The page as HTML.

    Parameters
    ----------
    procedure : Procedure
        From :func:`navbound.path.procedure`.
    findings : list of Finding
        Contradictions in its data.
    heights : Heights
        What is drawn below the coded altitudes.
    """
    shown = picture(procedure)
    template = files("navbound.report").joinpath("procedure.html.j2").read_text(encoding="utf-8")
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    return environment.from_string(template).render(
        title=procedure.name,
        notes=notes(procedure, findings, heights),
        plan=_plan(procedure, shown),
        profile=_profile(procedure, shown, heights),
        headings=HEADINGS,
        rows=[cells(leg) for leg in procedure.legs],
        source=procedure.file,
    )


def _plan(procedure: Procedure, shown: Picture) -> dict[str, Any]:
    xs = [x for line in shown.lines for x in line.east_m] + [m.east_m for m in shown.marks] or [0.0]
    ys = [y for line in shown.lines for y in line.north_m] + [m.north_m for m in shown.marks] or [0.0]
    span = max((max(xs) - min(xs)) / (WIDTH - 2 * EDGE), (max(ys) - min(ys)) / (HEIGHT - 2 * EDGE), 1.0)
    height = (max(ys) - min(ys)) / span + 2 * EDGE

    def at(east: float, north: float) -> tuple[float, float]:
        return round(EDGE + (east - min(xs)) / span, 1), round(EDGE + (max(ys) - north) / span, 1)

    lines = [
        {
            "part": procedure.legs[line.leg].part,
            "points": " ".join("{},{}".format(*at(e, n)) for e, n in zip(line.east_m, line.north_m, strict=True)),
            "title": " ".join(cells(procedure.legs[line.leg])[:7]),
        }
        for line in shown.lines
    ]
    bar_m = next(m for m in (50, 20, 10, 5, 2, 1, 0.5, 0.1, 0.0) if m * METRES_PER_NM / span < WIDTH / 4)
    bar = {"x1": 10.0, "x2": 10.0 + bar_m * METRES_PER_NM / span, "y": height - 10, "words": f"{bar_m:g} NM"}
    marks = _labelled([(*at(m.east_m, m.north_m), m.name) for m in shown.marks])
    return {"width": WIDTH, "height": round(height, 1), "lines": lines, "marks": marks, "bar": bar}


def _profile(procedure: Procedure, shown: Picture, heights: Heights) -> dict[str, Any] | None:
    known = [m for m in shown.marks if math.isfinite(m.along_m) and math.isfinite(m.altitude_m)]
    if len(known) < 2 or known[-1].along_m <= known[0].along_m:
        return None
    path, surface = _below(procedure, heights)
    drawn = [(m.along_m, m.altitude_m) for m in known]
    first, length = known[0].along_m, known[-1].along_m - known[0].along_m
    low, high = (end(a for _, a in (*drawn, *path, *surface)) for end in (min, max))
    rise = max(high - low, 1.0)

    def at(along: float, altitude: float) -> tuple[float, float]:
        x = 70 + (along - first) / length * (WIDTH - 160)
        return round(x, 1), round(PROFILE_HEIGHT - 30 - (altitude - low) / rise * (PROFILE_HEIGHT - 80), 1)

    def text(places: list[tuple[float, float]]) -> str:
        return " ".join(f"{x},{y}" for x, y in (at(*place) for place in places))

    rows = [{"y": at(first, a)[1], "words": f"{a / METRES_PER_FT:.0f} ft"} for a in (low, high)]
    marks = _labelled([(*at(*p), f"{m.name} {m.altitude}") for p, m in zip(drawn, known, strict=True)])
    lines = {"points": text(drawn), "path": text(path), "surface": text(surface)}
    return {"width": WIDTH, "height": PROFILE_HEIGHT, "marks": marks, "rows": rows} | lines


def _below(procedure: Procedure, heights: Heights) -> tuple[list[tuple[float, float]], list[tuple[float, float]]]:
    """The vertical path and the surface below it: places along the procedure and altitudes."""
    path, surface = heights.path, heights.surface
    if path is None:
        return [], []
    begin, length = procedure.legs[path.legs[0]].begin_m, path.begins_m[0]
    if not math.isfinite(begin):
        return [], []
    before = [length * (1.0 - k / STEPS) for k in range(STEPS + 1)]
    of_path = [(begin + length - s, altitude) for s, altitude in zip(before, path.altitude_m(before).tolist(), strict=True)]
    if surface is None:
        return of_path, []
    return of_path, [(begin + length - s, surface.altitude_m(s)) for s in (length, surface.origin_m)]


def _labelled(places: list[tuple[float, float, str]]) -> list[dict[str, Any]]:
    """Marks with their words beside them; words that would lie on others go below."""
    marks: list[dict[str, Any]] = []
    for x, y, name in places:
        if any(m["name"] == name and abs(m["x"] - x) < 1 and abs(m["y"] - y) < 1 for m in marks):
            continue
        ty = y - 6
        while any(abs(m["ty"] - ty) < 12 and m["tx"] - 7 * len(name) < x + 6 < m["tx"] + 7 * len(m["name"]) for m in marks):
            ty += 13
        marks.append({"x": x, "y": y, "tx": x + 6, "ty": round(ty, 1), "name": name})
    return marks
