"""Other places of the vehicle that a table has beside the position that is read: of a second receiver, of inertial sensors, of a truth.

Nobody declared which one counts. One that is far away contradicts the position, in whatever form it is written: degrees, radians, integers
of 1e-7 degrees or of 180/2^31 degrees, degrees with minutes and hemisphere, two numbers in one field, or Earth-fixed axes. Of several forms
that a column may have, that counts which brings it nearest. A text that can be nothing but a place (a point of WKT, ISO 6709, degrees with
both hemispheres) is one under any name; which texts are places decides `formats::place`, for live feeds too.
"""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
import polars as pl

from navbound import _core
from navbound.read.beside import utm
from navbound.read.checks.places import east_north_m
from navbound.read.columns.naming import LONGEST_NAME, name_parts
from navbound.read.columns.place_names import (
    INERTIAL_APART_M,
    PLACES_APART_M,
    is_count,
    is_no_vehicle,
    is_pair,
    keeps_inertial,
    other_place,
)
from navbound.read.tables.cells import MISSING
from navbound.units import EARTH_RADIUS_M

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from numpy.typing import NDArray

    _Forms = list[tuple[str, NDArray[np.float64] | None]]
    """The coordinates in each form that they may have; none where it reads nothing."""

Axis = Literal["est_lat_rad", "est_lon_rad"]
LAT: Axis = "est_lat_rad"
LON: Axis = "est_lon_rad"
_MOVED_M = 100.0
"""A place that moves by less while the vehicle moves is the origin of something. Provenance: ours. [m]"""
_READ_SHARE = 0.5
"""Share of the numbers of a column that a form must read to be that of the column. Provenance: ours. [1]"""
_SEMICIRCLE = math.pi / 2**31
_FORMS: dict[str, float] = {"deg": math.radians(1.0), "deg_e7": math.radians(1e-7), "semicircles": _SEMICIRCLE}
"""What a coordinate may be written in, to radians."""
_MARKS = r"(?i)point\s*[zm]*\s*\(|^\s*[+-]\d[\d.]+[+-]\d|\d.*[nsew].*\d|[nsew].*\d.*[nsew]|\d\.\d*[\s,;]+[-+]?\d+\.\d"
"""What every text that is a place has."""
_LEAST_E7 = 1e5
"""Coordinates of a pair above it are integers of 1e-7 degrees. Provenance: ours. [1]"""
_MOST_COUNTED = 1e5
"""Whole numbers up to it under a name that counts are no coordinates; those of 1e-7 degrees are larger. Provenance: ours. [1]"""
_EARTH_M = (6.3e6, 6.5e6)
"""Distances from the Earth's centre that make three numbers a position. [m]"""


class Form(NamedTuple):
    """What was seen of a column, or of several that are one place, read in one way.

    Attributes
    ----------
    n, n_read : int
        Numbers that are there, and those that this form reads.
    apart_m : float
        Largest distance from the position. [m]
    low, high : tuple of float
        Least and largest coordinates. [rad]
    """

    n: int = 0
    n_read: int = 0
    apart_m: float = 0.0
    low: tuple[float, float] = (math.inf, math.inf)
    high: tuple[float, float] = (-math.inf, -math.inf)

    def with_rows(self, lat: NDArray[np.float64], lon: NDArray[np.float64], apart_m: NDArray[np.float64], n: int) -> Form:
        """With more rows; a distance that is NaN where the form reads nothing. A place of one axis has a constant for the other."""
        read = np.isfinite(apart_m)
        if not read.any():
            return self._replace(n=self.n + n)
        span = [(values[read].min(), values[read].max()) for values in (lat, lon)]
        low = tuple(min(before, new) for before, (new, _) in zip(self.low, span, strict=True))
        high = tuple(max(before, new) for before, (_, new) in zip(self.high, span, strict=True))
        far_m = max(self.apart_m, float(apart_m[read].max()))
        return Form(self.n + n, self.n_read + int(read.sum()), far_m, (low[0], low[1]), (high[0], high[1]))

    @property
    def moved(self) -> bool:
        """Whether the place changes."""
        return any((high - low) * EARTH_RADIUS_M > _MOVED_M for low, high in zip(self.low, self.high, strict=True))


_Several = Literal["", "ecef", "utm", "numbers"]


