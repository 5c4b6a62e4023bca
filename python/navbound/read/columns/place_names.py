"""Names of places: which coordinate a column is, of which place, and whether it is one of the vehicle."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from typing import Literal, NamedTuple

from navbound.read.columns.naming import name_parts, words

Axis = Literal["est_lat_rad", "est_lon_rad"]
AXES: tuple[Axis, Axis] = ("est_lat_rad", "est_lon_rad")


NO_TRUTH = words("station base receiver frame system datum ellipsoid waypoint wpt runway thr threshold line path")
"""Parts of names of something else than the vehicle that is called a reference. Provenance: ours."""
_RECEIVERS = words("true gps gnss raw irs ins fms adsb own est fix rtk ref")
_LATITUDES = words("lat latitude latitud breite breitengrad") | {f"{whose}{lat}" for whose in _RECEIVERS for lat in ("lat", "latitude")}
_LONGITUDES = words("lon lng longitude longitud laenge länge laengengrad") | {
    f"{whose}{lon}" for whose in _RECEIVERS for lon in ("lon", "lng", "longitude")
}
_NO_VEHICLE = NO_TRUTH | words(
    "airport origin destination dest departure dep arrival arr home target goal next prev previous start end first last site sensor "
    "radar waypoint waypoints wp wps poi pois landmark landmarks obstacle obstacles contact contacts weather camera to ms latency "
    "route routes plan flightplan leg legs vor dme ndb others polygon geofence fence targets airports runways beacon antenna cpr "
    "centre center cell grid tile offset scale speed vel velocity rate err error sigma std var acc accuracy axis pred predicted "
    "forecast intruder traffic lead leader min max mean avg average median dot variance accel acceleration g dev deviation cmd "
    "command trim stick force jerk ctrl control gain load"
)
"""Parts of names of a latitude or a longitude, and of one that is none of the vehicle now. Provenance: ours."""
_ACCELERATION = re.compile(r"(?i)lat_?ac$")
"""Names of a lateral acceleration: `LatAc`. Provenance: from headers of Garmin's flight decks."""
_INERTIAL = words("irs ins iru ir adiru adirs inertial dr dead reckoning deadreckoning")
"""Parts of names of a place that only inertial sensors keep. Provenance: ours."""
_COORDINATE = "|".join(sorted(_LATITUDES | _LONGITUDES, key=len, reverse=True))


def _unnumbered(name: str) -> set[str]:
    return {part.rstrip("0123456789") for part in name_parts(name)}


def speaks_of_place(name: str) -> bool:
    """Whether the name is one of another place of the vehicle: the truth of somebody else, a second receiver.

    A number that is named of both coordinates is neither of them: PX4 counts `lat_lon_reset_counter`, and `delta_lat_lon[0]` is a step.
    """
    parts = _unnumbered(name)
    return (
        (_LATITUDES.isdisjoint(parts) != _LONGITUDES.isdisjoint(parts)) and parts.isdisjoint(_NO_VEHICLE) and not _ACCELERATION.search(name)
    )


@dataclass(frozen=True)
class Place:
    """What a column is by its name: which coordinate, of which place, and whether inertial sensors alone keep that."""

    axis: Axis
    whose: tuple[str, ...]
    inertial: bool


def other_place(name: str) -> Place | None:
    """The coordinate of another place of the vehicle that a column is by its name; or none."""
    if not speaks_of_place(name):
        return None
    return Place("est_lat_rad" if _unnumbered(name) & _LATITUDES else "est_lon_rad", whose(name), keeps_inertial(name))


def axes_of(name: str) -> set[str]:
    """Of which coordinates a name is, of whatever place."""
    axes = {"est_lat_rad": _LATITUDES, "est_lon_rad": _LONGITUDES}
    parts = " ".join(name_parts(name))
    return {axis for axis, of in axes.items() if re.search(rf"(?<![a-z])(?:{'|'.join(_RECEIVERS)})?(?:{'|'.join(of)})(?![a-z])", parts)}


def whose(name: str) -> tuple[str, ...]:
    """The parts of a name without what says that it is a coordinate."""
    return tuple(re.sub(_COORDINATE, "", part) for part in name_parts(name))


