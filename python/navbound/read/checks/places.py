"""Ways between places."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import polars as pl

from navbound import _core
from navbound.units import EARTH_RADIUS_M

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound import gnss


def east_north_m(start: NDArray[np.float64], end: NDArray[np.float64]) -> NDArray[np.float64]:
    """Ways between places on a sphere, good to a percent over some kilometres.

    Parameters
    ----------
    start, end : ndarray, shape (n, 2) or (1, 2)
        Latitude and longitude. [rad]

    Returns
    -------
    ndarray, shape (n, 2)
        East and north; a meridian and the same one a turn further are one. [m]
    """
    turned = end[:, 1] - start[:, 1]
    east = 2.0 * EARTH_RADIUS_M * np.cos(start[:, 0]) * np.sin(0.5 * (turned - 2.0 * np.pi * np.round(turned / (2.0 * np.pi))))
    north = EARTH_RADIUS_M * (end[:, 0] - start[:, 0])
    return np.column_stack(np.broadcast_arrays(east, north))


def wrapped(angle_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same angles within half a turn. [rad]."""
    within: NDArray[np.float64] = np.arctan2(np.sin(angle_rad), np.cos(angle_rad))
    return within


def half_turn_s(speed_mps: NDArray[np.float64]) -> NDArray[np.float64]:
    """Time below which no aircraft turns by half a turn, at 60 degrees of bank: the direction between two statements is known. [s]."""
    return np.pi * np.abs(speed_mps) / _core.TURNING_MPS2


_BESIDE_NOTHING_RAD = 0.02
"""Latitudes and longitudes up to this are beside 0 N 0 E. Provenance: ours; a degree, half an hour of a slow aircraft. [rad]"""


class Nowhere:
    """Rows at latitude 0, longitude 0 to the last bit of a track that is elsewhere: what a receiver writes that has no position."""

    def __init__(self) -> None:
        self._beside, self._elsewhere = set[str | None](), set[str | None]()

    def see(self, rows: pl.DataFrame) -> None:
        """The next rows, with their positions."""
        lat, lon = rows["est_lat_rad"], rows["est_lon_rad"]
        track = rows["track"] if "track" in rows.columns else pl.repeat(None, rows.height, dtype=pl.String, eager=True)
        beside = (lat.abs() <= _BESIDE_NOTHING_RAD) & (lon.abs() <= _BESIDE_NOTHING_RAD)
        nothing = (lat == 0.0) & (lon == 0.0)
        self._beside |= set(track.filter(beside & ~nothing))
        self._elsewhere |= set(track.filter(~beside))

    def at(self, rows: pl.DataFrame) -> pl.Series:
        """Which rows hold no position, once every row was seen."""
        refused = self._elsewhere - self._beside
        track = rows["track"] if "track" in rows.columns else pl.repeat(None, rows.height, dtype=pl.String, eager=True)
        of = track.is_in([name for name in refused if name is not None]).fill_null(value=False) | (track.is_null() & (None in refused))
        return ((rows["est_lat_rad"] == 0.0) & (rows["est_lon_rad"] == 0.0)).fill_null(value=False) & of


NO_PLACE = "latitude 0, longitude 0: no position of a track that is elsewhere"
"""The reason against such a row."""


_AWAY_M = 1000.0
"""Further from every solved position a header's approximate one is worth a word: they are rounded to hundreds of metres. Ours. [m]"""
_AWAY_STANDING_M, _SPREADS = 100.0, 5.0
"""Further than both, [m] and in units of the spread, from the positions of a receiver that stands, a header's approximate one contradicts
them: it is the marker's own place, which a survey or a first solution gave to metres. Provenance: ours."""
_STANDING_M = 50.0
"""A receiver whose positions are within this of their median for `_SHARE` of the time stands, or does not go far. Provenance: ours. [m]"""
_SHARE = 0.9
_EARTH_M = (6.3e6, 6.5e6)
"""Distances from the Earth's centre that a position can have; a header without one has zeros. [m]"""


class Header(NamedTuple):
    """What the approximate position of a file's header says of the solved ones.

    Attributes
    ----------
    notes : list of str
        What is worth a word.
    doubts : list of str
        Why nothing can be shown of the positions, unless a truth is named, which decides between the two.
    """

    notes: list[str]
    doubts: list[str]


def header_against(known: pl.DataFrame, observations: gnss.Observations) -> Header:
    """Compare the solved positions with the approximate one of the file's header. All orbits turned alike show nowhere else."""
    header_ecef_m = observations.approximate_ecef_m
    if header_ecef_m is None or not _EARTH_M[0] < float(np.linalg.norm(header_ecef_m)) < _EARTH_M[1]:
        return Header([], [])
    places = known.select("est_lat_rad", "est_lon_rad").drop_nulls().drop_nans().to_numpy()
    if not len(places):
        return Header([], [])
    from navbound import gnss  # noqa: PLC0415  (only with measurements)

    header = gnss.geodetic(header_ecef_m)[None, :2]
    apart_m = np.hypot(*east_north_m(header, places).T)
    # A place has a median by its axes; across the meridian of 180 degrees they are counted from the first place.
    way_m = east_north_m(places[:1], places)
    middle_m = np.median(way_m, axis=0)
    spread_m = float(np.quantile(np.hypot(*(way_m - middle_m).T), _SHARE))
    middle_apart_m = float(np.hypot(*(east_north_m(places[:1], header)[0] - middle_m)))
    if spread_m <= _STANDING_M and middle_apart_m > max(_AWAY_STANDING_M, _SPREADS * spread_m):
        return Header(
            [],
            [
                f"The receiver stands, and the approximate position of the header is {_distance(middle_apart_m)} from where the solved"
                " positions are: one of the two is wrong, or the header is of another place. --truth with the true position decides"
            ],
        )
    nearest_m = float(apart_m.min())
    if not nearest_m > _AWAY_M:
        return Header([], [])
    words = f"the approximate position of the header is {_distance(nearest_m)} from the nearest solved one: one of them is wrong, or old"
    return Header([words], [])


def _distance(length_m: float) -> str:
    return f"{length_m / 1000.0:.1f} km" if length_m >= 1000.0 else f"{length_m:.0f} m"
