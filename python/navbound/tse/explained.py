"""What stands behind a lateral bound, and published forms of it to compare with; public as :mod:`navbound.tse`."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from navbound import _core
from navbound.table.arguments import checked
from navbound.table.arrays import flatten, split_columns, unflatten
from navbound.tse.lateral import ctem, ctem_foot, exact, exceedance_risk, factors, ltem, project, sqsm

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]


class Rotated(NamedTuple):
    """All lateral bounds in the paper's rotated frame."""

    fte_m: Floats
    """Signed: positive where the estimate is above the line y = k x. [m]"""
    sigma_m: Floats
    """Standard deviation across the line. [m]"""
    factor: Floats
    """K. [1]"""
    exact_m: Floats
    ltem_m: Floats
    sqsm_m: Floats
    ctem_m: Floats
    risk_ltem: Floats
    """True risk at the LTEM bound. [1]"""
    risk_sqsm: Floats
    risk_ctem: Floats


class Explanation(NamedTuple):
    """Everything behind a lateral bound."""

    fte_m: Floats
    """Signed flight technical error. [m]"""
    along_m: Floats
    sigma_m: Floats
    sigma_major_m: Floats
    """Largest horizontal deviation. [m]"""
    sigma_minor_m: Floats
    """Smallest. [m]"""
    factor: Floats
    """K. [1]"""
    exact_m: Floats
    ltem_m: Floats
    sqsm_m: Floats
    ctem_m: Floats
    ctem_foot_m: Floats


@checked
def rotated_frame(
    k: ArrayLike, x0_m: ArrayLike, y0_m: ArrayLike, sigma_a_m: ArrayLike, sigma_b_m: ArrayLike, *, risk: ArrayLike
) -> Rotated:
    """All lateral bounds in the frame of the paper: axes along the ellipse, the path the line y = k x, the estimate at (x0, y0).

    For comparison with published numbers; :func:`project` needs neither slope nor eigenvectors.

    Parameters
    ----------
    k : array_like, shape (...)
        Slope of the path, plus or minus infinity along the second axis. [1]
    x0_m, y0_m : array_like, shape (...)
        Estimated position. [m]
    sigma_a_m, sigma_b_m : array_like, shape (...)
        Standard deviations along the two axes. [m]
    risk : array_like, shape (...)
        Allowed risk in [1e-300, 0.5]. [1]

    Returns
    -------
    Rotated
        Bounds, and the true risk at each quicker one, shape (...).

    Raises
    ------
    InputError
        A NaN slope, not finite, a negative deviation, or a risk outside [1e-300, 0.5].
    """
    shape, [slope, x, y, a, b, q] = flatten(
        k=(k, ()), x0_m=(x0_m, ()), y0_m=(y0_m, ()), sigma_a_m=(sigma_a_m, ()), sigma_b_m=(sigma_b_m, ()), risk=(risk, ())
    )
    columns = split_columns(_core.tse_rotated(slope, np.column_stack([x, y]), np.column_stack([a, b]), q), shape)
    fte, sigma, *bounds = columns
    risks = [exceedance_risk(fte, sigma, bound) for bound in bounds[1:]]
    return Rotated(fte, sigma, unflatten(factors(q).two_sided, shape), *bounds, *risks)


@checked
def explain(offset_en_m: ArrayLike, covariance_en_m2: ArrayLike, course_rad: ArrayLike, risk: ArrayLike) -> Explanation:
    """Everything behind a lateral bound: projection, axes, factor and each method's result.

    Parameters
    ----------
    offset_en_m, covariance_en_m2, course_rad : array_like, shapes (..., 2), (..., 2, 2) and (...)
        As :func:`project`. [m, m², rad]
    risk : array_like, shape (...)
        Allowed risk in [1e-300, 0.5]. [1]

    Returns
    -------
    Explanation
        Lengths of shape (...). [m]

    Raises
    ------
    InputError
        As :func:`project`, or a risk outside [1e-300, 0.5].
    """
    shape, [p, c, chi, q] = flatten(
        offset_en_m=(offset_en_m, (2,)), covariance_en_m2=(covariance_en_m2, (2, 2)), course_rad=(course_rad, ()), risk=(risk, ())
    )
    fte, along, sigma = project(p, c, chi)
    major, minor = split_columns(_core.tse_axes(c), (len(c),))
    bounds = [exact(fte, sigma, q), ltem(fte, sigma, q), sqsm(fte, c, q), ctem(p, c, q), ctem_foot(fte, chi, c, q)]
    columns = [fte, along, sigma, major, minor, factors(q).two_sided, *bounds]
    return Explanation(*(unflatten(column, shape) for column in columns))


@checked
def ltem_as_printed(offset_en_m: ArrayLike, covariance_en_m2: ArrayLike, risk: ArrayLike) -> Floats:
    """LTEM exactly as printed (F-39, slope cot phi, factors 1.96 and 4.41): an exhibit of errata E2, E3 and E13, not a bound.

    Parameters
    ----------
    offset_en_m, covariance_en_m2 : array_like, shapes (..., 2) and (..., 2, 2)
        As :func:`ctem`. [m, m²]
    risk : array_like, shape (...)
        0.05 or 1e-5, the two the paper prints. [1]

    Returns
    -------
    ndarray, shape (...)
        What the printed formula gives; it may be negative. [m]

    Raises
    ------
    InputError
        As :func:`ctem`, or another risk.
    """
    shape, [p, c, q] = flatten(offset_en_m=(offset_en_m, (2,)), covariance_en_m2=(covariance_en_m2, (2, 2)), risk=(risk, ()))
    return unflatten(_core.tse_ltem_as_printed(p, c, q), shape)
