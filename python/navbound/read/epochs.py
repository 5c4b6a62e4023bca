"""A table to the epoch table: strict numbers in SI, GPS time, and a count of what did not fit."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import _core, status
from navbound.errors import UNSEEN, FormatError
from navbound.read import receivers
from navbound.read.columns import LEVEL_QUANTITIES, POSITION, POSITION_TIME, QUANTITIES, UNITS, Assignment, Column, assign, position_time
from navbound.read.rejections import Rejections
from navbound.read.repeats import LEFT_OUT, left_out, separate
from navbound.read.source import Source, load
from navbound.read.table import LINE, Table, table
from navbound.read.times import gps_time

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from navbound.run.records import InputFile, Rejection

_QUANTITY = {q.name: q for q in QUANTITIES + LEVEL_QUANTITIES}
_BAD = "__bad"
_MISSING = r"(?i)^([+-]?nan(\(\w*\))?)?$"


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
    """

    epochs: pl.DataFrame
    source: InputFile
    rejected: list[Rejection]
    unused: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    columns: dict[str, str] = field(default_factory=dict)
    left_out: pl.DataFrame = field(default_factory=lambda: pl.DataFrame(schema=LEFT_OUT))


def read(path: str | Path, *, columns: Mapping[str, str] | None = None, needs: Sequence[str] = POSITION) -> Reading:
    """Read a recorded track: CSV, JSON, Parquet, an RTKLIB solution file, or the log of a receiver.

    Each may be packed by gzip, compress (``.Z``) or zip. Logs are those of u-blox, Septentrio, NovAtel and NMEA 0183; they need the
    extra ``receivers``.

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
        A declared column that names no known quantity or unit; a log whose decoder is not installed.
    """
    source = load(path)
    if source.kind == "rtklib":
        return _rtklib(source)
    if source.kind in {"ubx", "sbf", "novatel", "nmea"}:
        return _log(source, source.kind)
    found = table(source)
    mapping = assign(found.columns, columns, source.path, needs=needs)
    return _epochs(source, found, mapping, [name for name in POSITION if name in needs])


def _epochs(source: Source, found: Table, mapping: Assignment, required: Sequence[str]) -> Reading:
    frame, rejections, notes = found.frame, found.rejections, list[str]()
    out = pl.DataFrame({LINE: frame[LINE]})
    reasons = list[pl.Series]()
    for column in (*mapping.columns.values(), *mapping.times):
        dtype = frame.schema[column.name]
        if dtype.is_nested() or dtype in (pl.Binary, pl.Object):
            raise FormatError(source.path, f"holds {dtype}, where a number or a text is needed", field=column.name)
    for name, column in mapping.columns.items():
        if _QUANTITY[name].si == "text":
            out = out.with_columns(frame[column.name].cast(pl.String).str.replace_all(UNSEEN, "").str.strip_chars().alias(name))
            continue
        values, reason = _numbers(frame[column.name], column)
        out = out.with_columns(values.alias(name))
        if name in required:
            reasons.append(reason)
        else:
            _count(rejections, frame, column.name, reason)
    dated = position_time(mapping.unused)
    if tuple(required) == POSITION:
        out = _reported(out, mapping, notes, source)
    _look_like_radians(out, mapping, source, notes)
    time, reason, units = gps_time(frame, mapping.times, source, notes)
    out = out.with_columns(time.alias("time_ns"))
    reasons.append(reason)
    out = _positions_dated(out, frame, dated, source, (rejections, notes))
    used = [mapping.columns[n].name for n in required] + [mapping.times[0].name]
    track = pl.col("track").fill_null(source.stem) if "track" in out.columns else pl.lit(source.stem)
    out = out.with_columns(track.alias("track"))
    out, without = _drop(out, frame, reasons, used, rejections)
    out, contradicting = _in_order(out, rejections, notes)
    rejections.refuse_if_too_many(found.n_rows)
    _not_empty(source, out)
    described = {c.quantity: f"{c.name}:{c.unit}" for c in mapping.columns.values()} | {"time": ", ".join(units)}
    return Reading(
        out.drop(LINE), source.record(found.n_rows), rejections.records, mapping.unused, notes, described, _left_out(without, contradicting)
    )


_AHEAD_NS = 1_000_000_000
"""How much later than its row a position may be said to be: both may be rounded."""


def _positions_dated(
    out: pl.DataFrame, frame: pl.DataFrame, column: Column | None, source: Source, told: tuple[Rejections, list[str]]
) -> pl.DataFrame:
    """When each position was valid, where a column says so; a time that is none, or later than its row, is counted and not used."""
    dtype = None if column is None else frame.schema[column.name]
    if column is None or dtype is None or dtype.is_nested() or dtype in (pl.Binary, pl.Object):
        return out
    rejections, notes = told
    try:
        valid, reason, _ = gps_time(frame, [column], source, notes)
    except FormatError as e:
        notes.append(f"{source.path.name}: “{column.name}” is not used: {e.message}")
        return out
    late = (valid > out["time_ns"] + _AHEAD_NS).fill_null(value=False)
    reason = pl.select(pl.when(late).then(pl.lit("later than its row")).otherwise(reason)).to_series()
    for text in reason.drop_nulls().filter(reason.drop_nulls() != "empty").unique(maintain_order=True):
        at = frame.filter((reason == text).fill_null(value=False))
        # Without it the row's own time serves: that makes no row malformed.
        words = f"{column.name}: {text}; row used without it"
        rejections.add(words, at.height, at[LINE][0], str(at[column.name][0]), malformed=False)
    return out.with_columns(pl.select(pl.when(reason.is_null()).then(valid)).to_series().alias(POSITION_TIME))


