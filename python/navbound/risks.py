"""The risks that bounds take, checked by the core; loads nothing else, so that settings are refused before any work."""

from __future__ import annotations

import math

from navbound import _core
from navbound.errors import InputError


def checked_risk(argument: str, value: float) -> float:
    """An allowed risk, at most one half.

    Raises
    ------
    InputError
        Outside its domain; between 0.5 and 1 the error asks whether a confidence was meant.
    """
    try:
        return _core.checked_risk(float(value))
    except InputError as e:
        raise InputError(argument, value, e.unit, e.domain) from None


def at_least_once(risk: float, n_times: float) -> float:
    """Probability that what has this risk each time, below one, happens in so many independent times; small ones keep their digits."""
    return -math.expm1(n_times * math.log1p(-risk))
