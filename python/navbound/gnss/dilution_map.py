"""Dilutions of a grid of users over many instants; public in `navbound.gnss`."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from navbound import _core
from navbound.errors import InputError
from navbound.gnss.constellations import Orbits
from navbound.table.arguments import checked
from navbound.table.arrays import flatten

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class DopMap(NamedTuple):
    """Dilutions of precision, shape (users..., instants...), NaN where there is no position.

    ``hdop``, ``vdop``, ``pdop`` horizontal, vertical, position; ``gdop`` position and every clock; ``n_sv`` satellites above the mask. [1]
    """

    hdop: NDArray[np.float64]
    vdop: NDArray[np.float64]
    pdop: NDArray[np.float64]
    gdop: NDArray[np.float64]
    n_sv: NDArray[np.uint16]


@checked
def dop_map(
    orbits: Orbits, lat_rad: ArrayLike, lon_rad: ArrayLike, h_m: ArrayLike, time_s: ArrayLike, *, mask_rad: float = float(np.radians(5.0))
) -> DopMap:
    """Dilutions of every user at every instant, one clock for each constellation: `geometry` and `dop` in one, for maps.

    Parameters
    ----------
    orbits : Orbits
        The satellites.
    lat_rad, lon_rad, h_m : array_like
        Users, WGS-84; shapes that broadcast. [rad, rad, m]
    time_s : array_like
        Instants since the reference instant of the orbits. [s]
    mask_rad : float, optional
        Lowest elevation that is used. [rad]

    Returns
    -------
    DopMap
        ``GDOP² = PDOP² + sum over constellations c of (1/n_c + m_c' P m_c)``, m_c the mean direction of its satellites, P the
        covariance of the position.

    Raises
    ------
    InputError
        A user that is not on the Earth, a time that is not finite, a mask outside (-pi/2, pi/2).
    """
    if not -np.pi / 2 < mask_rad < np.pi / 2:
        raise InputError("mask_rad", mask_rad, "rad", "(-pi/2, pi/2)")
    users, (lat, lon, h) = flatten(lat_rad=(lat_rad, ()), lon_rad=(lon_rad, ()), h_m=(h_m, ()))
    instants, (time,) = flatten(time_s=(time_s, ()))
    dilutions = _core.dop_map(orbits.elements(), orbits.constellation.tolist(), (lat, lon, h), time, mask_rad)
    return DopMap(**{name: values.reshape(users + instants) for name, values in dilutions.items()})
