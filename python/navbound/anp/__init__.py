"""Actual navigation performance: how far off the navigation error may be, as circle, sphere, ellipsoid, direction or shaped region.

The error e (true minus estimated position, east-north-up) is Gaussian with the given covariance and, where given, a mean; no radius
depends on its sign. Every function takes the risk (1 - P), broadcasts over leading axes and refuses what is not a covariance.
Equations are those of docs/methods/anp.md.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from navbound import _core
from navbound.anp.rules import (
    cep,
    circle_fit,
    circle_fit_as_printed,
    circle_geodesy,
    circle_major,
    sep_sum,
    sphere_grubbs,
    sphere_grubbs_as_printed,
    sphere_major,
    sphere_mean_sigma,
    sphere_rms,
    two_drms,
)
from navbound.anp.shapes import Sides, box, box_factor, cylinder, cylinder_risk, cylinder_scale, rectangle, rectangle_risk, rectangle_scale
from navbound.errors import InputError
from navbound.status import REASONS
from navbound.table.arguments import checked
from navbound.table.arrays import flatten, unflatten

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = [
    "Directional",
    "Ellipsoid",
    "Law",
    "Sides",
    "TrackExtents",
    "along",
    "box",
    "box_factor",
    "cep",
    "chi_factor",
    "circle",
    "circle_fit",
    "circle_fit_as_printed",
    "circle_geodesy",
    "circle_law",
    "circle_major",
    "circle_risk",
    "cylinder",
    "cylinder_risk",
    "cylinder_scale",
    "directional",
    "ellipsoid",
    "epu",
    "intercept",
    "marginal",
    "rectangle",
    "rectangle_risk",
    "rectangle_scale",
    "sep_sum",
    "sphere",
    "sphere_grubbs",
    "sphere_grubbs_as_printed",
    "sphere_law",
    "sphere_major",
    "sphere_mean_sigma",
    "sphere_risk",
    "sphere_rms",
    "support",
    "track",
    "two_drms",
    "vepu",
    "volume_over_sphere",
]

_ACCURACY = 0.05


class Law(NamedTuple):
    """The law of an error's length at a radius; both sides carry their own digits."""

    inside: Floats
    outside: Floats
    density_per_m: Floats


class Directional(NamedTuple):
    """The error along a direction."""

    bias_m: Floats
    sigma_m: Floats
    half_width_m: Floats


class TrackExtents(NamedTuple):
    """Half-extents along the course, to its right, and up."""

    along_m: Floats
    cross_m: Floats
    up_m: Floats


class Ellipsoid(NamedTuple):
    """The ellipsoid e' V^-1 e <= factor^2.

    Attributes
    ----------
    factor : ndarray, shape (...)
        k, the factor of the three-dimensional length. [1]
    semi_axes_m : ndarray, shape (..., 3)
        Longest first. [m]
    axes : ndarray, shape (..., 3, 3)
        Directions of the semi-axes as columns, components east, north, up. [1]
    support_enu_m : ndarray, shape (..., 3)
        Half-size of the bounding box along east, north, up: ``k sqrt(u'Vu)``. [m]
    intercept_enu_m : ndarray, shape (..., 3)
        Where the east, north and up axes pierce the surface: ``k / sqrt(u'V^-1 u)``; NaN where `reason` is not empty. [m]
    volume_m3 : ndarray, shape (...)
        ``(4/3) pi k^3 sqrt(det V)``; zero for a singular covariance. [m³]
    reason : ndarray of str, shape (...)
        Why there is no intercept; empty where there is one.
    """

    factor: Floats
    semi_axes_m: Floats
    axes: Floats
    support_enu_m: Floats
    intercept_enu_m: Floats
    volume_m3: Floats
    reason: NDArray[np.str_]


