"""A table to the epoch table: strict numbers in SI, GPS time, and a count of what did not fit."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import polars as pl

from navbound import _core
from navbound.errors import FormatError
from navbound.read.checks import levels
from navbound.read.checks.places import NO_PLACE, Nowhere
from navbound.read.checks.rejections import Rejections, Tally
from navbound.read.checks.repeats import left_out, shared_words, unread_rows, without_shared
from navbound.read.checks.stated import of_counted_satellites
from navbound.read.columns.assign import assign
from navbound.read.columns.column import POSITION, Assignment
from navbound.read.columns.lacking import truth_as_position
from navbound.read.source import Source, load
from navbound.read.tables.dates import of_day
from navbound.read.tables.load import table
from navbound.read.tables.order import Late, one_row_a_time
from navbound.read.tables.stated_units import require_same_in_remarks
from navbound.read.tables.table import LINE, Table
from navbound.read.tables.values import SHOWN, Values, texts
from navbound.records.material import LEFT_OUT
from navbound.table.columns import COVARIANCE
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from navbound.read import receivers
    from navbound.records.run import InputFile, Rejection


@dataclass(frozen=True)
class Reading:
    """One file read.

    Attributes
    ----------
    epochs : DataFrame
        Columns of docs/notation.md that the file holds: at least ``track``, ``time_ns``, ``est_lat_rad``, ``est_lon_rad``.
    source : InputFile
        Digest and size.
    rejected : list of Rejection
        What was left out.
    unused : list of str
        Columns of the file that were not understood.
    notes : list of str
        Doubts that a person should settle: a missing time zone, rows out of order, degrees that may be radians.
    columns : dict
        Quantity to the column it was read from and its unit.
    left_out : DataFrame
        ``track`` and ``time_ns`` of rows that were expected to hold a position and cannot be judged: without a position or a time, with a
        refused value in one of them, or with another position, bound or status at the time of another row. A null time is not known.
    position_doubts : list of str
        Columns whose numbers may be in another unit than they are read in.
    place_doubts : list of str
        Why the positions may be elsewhere; a truth decides.
    unread : list of str
        Columns, or words of columns, that speak of integrity by their name and are not understood.
    satellites : DataFrame, optional
        What became of every satellite heard, where the positions were solved.
    """

    epochs: pl.DataFrame
    source: InputFile
    rejected: list[Rejection]
    unused: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    columns: dict[str, str] = field(default_factory=dict)
    left_out: pl.DataFrame = field(default_factory=lambda: pl.DataFrame(schema=LEFT_OUT))
    unread: list[str] = field(default_factory=list)
    position_doubts: list[str] = field(default_factory=list)
    place_doubts: list[str] = field(default_factory=list)
    satellites: pl.DataFrame | None = None


def read(path: str | Path, *, columns: Mapping[str, str] | None = None, needs: Sequence[str] = POSITION) -> Reading:
    """Read a recorded track: CSV, JSON, Parquet, an RTKLIB solution file, or the log of a receiver.

    Each may be packed by gzip, compress (``.Z``) or zip. Logs are those of u-blox, Septentrio, NovAtel and NMEA 0183.

    Parameters
    ----------
    path : str or Path
        The file.
    columns : mapping of str to str, optional
        What a column is, where its name does not say: ``{"est_lat_rad": "breite:deg", "time": "zeit:utc_ms"}``.
    needs : sequence of str
        Columns of docs/notation.md without which a table is refused. Without a position among them it is a table of protection levels,
        whose rows need a time alone.

    Raises
    ------
    FormatError
        A file that cannot be interpreted, or of whose rows more than a tenth is malformed.
    InputError
        A declared column that names no known quantity or unit.
    """
    return _read(load(path), columns, needs, {})


def read_beside(path: str | Path, columns: Mapping[str, str], where_present: Mapping[str, str]) -> Reading:
    """Read a recording beside another: what is declared of the other's columns counts for those that it has too.

    Raises
    ------
    FormatError, InputError
        As :func:`read`.
    """
    return _read(load(path), columns, POSITION, where_present, beside=True)


def _read(
    source: Source, columns: Mapping[str, str] | None, needs: Sequence[str], where_present: Mapping[str, str], *, beside: bool = False
) -> Reading:
    of = source.format
    if of.id == "rtklib" or of.read is not None:
        reading = _rtklib(source) if of.read is None else _log(source, of.read(source))
        if columns:
            reading.notes.append(f"Columns named by the caller change nothing in {source.path.name}, whose format names its own.")
        return reading
    content = table(source, (columns or {}).values())
    if beside:
        # A file of the truth may call its positions so.
        columns = truth_as_position(content.columns) | dict(columns or {})
    in_words, blank = texts(content.frame)
    mapping = assign(
        content.columns,
        columns,
        source.path,
        needs=needs,
        texts=in_words,
        blank=blank,
        of_day=of_day(content.frame.head(SHOWN)),
        where_present=where_present,
    )
    if source.kind == "csv":
        require_same_in_remarks(source.text(), mapping, source.path)
    return _epochs(source, content, mapping, [name for name in POSITION if name in needs], beside=beside)


def _epochs(source: Source, content: Table, mapping: Assignment, required: Sequence[str], *, beside: bool) -> Reading:
    rejections, values = content.rejections, Values(source.path, source.stem, mapping, required)
    part = values.take(content.frame)
    values.understand()
    out, without = values.timed(part)
    values.tally.into(rejections)
    # A truth is of its stamp.
    seconds = values.whole_seconds and not beside
    out, unjudged = _in_order(out, rejections, values.notes, whole_seconds=seconds, usual=values.usual_rows)
    without, n_shared = without_shared(without, out)
    values.notes.extend(shared_words(source.path.name, n_shared))
    rejections.refuse_if_too_many(content.n_rows)
    _not_empty(source, out, rejections)
    lost = pl.concat([left_out(without), unread_rows(source.stem, content.n_rows - content.frame.height), left_out(unjudged)])
    of_file = (source.record(content.n_rows), rejections.records, mapping.unused, values.notes, values.described(), lost)
    return Reading(out.drop(LINE), *of_file, unread=values.unread, position_doubts=values.doubts())


_STATES_SATELLITES = re.compile(r"^%.*\bns\b", re.MULTILINE)


def _rtklib(source: Source) -> Reading:
    text = source.text()
    d = _core.read_rtklib(text, str(source.path))
    rejections, notes = Rejections(source.path), list[str]()
    refused = pl.DataFrame(d["refused"], schema=["line", "field", "reason", "text"], orient="row")
    for (name, reason), group in refused.group_by("field", "reason", maintain_order=True):
        rejections.add(f"{name}: {reason}", group.height, group["line"][0], group["text"][0])
    cov = d["cov_m2"]
    plain = {k: d[k] for k in ("time_ns", "est_lat_rad", "est_lon_rad", "est_h_m", "ground_speed_mps", "n_sv", "hpl_m", "vpl_m")}
    out = pl.DataFrame({LINE: d["line"]} | plain | {name: cov[:, i] for i, name in enumerate(COVARIANCE)})
    out = out.with_columns(pl.lit(source.stem).alias("track"), pl.selectors.float().fill_nan(None))
    measured = pl.Series(d["quality"]).is_in(_core.RTKLIB_QUALITIES) | (not d["states_quality"])
    unmeasured, out = out.filter(~measured), out.filter(measured)
    if unmeasured.height:
        example = f"quality {d['quality'][measured.arg_min()]}"
        rejections.add("Q: not a measured position", unmeasured.height, unmeasured[LINE][0], example, malformed=False)
    nowhere = Nowhere()
    nowhere.see(out)
    without_place, out = out.filter(nowhere.at(out)), out.filter(~nowhere.at(out))
    if without_place.height:
        rejections.add(NO_PLACE, without_place.height, without_place[LINE][0], "0, 0", malformed=False)
    # Without the field the reader has 0.
    out = of_counted_satellites(out)[0] if _STATES_SATELLITES.search(text) else out.drop("n_sv")
    out, unjudged = _in_order(out, rejections, notes)
    rejections.refuse_if_too_many(d["n_rows"])
    _not_empty(source, out, rejections)
    empty = [c for c in out.columns if out[c].is_null().all()]
    # A selection of constants alone has one row of them even where no row was refused.
    without = refused.with_columns(track=pl.lit(source.stem), time_ns=pl.lit(None, pl.Int64)).select("track", "time_ns")
    lost = _left_out(without, unmeasured, without_place, unjudged)
    return Reading(out.drop(LINE, *empty), source.record(d["n_rows"]), rejections.records, notes=notes, left_out=lost)


def _log(source: Source, log: receivers.Log) -> Reading:
    rejections = Rejections(source.path, "record")
    for reason, damaged, count, first, example in log.left_out:
        rejections.add(reason, count, first, example, malformed=damaged)
    rejections.refuse_if_too_many(log.n_rows)
    _not_empty(source, log.epochs, rejections)
    out = log.epochs.rename({"record": LINE}).with_columns(pl.lit(source.stem).alias("track"), pl.selectors.float().fill_nan(None))
    # Of GGA: the count of other messages is part of their fix.
    out, n_few = of_counted_satellites(out, out["few"]) if source.format.id == "nmea" else (out, 0)
    # A format of your own has none.
    out = out.drop("few", strict=False)
    if n_few:
        log.notes.append(
            f"{source.path.name}: {counted(n_few, 'position counts', 'positions count')} fewer satellites than determine one; "
            f"{agreeing(n_few, 'it is', 'they are')} not ok."
        )
    out, unjudged = _in_order(out, rejections, log.notes)
    empty = [c for c in out.columns if out[c].is_null().all()]
    # The receiver lived and had no position: a row of a table without one counts in the same way.
    absent = pl.DataFrame({"track": [source.stem] * len(log.absent_ns), "time_ns": pl.Series(log.absent_ns, dtype=pl.Int64)})
    lost = _left_out(absent, unjudged)
    # Places of its own that nothing reads are named.
    unread = [name for name, sign in _PLACES_UNREAD.items() if source.format.id == "nmea" and sign in source.content]
    of_file = (source.record(log.n_rows), rejections.records)
    return Reading(out.drop(LINE, *empty), *of_file, notes=log.notes, columns=log.columns, left_out=lost, unread=unread)


_PLACES_UNREAD = {
    "PTNL,GGK (a position of Trimble)": b"$PTNL,GGK,",
    "PASHR,POS (a position of Ashtech)": b"$PASHR,POS,",
    "!AIVDO (the ship's own position)": b"!AIVDO,",
}
"""Sentences with a place that nothing compares, by what begins them."""


def _left_out(*rows: pl.DataFrame) -> pl.DataFrame:
    return pl.concat([left_out(each) for each in rows])


def _not_empty(source: Source, out: pl.DataFrame, rejections: Rejections) -> None:
    if out.is_empty():
        raise FormatError(source.path, rejections.without_position())


def _in_order(
    out: pl.DataFrame, rejections: Rejections, notes: list[str], *, whole_seconds: bool = False, usual: int = 1
) -> tuple[pl.DataFrame, pl.DataFrame]:
    """One row an instant, in the order of time; repeated ones are left out and counted. Second: those that cannot be judged."""
    # Those of a table are null already.
    out, without = levels.without_bound(out)
    for name, at in without.items():
        where = out.filter(at)
        rejections.add(f"{name}: {levels.REASON}", where.height, where[LINE][0], "0 or less", malformed=False)
    late, tally = Late(), Tally()
    late.see(out)
    notes += late.words(rejections.path, rejections.unit)
    separated = one_row_a_time(out, tally, whole_seconds=whole_seconds, usual=usual)
    tally.into(rejections)
    return separated.epochs, separated.unjudged
