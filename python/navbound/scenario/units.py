"""Units of configuration keys: a key ends in its unit, and everything is turned into SI units on the way in."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from navbound.errors import InputError
from navbound.units import METRES_PER_FT, METRES_PER_NM, MPS_PER_KT

TO_SI: dict[str, tuple[str, float]] = {
    "_deg": ("_rad", math.pi / 180),
    "_degps": ("_radps", math.pi / 180),
    "_nm": ("_m", METRES_PER_NM),
    "_km": ("_m", 1000.0),
    "_ft": ("_m", METRES_PER_FT),
    "_kt": ("_mps", MPS_PER_KT),
    "_fpm": ("_mps", METRES_PER_FT / 60),
    "_min": ("_s", 60.0),
    "_degph": ("_radps", math.pi / 180 / 3600),
    "_degprth": ("_radprts", math.pi / 180 / 60),
    "_urad": ("_rad", 1e-6),
    "_ug": ("_mps2", 9.80665e-6),
    "_ugprthz": ("_mpsprts", 9.80665e-6),
    "_ppm": ("", 1e-6),
}
"""Suffix to the SI suffix and the factor; all exact by definition but for the rounding of pi. ``prth`` and ``prts`` are "per root of an
hour, a second": a random walk's growth; µg/√Hz is the same as m/s/√s."""


@dataclass(frozen=True)
class Written:
    """A value as it was written, and in SI units."""

    key: str
    value: object
    si: object


class RepeatedKeyError(InputError):
    """One quantity in two units."""


Place = tuple[str | int, ...]


def to_si(table: dict[str, Any], written: dict[Place, Written]) -> dict[str, Any]:
    """Turn every key of a table into SI units, and note in `written` how it was written.

    Raises
    ------
    RepeatedKeyError
        One quantity written twice in different units.
    """
    result: dict[str, Any] = {}
    _table(table, (), "", written, result)
    return result


def _table(table: dict[str, Any], place: Place, path: str, written: dict[Place, Written], result: dict[str, Any]) -> None:
    for key, value in table.items():
        name, factor = _si_name(key)
        here = f"{path}.{key}" if path else key
        if name in result:
            raise RepeatedKeyError(here, value, domain=f"one unit: it is also given as {written[(*place, name)].key}")
        result[name] = _value(value, factor, (*place, name), here, written)
        written[(*place, name)] = Written(here, value, result[name])


def _value(value: Any, factor: float | None, place: Place, path: str, written: dict[Place, Written]) -> Any:
    if isinstance(value, dict):
        inner: dict[str, Any] = {}
        _table(value, place, path, written, inner)
        return inner
    if isinstance(value, list):
        items = []
        for i, item in enumerate(value):
            items.append(_value(item, factor, (*place, i), f"{path}[{i}]", written))
            written[(*place, i)] = Written(f"{path}[{i}]", item, items[-1])
        return items
    # A truth value is a number to Python, not to us.
    if factor is not None and isinstance(value, (int, float)) and not isinstance(value, bool):
        return value * factor
    return value


def _si_name(key: str) -> tuple[str, float | None]:
    stem, _, last = key.rpartition("_")
    if stem and f"_{last}" in TO_SI:
        suffix, factor = TO_SI[f"_{last}"]
        return stem + suffix, factor
    return key, None