def keeps_inertial(name: str) -> bool:
    """Whether a name is one of what inertial sensors alone keep."""
    return not _INERTIAL.isdisjoint(_unnumbered(name))


def is_no_vehicle(name: str) -> bool:
    """Whether a name is one of a place that is none of the vehicle now."""
    return not _NO_VEHICLE.isdisjoint(_unnumbered(name))


_PAIRS = words("pos position coord coords coordinate coordinates geom geometry loc location point place latlon latlng lonlat")
"""Parts of names of a place with both coordinates in one field. Provenance: ours."""
_COUNTS = words("count counter counts cnt reset resets num number seq sequence index idx id")
"""Parts of names of whole numbers that count something. Provenance: ours."""


def is_pair(name: str) -> bool:
    """Whether a name is one of both coordinates of a place of the vehicle."""
    parts = _unnumbered(name)
    of_both = not _LATITUDES.isdisjoint(parts) and not _LONGITUDES.isdisjoint(parts)
    return (of_both or not _PAIRS.isdisjoint(parts)) and not is_no_vehicle(name)


def is_count(name: str) -> bool:
    """Whether a name is one of whole numbers that count something: of those it is no coordinate."""
    return not _COUNTS.isdisjoint(_unnumbered(name))


PLACES_APART_M = 1852.0
"""Another place of the vehicle, of whatever sensor, contradicts the position beyond it. Provenance: ours. [m]"""
INERTIAL_APART_M = 10 * 1852.0
"""The same where inertial sensors alone keep the place: what RNP 10 allows them. Provenance: ours. [m]"""

_HEMISPHERES: dict[Axis, tuple[frozenset[str], frozenset[str]]] = {
    "est_lat_rad": (words("S SOUTH SOUTHERN SUD SUR SUED SÜD SUL SYD ZUID"), words("N NORTH NORTHERN NORD NORTE NOORD NORR")),
    "est_lon_rad": (words("W WEST WESTERN OUEST OVEST OESTE"), words("E EAST EASTERN EST ESTE OST OOST")),
}
"""Words of a hemisphere below zero, and above it, by the coordinate. `O` is east in German and west in French. Provenance: ours."""


class Sides(NamedTuple):
    """The signs that a text states of a latitude and of a longitude; none of what it does not speak of."""

    lat: int | None = None
    lon: int | None = None


_OF_BOTH = {
    f"{lat}{lon}": Sides(lat_sign, lon_sign)
    for lat_sign, lats in zip((-1, 1), _HEMISPHERES["est_lat_rad"], strict=True)
    for lon_sign, lons in zip((-1, 1), _HEMISPHERES["est_lon_rad"], strict=True)
    for lat in lats
    for lon in lons
}
"""`SW`, `SOUTHWEST`."""


def sides(text: str) -> Sides:
    """The hemispheres of a text that is nothing else: `S`, `south`, `(W)`, or `SW` and `S, W` of both."""
    word = re.sub(r"[^A-ZÀ-Þ]", "", unicodedata.normalize("NFKC", text).upper())
    for axis, of in _HEMISPHERES.items():
        for sign, written in zip((-1, 1), of, strict=True):
            if word in written:
                return Sides(lat=sign) if axis == "est_lat_rad" else Sides(lon=sign)
    return _OF_BOTH.get(word, Sides())


OF_HEMISPHERE = words("hemisphere hemispheres hemi hem quadrant ns ew nsew north south east west cardinal")
"""Parts of names of a hemisphere. Provenance: ours."""


class PlaceWords(NamedTuple):
    """Parts of names by which live knows other places and hemispheres, and the words of these; the core takes them in this order."""

    latitude: list[str]
    longitude: list[str]
    of_others: list[str]
    inertial: list[str]
    pair: list[str]
    counts: list[str]
    hemisphere: list[str]
    south: list[str]
    north: list[str]
    west: list[str]
    east: list[str]


def place_words() -> PlaceWords:
    """Those of tables."""
    names = (_LATITUDES, _LONGITUDES, _NO_VEHICLE, _INERTIAL, _PAIRS, _COUNTS, OF_HEMISPHERE)
    return PlaceWords(*(sorted(each) for each in (*names, *(side for axis in AXES for side in _HEMISPHERES[axis]))))
