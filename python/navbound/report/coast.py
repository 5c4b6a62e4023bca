"""What a map shows beneath the tracks: the coast, the land, the airports where tracks begin and end."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING

import numpy as np

from navbound.evaluation import sizes
from navbound.read.checks.places import east_north_m
from navbound.read.runways import near
from navbound.records.run import Waypoint

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from navbound.records.performance import GridPoint

REACH_M = 6000.0
"""An airport this near to the end of a track is where it lies. Provenance: ours."""
_CELL_DEG = 5.0
"""Of the ionospheric grid. [deg]"""
MOST_AIRPORTS = 40
"""More names than this are a list, no map. [1]"""


def airports(ends: NDArray[np.float64], known: Sequence[Waypoint]) -> list[Waypoint]:
    """Airports within `REACH_M` of the ends of tracks, (n, 2) latitude and longitude, that no point of the map names."""
    if not len(ends):
        return []
    named = {w.name.partition("/")[0] for w in known}
    places: dict[str, Waypoint] = {}
    for runway in near(ends[:, 0], ends[:, 1]):
        name = runway.name.partition("/")[0]
        lat, lon = (runway.lat_rad + runway.far_lat_rad) / 2, (runway.lon_rad + runway.far_lon_rad) / 2
        apart_m = sizes.horizontal(east_north_m(np.full_like(ends, (lat, lon)), ends))
        if name not in named and float(apart_m.min()) <= REACH_M:
            places.setdefault(name, Waypoint(name=name, lat_rad=lat, lon_rad=lon, kind="runway"))
    return list(places.values())[:MOST_AIRPORTS]


@cache
def _coastline() -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    """Longitude and latitude in degrees of all points of the prepared file, and whether a segment leads from each to the next.

    The file has one polyline a line, thousandths of a degree, each point as the difference from the one before.
    """
    text = files("navbound").joinpath("_web/coastline.txt").read_text(encoding="ascii")
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    steps = np.fromstring(" ".join(lines), dtype=np.int64, sep=" ").reshape(-1, 2)
    # A point is two numbers, and a number is followed by one space or the end of its line.
    ends = np.cumsum([(line.count(" ") + 1) // 2 for line in lines])
    points = np.cumsum(steps, axis=0)
    # The sums begin anew with every polyline.
    before = np.repeat(np.vstack((np.zeros((1, 2), np.int64), points[ends[:-1] - 1])), np.diff(ends, prepend=0), axis=0)
    lon, lat = ((points - before) / 1000.0).T
    leads = np.ones(len(lon), dtype=bool)
    leads[ends - 1] = False
    return lon, lat, leads


def clip_coastline(south: float, west: float, north: float, east: float) -> list[list[int]]:
    """Coastline inside a region given in degrees: polylines of longitude, latitude in thousandths of a degree, differenced."""
    middle = (west + east) / 2
    of_file, lat, leads = _coastline()
    lon = middle + (of_file - middle + 180.0) % 360.0 - 180.0
    inside = (lat >= south) & (lat <= north) & (lon >= west) & (lon <= east)
    # A segment stays when either end is inside; it breaks where the longitude wraps.
    segment = np.zeros(len(lon) + 1, dtype=np.int8)
    segment[1:-1] = leads[:-1] & (inside[:-1] | inside[1:]) & (np.abs(np.diff(lon)) < 180.0)
    edges = np.flatnonzero(np.diff(segment))
    kept: list[list[int]] = []
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        points = np.rint(np.column_stack((lon[first : last + 1], lat[first : last + 1])) * 1000.0).astype(np.int64)
        kept.append(np.diff(points, axis=0, prepend=np.zeros((1, 2), dtype=np.int64)).ravel().tolist())
    return kept


def clip_land(south: float, west: float, north: float, east: float) -> list[list[int]]:
    """Land inside a region given in degrees: rings of longitude, latitude in thousandths of a degree, differenced.

    Lakes are rings too: a point is on land where an odd number of rings surround it.
    """
    rings = []
    for ring in _rings():
        # The same ring a turn further, where the region reaches there.
        for turn in (-360.0, 0.0, 360.0):
            low, high = ring[:, 0].min() + turn, ring[:, 0].max() + turn
            if low > east or high < west or ring[:, 1].min() > north or ring[:, 1].max() < south:
                continue
            inside = _clipped(ring + np.array([turn, 0.0]), (west, south), (east, north))
            points = np.rint(inside * 1000.0).astype(np.int64)
            steps = np.diff(points, axis=0, prepend=np.zeros((1, 2), dtype=np.int64))
            if len(points) > 2:
                rings.append(steps[np.concatenate([[True], np.any(steps[1:] != 0, axis=1)])].ravel().tolist())
    return rings


@cache
def _rings() -> list[NDArray[np.float64]]:
    """Every polyline of the coast closed: along the antimeridian, where the atlas cut it, and around the pole."""
    lon, lat, leads = _coastline()
    ends = np.flatnonzero(~leads) + 1
    rings = []
    for points in np.split(np.column_stack((lon, lat)), ends[:-1]):
        around = abs(points[-1, 0] - points[0, 0]) > 180.0
        corners = [(points[-1, 0], -90.0), (points[0, 0], -90.0)] if around else []
        rings.append(np.vstack([points, *(np.array([corner]) for corner in corners)]))
    return rings


def _clipped(ring: NDArray[np.float64], low: tuple[float, float], high: tuple[float, float]) -> NDArray[np.float64]:
    """The ring inside a rectangle, edge by edge (Sutherland and Hodgman)."""
    for axis, limit, side in ((0, low[0], 1.0), (0, high[0], -1.0), (1, low[1], 1.0), (1, high[1], -1.0)):
        if not len(ring):
            break
        after = np.roll(ring, -1, axis=0)
        inside, next_inside = (side * (points[:, axis] - limit) >= 0 for points in (ring, after))
        crosses = inside != next_inside
        span = after[:, axis] - ring[:, axis]
        share = np.where(crosses, (limit - ring[:, axis]) / np.where(span == 0, 1.0, span), 0.0)
        crossing = ring + share[:, None] * (after - ring)
        # Of each edge: its beginning where that lies inside, then where it crosses the limit.
        both = np.stack([ring, crossing], axis=1)
        ring = both[np.stack([inside, crosses], axis=1)]
    return ring


def grid_region(points: Sequence[GridPoint]) -> tuple[float, float, float, float] | None:
    """South, west, north, east of a map of points, a cell of 5 degrees around them; it begins after the widest gap of longitudes. [deg]."""
    if not points:
        return None
    lats = np.degrees([point.lat_rad for point in points])
    lons = np.unique((np.rint(np.degrees([point.lon_rad for point in points])) + 180.0) % 360.0 - 180.0)
    gaps = np.diff(np.append(lons, lons[0] + 360.0))
    # Of gaps that are the same the one across the antimeridian.
    west = float(lons[-int(gaps[::-1].argmax()) % len(lons)])
    south, north = max(-90.0, float(lats.min()) - _CELL_DEG), min(90.0, float(lats.max()) + _CELL_DEG)
    beside = min(_CELL_DEG, float(gaps.max()) / 2)
    return round(south), west - beside, round(north), west + 360.0 - float(gaps.max()) + beside