@checked
def circle(covariance_en_m2: ArrayLike, risk: ArrayLike, mean_en_m: ArrayLike | None = None) -> Floats:
    """Radius of the circle around the estimate that the horizontal error leaves with this risk, exact.

    ``P(|e| > R) = risk``, docs/methods/anp.md section 2. Relative error below 1e-12 for risks above 1e-3, 1e-9 everywhere.

    Parameters
    ----------
    covariance_en_m2 : array_like, shape (..., 2, 2)
        Covariance of the horizontal error, east-north; may be singular. [m²]
    risk : array_like, shape (...)
        0.05 for the 95 % radius (ANP, EPU, EPE). [1]
    mean_en_m : array_like, shape (..., 2), optional
        Mean of the error, east-north; zero when absent. [m]

    Returns
    -------
    ndarray, shape (...)
        Radius. [m]

    Raises
    ------
    InputError
        Not a covariance, a mean that is not finite, or a risk outside [1e-300, 0.5].
    """
    if mean_en_m is None:
        shape, (covariance, q) = flatten(covariance_en_m2=(covariance_en_m2, (2, 2)), risk=(risk, ()))
        return unflatten(_core.anp_circle(covariance, None, q), shape)
    shape, (covariance, q, mean) = flatten(covariance_en_m2=(covariance_en_m2, (2, 2)), risk=(risk, ()), mean_en_m=(mean_en_m, (2,)))
    return unflatten(_core.anp_circle(covariance, mean, q), shape)


@checked
def sphere(covariance_enu_m2: ArrayLike, risk: ArrayLike, mean_enu_m: ArrayLike | None = None) -> Floats:
    """Radius of the sphere around the estimate that the error leaves with this risk, exact.

    ``P(|e| > R) = risk``, docs/methods/anp.md section 2. Relative error below 1e-12 for risks above 1e-3, 1e-9 everywhere.

    Parameters
    ----------
    covariance_enu_m2 : array_like, shape (..., 3, 3)
        Covariance of the error, east-north-up; may be singular. [m²]
    risk : array_like, shape (...)
        0.05 for the 95 % radius, 0.5 for SEP. [1]
    mean_enu_m : array_like, shape (..., 3), optional
        Mean of the error, east-north-up; zero when absent. [m]

    Returns
    -------
    ndarray, shape (...)
        Radius. [m]

    Raises
    ------
    InputError
        Not a covariance, a mean that is not finite, or a risk outside [1e-300, 0.5].
    """
    if mean_enu_m is None:
        shape, (covariance, q) = flatten(covariance_enu_m2=(covariance_enu_m2, (3, 3)), risk=(risk, ()))
        return unflatten(_core.anp_sphere(covariance, None, q), shape)
    shape, (covariance, q, mean) = flatten(covariance_enu_m2=(covariance_enu_m2, (3, 3)), risk=(risk, ()), mean_enu_m=(mean_enu_m, (3,)))
    return unflatten(_core.anp_sphere(covariance, mean, q), shape)


@checked
def circle_law(covariance_en_m2: ArrayLike, radius_m: ArrayLike, mean_en_m: ArrayLike | None = None) -> Law:
    """Probability of a horizontal error shorter and longer than a radius, and the density there.

    docs/methods/anp.md section 2.

    Parameters
    ----------
    covariance_en_m2 : array_like, shape (..., 2, 2)
        Covariance of the horizontal error, east-north. [m²]
    radius_m : array_like, shape (...)
        Radius, zero or more. [m]
    mean_en_m : array_like, shape (..., 2), optional
        Mean of the error, east-north; zero when absent. [m]

    Returns
    -------
    Law
        ``inside``, ``outside`` [1] and ``density_per_m`` [1/m], shape (...); 1e-9 of the smaller side.

    Raises
    ------
    InputError
        Not a covariance, a mean that is not finite, or a negative radius.
    """
    arguments = {"covariance_en_m2": (covariance_en_m2, (2, 2)), "radius_m": (radius_m, ())}
    if mean_en_m is None:
        shape, (covariance, radius) = flatten(**arguments)
        return _law(_core.anp_circle_law(covariance, None, radius), shape)
    shape, (covariance, radius, mean) = flatten(**arguments, mean_en_m=(mean_en_m, (2,)))
    return _law(_core.anp_circle_law(covariance, mean, radius), shape)


