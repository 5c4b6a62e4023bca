"""The risks that bounds take, checked by the core; loads nothing else, so that settings are refused before any work."""

from __future__ import annotations

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
