"""The altimeter setting of one aircraft against that of others around it: one static source, or one undulation, drops out."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from navbound.errors import InputError
from navbound.table.arguments import checked
from navbound.table.arrays import flatten
from navbound.units import METRES_PER_NM

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

WITHIN_M, WITHIN_S = 30.0 * METRES_PER_NM, 1800.0
"""Others so near in place and time share the pressure field: 30 NM, 30 min (specification). [m], [s]"""
LEAST_OTHERS = 3
"""Fewer others have no median that one of them cannot move. Provenance: ours. [1]"""


class AreaSetting(NamedTuple):
    """One aircraft against the others.

    Attributes
    ----------
    n : int
        Others within reach. [1]
    median_m : float
        Median of their intercepts. [m]
    difference_m : float
        Intercept of the aircraft less that median; NaN with fewer than three others. [m]
    """

    n: int
    median_m: float
    difference_m: float


@checked
def area_setting(intercept_m: float, others_m: ArrayLike, distance_m: ArrayLike, apart_s: ArrayLike) -> AreaSetting:
    """What is left of an intercept of :func:`navbound.vertical.setting_line` when the median of the other aircraft is taken out.

    It removes what all share: the undulation, the geoid, a pressure field that the setting of the aerodrome does not meet. The difference
    goes into :func:`navbound.vertical.setting_test`.

    Parameters
    ----------
    intercept_m : float
        Of the aircraft. [m]
    others_m : array_like, shape (n,)
        Of other aircraft, by their own settings. [m]
    distance_m, apart_s : array_like, shape (n,)
        How far away, and how long before or after. [m], [s]

    Raises
    ------
    InputError
        Numbers that are not finite, or lengths that differ.
    """
    _, (intercept,) = flatten(intercept_m=(intercept_m, ()))
    if not np.isfinite(intercept[0]):
        raise InputError("intercept_m", intercept_m, "m", "(-inf, inf)")
    _, (others, distance, apart) = flatten(others_m=(others_m, ()), distance_m=(distance_m, ()), apart_s=(apart_s, ()))
    near = (np.abs(distance) <= WITHIN_M) & (np.abs(apart) <= WITHIN_S)
    for name, values, unit in (("others_m", others, "m"), ("distance_m", distance, "m"), ("apart_s", apart, "s")):
        bad = np.flatnonzero(~np.isfinite(values))
        if bad.size:
            raise InputError(name, float(values[bad[0]]), unit, "(-inf, inf)", int(bad[0]))
    n = int(near.sum())
    median = float(np.median(others[near])) if n >= LEAST_OTHERS else float("nan")
    return AreaSetting(n, median, float(intercept[0]) - median)