class Place(NamedTuple):
    """Columns that are another place: one of an axis, one with both, or three of Earth-fixed axes.

    Attributes
    ----------
    by_name : bool
        The name says that it is one; otherwise its texts must.
    form : {"", "ecef", "utm", "numbers"}
        Of several columns, what they hold.
    """

    names: tuple[str, ...]
    axis: Axis | None
    whose: tuple[str, ...]
    inertial: bool
    by_name: bool = True
    form: _Several = ""


def find(free: Sequence[str], declared: Iterable[str]) -> list[Place]:
    """The other places among columns that nobody reads; none of an axis of which it is declared what counts."""
    axes = [axis for axis in (LAT, LON) if axis not in set(declared)]
    places = list[Place]()
    for name in free:
        of = other_place(name)
        if of is not None and of.axis in axes:
            places.append(Place((name,), of.axis, of.whose, of.inertial))
        elif of is None and axes == [LAT, LON] and not is_no_vehicle(name):
            places.append(Place((name,), None, (name,), inertial=keeps_inertial(name), by_name=is_pair(name) or _is_geohash(name)))
    if axes == [LAT, LON]:
        several: list[tuple[_Several, tuple[str, ...] | None]] = [("ecef", _ecef(free)), ("utm", _utm(free))]
        several += [("numbers", names) for names in _numbered(free)]
        places += [Place(names, None, names, inertial=False, form=form) for form, names in several if names is not None]
    return places


def _ecef(free: Sequence[str]) -> tuple[str, str, str] | None:
    """Three columns of Earth-fixed axes, or three of X, Y and Z, whose numbers decide."""
    for named in (r"ecef_?([xyz])|([xyz])_?ecef", r"()([xyz])"):
        axes = {(match[1] or match[2]): name for name in free if (match := re.fullmatch(named, _bare(name)))}
        if axes.keys() >= {"x", "y", "z"}:
            return axes["x"], axes["y"], axes["z"]
    return None


def _utm(free: Sequence[str]) -> tuple[str, str] | None:
    """Two columns of an easting and a northing of UTM by their names; those of other grids are not known."""
    named = [(name, set(name_parts(name)) - {"m"}) for name in free]
    axes = [[name for name, parts in named if "utm" in parts and parts & words] for words in (_EASTINGS, _NORTHINGS)]
    return (axes[0][0], axes[1][0]) if all(len(each) == 1 for each in axes) else None


def _numbered(free: Sequence[str]) -> list[tuple[str, str]]:
    """Two columns that are one pair of coordinates, `gps_lat_lon_0` and `gps_lat_lon_1`."""
    pairs: dict[str, list[str]] = {}
    # A long name has runs of blanks that a pattern would go over again from each of them.
    for name in (name for name in free if len(name) <= LONGEST_NAME):
        stem = re.sub(r"[^A-Za-z0-9]*\d[^A-Za-z0-9]*$", "", name)
        if stem != name and is_pair(stem):
            pairs.setdefault(stem, []).append(name)
    return [(names[0], names[1]) for names in pairs.values() if len(names) == _OF_A_PAIR]


_OF_A_PAIR = 2
"""Numbers of a place. [1]"""
_EASTINGS, _NORTHINGS = frozenset(("e", "x", "east", "easting")), frozenset(("n", "y", "north", "northing"))


def _is_geohash(name: str) -> bool:
    return "geohash" in re.sub(r"[^a-z]", "", name.lower())


def _bare(name: str) -> str:
    return "_".join(part for part in name_parts(name) if part not in {"", "m", "km", "cm"})


