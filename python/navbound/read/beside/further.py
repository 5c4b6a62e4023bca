"""What else a table says of what is read: further columns of a position, a speed or a time, and speeds in other rows than the positions.

The order of known names must not decide which of several columns counts, nor the row in which it stands whether a speed does.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import polars as pl

from navbound.errors import FormatError
from navbound.read.beside.places import OtherPlaces
from navbound.read.checks.limits import Limits
from navbound.read.checks.repeats import SAME_PLACE_M
from navbound.read.columns.column import NO_COLUMN, POSITION
from navbound.read.columns.naming import declare
from navbound.read.quantities import UNITS
from navbound.read.statements.kinds import STALE_AFTER_S
from navbound.read.tables.cells import largest, no_field, numbers
from navbound.read.tables.table import LINE
from navbound.read.tables.times import TimeFacts, converted, understand
from navbound.units import EARTH_RADIUS_M
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from collections.abc import Container, Mapping
    from pathlib import Path

    from navbound.read.beside.no_speed import NoSpeeds
    from navbound.read.checks.rejections import Tally
    from navbound.read.columns.column import Assignment, Column

APART_M = 100.0
"""Two columns of one position contradict each other beyond it: two antennas and two filters do not. Provenance: ours. [m]"""
SPEEDS_APART_MPS, SPEEDS_APART = 10.0, 0.1
"""Two columns of one speed contradict each other beyond this and this share of the larger; filters do not. Provenance: ours. [m/s, 1]"""
SPEEDS_SHARE = 0.2
"""Share of rows from which two speeds that contradict each other leave nothing shown. Provenance: ours. [1]"""
_VELOCITY = ("vel_n_mps", "vel_e_mps")
_DIRECTED_MPS = 2.0
"""Slower velocities have no direction. Provenance: ours. [m/s]"""
_INDICATORS = ("nac_p", "nic", "nuc_p", "pic")
"""Of two columns the smaller counts: the less is claimed."""
_SCALE_M = {"est_lat_rad": pl.lit(EARTH_RADIUS_M), "est_lon_rad": EARTH_RADIUS_M * pl.col("est_lat_rad").cos()}
"""Metres of a radian, for the quantities of a position."""


class Further:
    """Compares further columns with those that are read, over all rows.

    The largest speed and the smallest indicator count; positions and times must agree, and most of the speeds.
    """

    def __init__(self, path: Path, mapping: Assignment, no_speeds: NoSpeeds) -> None:
        self._no_speeds = no_speeds
        self._path, self._mapping = path, mapping
        self._time = next((column for column in mapping.again if column.quantity == "time"), None)
        self._facts, self._unit = list[TimeFacts](), ""
        self._apart_m: dict[str, float] = {}
        self._places = OtherPlaces(mapping.places, mapping.declared)
        self._speeds: dict[str, tuple[int, int, float]] = {}
        self._apart_s = 0.0

    def see(self, part: pl.DataFrame, frame: pl.DataFrame, within: pl.DataFrame, tally: tuple[Tally, int]) -> pl.DataFrame:
        """The next rows: those that are read, with the largest speed, the file's, and what objects in its fields state.

        `tally` takes numbers that are no speeds.
        """
        self._places.see(part, frame, within)
        for column in self._mapping.again:
            if column.quantity not in part.columns or no_field(frame.schema[column.name]):
                continue
            raw = frame[column.name]
            if column.quantity == "ground_speed_mps":
                raw = self._no_speeds.without(column.name, frame, raw, UNITS["mps"][column.unit], tally)
            other, _ = numbers(raw, column)
            if column.quantity in _SCALE_M:
                part = self._see_place(column, part, other)
            elif column.quantity in _INDICATORS:
                part = part.with_columns(pl.min_horizontal(column.quantity, other).alias(column.quantity))
            else:
                self._see_speeds(column.name, part[column.quantity], other)
                part = part.with_columns(pl.max_horizontal(column.quantity, other).alias(column.quantity))
        if {"ground_speed_mps", *_VELOCITY} <= set(part.columns):
            of_velocity = part.select(speed=(pl.col(_VELOCITY[0]) ** 2 + pl.col(_VELOCITY[1]) ** 2).sqrt())["speed"]
            self._see_speeds(_VELOCITY[0], part["ground_speed_mps"], of_velocity)
        return part

    def _see_place(self, column: Column, part: pl.DataFrame, other: pl.Series) -> pl.DataFrame:
        """Rows with the distance between both as an accuracy that they state: one of them is wrong by half of it, or both are."""
        apart = pl.col(column.quantity) - other
        apart -= 2.0 * math.pi * (apart / (2.0 * math.pi)).round()
        apart_m = part.select(apart_m=apart.abs() * _SCALE_M[column.quantity])["apart_m"]
        self._apart_m[column.name] = max(self._apart_m.get(column.name, 0.0), largest(apart_m))
        before = [pl.col("unread_accuracy_m")] if "unread_accuracy_m" in part.columns else []
        apart_m = pl.select(pl.when(pl.lit(apart_m) > SAME_PLACE_M).then(pl.lit(apart_m))).to_series()
        return part.with_columns(pl.max_horizontal(*before, pl.lit(apart_m)).alias("unread_accuracy_m")) if apart_m.count() else part

    def _contradicting_places(self) -> list[str]:
        """Other places of the vehicle that are far away."""
        words = list[str]()
        for place, apart_m in self._places.far():
            quantity = place.axis or POSITION[0]
            if (used := self._mapping.columns.get(quantity)) is not None:
                words.append(self._doubt("places of one vehicle", (used.name, ", ".join(place.names)), f"{apart_m:.0f} m", quantity))
        return words

    def _see_speeds(self, name: str, one: pl.Series, other: pl.Series) -> None:
        apart = (one - other).abs()
        far = apart > SPEEDS_APART_MPS + SPEEDS_APART * pl.select(pl.max_horizontal(one, other)).to_series()
        n, n_far, most = self._speeds.get(name, (0, 0, 0.0))
        self._speeds[name] = (n + len(apart.drop_nulls().drop_nans()), n_far + int(far.sum() or 0), max(most, largest(apart)))

    def notes(self) -> list[str]:
        """Positions of which two columns differ by less than leaves nothing shown, after all rows."""
        return [
            f"{self._path.name}: “{used.name}” and “{column.name}” are two columns of one quantity and up to {apart_m:.1f} m apart; "
            "the first is read, and their distance counts as an accuracy that the recording states"
            for column in self._mapping.again
            if (used := self._mapping.columns.get(column.quantity)) is not None
            and SAME_PLACE_M < (apart_m := self._apart_m.get(column.name, 0.0)) <= APART_M
        ]

    def doubts(self) -> list[str]:
        """Positions of which two columns say something else, after all rows."""
        words = []
        for column in self._mapping.again:
            apart_m, used = self._apart_m.get(column.name, 0.0), self._mapping.columns.get(column.quantity)
            if used is not None and apart_m > APART_M:
                words.append(self._doubt("two columns of one quantity", (used.name, column.name), f"{apart_m:.0f} m", column.quantity))
        words += self._contradicting_places()
        used = self._mapping.columns.get("ground_speed_mps")
        for name, (n, n_far, most_mps) in self._speeds.items():
            if used is not None and n_far > SPEEDS_SHARE * n:
                velocity = self._mapping.columns.get(name)
                apart = f"at {n_far} of {counted(n, 'row')} up to {most_mps:.0f} m/s"
                if velocity is None:
                    words.append(self._doubt("two columns of one speed", (used.name, name), apart, "ground_speed_mps"))
                else:
                    words.append(
                        f"{self._path.name}: the speed “{used.name}” and that of the velocity “{velocity.name}” are {apart} apart; "
                        f"{declare(f'ground_speed_mps={NO_COLUMN}')}, or {name}={NO_COLUMN}, to leave one out; nothing is shown until then"
                    )
        return words

    def times(self, frame: pl.DataFrame) -> dict[str, pl.Series]:
        """The second column of times of the next rows, as it is written; nothing where there is none."""
        if self._time is None or no_field(frame.schema[self._time.name]):
            self._time = None
            return {}
        self._facts.append(TimeFacts.of(frame, [self._time]))
        return {self._time.name: frame[self._time.name]}

    def understand(self, dtypes: Mapping[str, pl.DataType]) -> None:
        """Decide in which unit the second times are written, after all rows; numbers that are no times are compared with nothing."""
        if self._time is not None:
            try:
                # What they may be is no remark on the times that are read.
                self._unit = understand(TimeFacts.together(self._facts), [self._time], dtypes[self._time.name], self._path, [])
            except FormatError:
                self._time = None
        self._facts = []

    def against(self, time_ns: pl.Series, raw: pl.DataFrame) -> list[str]:
        """A doubt where the second column says another time than that of the row; once."""
        if self._time is None or self._apart_s > STALE_AFTER_S:
            return []
        other_ns, _ = converted(raw, [self._time], self._unit)
        self._apart_s = largest((other_ns - time_ns).cast(pl.Float64) * 1e-9)
        if self._apart_s <= STALE_AFTER_S:
            return []
        return [self._doubt("two columns of time", (self._mapping.times[0].name, self._time.name), f"{self._apart_s:.6g} s", "time")]

    def _doubt(self, of: str, names: tuple[str, str], apart: str, quantity: str) -> str:
        used, other = names
        return (
            f"{self._path.name}: “{used}” and “{other}” are {of} and {apart} apart; "
            f"{declare(f'{quantity}={used}')}, or the other; nothing is shown until it is stated"
        )


class Speeds:
    """Makes the speed over the ground of each row, of what it and the rows before it state, in the order of the file and across pieces.

    What a row of the track stated counts for as long as a speed stands in where reports have none.
    """

    def __init__(self, absent: Container[str]) -> None:
        self._absent = absent
        self._last: dict[str, pl.DataFrame] = {}

    def whole(self, rows: pl.DataFrame, *, left_out: pl.Expr) -> pl.DataFrame:
        """The next rows, with time and track: the largest speed that any column states, and its direction, of velocities where none does.

        A row with one of two velocities has the other of a row before: alone they make no speed. A row that is `left_out` has no position,
        and the next one without a speed has its.
        """
        if set(_VELOCITY) <= set(rows.columns):
            one = rows.select(pl.col(_VELOCITY[0]).is_null() != pl.col(_VELOCITY[1]).is_null()).to_series()
            filled = [self._filled(rows, name, of=pl.lit(value=True), to=one) for name in _VELOCITY]
            rows = _of_velocities(rows.with_columns(filled), self._absent)
        if "ground_speed_mps" not in rows.columns:
            return rows
        every = pl.repeat(value=True, n=rows.height, eager=True)
        filled = [self._filled(rows, "ground_speed_mps", of=left_out, to=every)]
        if "ground_track_rad" in rows.columns:
            # A direction is soon another one: the row after it alone has it.
            with_position = rows.select(left_out.not_()).to_series()
            filled.append(self._filled(rows, "ground_track_rad", of=left_out, to=with_position, once=True))
        return rows.with_columns(filled)

    def _filled(self, rows: pl.DataFrame, name: str, *, of: pl.Expr, to: pl.Series, once: bool = False) -> pl.Series:
        """A column, filled at the rows `to` by what the last of the rows `of` states, or at the first of them that follows it."""
        line = pl.col(LINE).cast(pl.Int64)
        spoken = rows.filter(of & pl.col(name).is_finite() & pl.col("time_ns").is_not_null())
        known = spoken.select("track", line, pl.col("time_ns").alias("spoken_ns"), pl.col(name).alias("spoken"), line.alias("said_in"))
        known = pl.concat([self._last.get(name, known.clear()), known])
        if known.is_empty():
            return rows[name]
        self._last[name] = known.unique("track", keep="last", maintain_order=True).sort(LINE)
        open_rows = rows.select("track", line, "time_ns", name, to=to)
        open_rows = open_rows.join_asof(known, on=LINE, by="track", check_sortedness=False)
        fresh = (pl.col("time_ns") - pl.col("spoken_ns")).is_between(0, int(Limits.latency_s * 1e9))
        if once:
            used = open_rows.filter("to")["said_in"]
            self._last[name] = self._last[name].filter(pl.col("said_in").is_in(used.implode()).not_())
            fresh &= pl.struct("track", "said_in", "to").is_first_distinct()
        return open_rows.select(pl.coalesce(name, pl.when(pl.col("to") & fresh).then("spoken")).alias(name)).to_series()


def _of_velocities(rows: pl.DataFrame, absent: Container[str]) -> pl.DataFrame:
    north, east = _VELOCITY
    of_velocity = (pl.col(north) ** 2 + pl.col(east) ** 2).sqrt()
    speeds = [pl.col(name) for name in ("ground_speed_mps",) if name in rows.columns]
    tracks = [pl.col(name) for name in ("ground_track_rad",) if name in rows.columns]
    whither = pl.when(of_velocity > _DIRECTED_MPS).then(pl.arctan2(east, north))
    added = [pl.max_horizontal(*speeds, of_velocity).alias("ground_speed_mps"), pl.coalesce(*tracks, whither).alias("ground_track_rad")]
    return rows.with_columns(each for each in added if each.meta.output_name() not in absent).drop(_VELOCITY)
