"""Letters of a hemisphere in a column of their own: which columns hold them by their names, and whose coordinate they sign."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from navbound.errors import FormatError
from navbound.read.columns.column import NO_COLUMN, Column
from navbound.read.columns.naming import LONGEST_NAME, name_parts, parted_form, plain_form, words
from navbound.read.columns.place_names import AXES, Axis, axes_of, whose

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

STATED: dict[str, Axis] = {"lat_hemisphere": "est_lat_rad", "lon_hemisphere": "est_lon_rad"}
"""What a person declares a column of letters as."""
_SIDE = r"(?:dir|direction|ref|hem|hemi|hemisphere|indicator|ind|cardinal|sign|{0})"
_NAMES = {
    f"{kind}_{axis}_rad": re.compile(rf"{of}(?:{written})_?{_SIDE.format(either)}|{of}{either}(?:_?(?:ind|indicator|hemisphere|dir))?")
    for axis, written, either in (
        ("lat", "lat|latitude", "n(?:orth)?[_/]?s(?:outh)?"),
        ("lon", "lon|lng|long|longitude", "e(?:ast)?[_/]?w(?:est)?"),
    )
    for kind, of in (("est", "(?:gps|gnss)?_?"), ("truth", "truth_?"))
}
"""Names of columns of letters beside a coordinate. Provenance: ours, from headers of loggers and of EXIF."""
_PARTS = words("n s e w ns ew dir direction ref hem hemi hemisphere indicator ind cardinal sign latns lonew deg rad degrees m")
"""Parts of names of letters, and of units of a coordinate, that say nothing of whose it is."""


def named(in_words: Iterable[str], blank: Iterable[str]) -> dict[str, list[str]]:
    """The columns of letters by their names, by the quantity that they may sign; what is blank at first may hold them later."""
    # `NS` may be a number of satellites.
    later = [name for name in blank if plain_form(name)[0] != "ns"]
    names = [name for name in (*in_words, *later) if len(name) <= LONGEST_NAME]
    return {quantity: [name for name in names if _is_named(pattern, name)] for quantity, pattern in _NAMES.items()}


def _is_named(pattern: re.Pattern[str], name: str) -> bool:
    return any(pattern.fullmatch(form) for form in (parted_form(name), plain_form(name)[0]))


def of_name(name: str) -> Axis | None:
    """The coordinate whose letters a column holds by its name; or none."""
    return next((axis for axis in AXES if len(name) <= LONGEST_NAME and _is_named(_NAMES[axis], name)), None)


def apart(declared: Mapping[str, str] | None, names: list[str], path: Path) -> tuple[dict[str, str], dict[Axis, str]]:
    """What is declared of quantities, and of letters: coordinate to column, or to none.

    Raises
    ------
    FormatError
        A column that the file lacks.
    """
    stated = {STATED[key]: name for key, name in (declared or {}).items() if key in STATED}
    for axis, name in stated.items():
        if name not in names and name != NO_COLUMN:
            raise FormatError(path, f"there is no column “{name}”", 1, next(key for key, of in STATED.items() if of == axis))
    return {key: value for key, value in (declared or {}).items() if key not in STATED}, stated


def signed(
    columns: Mapping[str, Column], letters: Mapping[str, list[str]], names: Sequence[str], stated: Mapping[Axis, str]
) -> dict[str, Column]:
    """The coordinates that have letters: those that a person declares, otherwise those of their own."""
    spoken_for = {name for of in letters.values() for name in of}
    places = [name for name in names if name not in spoken_for]
    out = dict[str, Column]()
    for quantity, candidates in letters.items():
        axis = next(axis for axis in AXES if axis.removeprefix("est") == quantity.removeprefix("est").removeprefix("truth"))
        if (column := columns.get(quantity)) is None:
            continue
        if quantity in stated:
            own = [stated[axis]] if stated[axis] != NO_COLUMN else []
        else:
            own = [name for name in candidates if _are_of(name, axis, column.name, names, places)]
        if own:
            out[quantity] = replace(column, hemisphere=own[0])
    return out


def _are_of(letters: str, axis: Axis, coordinate: str, names: Sequence[str], places: Sequence[str]) -> bool:
    """Whether letters are those of a coordinate: the only one of its axis, one of the same name, or beside it."""
    of_axis = [name for name in places if axis in axes_of(name)]
    if len(of_axis) < _SEVERAL:
        return True
    if axis in axes_of(letters) or _of_whom(letters):
        return _of_whom(letters) == _of_whom(coordinate)
    at = names.index(letters)
    beside = [names[k] for k in (at - 1, at + 1) if 0 <= k < len(names) and names[k] in of_axis]
    return beside[:1] == [coordinate]


_SEVERAL = 2
"""Coordinates of one axis of which letters may be those of another one. [1]"""


def _of_whom(name: str) -> tuple[str, ...]:
    return tuple(part for part, written in zip(whose(name), name_parts(name), strict=True) if part and not {part, written} & _PARTS)
