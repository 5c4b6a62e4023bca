"""Counting what was not used: every row that is left out appears in the report, with an example."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from navbound.errors import FormatError
from navbound.records.run import Rejection
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from pathlib import Path

MAX_BAD_SHARE = 0.1
"""A file with a larger share of malformed rows than this is refused as a whole. Provenance: ours."""
_DECIMAL_COMMA = re.compile(r"\s*[+-]?\d+,\d+\s*")


_SHOWN = 3
"""Reasons that a refusal names. [1]"""


@dataclass
class Rejections:
    """What was left out of one file, reason by reason.

    Attributes
    ----------
    path : Path
        The file.
    unit : {"line", "record"}
        What `first` counts: lines of a text file, or records of a structured one.
    """

    path: Path
    unit: str = "line"
    records: list[Rejection] = field(default_factory=list)
    malformed: int = 0
    """Rows left out because something in them cannot be read, as opposed to rows in which nothing stands."""
    n_with_bad_values: int = 0
    """Rows that stay without a value that cannot be read: a row with three bad values is one row."""
    _first_bad: tuple[int, str, str] | None = None

    def add(self, reason: str, count: int, first: int, example: str, *, malformed: bool = True) -> None:
        """Count rows left out for one reason; `first` is the line or record of the first, `example` the text found there."""
        if count == 0:
            return
        shown = example if self.unit == "line" else f"record {first}: {example}"
        line = first if self.unit == "line" else None
        self.records.append(Rejection(file=str(self.path), reason=reason, count=count, first_line=line, example=shown[:120]))
        if malformed:
            self.malformed += count
            if self._first_bad is None or first < self._first_bad[0]:
                self._first_bad = (first, reason, example)

    def add_values(self, reason: str, count: int, first: int, example: str) -> None:
        """Count the values of an optional column that cannot be read. Their rows count once, in `n_with_bad_values`."""
        self.add(reason, count, first, example)
        self.malformed -= count

    def in_words(self) -> str:
        """The reasons with their counts, the first few, behind a colon; nothing where no row was left out."""
        each = [f"{counted(r.count, 'row')} left out, {r.reason} ({r.example})" for r in self.records[:_SHOWN]]
        return ": " + "; ".join(each) if each else ""

    def without_position(self) -> str:
        """Why a file without a single position is refused: rows that have one and are left out are counted."""
        return f"no row that may be used{self.in_words()}" if self.records else "no row holds a time, a latitude and a longitude"

    def refuse_if_too_many(self, n_rows: int) -> None:
        """Refuse the file when more than the stated share of its rows is malformed.

        Raises
        ------
        FormatError
            Naming the first malformed line, what is wrong with it and the text found.
        """
        malformed = self.malformed + self.n_with_bad_values
        if self._first_bad is None or malformed <= MAX_BAD_SHARE * n_rows:
            return
        first, reason, example = self._first_bad
        where = f"; first in record {first}" if self.unit != "line" else ""
        field, separator, kind = reason.partition(": ")
        if _DECIMAL_COMMA.fullmatch(example):
            where += "; numbers with a decimal comma are not read: write them with a point"
        raise FormatError(
            self.path,
            f"{kind if separator else reason}: found “{example[:80]}”; {malformed} of {counted(n_rows, 'row')} "
            f"{agreeing(malformed, 'is', 'are')} malformed, "
            f"more than the {MAX_BAD_SHARE:.0%} that may be left out{where}",
            first if self.unit == "line" else None,
            field if separator else None,
        )


OPTIONAL, DATED, REQUIRED, REPEATED, LEVELS, COMPARED, SPEEDS = range(100_000, 800_000, 100_000)
"""Where a reason stands among the others of its file; the number of the column is added to that of an optional one."""


@dataclass
class Tally:
    """The same while a file comes in pieces.

    What pieces count for one reason is counted together, in the order of `place` and then of appearance.
    """

    n_with_bad_values: int = 0
    _counted: dict[tuple[int, str], _Counted] = field(default_factory=dict)

    def add(self, place: int, reason: str, count: int, first: int, example: str, *, kind: Kind = "row") -> None:
        """Count as :meth:`Rejections.add`: rows that are malformed, rows in which nothing is malformed, or values."""
        if count == 0:
            return
        before = self._counted.get((place, reason))
        if before is None:
            self._counted[place, reason] = _Counted(count, first, example, kind)
            return
        before.count += count
        if first < before.first:
            before.first, before.example = first, example

    def into(self, rejections: Rejections) -> None:
        """Hand over what was counted, once."""
        rejections.n_with_bad_values += self.n_with_bad_values
        for (_, reason), of in sorted(self._counted.items(), key=lambda entry: entry[0][0]):
            if of.kind == "value":
                rejections.add_values(reason, of.count, of.first, of.example)
            else:
                rejections.add(reason, of.count, of.first, of.example, malformed=of.kind == "row")


Kind = Literal["row", "quiet", "value"]


@dataclass
class _Counted:
    count: int
    first: int
    example: str
    kind: Kind
