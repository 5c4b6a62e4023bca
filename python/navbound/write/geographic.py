"""Tracks, paths, ellipses and events for maps of other programs: GeoJSON (RFC 7946) and KML (OGC 2.2)."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal
from xml.sax.saxutils import escape

import numpy as np
import polars as pl

from navbound.errors import FormatError, InputError
from navbound.rnp.usual import breaks
from navbound.status import USABLE
from navbound.table.arguments import checked
from navbound.table.columns import HORIZONTAL
from navbound.time import utc_text
from navbound.units import EARTH_RADIUS_M

if TYPE_CHECKING:
    from collections.abc import Iterator

    from navbound.records.run import Waypoint

NOT_JUDGED = "not judged"
"""State of the parts of a track whose epochs are not usable."""
_CORNERS = 36
_STYLES = {
    "normal": "ff3f7314",
    "caution": "ff00568f",
    "warning": "ff1f12c1",
    "unavailable": "ff6d6257",
    NOT_JUDGED: "ff6d6257",
    "path": "ff9b17b4",
}
"""Colours of KML, alpha blue green red: those of the report's light theme."""


@dataclass(frozen=True)
class Shape:
    """A feature.

    Attributes
    ----------
    kind : {"LineString", "Point", "Polygon"}
        Its geometry.
    places : list of list of float
        Longitude, latitude [deg] and, where it is known, the height [m]; of a polygon the ring, closed.
    properties : dict
        What a map shows of it: ``name``, ``what``, ``state`` and more.
    """

    kind: Literal["LineString", "Point", "Polygon"]
    places: list[list[float]]
    properties: dict[str, Any]


@checked
def shapes(
    epochs: pl.DataFrame, *, events: pl.DataFrame | None = None, waypoints: Sequence[Waypoint] = (), ellipse_every_s: float | None = None
) -> list[Shape]:
    """Everything of a run that has a place.

    Lines are cut where the state of the monitor changes, where nothing is known between two epochs, and at the date line. Epochs without a
    position are in no line.

    Parameters
    ----------
    epochs : DataFrame
        With ``track``, ``time_ns``, ``est_lat_rad``, ``est_lon_rad``; and ``alert``, ``status``, a path, a covariance, where it has them.
    events : DataFrame, optional
        Transitions of the monitor, which are put where the aircraft was.
    waypoints : sequence of Waypoint, optional
        Of the path.
    ellipse_every_s : float, optional
        Draw the 95 % ellipse of the position so often. [s]

    Raises
    ------
    InputError
        Columns that are missing, or an interval that is not positive.
    """
    missing = [name for name in ("track", "time_ns", "est_lat_rad", "est_lon_rad") if name not in epochs.columns]
    if missing:
        raise InputError("epochs", f"a table without {', '.join(missing)}", domain="a table with track, time and position")
    if ellipse_every_s is not None and not 0 < ellipse_every_s < math.inf:
        raise InputError("ellipse_every_s", ellipse_every_s, "s", "(0, inf)")
    made = [Shape("Point", [_place(w.lon_rad, w.lat_rad)], {"what": w.kind, "name": w.name}) for w in waypoints]
    for part in epochs.partition_by("track", maintain_order=True):
        track = str(part["track"][0])
        located = part.filter(pl.col("est_lat_rad").is_finite() & pl.col("est_lon_rad").is_finite())
        if located.is_empty():
            continue
        if {"path_lat_rad", "path_lon_rad"} <= set(part.columns):
            path = located.filter(pl.col("path_lat_rad").is_finite() & pl.col("path_lon_rad").is_finite())
            made += _lines(
                path,
                ("path_lon_rad", "path_lat_rad"),
                pl.Series(["path"] * path.height),
                {"what": "path", "track": track, "name": f"path of {track}"},
            )
        made += _lines(located, ("est_lon_rad", "est_lat_rad"), _states(located), {"what": "track", "track": track, "name": track})
        made += _events(located, events, track)
        if ellipse_every_s is not None and set(HORIZONTAL) <= set(located.columns):
            made += _ellipses(located, track, ellipse_every_s)
    return made