@checked
def sphere_law(covariance_enu_m2: ArrayLike, radius_m: ArrayLike, mean_enu_m: ArrayLike | None = None) -> Law:
    """Probability of an error shorter and longer than a radius, and the density there.

    docs/methods/anp.md section 2.

    Parameters
    ----------
    covariance_enu_m2 : array_like, shape (..., 3, 3)
        Covariance of the error, east-north-up. [m²]
    radius_m : array_like, shape (...)
        Radius, zero or more. [m]
    mean_enu_m : array_like, shape (..., 3), optional
        Mean of the error, east-north-up; zero when absent. [m]

    Returns
    -------
    Law
        ``inside``, ``outside`` [1] and ``density_per_m`` [1/m], shape (...); 1e-9 of the smaller side.

    Raises
    ------
    InputError
        Not a covariance, a mean that is not finite, or a negative radius.
    """
    arguments = {"covariance_enu_m2": (covariance_enu_m2, (3, 3)), "radius_m": (radius_m, ())}
    if mean_enu_m is None:
        shape, (covariance, radius) = flatten(**arguments)
        return _law(_core.anp_sphere_law(covariance, None, radius), shape)
    shape, (covariance, radius, mean) = flatten(**arguments, mean_enu_m=(mean_enu_m, (3,)))
    return _law(_core.anp_sphere_law(covariance, mean, radius), shape)


def _law(table: Floats, shape: tuple[int, ...]) -> Law:
    return Law(*(unflatten(np.ascontiguousarray(column), shape) for column in table.T))


@checked
def circle_risk(covariance_en_m2: ArrayLike, radius_m: ArrayLike, mean_en_m: ArrayLike | None = None) -> Floats:
    """Risk that the horizontal error is longer than a radius: ``circle_law(...).outside``, same arguments and errors. [1]."""
    return circle_law(covariance_en_m2, radius_m, mean_en_m).outside


@checked
def sphere_risk(covariance_enu_m2: ArrayLike, radius_m: ArrayLike, mean_enu_m: ArrayLike | None = None) -> Floats:
    """Risk that the error is longer than a radius: ``sphere_law(...).outside``, same arguments and errors. [1]."""
    return sphere_law(covariance_enu_m2, radius_m, mean_enu_m).outside


@checked
def directional(covariance_enu_m2: ArrayLike, direction: ArrayLike, risk: ArrayLike, mean_enu_m: ArrayLike | None = None) -> Directional:
    """Error along a direction: its mean, its deviation, and the half-width it leaves with this risk, exact.

    ``b = u'mean``, ``s = sqrt(u'Vu)``, ``P(|u'e| > R) = risk``; docs/methods/anp.md section 3.

    Parameters
    ----------
    covariance_enu_m2 : array_like, shape (..., 3, 3)
        Covariance of the error, east-north-up. [m²]
    direction : array_like, shape (..., 3)
        Direction east-north-up; any length but zero. [1]
    risk : array_like, shape (...)
        Risk to be outside. [1]
    mean_enu_m : array_like, shape (..., 3), optional
        Mean of the error, east-north-up; zero when absent. [m]

    Returns
    -------
    Directional
        ``bias_m``, ``sigma_m``, ``half_width_m``, shape (...). [m]

    Raises
    ------
    InputError
        Not a covariance, a mean that is not finite, a direction without length, or a risk outside [1e-300, 0.5].
    """
    mean = np.zeros(3) if mean_enu_m is None else mean_enu_m
    shape, (covariance, u, q, m) = flatten(
        covariance_enu_m2=(covariance_enu_m2, (3, 3)), direction=(direction, (3,)), risk=(risk, ()), mean_enu_m=(mean, (3,))
    )
    table = _core.anp_directional(covariance, _unit(u), m, q)
    return Directional(*(unflatten(np.ascontiguousarray(column), shape) for column in table.T))


