"""Ways between places."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from navbound.units import EARTH_RADIUS_M

if TYPE_CHECKING:
    import polars as pl
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
    east = 2.0 * EARTH_RADIUS_M * np.cos(start[:, 0]) * np.sin(0.5 * (end[:, 1] - start[:, 1]))
    north = EARTH_RADIUS_M * (end[:, 0] - start[:, 0])
    return np.column_stack(np.broadcast_arrays(east, north))


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