class OtherPlaces:
    """Compares other places with the position that is read, over all rows."""

    def __init__(self, places: Sequence[Place], declared: Iterable[str] = ()) -> None:
        self._places, self._declared = list(places), frozenset(declared)
        self._forms = dict[Place, dict[str, Form]]()
        self._own = Form()

    def see(self, part: pl.DataFrame, frame: pl.DataFrame, within: pl.DataFrame) -> None:
        """The next rows: those that are read, the file's, and what objects in their fields state."""
        self._places += [place for place in find(within.columns, self._declared) if place not in self._places]
        if not self._places or not {LAT, LON} <= set(part.columns):
            return
        frame = frame.hstack(within)
        own = part.select(LAT, LON).to_numpy().astype(np.float64)
        here_m = np.where(np.isfinite(own).all(axis=1), 0.0, np.nan)
        self._own = self._own.with_rows(own[:, 0], own[:, 1], here_m, len(own))
        names = set(frame.columns)
        for place in self._places:
            if not names.issuperset(place.names):
                continue
            n, forms = _read(place, frame, own)
            of_place = self._forms.setdefault(place, {})
            for form, there in forms:
                before = of_place.get(form, Form())
                if there is None:
                    of_place[form] = before._replace(n=before.n + n)
                else:
                    of_place[form] = before.with_rows(there[:, 0], there[:, 1], _apart_m(place, own, there), n)

    def _nearest(self, place: Place) -> Form | None:
        """In the form that brings it nearest, of those that read its numbers."""
        forms = [form for form in self._forms.get(place, {}).values() if form.n_read > _READ_SHARE * form.n]
        return min(forms, key=lambda form: form.apart_m, default=None)

    def far(self) -> Iterator[tuple[Place, float]]:
        """Those that contradict the position, and how far away at the most; one that stays while the vehicle moves is an origin."""
        nearest = {place: form for place in self._places if (form := self._nearest(place)) is not None}
        for place, form in nearest.items():
            stays = not any(other.moved for of, other in nearest.items() if of.whose == place.whose)
            far = form.apart_m > (INERTIAL_APART_M if place.inertial else PLACES_APART_M)
            if far and not (stays and self._own.moved):
                yield place, form.apart_m