@checked
def along(covariance_enu_m2: ArrayLike, direction: ArrayLike, risk: ArrayLike, mean_enu_m: ArrayLike | None = None) -> Floats:
    """Half-width that the error along a direction leaves with this risk: ``directional(...).half_width_m``. [m]."""
    return directional(covariance_enu_m2, direction, risk, mean_enu_m).half_width_m


@checked
def marginal(covariance_enu_m2: ArrayLike, direction: ArrayLike, risk: ArrayLike) -> Floats:
    """Half-width of one direction alone, zero mean: ``k1 sqrt(u'Vu)``, what "95 % vertical" means in standards. [m].

    Arguments and errors as :func:`directional`.
    """
    return directional(covariance_enu_m2, direction, risk).half_width_m


@checked
def epu(covariance_en_m2: ArrayLike, mean_en_m: ArrayLike | None = None) -> Floats:
    """Estimated position uncertainty: the 95 % circle, ``circle(..., risk=0.05)``. [m]."""
    return circle(covariance_en_m2, _ACCURACY, mean_en_m)


@checked
def vepu(covariance_enu_m2: ArrayLike, mean_enu_m: ArrayLike | None = None) -> Floats:
    """Vertical estimated position uncertainty: the 95 % vertical half-width. [m]."""
    return along(covariance_enu_m2, [0.0, 0.0, 1.0], _ACCURACY, mean_enu_m)


@checked
def chi_factor(dimension: int, risk: ArrayLike) -> Floats:
    """Factor that the length of a standard normal vector exceeds with this risk. [1].

    Parameters
    ----------
    dimension : {1, 2, 3}
        Of the vector.
    risk : array_like, shape (...)
        Risk. [1]

    Returns
    -------
    ndarray, shape (...)
        1.959964, 2.447747 and 2.795483 at 0.05. [1]

    Raises
    ------
    InputError
        Another dimension, or a risk outside [1e-300, 0.5].
    """
    if dimension not in (1, 2, 3):
        raise InputError("dimension", dimension, "1", "{1, 2, 3}")
    shape, (q,) = flatten(risk=(risk, ()))
    return unflatten(_core.chi_factor(int(dimension), q), shape)


@checked
def ellipsoid(covariance_enu_m2: ArrayLike, risk: ArrayLike) -> Ellipsoid:
    """Ellipsoid of constant density that the error leaves with this risk.

    ``e' V^-1 e <= k^2``, k the factor of the three-dimensional length; Dai et al. 2022, eq. 25 to 32, docs/methods/anp.md section 4.
    Its half-extents are joint numbers: one axis alone is left with 0.518 % at risk 0.05, not 5 %.

    Parameters
    ----------
    covariance_enu_m2 : array_like, shape (..., 3, 3)
        Covariance of the error, east-north-up. [m²]
    risk : array_like, shape (...)
        Risk to be outside. [1]

    Returns
    -------
    Ellipsoid
        Factor, semi-axes and directions, half-extents, volume.

    Raises
    ------
    InputError
        Not a covariance, or a risk outside [1e-300, 0.5].
    """
    shape, (covariance, q) = flatten(covariance_enu_m2=(covariance_enu_m2, (3, 3)), risk=(risk, ()))
    table = _core.anp_ellipsoid(covariance, q)
    intercepts = np.ascontiguousarray(table[:, 16:19])
    reason = np.where(np.isnan(intercepts[:, 0]), REASONS["singular_covariance"].words, "")
    return Ellipsoid(
        factor=table[:, 0].reshape(shape),
        semi_axes_m=table[:, 1:4].reshape(*shape, 3),
        axes=table[:, 4:13].reshape(*shape, 3, 3),
        support_enu_m=table[:, 13:16].reshape(*shape, 3),
        intercept_enu_m=intercepts.reshape(*shape, 3),
        volume_m3=table[:, 19].reshape(shape),
        reason=reason.reshape(shape),
    )


