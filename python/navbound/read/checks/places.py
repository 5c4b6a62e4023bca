"""Ways between places."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from navbound import gnss
from navbound.units import EARTH_RADIUS_M

if TYPE_CHECKING:
    import polars as pl
    from numpy.typing import NDArray


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
_EARTH_M = (6.3e6, 6.5e6)
"""Distances from the Earth's centre that a position can have; a header without one has zeros. [m]"""


def away_from_header(known: pl.DataFrame, observations: gnss.Observations) -> list[str]:
    """That no solved position is near the approximate one of the file's header. All orbits turned alike show nowhere else."""
    header_ecef_m = observations.approximate_ecef_m
    if header_ecef_m is None or not _EARTH_M[0] < float(np.linalg.norm(header_ecef_m)) < _EARTH_M[1]:
        return []
    header = gnss.geodetic(header_ecef_m)[None, :2]
    apart_m = float(np.nanmin(np.hypot(*east_north_m(header, known.select("est_lat_rad", "est_lon_rad").to_numpy()).T)))
    if not apart_m > _AWAY_M:
        return []
    return [
        f"the approximate position of the header is {apart_m / 1000.0:.1f} km from the nearest solved one: one of them is wrong, or old"
    ]
