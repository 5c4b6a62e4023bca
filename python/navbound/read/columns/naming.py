"""Names of columns: how one is taken apart, in which unit it says its numbers are, and how a person says what it is."""

from __future__ import annotations

import functools
import re
from typing import TYPE_CHECKING

from navbound.errors import FormatError
from navbound.read.quantities import UNITS, Quantity

if TYPE_CHECKING:
    from pathlib import Path


def words(text: str) -> frozenset[str]:
    """Words apart at blanks."""
    return frozenset(text.split())


LONGEST_NAME = 80
"""Longer names are compared with nothing: likeness takes quadratic time. [1]"""
_ALL_UNITS = frozenset(unit for units in UNITS.values() for unit in units if unit not in {"", "1"})


_NORTH_OR_SOUTH = "n/s"
"""A name that is no quantity in seconds."""


@functools.lru_cache(maxsize=16_384)
def plain_form(name: str) -> tuple[str, str | None]:
    """``Latitude (deg)`` and ``Latitude / deg`` to ``latitude`` and ``deg``; of a name that stands twice both columns are it."""
    stem, unit = re.sub(r"#\d{1,3}$", "", name).strip(), None
    if stem.endswith((")", "]")):
        # By searches and no pattern: one with several runs of blanks takes quadratic time.
        inside = stem[:-1]
        last_closed = max(inside.rfind(")"), inside.rfind("]"))
        opened = [at for bracket in "([" if (at := inside.find(bracket, last_closed + 1)) >= 0]
        if opened:
            stem, unit = inside[: min(opened)], inside[min(opened) + 1 :].strip().lower()
    elif stem.lower() != _NORTH_OR_SOUTH and (slash := stem.rfind("/")) > 0 and stem[slash + 1 :].strip().lower() in _ALL_UNITS:
        stem, unit = stem[:slash], stem[slash + 1 :].strip().lower()
    plain = re.sub(r"[\s\-.]+", "_", stem.strip().lower())
    if unit in _ABOVE_ELLIPSOID and plain in _HEIGHTS:
        # What it is above is part of its name: `Altitude` beside it is another height.
        return "ellipsoid_height", None
    return plain, unit


_ABOVE_ELLIPSOID = frozenset(("wgs84", "wgs-84", "wgs 84", "ellipsoid", "ellipsoidal", "above ellipsoid", "hae"))
_HEIGHTS = frozenset(("altitude", "alt", "height", "h"))


@functools.lru_cache(maxsize=16_384)
def apart_at_capitals(name: str) -> str:
    """``latDeg`` to ``lat_Deg``."""
    return re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", name)


LONGEST_PARTED = 200
"""Characters of a name of which parts are compared. [1]"""


def name_parts(name: str) -> list[str]:
    """Parts of a name, in small letters: at what is neither letter nor digit, and before a capital."""
    return re.split(r"[^a-z0-9]+", apart_at_capitals(name[:LONGEST_PARTED]).lower())


def parted_form(name: str) -> str:
    """``latDeg`` to ``lat_deg``."""
    return plain_form(apart_at_capitals(name))[0] if len(name) <= LONGEST_NAME else plain_form(name)[0]


def by_form(names: list[str]) -> dict[str, str]:
    """Plain names and those taken apart at capitals, to the first column of each; a plain name counts before one taken apart."""
    return {parted_form(name): name for name in reversed(names)} | {plain_form(name)[0]: name for name in reversed(names)}


NO_UNIT = _ABOVE_ELLIPSOID | {"", "1", "-", "geodetic", "true", "gps", "utc", "1s", "1 sigma", "used/view"}
"""What stands in brackets behind a name and says nothing of its unit."""


def written_unit(name: str, quantity: Quantity, path: Path) -> str | None:
    """The unit in brackets; None where there is none. One that is not known is no other: the number could be anything.

    Raises
    ------
    FormatError
        Naming the column and the units that are known.
    """
    written = plain_form(name)[1]
    if written is None or written in NO_UNIT or quantity.si == "text":
        return None
    if written in UNITS[quantity.si]:
        return written
    known = ", ".join(u for u in UNITS[quantity.si] if u)
    what = f"its unit “{written}” is not known (known: {known}); rename the column, or {declare(f'{quantity.name}={name}:UNIT')}"
    raise FormatError(path, what, 1, name)


def length_in(name: str) -> float | None:
    """The unit of length in brackets or at the end of a name, metres where there is none; None where it is a unit of something else."""
    stem, written = plain_form(name)
    if written is not None and written not in NO_UNIT:
        return UNITS["m"].get(written)
    return UNITS["m"].get(stem.rsplit("_", 1)[-1], 1.0)


def column_named(value: str, names: list[str]) -> tuple[str, str]:
    """``column:unit`` to both; a name may have a colon of its own."""
    name, separator, unit = value.rpartition(":")
    if value in names or not separator:
        return value, ""
    return name, unit


def declare(*columns: str) -> str:
    """How a person declares what a column is, from the command line and in Python."""
    options = " ".join(f'--map "{column}"' for column in columns)
    return f"declare it: {options} (in Python: columns)"
