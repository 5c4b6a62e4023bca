"""A text table or a Parquet file of any size to pieces of the epoch table. The largest thing in memory is its column of times."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import polars as pl

from navbound.errors import FormatError
from navbound.read.checks.rejections import Rejections, Tally
from navbound.read.checks.repeats import left_out, shared_words, unread_rows, without_shared
from navbound.read.columns.assign import assign
from navbound.read.columns.column import POSITION
from navbound.read.columns.lacking import truth_as_position
from navbound.read.pieces.chunks import CHUNK_BYTES, Chunks
from navbound.read.pieces.order import Pieces
from navbound.read.pieces.parquet import batches, is_parquet
from navbound.read.source import Source, digested
from navbound.read.tables.dates import of_day
from navbound.read.tables.order import Late, one_row_a_time
from navbound.read.tables.stated_units import HEAD_BYTES, require_same_in_remarks
from navbound.read.tables.table import LINE, Layout, layout_of, rows_of
from navbound.read.tables.values import SHOWN, Values, texts
from navbound.storage.frames import Spool

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from navbound.read.columns.column import Assignment
    from navbound.records.run import InputFile, Rejection

PIECE_ROWS = 1 << 17
"""Rows that are worked on at a time."""
_SAMPLES = 128
"""Rows of the sample for each piece: pieces differ in size by a tenth or so. Provenance: ours."""


@dataclass
class PiecedReading:
    """One file read in pieces, with the attributes of :class:`navbound.read.Reading`.

    Of these `left_out` and `rejected` are whole after :meth:`epochs`.

    Attributes
    ----------
    names : list of str
        Tracks, in order.
    with_levels : set of str
        Tracks with a protection level anywhere.
    unread : list of str
        Columns, or words of columns, that speak of integrity by their name and are not understood.
    position_doubts : list of str
        Columns whose numbers may be in another unit than they are read in.
    whole_seconds : bool
        Two fixes of one second may share a stamp.
    usual_rows : int
        How many rows of a time are usual.
    without : DataFrame
        Rows without an epoch, of which some may share the instant of one.
    """

    source: InputFile
    unused: list[str]
    notes: list[str]
    columns: dict[str, str]
    left_out: pl.DataFrame
    names: list[str]
    with_levels: set[str]
    pieces: Pieces
    rejections: Rejections
    n_rows: int
    unread: list[str]
    position_doubts: list[str]
    whole_seconds: bool
    usual_rows: int
    without: pl.DataFrame

    @property
    def rejected(self) -> list[Rejection]:
        """What was left out."""
        return self.rejections.records

    def epochs(self) -> Iterator[pl.DataFrame]:
        """One row a time, in the order of track and time; repeated rows are counted when the last piece was taken, so once.

        Raises
        ------
        FormatError
            More malformed rows than may be.
        """
        tally, unjudged, n_shared = Tally(), list[pl.DataFrame](), 0
        for piece in self.pieces:
            separated = one_row_a_time(piece, tally, whole_seconds=self.whole_seconds, usual=self.usual_rows)
            unjudged.append(left_out(separated.unjudged))
            self.without, n = without_shared(self.without, separated.epochs)
            n_shared += n
            yield separated.epochs.drop(LINE)
        tally.into(self.rejections)
        self.rejections.refuse_if_too_many(self.n_rows)
        self.notes += shared_words(Path(self.source.path).name, n_shared)
        self.left_out = pl.concat([self.left_out, left_out(self.without), *unjudged])

    def spread(self) -> Iterator[pl.DataFrame]:
        """Parts of each track that stands in several pieces, in order, as far as its first part with a reported speed."""
        spans = self.pieces.spread()
        for index in sorted({k for low, high in spans.values() for k in range(low, high + 1)}):
            names = [track for track, (low, high) in spans.items() if low <= index <= high]
            rows = self.pieces.piece(index) if names else pl.DataFrame()
            rows = rows if rows.is_empty() else rows.filter(pl.col("track").is_in(names))
            single = (
                rows if rows.is_empty() else one_row_a_time(rows, Tally(), whole_seconds=self.whole_seconds, usual=self.usual_rows).epochs
            )
            for part in [] if single.is_empty() else single.partition_by("track", maintain_order=True):
                yield part
                if "ground_speed_mps" in part.columns and part["ground_speed_mps"].is_not_null().any():
                    del spans[part["track"][0]]


@dataclass(frozen=True)
class Beside:
    """That a recording lies beside another: what is declared of the other's columns counts for those that it has too."""

    columns: Mapping[str, str]