def _apart_m(place: Place, own: NDArray[np.float64], there: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distance of each row, along the axis of a place that has one."""
    if place.axis is None:
        way_m = east_north_m(own, there)
        return np.asarray(np.hypot(way_m[:, 0], way_m[:, 1]))
    other = own.copy()
    of = (LAT, LON).index(place.axis)
    other[:, of] = there[:, of]
    along_m: NDArray[np.float64] = np.abs(east_north_m(own, other)[:, 1 - of])
    return along_m


def _read(place: Place, frame: pl.DataFrame, own: NDArray[np.float64]) -> tuple[int, _Forms]:
    """How many numbers are there, and the coordinates in each form that they may have."""
    if place.form == "ecef":
        return _of_ecef(frame.select(place.names))
    if place.form:
        first, second = (_floats(frame[name].cast(pl.Float64, strict=False)) for name in place.names)
        return _of_utm(first, second, own) if place.form == "utm" else _of_numbers(first, second)
    column = frame[place.names[0]]
    if place.axis is None:
        return _of_pairs(column, by_name=place.by_name)
    return _of_axis(column, place.axis, radians="rad" in name_parts(column.name))


def _of_axis(column: pl.Series, axis: Axis, *, radians: bool) -> tuple[int, _Forms]:
    numbers = _angles(column) if column.dtype == pl.String else _floats(column)
    # A receiver without a fix writes 0.
    numbers[numbers == 0.0] = np.nan
    if is_count(column.name) and not (numbers % 1.0 > 0.0).any() and not (np.abs(numbers) > _MOST_COUNTED).any():
        numbers[:] = np.nan
    forms, most = ({"rad": 1.0} if radians else _FORMS), 0.5 * np.pi if axis == LAT else 2.0 * np.pi
    read: _Forms = []
    angles = {form: numbers * factor for form, factor in forms.items()}
    if not radians:
        # Degrees and minutes in one number, as sentences of NMEA have them.
        whole = np.trunc(numbers / 100.0)
        minutes = numbers - 100.0 * whole
        angles["ddmm"] = np.radians(np.where(np.abs(minutes) < 60.0, whole + minutes / 60.0, np.nan))
    for form, angle in angles.items():
        angle[~(np.abs(angle) <= most)] = np.nan
        there = np.zeros((len(angle), 2))
        there[:, (LAT, LON).index(axis)] = angle
        read.append((form, there))
    return int(np.isfinite(numbers).sum()), read


def _floats(column: pl.Series) -> NDArray[np.float64]:
    if not column.dtype.is_numeric():
        return np.full(len(column), np.nan)
    return column.cast(pl.Float64).fill_null(math.nan).to_numpy(writable=True)


def _angles(column: pl.Series) -> NDArray[np.float64]:
    """Degrees of texts such as ``48.55N``, ``N 48 33.0`` or ``48°33'12"N``."""
    text = column.str.strip_chars().str.to_uppercase()
    text = text.set(text.str.contains(MISSING) | ~text.str.contains(r"^[NSEW+\-]?\s*\d[\d.\s°º'’′\"”″:DEGMIN_]*[NSEW]?$"), None)
    parts = text.str.extract_all(r"\d+(?:\.\d+)?").list.eval(pl.element().cast(pl.Float64))
    degrees = sum((parts.list.get(k, null_on_oob=True).fill_null(0.0) / 60.0**k for k in range(1, 3)), parts.list.get(0, null_on_oob=True))
    against = text.str.contains(r"^-|[SW]$|^[SW]")
    return pl.select(pl.when(against).then(-degrees).otherwise(degrees)).to_series().fill_null(math.nan).to_numpy(writable=True)


def _of_pairs(column: pl.Series, *, by_name: bool) -> tuple[int, _Forms]:
    """Two numbers in one field, in either order where the form does not say which."""
    dtype = column.dtype
    ordered = np.zeros(len(column), dtype=bool)
    if by_name and isinstance(dtype, pl.List) and pl.Series(dtype=dtype.inner).dtype.is_numeric():
        both = np.column_stack([_floats(column.list.get(k, null_on_oob=True)) for k in (0, 1)])
        if np.isfinite(both).any() and np.nanmedian(np.abs(both)) > _LEAST_E7:
            both *= 1e-7
    elif dtype == pl.String:
        # Few texts have a place; those without its marks are not looked at one by one.
        geohash = _is_geohash(column.name)
        marked = (column.is_not_null() if geohash else column.str.contains(_MARKS)).fill_null(value=False)
        if not marked.any():
            return column.len() - column.null_count(), [("lat, lon", None), ("lon, lat", None)]
        both = np.full((len(column), 2), np.nan)
        for at, place in zip(marked.arg_true().to_list(), _core.places_of(column.filter(marked).to_list(), geohash), strict=True):
            if place is not None and (by_name or place[2]):
                both[at], ordered[at] = place[0], place[1]
    else:
        return 0, []
    both[(both == 0.0).all(axis=1)] = np.nan
    read: _Forms = []
    for form, there in (("lat, lon", both), ("lon, lat", np.where(ordered[:, None], both, both[:, ::-1]))):
        place_rad = np.radians(there)
        place_rad[~((np.abs(place_rad[:, 0]) <= 0.5 * np.pi) & (np.abs(place_rad[:, 1]) <= 2.0 * np.pi))] = np.nan
        read.append((form, place_rad))
    return column.len() - column.null_count(), read


def _of_numbers(first: NDArray[np.float64], second: NDArray[np.float64]) -> tuple[int, _Forms]:
    return _of_pairs(pl.Series([[a, b] for a, b in zip(first, second, strict=True)], dtype=pl.List(pl.Float64)), by_name=True)


def _of_utm(east_m: NDArray[np.float64], north_m: NDArray[np.float64], own: NDArray[np.float64]) -> tuple[int, _Forms]:
    """In the zone of the position or one beside it, whichever is nearest: a file keeps one over a border."""
    east_m[(east_m == 0.0) & (north_m == 0.0)] = np.nan
    there = np.stack([utm.places(east_m, north_m, own, zone) for zone in (-1, 0, 1)])
    apart_m = np.stack([np.hypot(*east_north_m(own, each).T) for each in there])
    nearest = np.where(np.isfinite(apart_m), apart_m, np.inf).argmin(axis=0)
    return int(np.isfinite(east_m).sum()), [("utm", there[nearest, np.arange(len(own))])]


def _of_ecef(frame: pl.DataFrame) -> tuple[int, _Forms]:
    from navbound import gnss  # noqa: PLC0415  (few tables have such columns)

    axes = np.column_stack([_floats(frame[name].cast(pl.Float64, strict=False)) for name in frame.columns])
    there = np.full((len(axes), 2), np.nan)
    length_m = np.linalg.norm(axes, axis=1)
    # In kilometres, or in centimetres as u-blox receivers have them.
    usual_m = float(np.nanmedian(length_m)) if np.isfinite(length_m).any() else 0.0
    factor = 1e3 if usual_m < 1e-2 * _EARTH_M[0] else 1e-2 if 1e2 * _EARTH_M[0] < usual_m < 1e2 * _EARTH_M[1] else 1.0
    axes, length_m = factor * axes, factor * length_m
    on_earth = (length_m > _EARTH_M[0]) & (length_m < _EARTH_M[1])
    if on_earth.any():
        there[on_earth] = gnss.geodetic(axes[on_earth])[:, :2]
    return int((np.isfinite(length_m) & (length_m > 0.0)).sum()), [("ecef", there)]