@checked
def volume_over_sphere(covariance_enu_m2: ArrayLike, risk: ArrayLike) -> Floats:
    """Volume of the ellipsoid over that of the exact sphere of the same risk; never above one. [1].

    Arguments and errors as :func:`ellipsoid`; NaN for a point (zero covariance).
    """
    radius = sphere(covariance_enu_m2, risk)
    with np.errstate(invalid="ignore"):
        return np.asarray(ellipsoid(covariance_enu_m2, risk).volume_m3 / (4.0 / 3.0 * np.pi * radius**3), dtype=np.float64)


@checked
def support(covariance_enu_m2: ArrayLike, direction: ArrayLike, risk: ArrayLike) -> Floats:
    """Half-size of the ellipsoid's bounding box along a direction, ``k3 sqrt(u'Vu)``. [m].

    docs/methods/anp.md section 4; arguments and errors as :func:`directional`.
    """
    return _extents(covariance_enu_m2, direction, risk)[0]


@checked
def intercept(covariance_enu_m2: ArrayLike, direction: ArrayLike, risk: ArrayLike) -> Floats:
    """Where a direction pierces the ellipsoid, ``k3 / sqrt(u'V^-1 u)``, never more than the support. [m].

    NaN for a singular covariance, whose ellipsoid is flat. Arguments and errors as :func:`directional`.
    """
    return _extents(covariance_enu_m2, direction, risk)[1]


def _extents(covariance_enu_m2: ArrayLike, direction: ArrayLike, risk: ArrayLike) -> tuple[Floats, Floats]:
    shape, (covariance, u, q) = flatten(covariance_enu_m2=(covariance_enu_m2, (3, 3)), direction=(direction, (3,)), risk=(risk, ()))
    table = _core.anp_extents(covariance, _unit(u), q)
    return table[:, 0].reshape(shape), table[:, 1].reshape(shape)


@checked
def track(covariance_enu_m2: ArrayLike, course_rad: ArrayLike, risk: ArrayLike) -> TrackExtents:
    """Half-extents of the ellipsoid along a course, to its right, and up. [m].

    Parameters
    ----------
    covariance_enu_m2 : array_like, shape (..., 3, 3)
        Covariance of the error, east-north-up. [m²]
    course_rad : array_like, shape (...)
        Course, clockwise from true north. [rad]
    risk : array_like, shape (...)
        Risk to be outside the ellipsoid. [1]

    Returns
    -------
    TrackExtents
        ``along_m``, ``cross_m``, ``up_m``, shape (...). [m]

    Raises
    ------
    InputError
        Not a covariance, a course beyond one turn, or a risk outside [1e-300, 0.5].
    """
    shape, (course,) = flatten(course_rad=(course_rad, ()))
    axes = _core.tse_course_axes(course).reshape((*shape, 4))
    zero = np.zeros(shape)
    return TrackExtents(
        along_m=support(covariance_enu_m2, np.stack([axes[..., 0], axes[..., 1], zero], axis=-1), risk),
        cross_m=support(covariance_enu_m2, np.stack([axes[..., 2], axes[..., 3], zero], axis=-1), risk),
        up_m=support(covariance_enu_m2, np.stack([zero, zero, zero + 1.0], axis=-1), risk),
    )


def _unit(direction: Floats) -> Floats:
    """Directions of length one."""
    length = np.linalg.norm(direction, axis=-1)
    bad = np.flatnonzero(~((length > 0) & np.isfinite(length)))
    if bad.size:
        raise InputError("direction", float(length[bad[0]]), "1", "(0, inf) for its length", int(bad[0]))
    return np.asarray(direction / length[:, np.newaxis], dtype=np.float64)
