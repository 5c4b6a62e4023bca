"""The altimeter's setting: the line through differences of heights, and what a test of it can find."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from navbound import _core
from navbound.table.arguments import checked
from navbound.table.arrays import flatten, unflatten

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]


class SettingLine(NamedTuple):
    """The line through geometric less indicated height.

    Attributes
    ----------
    n : int
        Points. [1]
    intercept_m : float
        Difference at the ground, negative where the setting is too high. [m]
    slope : float
        Its growth with height: the deviation of the temperature by the temperature. [1]
    residual_sigma_m : float
        Standard deviation of the residuals, of n - 2 degrees of freedom. [m]
    """

    n: int
    intercept_m: float
    slope: float
    residual_sigma_m: float


@checked
def setting_line(height_m: ArrayLike, difference_m: ArrayLike) -> SettingLine:
    """Difference of heights at the ground, with the temperature taken out: the line of least squares.

    A wrong altimeter setting moves all indicated heights by the same; a wrong geometric height or undulation does, too. The barometric
    altitude of a transponder holds no setting: indicated heights need the one that is broadcast, or the aerodrome's.

    Parameters
    ----------
    height_m, difference_m : array_like, shape (n,)
        Indicated height above the aerodrome, and geometric less indicated height above the sea. [m]

    Raises
    ------
    InputError
        Numbers that are not finite, fewer than three points, the same height at all of them.
    """
    shape, flat = flatten(height_m=(height_m, ()), difference_m=(difference_m, ()))
    del shape
    return SettingLine(*_core.vertical_setting_line(*flat))


class SettingTest(NamedTuple):
    """What a test of the altimeter setting can find, shape (...) each.

    Attributes
    ----------
    threshold_m : ndarray
        A larger difference at the ground is an alarm. [m]
    power : ndarray
        Probability of an alarm at the error. [1]
    detectable_m : ndarray
        Error that is an alarm with the requested probability. [m]
    """

    threshold_m: Floats
    power: Floats
    detectable_m: Floats


@checked
def setting_test(sigma_m: ArrayLike, false_alarm: ArrayLike, error_m: ArrayLike, *, probability: ArrayLike = 0.9) -> SettingTest:
    """Threshold and power of the test of a difference at the ground: alarm above ``K sigma``, ``Q(K - d/s) + Q(K + d/s)``.

    Parameters
    ----------
    sigma_m : array_like, shape (...)
        Standard deviation of the difference where nothing is wrong; three approaches of one airliner suggest 10 m (inferred). [m]
    false_alarm : array_like, shape (...)
        Risk of an alarm where nothing is wrong. [1]
    error_m : array_like, shape (...)
        Error of the setting, as a height. [m]
    probability : array_like, shape (...)
        For which `detectable_m` is given. [1]

    Raises
    ------
    InputError
        A deviation that is not positive, a risk outside its domain, a probability outside [0.5, 1).
    """
    shape, flat = flatten(sigma_m=(sigma_m, ()), false_alarm=(false_alarm, ()), error_m=(error_m, ()), probability=(probability, ()))
    values = _core.vertical_setting_test(*flat)
    return SettingTest(*(unflatten(np.ascontiguousarray(column), shape) for column in values.T))
