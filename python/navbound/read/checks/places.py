"""Ways between places."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from navbound.units import EARTH_RADIUS_M

if TYPE_CHECKING:
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