@checked
def geojson(made: Sequence[Shape], path: str | Path) -> Path:
    """Write shapes as a FeatureCollection.

    Raises
    ------
    FormatError
        It cannot be written.
    """
    features = [
        {
            "type": "Feature",
            "geometry": {
                "type": s.kind,
                "coordinates": s.places[0] if s.kind == "Point" else [s.places] if s.kind == "Polygon" else s.places,
            },
            "properties": s.properties,
        }
        for s in made
    ]
    return _put(path, json.dumps({"type": "FeatureCollection", "features": features}, ensure_ascii=False, allow_nan=False))


@checked
def kml(made: Sequence[Shape], path: str | Path) -> Path:
    """Write shapes as a document with one style for each state.

    Raises
    ------
    FormatError
        It cannot be written.
    """
    styles = "".join(
        f'<Style id="{name.replace(" ", "-")}"><LineStyle><color>{colour}</color><width>3</width></LineStyle>'
        f"<PolyStyle><color>{colour}</color><fill>0</fill></PolyStyle></Style>\n"
        for name, colour in _STYLES.items()
    )
    marks = "".join(map(_placemark, made))
    head = '<?xml version="1.0" encoding="UTF-8"?>\n<kml xmlns="http://www.opengis.net/kml/2.2"><Document>\n'
    return _put(path, f"{head}{styles}{marks}</Document></kml>\n")


def _placemark(shape: Shape) -> str:
    places = " ".join(",".join(f"{value:.9f}" for value in place) for place in shape.places)
    inner = f"<coordinates>{places}</coordinates>"
    # Heights are above the ellipsoid, and a viewer's are above the sea: lines lie on the ground.
    geometry = {
        "LineString": f"<LineString><tessellate>1</tessellate>{inner}</LineString>",
        "Point": f"<Point>{inner}</Point>",
        "Polygon": f"<Polygon><outerBoundaryIs><LinearRing>{inner}</LinearRing></outerBoundaryIs></Polygon>",
    }[shape.kind]
    style = str(shape.properties.get("state", "normal")).replace(" ", "-")
    words = "; ".join(f"{key}: {value}" for key, value in shape.properties.items() if key != "name")
    name = escape(_printable(str(shape.properties.get("name", ""))))
    described = f"<name>{name}</name><description>{escape(_printable(words))}</description><styleUrl>#{style}</styleUrl>"
    return f"<Placemark>{described}{geometry}</Placemark>\n"


def _printable(text: str) -> str:
    """Without the control characters that XML has no word for."""
    return "".join(c for c in text if c.isprintable())


def _place(lon_rad: float, lat_rad: float, h_m: float | None = None) -> list[float]:
    """Degrees to nine decimals, a tenth of a millimetre."""
    place = [round((math.degrees(lon_rad) + 180.0) % 360.0 - 180.0, 9), round(math.degrees(lat_rad), 9)]
    return [*place, round(h_m, 4)] if h_m is not None and math.isfinite(h_m) else place


def _states(epochs: pl.DataFrame) -> pl.Series:
    usable = epochs["status"].is_in(USABLE) if "status" in epochs.columns else pl.Series([True] * epochs.height)
    alert = epochs["alert"].fill_null("normal") if "alert" in epochs.columns else pl.Series(["normal"] * epochs.height)
    return pl.select(pl.when(usable).then(alert).otherwise(pl.lit(NOT_JUDGED))).to_series()


def _lines(epochs: pl.DataFrame, names: tuple[str, str], states: pl.Series, properties: dict[str, Any]) -> Iterator[Shape]:
    """One line a run of epochs with one state, joined to the next, and cut at the date line.

    Nothing joins epochs between which nothing is known; one between two such gaps is a point.
    """
    if epochs.height < 2:
        return
    lon, lat = (epochs[name].to_list() for name in names)
    heights = epochs["est_h_m"].to_list() if names[0].startswith("est") and "est_h_m" in epochs.columns else [None] * epochs.height
    times, known = epochs["time_ns"].to_list(), states.to_list()
    gaps = {int(k) + 1 for k in breaks(epochs["time_ns"].to_numpy())}
    begin = 0
    for k in range(1, len(known) + 1):
        if k < len(known) and known[k] == known[begin] and k not in gaps:
            continue
        last = k - 1 if k in gaps else min(k, len(known) - 1)
        places = [_place(lon[i], lat[i], heights[i]) for i in range(begin, last + 1)]
        more = {"state": known[begin], "from_utc": utc_text(times[begin]), "until_utc": utc_text(times[last])}
        if len(places) == 1 and begin in gaps | {0}:
            yield Shape("Point", places, properties | more)
        for piece in _cut(places):
            yield Shape("LineString", piece, properties | more)
        begin = k


