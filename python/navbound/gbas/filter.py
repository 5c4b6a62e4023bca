"""GBAS and an inertial system: covariance of the fix they make together, and whether a model of correlated noise bounds."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from navbound import _core
from navbound.errors import InputError
from navbound.gbas.arguments import named, systems, width_of
from navbound.gbas.models import Service, check_service
from navbound.table.arguments import checked
from navbound.table.arrays import flatten

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray


NoiseForm = Literal["paper", "bound"]


@checked
def aided_covariance(
    az_rad: ArrayLike,
    el_rad: ArrayLike,
    constellation: Sequence[int] | NDArray[np.int64] | None = None,
    *,
    lat_rad: float,
    service: Service = "D",
    noise: NoiseForm = "bound",
    seconds: float = 900.0,
) -> NDArray[np.float64]:
    """Covariance of a fix from GBAS-corrected ranges and an inertial system (navi.673 equations 3 and 4, rebuilt).

    Parameters
    ----------
    az_rad, el_rad : array_like, shape (..., n)
        Satellites, which stand still; both NaN for one that is not used. [rad]
    constellation : sequence of int, shape (n,), optional
        Index of each satellite's system; without it all share one clock.
    service : {"D", "F"}
        Error model.
    noise : {"bound", "paper"}
        Smoothed multipath of unknown time constant: as Langel et al. 2021 bound it, or as the paper's words have it. Only the first may
        support a statement of safety; only the second makes the sigma smaller than that of the ranges alone.
    lat_rad : float
        Latitude. [rad]
    seconds : float
        How long the filter has run. [s]

    Returns
    -------
    ndarray, shape (..., 3, 3)
        East-north-up. [m²]

    Raises
    ------
    InputError
        A sky without satellites, numbers outside their domains.
    """
    check_service(service)
    shape, (az, el) = flatten(az_rad=(az_rad, ()), el_rad=(el_rad, ()))
    if not 0 <= seconds <= 86_400:
        raise InputError("seconds", seconds, "s", "[0, 86400]")
    job = {
        "service": service,
        "form": named("noise", noise, ("paper", "bound")),
        "lat_rad": lat_rad,
        "seconds": seconds,
        "az_rad": az,
        "el_rad": el,
        "constellation": systems(width_of(shape), constellation),
    }
    return _core.gbas_aided_covariance(job).reshape(*shape[:-1], 3, 3)


@checked
def offset_variances(
    true_constant_s: float, *, noise: NoiseForm = "bound", shortest_s: float = 54.0, longest_s: float = 2894.0, n: int = 901
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Variance of a constant offset seen every second through correlated noise of 1 m: as the filter has it, and as it is.

    Parameters
    ----------
    true_constant_s : float
        Time constant the noise really has. [s]
    noise : {"bound", "paper"}
        The filter's model.
    shortest_s, longest_s : float
        Between which the filter knows the constant to lie. [s]
    n : int
        Measurements.

    Returns
    -------
    filter_m2, true_m2 : ndarray, shape (n,)
        After each measurement. [m²]

    Raises
    ------
    InputError
        Constants that are not positive or not in order.
    """
    if not 1 <= n <= 1_000_000:
        raise InputError("n", n, "1", "[1, 1000000]")
    form = named("noise", noise, ("paper", "bound"))
    variances = _core.gbas_offset_variances(form, [shortest_s, longest_s], true_constant_s, n)
    return np.ascontiguousarray(variances[:, 0]), np.ascontiguousarray(variances[:, 1])
