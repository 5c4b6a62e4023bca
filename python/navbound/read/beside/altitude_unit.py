"""The unit of an altitude whose column states none, beside what decides it.

`altitude` is in feet in tables of aviation and in metres in those of phones and receivers. Names of a phone's accuracies decide it before
a row is read; a height in metres that has the same numbers, or a climb rate of which they are the way, does after all rows. Nothing else
does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound.read.columns.naming import declare, name_parts
from navbound.read.quantities import UNITS
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from navbound.read.columns.column import Column

ALTITUDE, HEIGHT, CLIMB = "altitude_m", "est_h_m", "vertical_rate_mps"
HEAD_ROWS = 5000
"""Rows of a file that decide, the first ones that say something: the same in pieces of any length. Provenance: ours. [1]"""
_FT_M = UNITS["m"]["ft"]
HIGH_M, LIKE = 300.0, 0.1
"""Height from which geoid and pressure hardly change a ratio [m], and how much they may [1]. Provenance: ours."""
_HIGH = pl.min_horizontal(pl.col(HEIGHT).abs(), pl.col(ALTITUDE).abs() / _FT_M) > HIGH_M
"""Both are high enough where the altitude is in metres, and so is the height where it is not."""
_CLIMBING_MPS = 1.0
"""A smaller climb rate says little beside the noise of altitudes. Provenance: ours. [m/s]"""
_WINDOW_NS = 10_000_000_000
_LONGEST_NS = 3 * _WINDOW_NS
_LEAST_M, _NOISE_M = 10.0, 2.0
"""Climb within 10 s that is compared, and the noise of its altitudes, which may be rounded to whole metres. Provenance: ours. [m]"""
_MOST, _LEAST_N = 0.5, 5
"""Share of what is compared that has to fit, and how much there has to be. Provenance: ours. [1]"""


_COMPARED = {HEIGHT: "row", CLIMB: "climb"}


class AltitudeUnit:
    """Decides whether an altitude that is read in feet by its name alone is in metres.

    Attributes
    ----------
    words : str
        By what it is in metres; empty where nothing decides, or not yet.
    """

    def __init__(self, columns: Mapping[str, Column]) -> None:
        self.words = ""
        self._columns = columns
        self._beside = [name for name in (HEIGHT, CLIMB) if name in columns and _is_known(columns[name])]
        self._n_rows, self._head = 0, list[pl.DataFrame]()

    def see(self, part: pl.DataFrame) -> None:
        """The next rows, with their times as they are written; the first of the file that say something are kept."""
        if not self._beside or self._n_rows >= HEAD_ROWS:
            return
        says = {HEIGHT: _HIGH, CLIMB: pl.col(CLIMB).abs() >= _CLIMBING_MPS}
        rows = part.filter(pl.any_horizontal(says[name] for name in self._beside) & pl.col(ALTITUDE).is_not_null())
        self._head.append(rows.head(HEAD_ROWS - self._n_rows))
        self._n_rows += self._head[-1].height

    def head(self) -> pl.DataFrame:
        """The rows that were kept."""
        return pl.concat(self._head, how="diagonal_relaxed") if self._head else pl.DataFrame()

    def understand(self, timed: pl.DataFrame) -> None:
        """Decide by the head with `track` and `time_ns`; where both speak they have to agree."""
        self._head = []
        compared = {HEIGHT: _by_height, CLIMB: _by_climb}
        outcomes = {name: compared[name](timed) for name in self._beside}
        spoken = {name: fits for name, fits in outcomes.items() if sum(fits) >= _LEAST_N}
        if spoken and all(n_m > _MOST * sum((n_m, n_ft, n_none)) for n_m, n_ft, n_none in spoken.values()):
            of = (f"“{self._columns[name].name}” at {fits[0]} of {counted(sum(fits), _COMPARED[name])}" for name, fits in spoken.items())
            self.words = f"in which it agrees with {' and '.join(of)}"

    def made(self, part: pl.DataFrame) -> pl.DataFrame:
        """Rows with the altitude in the unit that was decided; they were read in feet."""
        return part.with_columns(pl.col(ALTITUDE) / _FT_M) if self.words else part


def note(path: Path, column: Column, words: str) -> str:
    """That an altitude is read in metres, and why."""
    how = declare(f"{ALTITUDE}={column.name}:ft")
    return f"{path.name}: “{column.name}” states no unit and is read in metres, {words}; if it is in feet, {how}"


def _is_known(column: Column) -> bool:
    """Whether its unit does not itself rest on a name that is in use for several: `height` may be in feet, `vertical_rate` in m/s."""
    return column.unit_stated or not _OF_ELLIPSOID.isdisjoint(name_parts(column.name))


_OF_ELLIPSOID = frozenset(("ellipsoid", "ellipsoidal", "hae"))
"""Parts of names of heights that nobody writes in feet. Provenance: ours."""


def _by_height(rows: pl.DataFrame) -> tuple[int, int, int]:
    """At how many rows the altitude is the height where it is in metres, where it is in feet, and in neither."""
    both = rows.filter(_HIGH).select(read=ALTITUDE, height=HEIGHT).drop_nulls()
    ratio = (both["read"] / both["height"]).to_numpy()
    return _fitting(np.abs(ratio / _FT_M - 1.0) <= LIKE, np.abs(ratio - 1.0) <= LIKE)


def _by_climb(rows: pl.DataFrame) -> tuple[int, int, int]:
    """The same of ways up or down within 10 s."""
    rows = rows.drop_nulls(["time_ns", ALTITUDE, CLIMB]).sort("track", "time_ns", maintain_order=True)
    window = (pl.col("time_ns") // _WINDOW_NS).alias("window")
    first = rows.group_by("track", window, maintain_order=True).agg(pl.col("time_ns", ALTITUDE).first(), pl.col(CLIMB).mean())
    if first.height <= 1:
        return 0, 0, 0
    time_ns, altitude = first["time_ns"].to_numpy(), first[ALTITUDE].to_numpy()
    elapsed_ns = np.diff(time_ns)
    same = (first["track"][1:] == first["track"][:-1]).to_numpy() & (elapsed_ns > 0) & (elapsed_ns <= _LONGEST_NS)
    way_m = (first[CLIMB].to_numpy()[:-1] * elapsed_ns * 1e-9)[same]
    read_m = np.diff(altitude)[same]
    far = np.abs(way_m) >= _LEAST_M
    way_m, read_m = way_m[far], read_m[far]
    within_m = 2.0 * LIKE * np.abs(way_m) + _NOISE_M
    return _fitting(np.abs(read_m / _FT_M - way_m) <= within_m, np.abs(read_m - way_m) <= within_m)


def _fitting(in_metres: NDArray[np.bool_], in_feet: NDArray[np.bool_]) -> tuple[int, int, int]:
    return int(in_metres.sum()), int((in_feet & ~in_metres).sum()), int((~in_metres & ~in_feet).sum())