def _cut(places: list[list[float]]) -> Iterator[list[list[float]]]:
    """Pieces that do not cross the date line; what crosses ends on it (RFC 7946, 3.1.9)."""
    piece = [places[0]]
    for before, after in itertools.pairwise(places):
        if abs(after[0] - before[0]) <= 180.0:
            piece.append(after)
            continue
        side = math.copysign(180.0, before[0])
        share = (side - before[0]) / (after[0] + 2 * side - before[0])
        middle = [a + share * (b - a) for a, b in zip(before[1:], after[1:], strict=False)]
        yield [*piece, [side, *middle]]
        piece = [[-side, *middle], after]
    if len(piece) > 1:
        yield piece


def _events(located: pl.DataFrame, events: pl.DataFrame | None, track: str) -> Iterator[Shape]:
    """Each transition where the aircraft was at the last epoch before it."""
    if events is None or events.is_empty():
        return
    times = located["time_ns"].to_numpy()
    for row in events.filter(pl.col("track") == track).iter_rows(named=True):
        at = int(np.searchsorted(times, row["annunciation_ns"], side="right")) - 1
        lon, lat = located["est_lon_rad"][max(at, 0)], located["est_lat_rad"][max(at, 0)]
        when = utc_text(row["annunciation_ns"])
        properties = {
            "what": "event",
            "track": track,
            "name": f"{row['kind']} {when} UTC",
            "state": row["kind"],
            "utc": when,
            "words": row["words"],
        }
        yield Shape("Point", [_place(lon, lat)], properties)


def _ellipses(located: pl.DataFrame, track: str, every_s: float) -> Iterator[Shape]:
    """The ellipse that holds the position with 95 %, of two normal errors: 2.448 deviations."""
    angle = np.linspace(0.0, math.tau, _CORNERS + 1)
    ring = np.stack([np.cos(angle), np.sin(angle)])
    usable = located.filter(pl.col("status").is_in(USABLE)) if "status" in located.columns else located
    due = -math.inf
    for row in usable.select("time_ns", "est_lat_rad", "est_lon_rad", *HORIZONTAL).iter_rows(named=True):
        ee, en, nn = (row[name] for name in HORIZONTAL)
        if row["time_ns"] < due or any(v is None or not math.isfinite(v) for v in (ee, en, nn)):
            continue
        due = row["time_ns"] + every_s * 1e9
        values, vectors = np.linalg.eigh(np.array([[ee, en], [en, nn]]))
        east, north = vectors @ (np.sqrt(np.maximum(values, 0.0) * -2.0 * math.log(0.05))[:, None] * ring)
        lat = row["est_lat_rad"] + north / EARTH_RADIUS_M
        lon = row["est_lon_rad"] + east / (EARTH_RADIUS_M * math.cos(row["est_lat_rad"]))
        places = [_place(a, b) for a, b in zip(lon.tolist(), lat.tolist(), strict=True)]
        # Around the date line it stays in one piece, beyond 180 degrees.
        places = [[places[0][0] + math.remainder(x - places[0][0], 360.0), y] for x, y in places]
        # The ring is closed by the same numbers, and runs against the clock as RFC 7946 requires.
        places[-1] = places[0]
        when = utc_text(row["time_ns"])
        yield Shape("Polygon", _against_the_clock(places), {"what": "ellipse", "track": track, "name": f"95 % {when} UTC", "utc": when})


def _against_the_clock(ring: list[list[float]]) -> list[list[float]]:
    # From the first corner, since a ring of a metre is lost among the digits of degrees.
    x0, y0 = ring[0]
    area = sum((a[0] - x0) * (b[1] - y0) - (b[0] - x0) * (a[1] - y0) for a, b in itertools.pairwise(ring))
    return ring if area >= 0 else ring[::-1]


def _put(path: str | Path, text: str) -> Path:
    try:
        Path(path).write_text(text, encoding="utf-8")
    except OSError as e:
        raise FormatError(path, f"cannot be written: {e.strerror or e}") from e
    return Path(path)
