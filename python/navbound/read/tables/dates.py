"""A date and a time of day in two columns: what each may look like, and both as one written time.

A date with the year first has one meaning. Of one with day and month as numbers the rows of the whole column decide which stands first,
or the caller does: a guess would be wrong by months.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import polars as pl

from navbound.errors import FormatError

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from navbound.read.columns.column import Column

_OF_DAY = r"(?i)^(\d{1,2}):(\d{2})(?::(\d{2}(?:[.,]\d+)?))?\s*([ap]m)?\s*(Z|UTC|GMT|[+-]\d\d:?\d\d)?$"
_MIDNIGHT = r"[T ]0?0:00(:00(\.0+)?)?$"
"""Behind a date: what programs of tables write where they have no time."""
_DIGITS = r"^(\d{4})(\d\d)(\d\d)$"
_YEAR_FIRST = r"^(\d{4})[-/.](\d{1,2})[-/.](\d{1,2})$"
_YEAR_LAST = r"^(\d{1,2})[-/.](\d{1,2})[-/.](\d{4})$"
_NAMED_MONTH = r"(?i)^(\d{1,2})[- ]([a-z]{3})[a-z]*[- ,]+(\d{4})$"
_MONTHS = {
    name: f"{n:02d}" for n, name in enumerate(("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec"), 1)
}
_MONTHS_OF_YEAR = 12


def of_day(frame: pl.DataFrame) -> set[str]:
    """Columns whose fields are times of day and no dates, as far as something is written in these rows."""
    kinds = {name: dtype for name, dtype in frame.schema.items() if dtype in (pl.String, pl.Time)}
    written = {name: _texts(frame[name]).drop_nulls() for name in kinds}
    return {name for name, texts in written.items() if texts.len() and texts.str.contains(_OF_DAY).all()}


@dataclass(frozen=True)
class Orders:
    """What dates with day and month as numbers state of their order; of the whole column, however it is read.

    Attributes
    ----------
    day_first, month_first, either : str
        The first date that can be read with the day first alone, with the month first alone, and as two different days; empty where there
        is none.
    """

    day_first: str = ""
    month_first: str = ""
    either: str = ""

    @classmethod
    def of(cls, dates: pl.Series) -> Orders:
        """Of all rows, or of some."""
        texts = _days(dates)
        parts = texts.str.extract_groups(_YEAR_LAST)
        first, second = (parts.struct.field(str(k)).cast(pl.Int64) for k in (1, 2))
        high = [(each > _MONTHS_OF_YEAR).fill_null(value=False) for each in (first, second)]
        both = (first != second).fill_null(value=False) & ~high[0] & ~high[1]
        return cls(*(next(iter(texts.filter(at).head(1)), "") for at in (high[0] & ~high[1], high[1] & ~high[0], both)))

    @classmethod
    def together(cls, orders: Iterable[Orders]) -> Orders:
        """Of a column that came in pieces."""
        every = list(orders)
        names = ("day_first", "month_first", "either")
        return cls(*(next((text for each in every if (text := getattr(each, name))), "") for name in names))

    def order(self, date: Column, path: Path, notes: list[str]) -> str:
        """The order of the column: one of :data:`navbound.read.quantities.DATE_ORDERS`. What the rows decide is added to `notes`.

        Raises
        ------
        FormatError
            Dates that may be two different days, or rows of both orders.
        """
        if date.order:
            return date.order
        ways = " or ".join(f'--map "utc_date={date.name}:{order}"' for order in ("dmy", "mdy"))
        if self.day_first and self.month_first:
            words = f"“{self.day_first}” has the day first, and “{self.month_first}” the month; write the year first"
            raise FormatError(path, words, field=date.name)
        if self.either and not (self.day_first or self.month_first):
            words = f"“{self.either}” is one day with the day first and another one with the month first, and no row decides"
            raise FormatError(path, f"{words}; declare it: {ways} (in Python: columns)", field=date.name)
        if self.day_first or self.month_first:
            order, what, text = ("dmy", "day", self.day_first) if self.day_first else ("mdy", "month", self.month_first)
            notes.append(f"{path.name}: “{date.name}” has the {what} first in all rows, as “{text}” shows")
            return order
        return "ymd"


NO_ORDER = Orders()
"""Of no dates of numbers."""


def joined(dates: pl.Series, times: pl.Series, order: str) -> pl.Series:
    """``2024-05-13 12:30:01.5`` of both; null where one of them is none."""
    texts = _days(dates)
    year, month, day = (_group(texts, _YEAR_FIRST, k) for k in (1, 2, 3))
    first, second, last = (_group(texts, _YEAR_LAST, k) for k in (1, 2, 3))
    of_name = _group(texts, _NAMED_MONTH, 2).str.to_lowercase().replace_strict(_MONTHS, default=None, return_dtype=pl.String)
    same = pl.when(first.cast(pl.Int64) == second.cast(pl.Int64)).then(first)
    behind = {"dmy": (first, second), "mdy": (second, first), "ymd": (same, same)}[order]
    of_day_ = pl.coalesce(day, _group(texts, _NAMED_MONTH, 1), behind[0])
    of_month, of_year = pl.coalesce(month, of_name, behind[1]), pl.coalesce(year, _group(texts, _NAMED_MONTH, 3), last)
    clock = _texts(times)
    hour, minute, second_, half, zone = (_group(clock, _OF_DAY, k) for k in range(1, 6))
    afternoon = (half.str.to_lowercase() == "pm").fill_null(value=False)
    hours = hour.cast(pl.Int64)
    # 12 am is the begin of the day; 13 pm is no time.
    of_twelve = pl.when(hours.is_between(1, 12)).then(hours % 12 + pl.when(afternoon).then(12).otherwise(0))
    hours = pl.when(half.is_null()).then(hours).otherwise(of_twelve)
    seconds = second_.fill_null("00").str.replace(",", ".", literal=True)
    zones = pl.when(zone.str.contains(r"^[+-]")).then(zone).otherwise(pl.lit(""))
    whole = pl.concat_str(
        of_year, pl.lit("-"), of_month.str.zfill(2), pl.lit("-"), of_day_.str.zfill(2), pl.lit(" "),
        hours.cast(pl.String).str.zfill(2), pl.lit(":"), minute, pl.lit(":"), seconds, zones,
    )  # fmt: skip
    return pl.select(whole).to_series()


def as_written(dates: pl.Series, times: pl.Series) -> pl.Series:
    """Both fields as they stand in the file; null where one of them is empty."""
    return pl.select(pl.concat_str(pl.lit(_texts(dates)), pl.lit(_texts(times)), separator=" ")).to_series()


_OFFSET = r"^([+-]?)(\d{1,2})(?::?(\d{2}))?$"


def with_offset(times: pl.Series, offsets: pl.Series) -> pl.Series:
    """``12:30:01+02:00`` of a time of day and its offset; nothing where one of both is not written, and no time where an offset is none."""
    clock, offset = _texts(times), _texts(offsets)
    sign, hours, minutes = (_group(offset, _OFFSET, k) for k in (1, 2, 3))
    zone = pl.concat_str(
        pl.when(sign == "-").then(pl.lit("-")).otherwise(pl.lit("+")), hours.str.zfill(2), pl.lit(":"), minutes.fill_null("00")
    )
    return pl.select(pl.concat_str(pl.lit(clock), pl.coalesce(zone, pl.lit(offset)))).to_series()


def is_zoned(times: pl.Series) -> bool:
    """Whether some time of day states its zone."""
    return bool(_texts(times).str.contains(r"(?i)(Z|UTC|GMT|[+-]\d\d:?\d\d)$").any())


def _texts(column: pl.Series) -> pl.Series:
    """Without blanks at the ends; null where nothing is written."""
    texts = column.cast(pl.String).str.strip_chars()
    return texts.set((texts == "").fill_null(value=False), None)


def _days(column: pl.Series) -> pl.Series:
    return _texts(column).str.replace(_MIDNIGHT, "").str.replace(_DIGITS, "$1-$2-$3")


def _group(texts: pl.Series, pattern: str, k: int) -> pl.Expr:
    return pl.lit(texts).str.extract(pattern, k)