def _reported(out: pl.DataFrame, mapping: Assignment, notes: list[str], source: Source) -> pl.DataFrame:
    """What a recorded track says of its own epochs, in words of the list; and a note on what no one reads."""
    before, out = out, status.recorded(out)
    if "status" in before.columns:
        n_unknown = before.filter(~pl.col("status").str.to_lowercase().is_in(list(status.STATUSES)).fill_null(value=False)).height
        if n_unknown:
            notes.append(
                f"{source.path.name}: {n_unknown} epochs have a status that is none of {', '.join(status.STATUSES)}; they are not judged"
            )
    if mapping.unused:
        notes.append(f"{source.path.name}: columns not used: {', '.join(mapping.unused)}")
    return out


def _rtklib(source: Source) -> Reading:
    d = _core.read_rtklib(source.text(), str(source.path))
    rejections, notes = Rejections(source.path), list[str]()
    refused = pl.DataFrame(d["refused"], schema=["line", "field", "reason", "text"], orient="row")
    for (name, reason), group in refused.group_by("field", "reason", maintain_order=True):
        rejections.add(f"{name}: {reason}", group.height, group["line"][0], group["text"][0])
    cov = d["cov_m2"]
    names = ("cov_ee_m2", "cov_en_m2", "cov_nn_m2", "cov_eu_m2", "cov_nu_m2", "cov_uu_m2")
    plain = {k: d[k] for k in ("time_ns", "est_lat_rad", "est_lon_rad", "est_h_m", "ground_speed_mps", "n_sv", "hpl_m", "vpl_m")}
    out = pl.DataFrame({LINE: d["line"]} | plain | {name: cov[:, i] for i, name in enumerate(names)})
    out = out.with_columns(pl.lit(source.stem).alias("track"), pl.selectors.float().fill_nan(None))
    out, contradicting = _in_order(out, rejections, notes)
    rejections.refuse_if_too_many(d["n_rows"])
    _not_empty(source, out)
    empty = [c for c in out.columns if out[c].is_null().all()]
    # A selection of constants alone has one row of them even where no row was refused.
    without = refused.with_columns(track=pl.lit(source.stem), time_ns=pl.lit(None, pl.Int64)).select("track", "time_ns")
    lost = _left_out(without, contradicting)
    return Reading(out.drop(LINE, *empty), source.record(d["n_rows"]), rejections.records, notes=notes, left_out=lost)


def _log(source: Source, kind: receivers.Kind) -> Reading:
    log = receivers.read(source, kind)
    rejections = Rejections(source.path, "record")
    for reason, (count, first, example, damaged) in log.left_out.items():
        rejections.add(reason, count, first, example, malformed=damaged)
    rejections.refuse_if_too_many(log.n_rows)
    out = pl.DataFrame(log.rows, infer_schema_length=None)
    _not_empty(source, out)
    if "unix_ns" in out.columns:
        gps = pl.Series("time_ns", _core.gps_from_unix_ns(np.ascontiguousarray(out["unix_ns"].fill_null(0).to_numpy(), dtype=np.int64)))
        known = pl.coalesce("time_ns", gps) if "time_ns" in out.columns else gps
        out = out.with_columns(known.alias("time_ns")).drop("unix_ns")
    out = out.rename({"record": LINE}).with_columns(pl.lit(source.stem).alias("track"), pl.selectors.float().fill_nan(None))
    out, contradicting = _in_order(out, rejections, log.notes)
    empty = [c for c in out.columns if out[c].is_null().all()]
    lost = _left_out(contradicting)
    return Reading(
        out.drop(LINE, *empty), source.record(log.n_rows), rejections.records, notes=log.notes, columns=log.columns, left_out=lost
    )


def _left_out(*rows: pl.DataFrame) -> pl.DataFrame:
    return pl.concat([left_out(each) for each in rows])


def _not_empty(source: Source, out: pl.DataFrame) -> None:
    if out.is_empty():
        raise FormatError(source.path, "no row holds a time, a latitude and a longitude")


