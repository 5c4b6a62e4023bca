"""Units that a table states beside the names of its columns, in a row below the header or in a remark: the same or refused."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from navbound.errors import FormatError
from navbound.read.columns.naming import NO_UNIT, declare
from navbound.read.quantities import QUANTITY, UNITS

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from navbound.read.columns.column import Assignment

_TELLING = frozenset(unit for si, units in UNITS.items() if si in {"rad", "m", "m2", "mps", "hpa"} for unit in units)
_LEAST = 2
"""Units in one row that make it a row of units: one may be a word of its column. [1]"""
_REMARK = re.compile(r"^[ \t]*#.*$", re.MULTILINE)
_LONGEST = 1000
"""Characters of a remark that are looked at. [1]"""
HEAD_BYTES = 1 << 16
"""Of a file that is read in pieces only remarks at its beginning are looked at. [B]"""


def _unit(cell: object) -> str:
    return str(cell).strip(" \t\"'#[]()").lower()


def is_row_of_units(row: Mapping[str, object], mapping: Assignment) -> bool:
    """Whether a row below a header holds the units of its columns."""
    cells = [_unit(row[column.name]) for column in mapping.columns.values() if row.get(column.name) is not None]
    return sum(cell in _TELLING for cell in cells) >= _LEAST


def of_no_length(stated: Mapping[str, object], mapping: Assignment) -> set[str]:
    """The accuracies and levels of which a row of units says that they are no lengths: `cAcc` in degrees."""
    units = {name: _unit(stated.get(name) or "") for name in (*mapping.accuracies, *mapping.levels)}
    return {name for name, unit in units.items() if unit in _TELLING and unit not in UNITS["m"]}


def require_same(stated: Mapping[str, object], mapping: Assignment, path: Path, line: int) -> None:
    """Refuse units that a file states, column by column, where they are others than those that the columns are read in.

    Raises
    ------
    FormatError
        Naming the line, the column and both units.
    """
    for column in mapping.columns.values():
        units, unit = UNITS[QUANTITY[column.quantity].si], _unit(stated.get(column.name) or "")
        if len(units) > len(UNITS["1"]) and unit not in NO_UNIT and units.get(unit) != units[column.unit]:
            how = declare(f"{column.quantity}={column.name}:{unit if unit in units else 'UNIT'}")
            known = "" if unit in units else f"which is not known (known: {', '.join(units)}): leave it out, and "
            what = f"states the unit “{unit}” of “{column.name}”, which is read in {column.unit}; {known}{how}"
            raise FormatError(path, what, line, column.name)
    for name, factor in (mapping.accuracies | mapping.levels).items():
        unit = _unit(stated.get(name) or "")
        if unit in UNITS["m"] and UNITS["m"][unit] != factor:
            what = f"states the unit “{unit}” of “{name}”, whose name does not; leave the units out and rename it “{name} [{unit}]”"
            raise FormatError(path, what, line, name)


def require_same_in_remarks(text: str, mapping: Assignment, path: Path) -> None:
    """As :func:`require_same` for remarks such as ``# units: epu [NM]``.

    Raises
    ------
    FormatError
        Naming the line, the column and both units.
    """
    names = [column.name for column in mapping.columns.values()] + [*mapping.accuracies, *mapping.levels]
    for remark in _REMARK.finditer(text):
        stated = dict(_stated(remark[0][:_LONGEST], names))
        if stated:
            require_same(stated, mapping, path, text.count("\n", 0, remark.start()) + 1)


def _stated(remark: str, names: list[str]) -> Iterator[tuple[str, str]]:
    # Without brackets or the word, what stands behind a name may be anything.
    between = r"\s*(?:[\[(:=]|in\b)\s*" if re.search(r"\bunits?\b", remark, re.IGNORECASE) else r"\s*[\[(]\s*"
    for name in names:
        unit = re.search(rf"(?<![\w]){re.escape(name)}{between}([^\s\]),;]+)", remark, re.IGNORECASE)
        if unit and _unit(unit[1]) in _TELLING:
            yield name, unit[1]
