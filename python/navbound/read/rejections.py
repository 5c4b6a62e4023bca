"""Counting what was not used: every row that is left out appears in the report, with an example."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from navbound.errors import FormatError
from navbound.run.records import Rejection

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

MAX_BAD_SHARE = 0.1
"""A file with a larger share of malformed rows than this is refused as a whole. Provenance: ours."""


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
    _with_bad_values: set[int] = field(default_factory=set)
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

    def add_values(self, reason: str, rows: Sequence[int], example: str) -> None:
        """Count the values of an optional column that cannot be read; `rows` are the lines or records that stay without them."""
        self.add(reason, len(rows), rows[0], example)
        self.malformed -= len(rows)
        self._with_bad_values.update(rows)

    def refuse_if_too_many(self, n_rows: int) -> None:
        """Refuse the file when more than the stated share of its rows is malformed.

        Raises
        ------
        FormatError
            Naming the first malformed line, what is wrong with it and the text found.
        """
        malformed = self.malformed + len(self._with_bad_values)
        if self._first_bad is None or malformed <= MAX_BAD_SHARE * n_rows:
            return
        first, reason, example = self._first_bad
        where = f"; first in record {first}" if self.unit != "line" else ""
        field, separator, kind = reason.partition(": ")
        raise FormatError(
            self.path,
            f"{kind if separator else reason}: found “{example[:80]}”; {malformed} of {n_rows} rows are malformed, "
            f"more than the {MAX_BAD_SHARE:.0%} that may be left out{where}",
            first if self.unit == "line" else None,
            field if separator else None,
        )
