"""Rows of a table to columns in SI with GPS time, all at once or in pieces of the file: the same numbers, counts and notes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import polars as pl

from navbound.errors import UNSEEN, FormatError
from navbound.read.beside.further import Further, Speeds
from navbound.read.beside.hemispheres import Hemispheres
from navbound.read.beside.no_speed import NoSpeeds
from navbound.read.beside.position_times import PositionTimes
from navbound.read.beside.speed_unit import SPEED, SpeedUnit
from navbound.read.beside.unstated_units import UnstatedUnits
from navbound.read.checks import levels, stated
from navbound.read.checks.places import NO_PLACE, Nowhere
from navbound.read.checks.rejections import COMPARED, LEVELS, OPTIONAL, REQUIRED, SPEEDS, Kind, Tally
from navbound.read.checks.repeats import expected, median_rows, usual_rows
from navbound.read.columns.assign import is_header
from navbound.read.columns.column import POSITION, Assignment, Column
from navbound.read.quantities import QUANTITY, UNITS
from navbound.read.statements.kinds import BY_OTHERS
from navbound.read.statements.lists import without_lists
from navbound.read.statements.rows import Stating
from navbound.read.tables.cells import (
    MISSING,
    in_hemisphere,
    lengths,
    no_field,
    numbers,
    of_true_north,
    on_ground,
    within_objects,
    words_of_ground,
)
from navbound.read.tables.names import Callsigns, one_writing
from navbound.read.tables.stated_units import is_row_of_units, of_no_length, require_same
from navbound.read.tables.table import LINE
from navbound.read.tables.times import TimeFacts, converted, shown, understand, units

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path


_BAD, _EXAMPLE = "__bad", "__example"
_RAW = "__raw "

SHOWN = 20
"""Rows that show whether a column holds words: as many as the shortest piece of a file has. Provenance: ours."""


def texts(frame: pl.DataFrame) -> tuple[set[str], set[str]]:
    """Columns of text of which something is written in the first rows, and nothing there is a number; and those in which nothing is."""
    head = frame.head(SHOWN).with_columns(pl.selectors.by_dtype(pl.Null).cast(pl.String))
    strings = [name for name, dtype in head.schema.items() if dtype == pl.String and name != LINE]
    written = {name: head[name].str.strip_chars().set(head[name].str.strip_chars().str.contains(MISSING), None) for name in strings}
    in_words = {name for name, each in written.items() if each.count() and lengths(each, 1.0).count() == 0}
    return in_words, {name for name, each in written.items() if not each.count()}


_WORDY = r"^[\s#\"(\[]*([A-Za-z°]|1e-7 deg|1?\s*$|-\s*$)"
"""A name, a unit, or nothing; never a measured value but the number 1."""

_ROWS_OF_WORDS = 100
"""Rows without a number that are looked at for another header. [1]"""


class Values:
    """Takes rows of one table; every piece is taken before the times are understood, and dated after.

    Attributes
    ----------
    tally : Tally
        What could not be used.
    notes : list of str
        Doubts; whole once the times are understood.
    position_doubts : list of str
        Columns whose numbers may be in another unit than they are read in, so that nothing can be shown until it is stated.
    whole_seconds : bool
        All times so far are whole seconds.
    """

    def __init__(self, path: Path, stem: str, mapping: Assignment, required: Sequence[str]) -> None:
        self.tally, self.notes, self.position_doubts = Tally(), list[str](), list[str]()
        self._path, self._stem, self._mapping, self._required = path, stem, mapping, required
        self._times = PositionTimes(path, mapping.unused, mapping.statements)
        self._no_speeds = NoSpeeds()
        self._further, self._speeds = Further(path, mapping, self._no_speeds), Speeds(mapping.absent)
        self._hemispheres = Hemispheres(path, mapping)
        self._nowhere, self.whole_seconds = Nowhere(), True
        self._callsigns = Callsigns()
        self._speed = SpeedUnit(mapping.speed) if mapping.speed else None
        self._facts = list[TimeFacts]()
        self._dtypes: dict[str, pl.DataType] = {}
        self._times_of: dict[int, int] = {}
        self._stating, self._units = Stating(mapping), UnstatedUnits(path, mapping)
        self._unit = ""
        self._n_ground: dict[str, int] = {}
        self._no_lengths = set[str]()
        self._altitude = self._units.altitude

    def take(self, frame: pl.DataFrame) -> pl.DataFrame:
        """Columns in SI of some rows, with their times as they are written and the reasons against them.

        Raises
        ------
        FormatError
            A column that holds neither numbers nor text.
        """
        frame = without_lists(frame, [name for name, kind in self._mapping.statements if kind is BY_OTHERS])
        self._check_kinds(frame)
        frame = self._without_names_and_units(frame)
        out, against, reasons = {LINE: frame[LINE]}, list[tuple[str, pl.Series]](), dict[str, pl.Series]()
        bad = pl.repeat(value=False, n=frame.height, eager=True)
        for place, (name, column) in enumerate(self._mapping.columns.items()):
            raw = frame[column.name]
            if QUANTITY[name].si == "text":
                out[name] = one_writing(name, raw.cast(pl.String).str.replace_all(UNSEEN, "").str.strip_chars())
                continue
            out[name], reason = self._numbers(frame, column)
            self._n_ground[column.name] = self._n_ground.get(column.name, 0) + int(on_ground(raw, column).sum())
            reasons[name] = reason
            if name in self._required:
                against.append((column.name, reason))
            else:
                bad |= self._count(OPTIONAL + place, frame, column.name, reason)
        # A row that is left out is malformed once.
        for _, reason in against:
            bad &= reason.is_null()
        self.tally.n_with_bad_values += int(bad.sum())
        part = pl.DataFrame([values.alias(name) for name, values in out.items()])
        part, without = levels.without_bound(part)
        for place, (name, at) in enumerate(without.items()):
            where, heading = frame.filter(at), self._mapping.columns[name].name
            # An outage written as zero is no damage of the file.
            self.tally.add(
                LEVELS + place, f"{heading}: {levels.REASON}", where.height, where[LINE][0], str(where[heading][0]), kind="quiet"
            )
        part = self._times.with_age(self._with_unread(self._callsigns.as_tracks(part), frame), frame)
        # A column of states may hold objects of them, too.
        may_hold = [name for name in (*self._mapping.unused, *(name for name, _ in self._mapping.statements)) if name in frame.columns]
        within = within_objects(frame.select(may_hold))
        self._hemispheres.see(part, frame, within)
        part = self._with_speed(
            self._further.see(part, frame, within, (self.tally, SPEEDS)).with_columns(*_reasons(frame, against), *self._raw(frame)), frame
        )
        self._units.see(part)
        if set(POSITION) <= set(self._required):
            self._nowhere.see(part)
        if tuple(self._required) == POSITION:
            part = stated.against_itself(part)
        else:
            part = stated.with_faulty_cells(stated.worse_than_level(part), reasons, without)
        return stated.with_statements(stated.of_satellites(self._stating.with_statuses(part)), self._stating.of(frame, within))

    def _numbers(self, frame: pl.DataFrame, column: Column) -> tuple[pl.Series, pl.Series]:
        """A column in SI, and why its values are none; a speed that is none is not stated, which is no fault of the row."""
        raw = frame[column.name]
        if column.quantity == "ground_speed_mps":
            raw = self._no_speeds.without(column.name, frame, raw, UNITS["mps"][column.unit], (self.tally, SPEEDS))
        values, reason = numbers(raw, column)
        if column.variation:
            return of_true_north(values, reason, frame[column.variation])
        return in_hemisphere(column, values, reason, frame[column.hemisphere]) if column.hemisphere else (values, reason)

    def _with_speed(self, part: pl.DataFrame, frame: pl.DataFrame) -> pl.DataFrame:
        """The numbers of a speed whose unit nobody states."""
        if self._speed is None or no_field(frame.schema[self._speed.name]):
            self._speed = None
            return part
        part = part.with_columns(self._speed.take(frame))
        self._speed.see(part)
        return part

    def _with_unread(self, part: pl.DataFrame, frame: pl.DataFrame) -> pl.DataFrame:
        """The largest number of the columns that nothing reads though they speak of an accuracy, or of a level; it bounds nothing."""
        for quantity, factors in (("unread_accuracy_m", self._mapping.accuracies), ("unread_level_m", self._mapping.levels)):
            known = {name: frame[name] for name in factors if name not in self._no_lengths and not no_field(frame.schema[name])}
            numbers_of = {name: lengths(raw, factors[name]) for name, raw in known.items()}
            self._count_uncompared(frame, numbers_of)
            values = [(each * factors[name]).alias(name) for name, each in numbers_of.items()]
            self._units.see_accuracies(numbers_of)
            if values:
                part = part.with_columns(pl.DataFrame(values).max_horizontal().alias(quantity))
        return part

    def _count_uncompared(self, frame: pl.DataFrame, compared: Mapping[str, pl.Series]) -> None:
        """Count the texts of columns that are compared as lengths; an empty field states nothing."""
        for name, values in compared.items():
            if frame.schema[name] != pl.String:
                continue
            written = frame[name].str.strip_chars()
            text = values.is_null() & ~written.str.contains(MISSING).fill_null(value=True)
            at = frame.filter(text)
            if not at.is_empty():
                place = COMPARED + self._mapping.unused.index(name)
                self.tally.add(place, f"{name}: not a number; not compared", at.height, at[LINE][0], str(at[name][0]), kind="quiet")

    def _without_names_and_units(self, frame: pl.DataFrame) -> pl.DataFrame:
        """Refuse a table in which the names of columns change on the way; the same header again is a row without numbers.

        A row of units is left out where they are those that the columns are read in, and refused where they are others.
        """
        texts = [c.name for c in (*self._mapping.columns.values(), *self._mapping.times) if frame.schema[c.name] == pl.String]
        if not texts:
            return frame
        wordy = pl.all_horizontal(pl.col(name).str.contains(_WORDY) | pl.col(name).is_null() for name in texts)
        units = list[int]()
        for row in frame.filter(wordy.fill_null(value=False)).head(_ROWS_OF_WORDS).iter_rows(named=True):
            line = row.pop(LINE)
            again = all(str(cell).strip() == name for name, cell in row.items() if cell is not None)
            if not again and is_header(list(row.values())):
                why = (
                    "another header in the middle of the table: the columns below it may be others, or in other units; split the file there"
                )
                raise FormatError(self._path, why, line)
            if is_row_of_units(row, self._mapping):
                require_same(row, self._mapping, self._path, line)
                self._no_lengths |= of_no_length(row, self._mapping)
                self.notes.append(f"{self._path.name}: line {line} holds the units of the columns, which are those that they are read in")
                units.append(line)
        return frame.filter(~pl.col(LINE).is_in(units)) if units else frame

    def _check_kinds(self, frame: pl.DataFrame) -> None:
        names = [column.name for column in (*self._mapping.columns.values(), *self._mapping.times)]
        for name in (*names, *(name for name, _ in self._mapping.statements)):
            if no_field(frame.schema[name]):
                raise FormatError(self._path, f"holds {frame.schema[name]}, where a number or a text is needed", field=name)

    def _count(self, place: int, frame: pl.DataFrame, name: str, reason: pl.Series) -> pl.Series:
        """Count the values of an optional column that could not be used; the rows stay, an empty field is no fault."""
        bad = (reason != "empty").fill_null(value=False)
        for text in reason.filter(bad).unique(maintain_order=True):
            at = frame.filter((reason == text).fill_null(value=False))
            self.tally.add(place, f"{name}: {text}; row used without it", at.height, at[LINE][0], str(at[name][0]), kind="value")
        return bad

    def _raw(self, frame: pl.DataFrame) -> list[pl.Series]:
        self._facts.append(TimeFacts.of(frame, self._mapping.times))
        columns = {column.name: frame[column.name] for column in self._mapping.times}
        columns |= self._times.written(frame) | self._further.times(frame)
        self._dtypes |= {name: values.dtype for name, values in columns.items()}
        return [values.alias(_RAW + name) for name, values in columns.items()]

    @property
    def unread(self) -> list[str]:
        """Columns, or words of columns, that speak of integrity by their name and are not understood."""
        return self._stating.unread

    def understand(self) -> None:
        """Decide in which unit the times are written, now that every row was taken.

        Raises
        ------
        FormatError
            Numbers that are no times.
        """
        name = self._path.name
        self.notes += [f"{name}: {words}" for words in self._stating.statuses()]
        self.notes += self._callsigns.words(name)
        self.notes += [f"{name}: {words_of_ground(column, n)}" for column, n in self._n_ground.items() if n]
        self._units.radians()
        self.notes += self._units.notes
        self._unit = self._understood(self._mapping.times, self._facts)
        self._understand_altitude()
        n_notes = len(self._units.notes)
        self._units.others()
        self.notes += self._units.notes[n_notes:]
        self.position_doubts += self._units.doubts
        self.position_doubts += [*self._further.doubts(), *self._hemispheres.doubts()]
        self.notes += self._further.notes()
        self.position_doubts += self._times.understand(self._dtypes, self.notes)
        self._further.understand(self._dtypes)
        self._understand_speed()
        decided = "" if self._speed is None or not self._speed.unit else self._speed.name
        unused = [each for each in self._mapping.unused if each != decided]
        if tuple(self._required) == POSITION and unused:
            self.notes.append(f"{name}: columns not used: {_few(unused)}")
        # The numbers of all rows are needed no more.
        self._facts = []

    def _understand_altitude(self) -> None:
        if self._altitude is None or (head := self._altitude.head()).is_empty():
            return
        time, _ = converted(_written(head), self._mapping.times, self._unit)
        self._altitude.understand(head.with_columns(time.alias("time_ns"), self._track(head)))

    def _understand_speed(self) -> None:
        if self._speed is None:
            return
        if (head := self._speed.head()).is_empty():
            self._speed.settle()
        else:
            time, _ = converted(_written(head), self._mapping.times, self._unit)
            self._speed.understand(head.with_columns(time.alias("time_ns"), self._track(head)))
        notes, doubts = self._speed.words(self._path)
        self.notes += notes
        self.position_doubts += doubts

    def _understood(self, columns: list[Column], facts: list[TimeFacts]) -> str:
        return understand(TimeFacts.together(facts), columns, self._dtypes[columns[0].name], self._path, self.notes)

    @staticmethod
    def keys(part: pl.DataFrame) -> pl.DataFrame:
        """What :meth:`when` needs of a part."""
        return part.select(name for name in part.columns if name == "track" or name.startswith(_RAW))

    def when(self, part: pl.DataFrame) -> pl.DataFrame:
        """Track and time of rows that have one; nothing is counted."""
        time, _ = converted(_written(part), self._mapping.times, self._unit)
        return part.select(self._track(part), time.alias("time_ns")).drop_nulls("time_ns")

    def _track(self, part: pl.DataFrame) -> pl.Expr:
        return (pl.col("track").fill_null(self._stem) if "track" in part.columns else pl.lit(self._stem)).alias("track")

    def timed(self, part: pl.DataFrame) -> tuple[pl.DataFrame, pl.DataFrame]:
        """Rows with GPS time and track that may be epochs; and those that may not, which are counted, as :func:`expected` has them."""
        raw = _written(part)
        time, reason = converted(raw, self._mapping.times, self._unit)
        name, written = shown(raw, self._mapping.times)
        part = self._without_nowhere(part)
        timeless = raw.select(pl.when(reason.is_not_null()).then(pl.concat_str(pl.lit(f"{name}: "), reason))).to_series()
        out = part.with_columns(
            time.alias("time_ns"),
            pl.coalesce(_BAD, timeless).alias(_BAD),
            pl.when(pl.col(_BAD).is_null()).then(_text(written, timeless.is_not_null())).otherwise(pl.col(_EXAMPLE)).alias(_EXAMPLE),
        )
        self.position_doubts += self._further.against(out["time_ns"], raw)
        if self._altitude is not None and "altitude_m" in out.columns:
            out = self._altitude.made(out)
        out = self._times.dated(out, raw, self.tally).drop(pl.selectors.starts_with(_RAW))
        if self._speed is not None:
            if self._speed.unit:
                factor = UNITS["mps"][self._speed.unit]
                out = out.with_columns(self._no_speeds.without(self._speed.name, out, out[SPEED], factor, (self.tally, SPEEDS)))
            out = self._speed.made(out)
        out = self._speeds.whole(out.with_columns(self._track(out)), left_out=pl.col(_BAD).is_not_null())
        self.whole_seconds &= bool((out["time_ns"].drop_nulls() % 1_000_000_000 == 0).all())
        without = out.filter(pl.col(_BAD).is_not_null())
        for (reason_text,), group in without.group_by(_BAD, maintain_order=True):
            kind: Kind = "quiet" if str(reason_text).endswith(": empty") or reason_text == NO_PLACE else "row"
            self.tally.add(REQUIRED, str(reason_text), group.height, group[LINE][0], str(group[_EXAMPLE][0]), kind=kind)
        empty = pl.col(_BAD).is_in([f"{self._mapping.columns[each].name}: empty" for each in POSITION if each in self._required])
        rows = out.filter(pl.col(_BAD).is_null()).drop(_BAD, _EXAMPLE)
        for n, times in usual_rows(rows).items():
            self._times_of[n] = self._times_of.get(n, 0) + times
        return rows, expected(without, empty=empty, besides=(_BAD, _EXAMPLE, LINE))

    @property
    def usual_rows(self) -> int:
        """How many rows of a time are usual in the table, after the last rows."""
        return median_rows(self._times_of)

    def _without_nowhere(self, part: pl.DataFrame) -> pl.DataFrame:
        """A place that a receiver writes that has none speaks against its row; a receiver without a position is no damage of the file."""
        if not set(POSITION) <= set(self._required):
            return part
        nowhere = self._nowhere.at(part) & part[_BAD].is_null()
        return part.with_columns(
            pl.when(nowhere).then(pl.lit(NO_PLACE)).otherwise(pl.col(_BAD)).alias(_BAD),
            pl.when(nowhere).then(pl.lit("0, 0")).otherwise(pl.col(_EXAMPLE)).alias(_EXAMPLE),
        )

    def doubts(self) -> list[str]:
        """Why nothing can be shown of the positions, after the last rows."""
        self.position_doubts += [each for each in self._no_speeds.doubts(self._path) if each not in self.position_doubts]
        return [*self.position_doubts, *self._times.doubts()]

    def described(self) -> dict[str, str]:
        """Quantity to the column that it was read from and its unit."""
        columns = {c.quantity: f"{c.name}:{c.unit}" for c in self._mapping.columns.values()}
        if self._altitude is not None and self._altitude.words:
            columns["altitude_m"] = f"{self._mapping.columns['altitude_m'].name}:m"
        if self._speed is not None and self._speed.unit:
            columns["ground_speed_mps"] = f"{self._speed.name}:{self._speed.unit}"
        return columns | {"time": ", ".join(units(self._mapping.times, self._unit))}


def _reasons(frame: pl.DataFrame, against: list[tuple[str, pl.Series]]) -> list[pl.Series]:
    """The first reason against each row, and the text at fault; null where there is none."""
    bad = example = pl.repeat(None, frame.height, dtype=pl.String, eager=True)
    for name, reason in against:
        first = reason.is_not_null() & bad.is_null()
        both = pl.select(
            pl.when(first).then(pl.concat_str(pl.lit(f"{name}: "), reason)).otherwise(bad).alias(_BAD),
            pl.when(first).then(_text(frame[name], first)).otherwise(example).alias(_EXAMPLE),
        )
        bad, example = both[_BAD], both[_EXAMPLE]
    return [bad.alias(_BAD), example.alias(_EXAMPLE)]


def _written(part: pl.DataFrame) -> pl.DataFrame:
    """Columns of times as they stand in the file."""
    names = [name for name in part.columns if name.startswith(_RAW)]
    return part.select(pl.col(name).alias(name.removeprefix(_RAW)) for name in names)


def _text(raw: pl.Series, where: pl.Series) -> pl.Series:
    """What stands in some rows of a column."""
    if raw.dtype == pl.String:
        return raw
    text = pl.repeat(None, len(raw), dtype=pl.String, eager=True)
    return text.scatter(where.arg_true(), [str(value) for value in raw.filter(where)])


_NAMED = 100
"""Columns that a note names. [1]"""


def _few(names: list[str]) -> str:
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return f"{', '.join(names[:_NAMED])}{more}"
