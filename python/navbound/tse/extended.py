"""Total system error beyond one known offset and one normal law, and above the path; public as :mod:`navbound.tse`."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from navbound import _core
from navbound.errors import InputError
from navbound.table.arguments import checked
from navbound.table.arrays import flatten, split_columns, unflatten

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]


class RandomFte(NamedTuple):
    """Bound with a flight technical error known only by its law."""

    sigma_m: Floats
    """Total standard deviation. [m]"""
    tse_m: Floats
    """Exact bound. [m]"""


class Vertical(NamedTuple):
    """Errors across and above the path, and their bounds."""

    fte_m: Floats
    """Across the path, positive right. [m]"""
    sigma_m: Floats
    """Standard deviation across the path. [m]"""
    fte_v_m: Floats
    """Above the path, positive up. [m]"""
    sigma_v_m: Floats
    """Standard deviation above the path. [m]"""
    correlation: Floats
    """Correlation of the two errors. [1]"""
    tse_m: Floats
    """Exact bound across the path. [m]"""
    tse_v_m: Floats
    """Exact bound above the path. [m]"""


class Box(NamedTuple):
    """A box around the path and the risk of being outside."""

    limit_m: Floats
    """Half width. [m]"""
    limit_v_m: Floats
    """Half height. [m]"""
    risk: Floats
    """Risk of being outside, by the bivariate normal law. [1]"""
    risk_lateral: Floats
    """Risk beyond the side walls. [1]"""
    risk_vertical: Floats
    """Risk beyond floor and ceiling. [1]"""


@checked
def random_fte(
    mean_fte_m: ArrayLike,
    sigma_fte_m: ArrayLike,
    sigma_nse_m: ArrayLike,
    risk: ArrayLike,
    *,
    sigma_pde_m: ArrayLike = 0.0,
    correlation: ArrayLike = 0.0,
) -> RandomFte:
    """Exact bound with a flight technical error known only by its normal law.

    ``sigma^2 = sigma_fte^2 + sigma_nse^2 + sigma_pde^2 + 2 rho sigma_fte sigma_nse``. A coupled autopilot follows the estimate, so slow
    navigation errors stand in the true track with the opposite sign: ``rho`` matters.

    Parameters
    ----------
    mean_fte_m : array_like, shape (...)
        Mean flight technical error. [m]
    sigma_fte_m, sigma_nse_m, sigma_pde_m : array_like, shape (...)
        Standard deviations of flight technical, navigation system and path definition error. [m]
    risk : array_like, shape (...)
        Allowed risk in [1e-300, 0.5]. [1]
    correlation : array_like, shape (...)
        Correlation of flight technical and navigation system error, in [-1, 1]. [1]

    Returns
    -------
    RandomFte
        ``sigma_m`` and ``tse_m``, shape (...). [m]

    Raises
    ------
    InputError
        Not finite, a negative deviation, or a correlation or risk outside its domain.
    """
    shape, flat = flatten(
        mean_fte_m=(mean_fte_m, ()),
        sigma_fte_m=(sigma_fte_m, ()),
        sigma_nse_m=(sigma_nse_m, ()),
        sigma_pde_m=(sigma_pde_m, ()),
        correlation=(correlation, ()),
        risk=(risk, ()),
    )
    return RandomFte(*split_columns(_core.tse_random_fte(np.column_stack(flat[:5]), flat[5]), shape))


@checked
def student_t(fte_m: ArrayLike, scale_m: ArrayLike, degrees_of_freedom: ArrayLike, risk: ArrayLike) -> Floats:
    """Exact bound where the navigation error follows Student's law.

    Parameters
    ----------
    fte_m : array_like, shape (...)
        Flight technical error, of either sign. [m]
    scale_m : array_like, shape (...)
        Scale of the law across the path; its standard deviation is ``scale sqrt(nu / (nu - 2))`` for nu > 2. [m]
    degrees_of_freedom : array_like, shape (...)
        nu, from 1 to 1e6. [1]
    risk : array_like, shape (...)
        Allowed risk in [1e-300, 0.5]. [1]

    Returns
    -------
    ndarray, shape (...)
        The bound. [m]

    Raises
    ------
    InputError
        Not finite, a negative scale, or a nu or risk outside its domain.
    """
    shape, [f, s, nu, q] = flatten(fte_m=(fte_m, ()), scale_m=(scale_m, ()), degrees_of_freedom=(degrees_of_freedom, ()), risk=(risk, ()))
    return unflatten(_core.tse_student_t(f, s, nu, q), shape)


@checked
def mixture(weight: ArrayLike, fte_m: ArrayLike, sigma_m: ArrayLike, risk: ArrayLike) -> Floats:
    """Exact bound of a mixture of normal errors: mode switching, faulty and fault-free hypotheses.

    Parameters
    ----------
    weight : array_like, shape (..., k)
        Weights of the components, together one within 1e-12. [1]
    fte_m, sigma_m : array_like, shape (..., k)
        Mean and standard deviation of each component. [m]
    risk : array_like, shape (...)
        Allowed risk in [1e-300, 0.5]. [1]

    Returns
    -------
    ndarray, shape (...)
        The bound. [m]

    Raises
    ------
    InputError
        Not finite, a negative weight or deviation, weights that do not sum to one, or a risk outside [1e-300, 0.5].
    """
    k = np.shape(weight)[-1:]
    if k in {(), (0,)}:
        raise InputError("weight", f"shape {np.shape(weight)}", domain="one component or more along the last axis")
    shape, [w, f, s, q] = flatten(weight=(weight, k), fte_m=(fte_m, k), sigma_m=(sigma_m, k), risk=(risk, ()))
    return unflatten(_core.tse_mixture(w, f, s, q), shape)


@checked
def paired_overbound(fte_m: ArrayLike, sigma_m: ArrayLike, bias_m: ArrayLike, risk: ArrayLike) -> Floats:
    """Exact bound where the navigation error lies between two normal laws shifted by a bias either way: bias + exact.

    Parameters
    ----------
    fte_m, sigma_m, risk : array_like, shape (...)
        As :func:`exact`.
    bias_m : array_like, shape (...)
        Shift of the overbound, not negative. [m]

    Returns
    -------
    ndarray, shape (...)
        The bound. [m]

    Raises
    ------
    InputError
        As :func:`exact`, or a bias outside [0, inf).
    """
    shape, [f, s, b, q] = flatten(fte_m=(fte_m, ()), sigma_m=(sigma_m, ()), bias_m=(bias_m, ()), risk=(risk, ()))
    return unflatten(_core.tse_paired_overbound(f, s, b, q), shape)


@checked
def rf_fte(fte_m: ArrayLike, along_m: ArrayLike, sigma_along_m: ArrayLike, radius_m: ArrayLike) -> Floats:
    """Flight technical error on a curved (RF) leg with the bias of its curvature: ``|fte| + (sigma_along^2 + along^2) / (2 R)``.

    Parameters
    ----------
    fte_m : array_like, shape (...)
        Flight technical error at the closest point of the leg. [m]
    along_m : array_like, shape (...)
        Estimate ahead of the closest point. [m]
    sigma_along_m : array_like, shape (...)
        Standard deviation of the navigation error along the leg. [m]
    radius_m : array_like, shape (...)
        Radius of the leg. [m]

    Returns
    -------
    ndarray, shape (...)
        The error to give to the lateral bounds. [m]

    Raises
    ------
    InputError
        Not finite, a negative deviation, or a radius that is not positive.
    """
    shape, [f, a, s, r] = flatten(fte_m=(fte_m, ()), along_m=(along_m, ()), sigma_along_m=(sigma_along_m, ()), radius_m=(radius_m, ()))
    return unflatten(_core.tse_rf_fte(f, a, s, r), shape)


@checked
def vertical(
    offset_enu_m: ArrayLike, covariance_enu_m2: ArrayLike, course_rad: ArrayLike, path_angle_rad: ArrayLike, risk: ArrayLike
) -> Vertical:
    """Exact bounds across and above the path.

    Above the path the error is ``c . d`` with ``c = (-tan g sin chi, -tan g cos chi, 1)``; the full covariance carries the horizontal
    error into the vertical one.

    Parameters
    ----------
    offset_enu_m : array_like, shape (..., 3)
        Estimated position minus expected point, east, north, up. [m]
    covariance_enu_m2 : array_like, shape (..., 3, 3)
        Covariance of the navigation error. [m²]
    course_rad : array_like, shape (...)
        Course of the path, clockwise from true north. [rad]
    path_angle_rad : array_like, shape (...)
        Path angle, negative on a descent. [rad]
    risk : array_like, shape (...)
        Allowed risk in [1e-300, 0.5]. [1]

    Returns
    -------
    Vertical
        Errors, deviations, their correlation and both bounds, shape (...).

    Raises
    ------
    InputError
        Not finite, a vertical path, a covariance that is not symmetric or is indefinite, or a risk outside [1e-300, 0.5].
    """
    shape, [p, c, chi, gamma, q] = flatten(
        offset_enu_m=(offset_enu_m, (3,)),
        covariance_enu_m2=(covariance_enu_m2, (3, 3)),
        course_rad=(course_rad, ()),
        path_angle_rad=(path_angle_rad, ()),
        risk=(risk, ()),
    )
    return Vertical(*split_columns(_core.tse_vertical(p, c, chi, gamma, q), shape))


@checked
def box_risk(
    fte_m: ArrayLike,
    sigma_m: ArrayLike,
    fte_v_m: ArrayLike,
    sigma_v_m: ArrayLike,
    *,
    limit_m: ArrayLike,
    limit_v_m: ArrayLike,
    correlation: ArrayLike = 0.0,
) -> Box:
    """Risk of being outside a box around the path, jointly and by each pair of walls.

    Parameters
    ----------
    fte_m, sigma_m : array_like, shape (...)
        Error and standard deviation across the path. [m]
    fte_v_m, sigma_v_m : array_like, shape (...)
        Error and standard deviation above it. [m]
    limit_m, limit_v_m : array_like, shape (...)
        Half width and half height of the box. [m]
    correlation : array_like, shape (...)
        Correlation of the two errors. [1]

    Returns
    -------
    Box
        The limits and ``risk``, ``risk_lateral``, ``risk_vertical``, shape (...); the first lies between the larger and the sum of the
        other two.

    Raises
    ------
    InputError
        Not finite, a negative deviation or limit, or a correlation outside [-1, 1].
    """
    shape, flat = flatten(
        fte_m=(fte_m, ()),
        sigma_m=(sigma_m, ()),
        fte_v_m=(fte_v_m, ()),
        sigma_v_m=(sigma_v_m, ()),
        correlation=(correlation, ()),
        limit_m=(limit_m, ()),
        limit_v_m=(limit_v_m, ()),
    )
    return Box(*split_columns(_core.tse_box_risk(np.column_stack(flat[:5]), np.column_stack(flat[5:])), shape))


@checked
def box(
    fte_m: ArrayLike,
    sigma_m: ArrayLike,
    fte_v_m: ArrayLike,
    sigma_v_m: ArrayLike,
    risk: ArrayLike,
    *,
    correlation: ArrayLike = 0.0,
    share: ArrayLike = 0.5,
) -> Box:
    """Half sizes of a box around the path that is left with no more than one joint risk.

    ``share`` of the risk goes to the side walls, the rest to floor and ceiling; the joint risk at the resulting limits is reported.

    Parameters
    ----------
    fte_m, sigma_m : array_like, shape (...)
        Error and standard deviation across the path. [m]
    fte_v_m, sigma_v_m : array_like, shape (...)
        Error and standard deviation above it. [m]
    risk : array_like, shape (...)
        Allowed joint risk in [1e-300, 0.5]. [1]
    correlation : array_like, shape (...)
        Correlation of the two errors. [1]
    share : array_like, shape (...)
        Part of the risk for the side walls, in [1e-300, 0.5]. [1]

    Returns
    -------
    Box
        ``limit_m``, ``limit_v_m`` and the risks there, shape (...).

    Raises
    ------
    InputError
        Not finite, a negative deviation, or a correlation, share or risk outside its domain.
    """
    shape, flat = flatten(
        fte_m=(fte_m, ()),
        sigma_m=(sigma_m, ()),
        fte_v_m=(fte_v_m, ()),
        sigma_v_m=(sigma_v_m, ()),
        correlation=(correlation, ()),
        risk=(risk, ()),
        share=(share, ()),
    )
    return Box(*split_columns(_core.tse_box(np.column_stack(flat[:5]), flat[5], flat[6]), shape))
