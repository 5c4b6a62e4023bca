"""Letters of a hemisphere that contradict a coordinate as it is read, in whatever column they stand.

A column that signs a coordinate is read with it (`columns.hemispheres`). Another one may hold the letters of a coordinate under a name that
nobody knows, or behind numbers: then the position is on the other side of the Earth, and every row agrees with the next one.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import polars as pl

from navbound.read.columns.column import NO_COLUMN
from navbound.read.columns.hemispheres import STATED, of_name
from navbound.read.columns.naming import declare, name_parts, plain_form, words
from navbound.read.columns.place_names import AXES, OF_HEMISPHERE, Axis, Sides, axes_of, is_no_vehicle, sides
from navbound.read.tables.cells import in_one_text
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from navbound.read.columns.column import Assignment

_MOST_WORDS = 64
"""A column of letters has few words; one of more is none. Provenance: ours. [1]"""
_SHARE = 0.5
"""Share of the words of a column that letters must be. Provenance: ours. [1]"""
_AGAINST = 0.01
"""Share of letters from which they contradict a coordinate: at the equator a rounding decides a few. Provenance: ours. [1]"""
_NO_SIDE_RAD = 1e-4
"""Nearer to zero a letter contradicts nothing. Provenance: ours. [rad]"""
_DIRECTION = words("wind heading hdg course cog track bearing dir direction flight moving compass sector runway")
"""Parts of names of a direction that is written as a hemisphere. Provenance: ours."""
_CODES: dict[Axis, dict[float, int]] = {
    "est_lat_rad": {-1.0: -1, 83.0: -1, 115.0: -1, 78.0: 1, 110.0: 1},
    "est_lon_rad": {-1.0: -1, 87.0: -1, 119.0: -1, 69.0: 1, 101.0: 1},
}
"""Numbers of a hemisphere: the sign, or the character. Provenance: ours."""
_UNCLEAR = frozenset((0.0, 1.0, 2.0))
_ALL_CODES = frozenset(code for codes in _CODES.values() for code in codes)
_COUNTED = words("ns ew")
"""Names that are those of numbers of satellites and of intervals, too. Provenance: ours."""


@dataclass
class _Seen:
    """What stands in one column."""

    n_written: int = 0
    n_letters: dict[Axis, int] = field(default_factory=lambda: dict.fromkeys(AXES, 0))
    n_against: dict[Axis, int] = field(default_factory=lambda: dict.fromkeys(AXES, 0))
    n_unclear: int = 0

    def are_letters(self, axis: Axis) -> bool:
        return self.n_letters[axis] > _SHARE * self.n_written


class Hemispheres:
    """Compares letters with the signs of the coordinates, over all rows."""

    def __init__(self, path: Path, mapping: Assignment) -> None:
        self._path, self._mapping = path, mapping
        self._read: dict[Axis, str] = {axis: mapping.columns[axis].name for axis in AXES if axis in mapping.columns}
        self._axes = [axis for axis in AXES if axis not in mapping.declared_sides and axis in self._read]
        self._free = {*mapping.unused, *(name for name, _ in mapping.statements)}
        self._seen, self._names = dict[str, _Seen](), list[str]()
        self._n_negative: dict[Axis, int] = dict.fromkeys(AXES, 0)

    def see(self, part: pl.DataFrame, frame: pl.DataFrame, within: pl.DataFrame) -> None:
        """The next rows: those that are read, the file's, and what objects in their fields state."""
        if not set(AXES) <= set(part.columns):
            return
        self._names = self._names or frame.columns
        for axis in AXES:
            self._n_negative[axis] += int((part[axis] < -_NO_SIDE_RAD).sum())
        columns = [frame[name] for name in frame.columns if name in self._free]
        for column in (*columns, *within.get_columns()):
            if not is_no_vehicle(column.name):
                self._see(column, part)

    def _see(self, column: pl.Series, part: pl.DataFrame) -> None:
        of, read = of_name(column.name), dict[str, Sides]()
        if column.dtype in (pl.String, pl.List(pl.String)):
            texts = in_one_text(column)
            written = texts.unique().drop_nulls()
            if len(written) > _MOST_WORDS:
                return
            read = {text: sides(text) for text in written}
        elif (of is None and not _is_of_any(column.name)) or not (column.dtype.is_numeric() or column.dtype == pl.Boolean):
            return
        else:
            texts = column.cast(pl.Float64)
        if of is None and not _is_of_any(column.name) and not any(side.lat or side.lon for side in read.values()):
            return
        signs = {axis: _coded(texts, {text: side[k] for text, side in read.items()}) for k, axis in enumerate(AXES)}
        numbers = texts.cast(pl.Float64, strict=False)
        if of is not None:
            signs[of] = pl.select(pl.coalesce(signs[of], _coded(numbers, _CODES[of]))).to_series()
        seen = self._seen.setdefault(column.name, _Seen())
        # Where the name is of neither coordinate nobody knows of which its numbers are.
        unclear = _UNCLEAR if of is not None else _UNCLEAR | _ALL_CODES if _is_of_any(column.name) else frozenset[float]()
        seen.n_unclear += int(numbers.is_in(sorted(unclear)).sum())
        blank = sum(int((texts == text).sum()) for text in read if not text.strip())
        self._count(seen, len(texts) - texts.null_count() - blank, signs, part)

    @staticmethod
    def _count(seen: _Seen, n_written: int, signs: dict[Axis, pl.Series], part: pl.DataFrame) -> None:
        seen.n_written += n_written
        for axis, sign in signs.items():
            angle = part[axis]
            side = pl.select(pl.when(angle.abs() > _NO_SIDE_RAD).then(angle.sign())).to_series()
            seen.n_letters[axis] += sign.count()
            seen.n_against[axis] += int((sign.cast(pl.Float64) * side < 0.0).sum())

    def doubts(self) -> list[str]:
        """Coordinates that letters contradict, after all rows."""
        return [*self._contradicted(), *self._unclear(), *self._one_sided()]

    def _contradicted(self) -> Iterator[str]:
        for axis in self._axes:
            for name, seen in self._seen.items():
                are_letters = seen.are_letters(axis) or of_name(name) == axis
                if are_letters and seen.n_against[axis] > _AGAINST * seen.n_letters[axis] and self._is_evident(name, seen, axis):
                    n = f"at {seen.n_against[axis]} of {counted(seen.n_letters[axis], 'row')}"
                    yield self._words(name, axis, f"says another hemisphere than “{self._read[axis]}” is read in {n}")

    def _is_evident(self, name: str, seen: _Seen, axis: Axis) -> bool:
        """Whether letters are those of a hemisphere: by their name, by those of the other coordinate, or of both by where they stand."""
        parts = set(name_parts(name))
        if axes_of(name) or of_name(name) or parts & OF_HEMISPHERE:
            return True
        if all(seen.are_letters(each) for each in AXES):
            return self._stands_behind(name) and not parts & _DIRECTION
        signed = {each for each in AXES if each in self._read and self._mapping.columns[each].hemisphere}
        if axis in signed:
            # Letters beside it sign it: loggers write a reason of recording with letters, too.
            return False
        lettered = {each for each in AXES for other in self._seen.values() if other is not seen and other.are_letters(each)}
        return bool((signed | lettered) - {axis})

    def _stands_behind(self, name: str) -> bool:
        """Whether a column comes directly behind a coordinate."""
        at = self._names.index(name) if name in self._names else 0
        return at > 0 and self._names[at - 1] in self._read.values()

    def _unclear(self) -> Iterator[str]:
        """Numbers in a column of letters, beside a coordinate that is never below zero."""
        for name, seen in self._seen.items():
            axis = of_name(name) or next((each for each in self._axes if not self._n_negative[each] and _is_of_any(name)), None)
            if axis not in self._axes or self._n_negative[axis] or plain_form(name)[0] in _COUNTED:
                continue
            if seen.n_unclear > _SHARE * seen.n_written:
                yield self._words(name, axis, f"holds numbers, and nothing says which hemisphere of “{self._read[axis]}” they mean")

    def _one_sided(self) -> Iterator[str]:
        """A coordinate without letters and without a sign beside one with letters."""
        signed = [axis for axis in AXES if axis in self._read and self._mapping.columns[axis].hemisphere]
        if len(signed) != 1:
            return
        letters = self._mapping.columns[signed[0]].hemisphere
        for axis in self._axes:
            has_letters = any(seen.are_letters(axis) for seen in self._seen.values())
            if axis not in signed and not self._n_negative[axis] and not has_letters:
                what = f"says the hemisphere of “{self._read[signed[0]]}”, and “{self._read[axis]}” has neither a hemisphere nor a sign"
                how = f"{declare(f'{_key(axis)}=COLUMN')}, or {_key(axis)}={NO_COLUMN} where it needs none"
                yield f"{self._path.name}: “{letters}” {what}; {how}; nothing is shown until then"

    def _words(self, name: str, axis: Axis, what: str) -> str:
        key = _key(axis)
        how = f"{declare(f'{key}={name}')}, or {key}={NO_COLUMN} where it is something else"
        return f"{self._path.name}: “{name}” {what}; {how}; nothing is shown until then"


def _is_of_any(name: str) -> bool:
    """Whether a name is one of a hemisphere, and of neither coordinate."""
    return not words("hemisphere hemispheres hemi hem quadrant").isdisjoint(name_parts(name)) and not axes_of(name)


def _coded(column: pl.Series, signs: Mapping[Any, int | None]) -> pl.Series:
    if not signs:
        return pl.Series([None] * len(column), dtype=pl.Int8)
    return column.replace_strict(signs, default=None, return_dtype=pl.Int8)


def _key(axis: Axis) -> str:
    return next(key for key, of in STATED.items() if of == axis)