def _numbers(column: pl.Series, what: Column) -> tuple[pl.Series, pl.Series]:
    """Values in SI, null where there is none; and why, null where nothing is wrong."""
    q = _QUANTITY[what.quantity]
    factor = UNITS[q.si][what.unit]
    if column.dtype == pl.String:
        text = column.str.strip_chars()
        # Programs write a missing number as an empty field or as nan: an outage is no damage.
        text = text.set(text.str.contains(_MISSING), None)
        raw = text.cast(pl.Float64, strict=False)
        empty = text.is_null()
    elif column.dtype.is_numeric() or column.dtype == pl.Null:
        raw = column.cast(pl.Float64)
        # A data frame writes a missing number as NaN.
        empty = raw.is_null() | raw.is_nan()
    else:
        raw, empty = pl.Series([None] * len(column), dtype=pl.Float64), column.is_null()
    frame = pl.DataFrame({"raw": raw, "empty": empty, "si": raw * factor})
    allowed = f"outside [{q.low / factor:.6g}, {q.high / factor:.6g}] {'' if q.si == '1' else what.unit}".rstrip()
    frame = frame.select(
        pl.when(pl.col("si").is_between(q.low, q.high) & pl.col("raw").is_finite()).then("si").alias("value"),
        pl.when("empty").then(pl.lit("empty"))
        .when(pl.col("raw").is_null()).then(pl.lit("not a number"))
        .when(~pl.col("raw").is_finite()).then(pl.lit("not finite"))
        .when(~pl.col("si").is_between(q.low, q.high)).then(pl.lit(allowed))
        .alias("reason"),
    )  # fmt: skip
    return frame["value"], frame["reason"]


def _count(rejections: Rejections, frame: pl.DataFrame, name: str, reason: pl.Series) -> None:
    """Count the values of an optional column that could not be used; the rows stay, an empty field is no fault."""
    for text in reason.drop_nulls().unique(maintain_order=True):
        if text == "empty":
            continue
        at = frame.filter((reason == text).fill_null(value=False))
        rejections.add_values(f"{name}: {text}; row used without it", at[LINE].to_list(), str(at[name][0]))


def _drop(
    out: pl.DataFrame, frame: pl.DataFrame, reasons: list[pl.Series], names: list[str], rejections: Rejections
) -> tuple[pl.DataFrame, pl.DataFrame]:
    """Leave out rows without time, latitude or longitude, counted by the first reason: what stays, and what does not."""
    labelled = [
        pl.when(reason.is_not_null()).then(pl.concat_str(pl.lit(f"{name}: "), reason)) for name, reason in zip(names, reasons, strict=True)
    ]
    out = out.with_columns(pl.coalesce(labelled).alias(_BAD))
    bad = out.filter(pl.col(_BAD).is_not_null())
    for (reason,), group in bad.group_by(_BAD, maintain_order=True):
        name, _, kind = str(reason).rpartition(": ")
        line = group[LINE][0]
        example = str(frame.filter(pl.col(LINE) == line)[name][0])
        rejections.add(str(reason), group.height, line, example, malformed=kind != "empty")
    return out.filter(pl.col(_BAD).is_null()).drop(_BAD), bad


def _in_order(out: pl.DataFrame, rejections: Rejections, notes: list[str]) -> tuple[pl.DataFrame, pl.DataFrame]:
    """One row an instant, in the order of time; a repeated instant of a track is left out and counted. Second: rows that contradict."""
    late = out.filter(pl.col("time_ns") < pl.col("time_ns").cum_max().over("track"))
    if not late.is_empty():
        notes.append(
            f"{rejections.path.name}: {late.height} rows stood after a later one of their track and were put in order of time "
            f"(first: {rejections.unit} {late[LINE][0]})"
        )
    out = out.sort("track", "time_ns", maintain_order=True)
    found = separate(out)
    reason = "time repeated within a track"
    kinds = {reason: found.identical, f"{reason} with another position, bound or status": found.contradicting}
    for reason, repeated in kinds.items():
        if not repeated.is_empty():
            track, time_ns, line = repeated.sort(LINE).select("track", "time_ns", LINE).row(0)
            rejections.add(reason, repeated.height, line, f"track {track}, time_ns {time_ns}", malformed=False)
    return found.epochs, found.contradicting


def _look_like_radians(out: pl.DataFrame, mapping: Assignment, source: Source, notes: list[str]) -> None:
    """Note degrees that could be radians: a flight near 0 N 0 E and a wrong unit look alike, so a person must judge."""
    if not {"est_lat_rad", "est_lon_rad"} <= mapping.columns.keys():
        return
    lat, lon = mapping.columns["est_lat_rad"], mapping.columns["est_lon_rad"]
    largest = max(2 * _largest(out["est_lat_rad"]), _largest(out["est_lon_rad"]))
    if lat.unit == "deg" and lon.unit == "deg" and 0 < largest <= math.pi * UNITS["rad"]["deg"]:
        notes.append(
            f"{source.path.name}: “{lat.name}” and “{lon.name}” were read as degrees, but all values are small enough to be radians; "
            f"if they are, declare est_lat_rad={lat.name}:rad and est_lon_rad={lon.name}:rad"
        )


def _largest(values: pl.Series) -> float:
    found = values.abs().max()
    return float(found) if isinstance(found, (int, float)) else 0.0
