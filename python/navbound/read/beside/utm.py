"""Eastings and northings of UTM to places.

Provenance: standard, the series of Krueger in the third flattening, to its cube (a millimetre within a zone), from knowledge of it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_A_M, _F = 6378137.0, 1.0 / 298.257223563
"""WGS-84. [m, 1]"""
_SCALE, _FALSE_EAST_M, _FALSE_NORTH_M = 0.9996, 500_000.0, 10_000_000.0
"""Of the central meridian, and what is added to eastings, and to northings of the south. [1, m, m]"""
_ZONE_RAD = np.radians(6.0)
_N = _F / (2.0 - _F)
_RADIUS_M = _A_M / (1.0 + _N) * (1.0 + _N**2 / 4.0 + _N**4 / 64.0)
_BETA = (_N / 2.0 - 2.0 * _N**2 / 3.0 + 37.0 * _N**3 / 96.0, _N**2 / 48.0 + _N**3 / 15.0, 17.0 * _N**3 / 480.0)
_DELTA = (2.0 * _N - 2.0 * _N**2 / 3.0 - 2.0 * _N**3, 7.0 * _N**2 / 3.0 - 8.0 * _N**3 / 5.0, 56.0 * _N**3 / 15.0)


def places(east_m: NDArray[np.float64], north_m: NDArray[np.float64], near: NDArray[np.float64], zone: int) -> NDArray[np.float64]:
    """Latitude and longitude [rad] in the zone and hemisphere of places nearby (n, 2), or so many zones further east."""
    middle = (np.floor(near[:, 1] / _ZONE_RAD) + 0.5 + zone) * _ZONE_RAD
    xi = (north_m - np.where(near[:, 0] < 0.0, _FALSE_NORTH_M, 0.0)) / (_SCALE * _RADIUS_M)
    eta = (east_m - _FALSE_EAST_M) / (_SCALE * _RADIUS_M)
    xi_1 = xi - sum(b * np.sin(2 * j * xi) * np.cosh(2 * j * eta) for j, b in enumerate(_BETA, 1))
    eta_1 = eta - sum(b * np.cos(2 * j * xi) * np.sinh(2 * j * eta) for j, b in enumerate(_BETA, 1))
    chi = np.arcsin(np.clip(np.sin(xi_1) / np.cosh(eta_1), -1.0, 1.0))
    lat = chi + sum(d * np.sin(2 * j * chi) for j, d in enumerate(_DELTA, 1))
    return np.column_stack([lat, middle + np.arctan2(np.sinh(eta_1), np.cos(xi_1))])
