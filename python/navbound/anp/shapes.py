"""Regions with corners, public through navbound.anp: the rectangle of a tunnel, the cylinder, the simultaneous box."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from navbound import _core
from navbound.table.arguments import checked
from navbound.table.arrays import flatten, unflatten

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]


class Sides(NamedTuple):
    """Probability of a region and of what is outside it; both carry their own digits."""

    inside: Floats
    outside: Floats


@checked
def rectangle(covariance_cu_m2: ArrayLike, half_cross_m: ArrayLike, half_up_m: ArrayLike, mean_cu_m: ArrayLike | None = None) -> Sides:
    """Probability of a rectangle (the cross-section of a tunnel), and of what is outside it.

    ``|cross| <= half_cross_m`` and ``|up| <= half_up_m``; docs/methods/anp.md section 5.

    Parameters
    ----------
    covariance_cu_m2 : array_like, shape (..., 2, 2)
        Covariance of the error across (right) and up. [m²]
    half_cross_m, half_up_m : array_like, shape (...)
        Half sizes. [m]
    mean_cu_m : array_like, shape (..., 2), optional
        Mean of the error across and up; zero when absent. [m]

    Returns
    -------
    Sides
        ``inside`` and ``outside``, shape (...), to 1e-9 of the smaller side. [1]

    Raises
    ------
    InputError
        Not a covariance, a mean that is not finite, or a half size that is not positive.
    """
    mean = np.zeros(2) if mean_cu_m is None else mean_cu_m
    shape, (v, c, u, m) = flatten(
        covariance_cu_m2=(covariance_cu_m2, (2, 2)), half_cross_m=(half_cross_m, ()), half_up_m=(half_up_m, ()), mean_cu_m=(mean, (2,))
    )
    table = _core.anp_rectangle(v, m, c, u)
    return Sides(table[:, 0].reshape(shape), table[:, 1].reshape(shape))


@checked
def rectangle_risk(
    covariance_cu_m2: ArrayLike, half_cross_m: ArrayLike, half_up_m: ArrayLike, mean_cu_m: ArrayLike | None = None
) -> Floats:
    """Risk to be outside a rectangle: ``rectangle(...).outside``, same arguments and errors. [1]."""
    return rectangle(covariance_cu_m2, half_cross_m, half_up_m, mean_cu_m).outside


@checked
def rectangle_scale(
    covariance_cu_m2: ArrayLike,
    half_cross_m: ArrayLike,
    half_up_m: ArrayLike,
    risk: ArrayLike,
    mean_cu_m: ArrayLike | None = None,
) -> Floats:
    """Factor by which both half sizes are stretched until the error leaves the rectangle with this risk. [1].

    Arguments and errors as :func:`rectangle`, and a risk inside [1e-300, 0.5], shape (...).
    """
    mean = np.zeros(2) if mean_cu_m is None else mean_cu_m
    shape, (v, c, u, m, q) = flatten(
        covariance_cu_m2=(covariance_cu_m2, (2, 2)),
        half_cross_m=(half_cross_m, ()),
        half_up_m=(half_up_m, ()),
        mean_cu_m=(mean, (2,)),
        risk=(risk, ()),
    )
    return unflatten(_core.anp_rectangle_scale(v, m, c, u, q), shape)


@checked
def cylinder(covariance_enu_m2: ArrayLike, radius_m: ArrayLike, half_height_m: ArrayLike, mean_enu_m: ArrayLike | None = None) -> Sides:
    """Probability of a cylinder around the estimate, and of what is outside it.

    Horizontal error within ``radius_m`` and ``|up| <= half_height_m``; docs/methods/anp.md section 5.

    Parameters
    ----------
    covariance_enu_m2 : array_like, shape (..., 3, 3)
        Covariance of the error, east-north-up. [m²]
    radius_m, half_height_m : array_like, shape (...)
        Its sizes. [m]
    mean_enu_m : array_like, shape (..., 3), optional
        Mean of the error, east-north-up; zero when absent. [m]

    Returns
    -------
    Sides
        ``inside`` and ``outside``, shape (...), to 1e-9 of the smaller side. [1]

    Raises
    ------
    InputError
        Not a covariance, a mean that is not finite, or a size that is not positive.
    """
    mean = np.zeros(3) if mean_enu_m is None else mean_enu_m
    shape, (v, r, h, m) = flatten(
        covariance_enu_m2=(covariance_enu_m2, (3, 3)), radius_m=(radius_m, ()), half_height_m=(half_height_m, ()), mean_enu_m=(mean, (3,))
    )
    table = _core.anp_cylinder(v, m, r, h)
    return Sides(table[:, 0].reshape(shape), table[:, 1].reshape(shape))


@checked
def cylinder_risk(
    covariance_enu_m2: ArrayLike, radius_m: ArrayLike, half_height_m: ArrayLike, mean_enu_m: ArrayLike | None = None
) -> Floats:
    """Risk to be outside a cylinder: ``cylinder(...).outside``, same arguments and errors. [1]."""
    return cylinder(covariance_enu_m2, radius_m, half_height_m, mean_enu_m).outside


@checked
def cylinder_scale(
    covariance_enu_m2: ArrayLike,
    radius_m: ArrayLike,
    half_height_m: ArrayLike,
    risk: ArrayLike,
    mean_enu_m: ArrayLike | None = None,
) -> Floats:
    """Factor by which radius and half height are stretched until the error leaves the cylinder with this risk. [1].

    Arguments and errors as :func:`cylinder`, and a risk inside [1e-300, 0.5], shape (...).
    """
    mean = np.zeros(3) if mean_enu_m is None else mean_enu_m
    shape, (v, r, h, m, q) = flatten(
        covariance_enu_m2=(covariance_enu_m2, (3, 3)),
        radius_m=(radius_m, ()),
        half_height_m=(half_height_m, ()),
        mean_enu_m=(mean, (3,)),
        risk=(risk, ()),
    )
    return unflatten(_core.anp_cylinder_scale(v, m, r, h, q), shape)


@checked
def box_factor(covariance_enu_m2: ArrayLike, risk: ArrayLike) -> Floats:
    """Factor k of the box ``|e_i| <= k sigma_i`` that a zero-mean error leaves with this risk, solved. [1].

    2.387738 at 0.05 for three uncorrelated axes, 2.236477 for two (an error without vertical variance).

    Parameters
    ----------
    covariance_enu_m2 : array_like, shape (..., 3, 3)
        Covariance of the error, east-north-up. [m²]
    risk : array_like, shape (...)
        Risk to be outside the box. [1]

    Returns
    -------
    ndarray, shape (...)
        Factor. [1]

    Raises
    ------
    InputError
        Not a covariance, a horizontal variance of zero, or a risk outside [1e-300, 0.5].
    """
    shape, (v, q) = flatten(covariance_enu_m2=(covariance_enu_m2, (3, 3)), risk=(risk, ()))
    return unflatten(_core.anp_box_factor(v, q), shape)


@checked
def box(covariance_enu_m2: ArrayLike, risk: ArrayLike) -> Floats:
    """Half-sizes east, north, up of the simultaneous box: :func:`box_factor` times each sigma, shape (..., 3). [m]."""
    factor = box_factor(covariance_enu_m2, risk)
    variances = np.diagonal(np.asarray(covariance_enu_m2, dtype=np.float64), axis1=-2, axis2=-1)
    return np.asarray(factor[..., np.newaxis] * np.sqrt(variances), dtype=np.float64)