def read_pieces(
    path: str | Path, *, columns: Mapping[str, str] | None = None, piece_rows: int = PIECE_ROWS, beside: Beside | None = None
) -> PiecedReading:
    """Read a recorded track from a text table or a Parquet file of any size.

    Parameters
    ----------
    path : str or Path
        The file.
    columns : mapping of str to str, optional
        As :func:`navbound.read.read`.
    piece_rows : int
        About how many rows are worked on at a time.
    beside : Beside, optional
        As :func:`navbound.read.tables.epochs.read_beside`.

    Raises
    ------
    FormatError, InputError
        As :func:`navbound.read.read`.
    """
    path, stride = Path(path), max(1, piece_rows // _SAMPLES)
    first: _FirstPass = _OfParquet(path, columns, stride) if is_parquet(path) else _OfText(path, columns, stride)
    first.beside = beside
    first.read()
    return _second_pass(first, max(1, piece_rows // first.stride))


class _FirstPass:
    """Rows in SI, with their times as they are written."""

    unit = "line"

    def __init__(self, path: Path, columns: Mapping[str, str] | None, stride: int) -> None:
        self.path, self.stride, self.n_rows, self.n_unread = path, stride, 0, 0
        self.parts, self.places = Spool(), list[tuple[int, int]]()
        self.sample, self.names = list[pl.DataFrame](), set[str | None]()
        self.rejections = Rejections(path, self.unit)
        self._columns = columns
        self.beside: Beside | None = None

    @property
    def source(self) -> Source:
        """The file without its content; digest and size are those of what was read."""
        raise NotImplementedError

    def read(self) -> None:
        """Every row of the file."""
        raise NotImplementedError

    def named(self, names: list[str], frame: pl.DataFrame) -> None:
        """What the columns of the first rows are."""
        columns, where_present = self._columns, dict[str, str]()
        if self.beside is not None:
            # A file of the truth may call its positions so.
            columns, where_present = truth_as_position(names) | dict(columns or {}), dict(self.beside.columns)
        in_words, blank = texts(frame)
        self.mapping: Assignment = assign(
            names, columns, self.path, texts=in_words, blank=blank, of_day=of_day(frame.head(SHOWN)), where_present=where_present
        )
        self.values = Values(self.path, self.source.stem, self.mapping, list(POSITION))

    def keep(self, frame: pl.DataFrame) -> None:
        """The next rows."""
        if frame.is_empty():
            return
        part = self.values.take(frame)
        self.places.append(self.parts.put(part))
        self.sample.append(self.values.keys(part.gather_every(self.stride)))
        self.names |= set(part["track"].unique()) if "track" in part.columns else {None}

    def checked(self) -> None:
        """Refuse a file without rows, or with too many that are none."""
        if self.n_rows == 0:
            raise FormatError(self.path, "no rows below the header")
        self.rejections.refuse_if_too_many(self.n_rows)


class _OfText(_FirstPass):
    """Lines of a text table."""

    def __init__(self, path: Path, columns: Mapping[str, str] | None, stride: int) -> None:
        super().__init__(path, columns, stride)
        # Short chunks for short pieces, so that what depends on a chunk is seen to depend on nothing.
        self._chunks = Chunks(path, min(CHUNK_BYTES, 64 * _SAMPLES * stride))
        self._layout: Layout | None = None
        self._bad: tuple[str, int, int, str] | None = None
        self._remarks: tuple[str, int, int, str] | None = None

    @property
    def source(self) -> Source:
        return self._chunks.source

    def read(self) -> None:
        for lines in self._chunks:
            self._take(lines)

    def _take(self, lines: pl.DataFrame) -> None:
        if lines.is_empty():
            return
        if self._layout is None:
            rows_begin = ~lines["text"].str.starts_with("#")
            if not rows_begin.any():
                return
            lines = lines[int(rows_begin.arg_max() or 0) :]
            self._layout = layout_of(self.path, lines, (self._columns or {}).values())
            self.named(self._layout.columns, rows_of(self.path, self._layout, lines[1:]).frame)
            with self.path.open("rb") as file:
                require_same_in_remarks(file.read(HEAD_BYTES).decode("utf-8", "replace"), self.mapping, self.path)
            lines = lines[1:]
        rows = rows_of(self.path, self._layout, lines)
        self.n_rows += rows.n_rows
        if rows.bad is not None:
            self.n_unread += rows.bad[1]
            self._bad = _together(self._bad, rows.bad)
        if rows.remarks is not None:
            self._remarks = _together(self._remarks, rows.remarks)
        self.keep(rows.frame)

    def checked(self) -> None:
        if self._layout is None:
            raise FormatError(self.path, "nothing but comments")
        if self.n_rows and self._bad is not None:
            self.rejections.add(*self._bad)
        if self.n_rows and self._remarks is not None:
            self.rejections.add(*self._remarks, malformed=False)
        super().checked()


def _together(before: tuple[str, int, int, str] | None, more: tuple[str, int, int, str]) -> tuple[str, int, int, str]:
    reason, count, line, text = before or (more[0], 0, *more[2:])
    return reason, count + more[1], line, text


class _OfParquet(_FirstPass):
    """Batches of a Parquet file."""

    unit = "record"

    def __init__(self, path: Path, columns: Mapping[str, str] | None, stride: int) -> None:
        super().__init__(path, columns, stride)
        self._source = Source(path, b"", "", 0)

    @property
    def source(self) -> Source:
        return self._source

    def read(self) -> None:
        # Batches of few rows for short pieces, as the chunks of a text.
        for batch in batches(self.path, min(PIECE_ROWS, _SAMPLES * self.stride)):
            if self.n_rows == 0:
                self.named(batch.columns, batch)
            counted = batch.with_columns(pl.int_range(self.n_rows + 1, self.n_rows + batch.height + 1).alias(LINE))
            self.n_rows += batch.height
            self.keep(counted)
        self._source = digested(self.path)


def _second_pass(first: _FirstPass, every: int) -> PiecedReading:
    """Rows with their times, distributed to pieces."""
    first.checked()
    values, source = first.values, first.source
    values.understand()
    names = sorted({source.stem if name is None else name for name in first.names})
    pieces = Pieces(names, values.when(pl.concat(first.sample)), every)
    late, without = Late(), list[pl.DataFrame]()
    with_levels, n = set[str](), 0
    for place in first.places:
        out, lost = values.timed(first.parts.get(place))
        without.append(lost)
        late.see(out)
        if out.is_empty():
            continue
        pieces.put(out)
        n += out.height
        with_levels |= _with(out, "hpl_m")
    first.parts.close()
    values.tally.into(first.rejections)
    values.notes.extend(late.words(source.path, first.unit))
    if n == 0:
        first.rejections.refuse_if_too_many(first.n_rows)
        raise FormatError(source.path, first.rejections.without_position())
    return PiecedReading(
        source=source.record(first.n_rows),
        unused=first.mapping.unused,
        notes=values.notes,
        columns=values.described(),
        left_out=unread_rows(source.stem, first.n_unread),
        names=[name for name in names if pieces.has(name)],
        with_levels=with_levels,
        pieces=pieces,
        rejections=first.rejections,
        n_rows=first.n_rows,
        unread=values.unread,
        position_doubts=values.doubts(),
        whole_seconds=values.whole_seconds and first.beside is None,
        usual_rows=values.usual_rows,
        without=pl.concat(without),
    )


def _with(rows: pl.DataFrame, name: str) -> set[str]:
    """Tracks with a value in a column."""
    return set(rows.filter(pl.col(name).is_not_null())["track"].unique()) if name in rows.columns else set()
