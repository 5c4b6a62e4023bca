"""A column of a file and what it holds, and all of a file together."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from navbound.read.beside.places import Place
from navbound.read.columns.naming import length_in, plain_form
from navbound.read.own_positions import READSB
from navbound.read.quantities import POSITION_TIME_NAMES, QUANTITIES, TRANSPONDER
from navbound.read.statements.names import speaks_of_accuracy, speaks_of_integrity, speaks_of_level

if TYPE_CHECKING:
    from collections.abc import Iterable

    from navbound.read.statements.kinds import Kind


@dataclass(frozen=True)
class Column:
    """A column of the file, what it holds, and how it is written."""

    quantity: str
    name: str
    unit: str
    unit_stated: bool = False
    """Whether the file or the caller says the unit; otherwise it is the usual one of the name."""
    order: str = ""
    """Of a date of numbers, as the caller states it."""
    hemisphere: str = ""
    """Of a coordinate without a sign, the column whose letters say on which side of the equator or of Greenwich it is."""
    variation: str = ""
    """Of a magnetic direction, the column whose angles in degrees make it a true one, positive to the east."""
    because: str = ""
    """Why it is read in this unit, where names beside it say so; the rest of a sentence."""


@dataclass(frozen=True)
class Assignment:
    """What each column of a file is.

    Attributes
    ----------
    columns : dict
        Quantity to column; times under ``gps_ns``, ``gps_week`` and so on stand in `times`.
    times : list of Column
        One column, or week and time of week.
    unused : list of str
        Columns that nothing is known about.
    statements : list of (str, Kind)
        Columns in which a recorded track states the validity or the integrity of its own positions.
    again : list of Column
        Further columns of a position, a speed or a time that is read and that nobody declared: a known name stands twice.
    places : list of Place
        Other places of the vehicle under names that nothing reads, where nobody declared which one counts.
    declared : frozenset of str
        Quantities of which somebody declared the column.
    declared_sides : frozenset of str
        Coordinates of which somebody declared the column of hemispheres, or that there is none.
    absent : frozenset of str
        Quantities that no column is to be read as, nor made of others.
    speed : str
        The column of a speed over the ground whose unit nobody states; empty where there is none. It is one of those that are not used.
    """

    columns: dict[str, Column]
    times: list[Column]
    unused: list[str]
    statements: list[tuple[str, Kind]] = field(default_factory=list)
    again: list[Column] = field(default_factory=list)
    places: list[Place] = field(default_factory=list)
    absent: frozenset[str] = frozenset()
    speed: str = ""
    declared: frozenset[str] = frozenset()
    declared_sides: frozenset[str] = frozenset()

    @property
    def unread(self) -> list[str]:
        """Columns that nothing reads, though their names speak of integrity; so does a second column of one accuracy."""
        compared = {column.name for column in self.again}
        plain = {name: plain_form(name)[0] for name in self.unused if name not in compared}
        transponders = bool(TRANSPONDER & set(plain.values()))
        known = _accuracies_by_alias().union(POSITION_TIME_NAMES)
        speaks = {name: speaks_of_integrity(name) or each in known for name, each in plain.items()}
        return [name for name, each in plain.items() if speaks[name] and not (transponders and each == "alert")]

    @property
    def accuracies(self) -> dict[str, float]:
        """Those of them that are lengths of a horizontal accuracy or error: the factor to metres of the unit in the name, otherwise 1."""
        again = _accuracies_by_alias()
        return _lengths(name for name in self.unread if speaks_of_accuracy(name) or plain_form(name)[0] in again)

    @property
    def levels(self) -> dict[str, float]:
        """Those of them that are horizontal protection levels under a name of their own, in the same way."""
        return _lengths(name for name in self.unread if speaks_of_level(name))


def _lengths(names: Iterable[str]) -> dict[str, float]:
    factors = {name: length_in(name) for name in names}
    return {name: factor for name, factor in factors.items() if factor is not None}


@functools.cache
def _accuracies_by_alias() -> frozenset[str]:
    """Names of the accuracies that a covariance is made of; where two of one file name the same, one is read."""
    return frozenset(alias for q in QUANTITIES if q.name in {"sigma_e_m", "sigma_n_m", "epu_m"} for alias in q.aliases)


NO_COLUMN = "-"
"""Declared of a quantity that no column is to be read as."""
POSITION = ("est_lat_rad", "est_lon_rad")
"""What the rows of a recorded track need beside a time."""
OF_TRANSPONDER = TRANSPONDER | READSB | {"callsign", "flight", "icao", "icao24", "hexident", "groundspeed", "vertrate", "baro_rate"}


def is_transponder(mapping: Assignment) -> bool:
    """Whether the names of a table are those of states of transponders, whose heights are in feet."""
    read = (column.name for column in mapping.columns.values())
    names = (*read, *mapping.unused, *(name for name, _ in mapping.statements))
    return not OF_TRANSPONDER.isdisjoint(plain_form(name)[0] for name in names)
