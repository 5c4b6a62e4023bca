"""Units that nobody states: what the numbers of a table, or its names, say of them after all rows."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import polars as pl

from navbound.read.beside.altitude_unit import HIGH_M, LIKE, AltitudeUnit, note
from navbound.read.columns.column import POSITION, Assignment, is_transponder
from navbound.read.columns.naming import declare, plain_form
from navbound.read.quantities import UNITS
from navbound.read.tables.cells import largest, smallest
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

_OF_NAVIGATION = (("anp", None), ("actual_navigation_performance", None))
"""Names of what flight management systems show in nautical miles, where a table states no unit."""
_LEAST_EPU_M = 1.0
"""A smaller radius that holds 95 % is one of a phase solution in metres, or one in nautical miles. Provenance: ours. [m]"""


class UnstatedUnits:
    """Looks at the rows that are read; `notes` and `doubts` are whole after :meth:`radians`, and :meth:`others` once the times are known.

    Attributes
    ----------
    notes : list of str
        What was read in a usual unit.
    doubts : list of str
        Columns whose numbers may be in another unit than they are read in, so that nothing can be shown until it is stated.
    altitude : AltitudeUnit or None
        Of an altitude in feet by its name alone, what stands beside it.
    """

    def __init__(self, path: Path, mapping: Assignment) -> None:
        self.notes, self.doubts = list[str](), list[str]()
        self._path, self._columns, self._transponder = path, mapping.columns, is_transponder(mapping)
        self._largest = dict.fromkeys(POSITION, 0.0)
        self._n_heights = self._n_feet = self._n_metres = 0
        self._least_epu_m = self._least_anp_m = math.inf
        self._without_unit = {name for name in mapping.accuracies if plain_form(name) in _OF_NAVIGATION}
        altitude = mapping.columns.get("altitude_m")
        of_name = altitude is not None and altitude.unit == "ft" and not altitude.unit_stated and not self._transponder
        self.altitude = AltitudeUnit(mapping.columns) if of_name else None

    def see(self, part: pl.DataFrame) -> None:
        """The next rows."""
        for name in POSITION:
            if name in part.columns:
                self._largest[name] = max(self._largest[name], largest(part[name]))
        self._see_heights(part)
        if "epu_m" in part.columns:
            self._least_epu_m = min(self._least_epu_m, smallest(part["epu_m"]))

    def see_accuracies(self, numbers_of: Mapping[str, pl.Series]) -> None:
        """The next numbers of accuracies that nothing reads."""
        for name in self._without_unit & numbers_of.keys():
            self._least_anp_m = min(self._least_anp_m, smallest(numbers_of[name]))

    def _see_heights(self, part: pl.DataFrame) -> None:
        """Count heights that are a pressure altitude times feet in a metre, or the other way round; keep what decides a unit."""
        if self.altitude is not None:
            self.altitude.see(part)
        if not {"est_h_m", "altitude_m"} <= set(part.columns):
            return
        high = part.filter(pl.min_horizontal(pl.col("est_h_m").abs(), pl.col("altitude_m").abs()) > HIGH_M)
        ratio = pl.col("est_h_m") / pl.col("altitude_m")
        feet = 1.0 / UNITS["m"]["ft"]
        self._n_heights += high.height
        self._n_feet += high.filter((ratio / feet - 1.0).abs() <= LIKE).height
        self._n_metres += high.filter((ratio * feet - 1.0).abs() <= LIKE).height

    def radians(self) -> None:
        """Doubt degrees that could be radians: a flight near 0 N 0 E and a wrong unit look alike, so a person must state the unit."""
        columns = self._columns
        if not set(POSITION) <= columns.keys():
            return
        lat, lon = (columns[name] for name in POSITION)
        largest = max(2 * self._largest["est_lat_rad"], self._largest["est_lon_rad"])
        if lat.unit == "deg" and lon.unit == "deg" and 0 < largest <= math.pi * UNITS["rad"]["deg"]:
            doubt = (
                f"{self._path.name}: “{lat.name}” and “{lon.name}” were read as degrees, but all values are small enough to be radians; "
                f"{declare(f'est_lat_rad={lat.name}:rad', f'est_lon_rad={lon.name}:rad')}, or :deg; "
                "nothing is shown until the unit is stated"
            )
            (self.notes if lat.unit_stated and lon.unit_stated else self.doubts).append(doubt)
        elif lat.unit == lon.unit == "deg" and 0 < self._largest["est_lat_rad"] <= math.pi / 2 * UNITS["rad"]["deg"]:
            # The longitude is no radian. Near the equator this is a doubt without a cause.
            self.notes.append(
                f"{self._path.name}: “{lat.name}” was read as degrees, but all its values are small enough to be radians; if they are, "
                f"{declare(f'est_lat_rad={lat.name}:rad')}"
            )

    def others(self) -> None:
        """Doubts and notes of heights, altitudes and radii."""
        self._look_like_feet()
        self._units_of_names()

    def _units_of_names(self) -> None:
        """Units that are those of a name and that nobody states: a height of ADS-B is in feet, an uncertainty of a flight display in NM."""
        columns = self._columns
        altitude = columns.get("altitude_m")
        decided = "" if altitude is None else altitude.because or (self.altitude.words if self.altitude is not None else "")
        if altitude is not None and decided:
            self.notes.append(note(self._path, altitude, decided))
        for name in ("est_h_m",) if decided else ("est_h_m", "altitude_m"):
            column = columns.get(name)
            if column is not None and column.unit == "ft" and not column.unit_stated and not self._transponder:
                how = declare(f"{name}={column.name}:m")
                self.notes.append(f"{self._path.name}: “{column.name}” states no unit and is read in feet; if it is in metres, {how}")
        if self._least_anp_m < _LEAST_EPU_M:
            self.doubts += [
                f"{self._path.name}: “{name}” states no unit and would be compared in metres; {_small_epu(name)}"
                for name in sorted(self._without_unit)
            ]
        column = columns.get("epu_m")
        if column is None or column.unit != "m" or column.unit_stated:
            return
        words = f"{self._path.name}: “{column.name}” states no unit and is read in metres"
        how = declare(f"epu_m={column.name}:nm")
        if self._least_epu_m >= _LEAST_EPU_M:
            self.notes.append(f"{words}; if it is in nautical miles, {how}")
        else:
            self.doubts.append(f"{words}; {_small_epu(column.name)}")

    def _look_like_feet(self) -> None:
        columns = self._columns
        if self.altitude is not None and self.altitude.words:
            # They were counted as they were read, in feet.
            return
        for n, name, other in ((self._n_feet, "est_h_m", "altitude_m"), (self._n_metres, "altitude_m", "est_h_m")):
            if 2 * n > self._n_heights:
                of, beside = columns[name], columns[other]
                self.notes.append(
                    f"{self._path.name}: “{of.name}” was read as {of.unit}, and is 3.28 times “{beside.name}” ({beside.unit}) at {n} of "
                    f"{counted(self._n_heights, 'row')}: one of them is in another unit than it is read in; "
                    f"{declare(f'{name}={of.name}:ft')}"
                )


def _small_epu(name: str) -> str:
    how = declare(f"epu_m={name}:nm")
    return f"as small as it is it may be in nautical miles: {how}, or :m; nothing is shown until then"
