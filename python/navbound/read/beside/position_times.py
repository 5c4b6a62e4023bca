"""When each position of a table was valid, where a column says so, or how old it was."""

from __future__ import annotations

from typing import TYPE_CHECKING

import polars as pl

from navbound.errors import FormatError
from navbound.read.checks import stated
from navbound.read.checks.rejections import DATED
from navbound.read.columns.timed import position_time
from navbound.read.quantities import POSITION_TIME
from navbound.read.statements.kinds import AGES, STALE_AFTER_S
from navbound.read.statements.texts import Stated
from navbound.read.tables.cells import no_field
from navbound.read.tables.table import LINE
from navbound.read.tables.times import TimeFacts, converted, understand
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from navbound.read.checks.rejections import Tally
    from navbound.read.statements.kinds import Kind

_LATE = "later than its row"
_AGE, _OLDEST_S = "__age_s", 1e6
"""Column of the age that a row states of its position, and the largest that dates it. [s] Provenance: ours."""
_AHEAD_NS = 1_000_000_000
"""How much later than its row a position may be said to be: both may be rounded."""


class PositionTimes:
    """Takes every piece of a table before the times are understood, and dates its positions after."""

    def __init__(self, path: Path, unused: list[str], statements: Sequence[tuple[str, Kind]]) -> None:
        self._path, self._statements = path, statements
        self._column = position_time(unused)
        self._facts, self._unit = list[TimeFacts](), ""
        self._n_dated = self._n_undated = 0

    def with_age(self, part: pl.DataFrame, frame: pl.DataFrame) -> pl.DataFrame:
        """The next rows, with the age that each states of its position where no column states the time of the position."""
        if self._column is not None and no_field(frame.schema[self._column.name]):
            # `lastPosition` of readsb is an object and no time.
            self._column = None
        stating = [(name, kind) for name, kind in self._statements if not no_field(frame.schema[name])]
        ages = {name: unit_s for name, kind in stating for of, unit_s in AGES if kind is of}
        if self._column is not None or not ages:
            return part
        stated_s = [(frame[name].cast(pl.Float64, strict=False).fill_nan(None) * unit_s).alias(name) for name, unit_s in ages.items()]
        oldest_s = pl.DataFrame(stated_s).max_horizontal()
        return part.with_columns(pl.select(pl.when(oldest_s.is_between(0.0, _OLDEST_S)).then(oldest_s)).to_series().alias(_AGE))

    def written(self, frame: pl.DataFrame) -> dict[str, pl.Series]:
        """The times as they stand in the next rows; nothing where no column has them."""
        if self._column is None:
            return {}
        self._facts.append(TimeFacts.of(frame, [self._column]))
        return {self._column.name: frame[self._column.name]}

    def understand(self, dtypes: Mapping[str, pl.DataType], notes: list[str]) -> list[str]:
        """Decide in which unit they are; a doubt where they are no times."""
        column, facts = self._column, self._facts
        self._facts = []
        if column is None:
            return []
        try:
            self._unit = understand(TimeFacts.together(facts), [column], dtypes[column.name], self._path, notes)
        except FormatError as e:
            self._column = None
            return [f"{self._path.name}: “{column.name}” says when positions were valid and is not read: {e.message}"]
        return []

    def dated(self, out: pl.DataFrame, raw: pl.DataFrame, tally: Tally) -> pl.DataFrame:
        """Rows with the time at which each position was valid; a time that is none, or later than its row, is counted and not used."""
        if _AGE in out.columns:
            valid_ns = pl.col("time_ns") - (pl.col(_AGE) * 1e9).round().cast(pl.Int64)
            return out.with_columns(valid_ns.alias(POSITION_TIME)).drop(_AGE)
        if self._column is None:
            return out
        name = self._column.name
        valid, reason = converted(raw, [self._column], self._unit)
        late = (valid > out["time_ns"] + _AHEAD_NS).fill_null(value=False)
        reason = pl.select(pl.when(late).then(pl.lit(_LATE)).otherwise(reason)).to_series()
        for text in reason.drop_nulls().filter(reason.drop_nulls() != "empty").unique(maintain_order=True):
            at = (reason == text).fill_null(value=False)
            # Without it the row's own time serves: that makes no row malformed.
            words = f"{name}: {text}; row used without it"
            tally.add(DATED, words, int(at.sum()), out.filter(at)[LINE][0], str(raw.filter(at)[name][0]), kind="quiet")
            self._n_undated += 0 if text == _LATE else int(at.sum())
        self._n_dated += int(valid.count())
        out = out.with_columns(pl.select(pl.when(reason.is_null()).then(valid)).to_series().alias(POSITION_TIME))
        # One of the two clocks is wrong, and nothing says which.
        ahead_s = (valid - out["time_ns"]).cast(pl.Float64) * 1e-9
        of_row = pl.format("{} s later than its row", ahead_s.round(1))
        wrong = pl.select(pl.when(ahead_s > STALE_AFTER_S).then(of_row)).to_series()
        return stated.with_statements(out, [(name, "invalid", Stated(wrong, []))]) if wrong.count() else out

    def doubts(self) -> list[str]:
        """Why nothing can be shown of the positions, after the last rows."""
        if self._column is None or self._n_undated <= self._n_dated:
            return []
        unread = f"{self._n_undated} of its {counted(self._n_undated + self._n_dated, 'field')} cannot be read as a time"
        return [f"{self._path.name}: “{self._column.name}” says when positions were valid, and {unread}"]
