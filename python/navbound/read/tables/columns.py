"""Which column of a table is what, and in which unit: known names, and what a caller declares."""

from __future__ import annotations

import difflib
import functools
import math
import re
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from navbound.errors import FormatError, InputError
from navbound.read.beside.places import Place, find
from navbound.read.checks.statements import (
    ACCURACY_WORDS,
    AGE,
    NUC,
    READSB_TYPE,
    kind_of,
    speaks_of_accuracy,
    speaks_of_integrity,
    speaks_of_level,
)
from navbound.read.own_positions import HEARD, READSB
from navbound.read.quantities import (
    DATE_NAMES,
    DATE_ORDERS,
    DAY,
    DUMP1090,
    DUMP1090_SPEED,
    FLIGHTRADAR24,
    LEVEL_QUANTITIES,
    OPENSKY_STATES,
    OPENSKY_VELOCITY,
    POSITION_TIME_NAMES,
    QUANTITIES,
    STATED_QUANTITIES,
    TIME_NAMES,
    TIME_UNITS,
    TRANSPONDER,
    UNITS,
    WEEK,
    WRITTEN,
    Quantity,
)

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Mapping, Sequence
    from pathlib import Path

    from navbound.read.checks.statements import Kind

_LONGEST_NAME = 80
"""Longer names are compared with nothing: likeness takes quadratic time. [1]"""
_MOST_COMPARED = 1000
"""Columns whose names are compared with the known ones. [1]"""
_MOST_SHOWN = 30
"""Columns that a refusal names, the nearest to a known name first: the one that is looked for may have a name like none. [1]"""


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

    @property
    def unread(self) -> list[str]:
        """Columns that nothing reads, though their names speak of integrity; so does a second column of one accuracy."""
        compared = {column.name for column in self.again}
        plain = {name: _plain(name)[0] for name in self.unused if name not in compared}
        transponders = bool(TRANSPONDER & set(plain.values()))
        known = _accuracies_by_alias().union(POSITION_TIME_NAMES)
        speaks = {name: speaks_of_integrity(name) or each in known for name, each in plain.items()}
        return [name for name, each in plain.items() if speaks[name] and not (transponders and each == "alert")]

    @property
    def accuracies(self) -> dict[str, float]:
        """Those of them that are lengths of a horizontal accuracy or error: the factor to metres of the unit in the name, otherwise 1."""
        again = _accuracies_by_alias()
        return _lengths(name for name in self.unread if speaks_of_accuracy(name) or _plain(name)[0] in again)

    @property
    def levels(self) -> dict[str, float]:
        """Those of them that are horizontal protection levels under a name of their own, in the same way."""
        return _lengths(name for name in self.unread if speaks_of_level(name))


def _lengths(names: Iterable[str]) -> dict[str, float]:
    factors = {name: _length_in(name) for name in names}
    return {name: factor for name, factor in factors.items() if factor is not None}


@functools.cache
def _accuracies_by_alias() -> frozenset[str]:
    """Names of the accuracies that a covariance is made of; where two of one file name the same, one is read."""
    return frozenset(alias for q in QUANTITIES if q.name in {"sigma_e_m", "sigma_n_m", "epu_m"} for alias in q.aliases)


def _length_in(name: str) -> float | None:
    """The unit of length in brackets or at the end of a name, metres where there is none; None where it is a unit of something else."""
    stem, written = _plain(name)
    if written is not None and written not in NO_UNIT:
        return UNITS["m"].get(written)
    return UNITS["m"].get(stem.rsplit("_", 1)[-1], 1.0)


NO_COLUMN = "-"
"""Declared of a quantity that no column is to be read as."""

POSITION = ("est_lat_rad", "est_lon_rad")
"""What the rows of a recorded track need beside a time."""


def assign(
    names: Iterable[str],
    declared: Mapping[str, str] | None,
    path: Path,
    *,
    needs: Sequence[str] = POSITION,
    texts: Container[str] = (),
    of_day: Container[str] = (),
    where_present: Mapping[str, str] | None = None,
) -> Assignment:
    """Find what each column is.

    Parameters
    ----------
    names : iterable of str
        Columns of the file.
    declared : mapping, optional
        Quantity, or ``time``, to ``column`` or ``column:unit``, or to ``-`` where no column is to be read as it; goes before the known
        names.
    path : Path
        The file, for messages.
    needs : sequence of str
        Quantities without which the file is refused, beside a time; other than a position they are those of errors and protection levels.
    texts : container of str
        Columns that hold words and no number: one named `track` is then a flight's name, not its direction.
    of_day : container of str
        Columns that hold times of day without a date: they are times together with a column of dates alone.
    where_present : mapping, optional
        More of `declared`, each of which counts where the file has its column.

    Raises
    ------
    InputError
        A declaration that names an unknown quantity or unit.
    FormatError
        A declared column that the file lacks, or no time, latitude or longitude: what is needed and the nearest names found.
    """
    names = list(names)
    quantities = QUANTITIES + (STATED_QUANTITIES if tuple(needs) == POSITION else LEVEL_QUANTITIES)
    own = {"time_ns", "est_lat_rad"} <= set(names) or any(_plain(name)[0] == "track" and name in texts for name in names)
    columns: dict[str, Column] = {}
    times: list[Column] = []
    known = {"time", "time_ns", *WEEK, *DAY, *(q.name for q in quantities)}
    beside = {key: value for key, value in (where_present or {}).items() if key in known and _column_named(value, names)[0] in names}
    stated = beside | dict(declared or {})
    absent = frozenset(
        key for key, value in stated.items() if value == NO_COLUMN and value not in names and key in {q.name for q in quantities}
    )
    for key, value in ((key, value) for key, value in stated.items() if key not in absent):
        column = _declared(key, value, names, path, quantities)
        if column.quantity == "time":
            times.append(column)
        else:
            columns[key] = column
    taken = {c.name for c in [*columns.values(), *times]}
    if {_plain(name)[0] for name in names} & TRANSPONDER:
        quantities = tuple(q for q in quantities if q.name != "alert")
    states = {q: c for q, c in _of_layouts(names).items() if c.name not in taken and q not in absent}
    columns = states | columns
    taken |= {c.name for c in states.values()}
    for quantity in quantities:
        if quantity.name not in columns and quantity.name not in absent:
            assigned = _known(quantity, [n for n in names if n not in taken], path, own=own)
            if assigned is not None:
                columns[quantity.name] = assigned
                taken.add(assigned.name)
    if (altitude := _of_phone(columns.get("altitude_m"), names)) is not None:
        columns["altitude_m"] = altitude
    times = _of_whole_times(times, [n for n in names if n not in taken], of_day, path)
    taken |= {c.name for c in times}
    _require(columns, times, names, path, needs)
    _refuse_twins(columns, set(declared or {}), names, path)
    free = [n for n in names if n not in taken]
    kinds = _kinds(free, {_plain(name)[0] for name in names}, texts)
    if tuple(needs) != POSITION:
        # A level counts with any dilution: an error above it is misleading all the same.
        kinds = {name: kind for name, kind in kinds.items() if kind is None or not math.isfinite(kind.above)}
    # The mode of a table of levels is a word of the method that gave them, or one against the position. NUCp 0 is no integrity at all.
    kinds |= {columns[name].name: kind_of(name) for name in ("mode", "nuc_p") if name in columns}
    statements = [(name, kind) for name, kind in kinds.items() if kind is not None]
    stating = {name for name, _ in statements}
    # A time of day without its date is compared with nothing.
    rest = [n for n in free if kinds.get(n) in (None, NUC) and n not in of_day]
    again = _again(columns, times, {*(declared or {}), *beside}, rest, path)
    unused = [n for n in free if n not in stating]
    compared = {column.name for column in again}
    stated_of = frozenset({*(declared or {}), *beside})
    places = find([*(n for n in unused if n not in compared), *stating], stated_of) if tuple(needs) == POSITION else []
    speed = "" if tuple(needs) != POSITION or "ground_speed_mps" in columns.keys() | absent else _speed_without_unit(unused)
    return Assignment(columns, times, unused, statements, again, places, absent, speed, stated_of)


def _of_whole_times(declared: list[Column], free: list[str], of_day: Container[str], path: Path) -> list[Column]:
    """The columns that state times together: those that are declared or known by name, and what they are not whole without."""
    times = declared or _times(free, of_day)
    times = _whole_week(times, _without(free, times), path)
    return _whole_day(times, _without(free, times), of_day, path)


def _without(names: list[str], columns: list[Column]) -> list[str]:
    taken = {column.name for column in columns}
    return [name for name in names if name not in taken]


def _kinds(free: list[str], plain: set[str], texts: Container[str]) -> dict[str, Kind | None]:
    """What columns that nobody reads state of the validity or the integrity of positions, beside the plain names of all columns."""
    kinds = {name: kind_of(_plain(name)[0]) for name in free}
    in_words = [name for name in free if name in texts and _parted(name) in ACCURACY_WORDS.names]
    kinds |= dict.fromkeys(in_words, ACCURACY_WORDS)
    if plain & TRANSPONDER:
        kinds.pop("alert", None)
    if plain >= READSB:
        kinds |= {name: READSB_TYPE for name in free if _plain(name)[0] == "type"}
    if plain >= HEARD:
        kinds |= {name: AGE for name in free if _plain(name)[0] == "seen"}
    return kinds


def kinds_within(names: Iterable[str]) -> dict[str, Kind]:
    """What keys of objects in fields state of positions: each by itself, or behind the names of its field and object.

    The `type` of what has coordinates says what it is.
    """
    names = list(names)
    shapes = {name.rpartition(".")[0] for name in names if name.endswith((".coordinates", ".geometry")) or ".geometry." in name}
    kinds = {name: kind_of(_plain(name.rpartition(".")[2])[0]) or kind_of(_plain(name)[0]) for name in names}
    return {
        name: kind
        for name, kind in kinds.items()
        if kind is not None and not (name.endswith(".type") and name.rpartition(".")[0] in shapes)
    }


def _speed_without_unit(free: list[str]) -> str:
    """The first column of a name that is in use for a speed in several units."""
    plain, (speed,) = _by_form(free), (quantity for quantity in QUANTITIES if quantity.name == "ground_speed_mps")
    names = (alias for alias, unit in speed.aliases.items() if unit == WRITTEN)
    return next((plain[alias] for alias in names if alias in plain), "")


_OF_PHONE = re.compile(r"(?:horizontal|vertical|speed|bearing|course|altitude)_accuracy(?:_.*)?")
"""Accuracies as the location services of Android, iOS and browsers name them, whose altitudes are in metres. Provenance: standard, from
knowledge of the interfaces."""


def _of_phone(altitude: Column | None, names: list[str]) -> Column | None:
    """An altitude in feet by its name alone beside two accuracies of a phone; its location service has it in metres."""
    if altitude is None or altitude.unit != "ft" or altitude.unit_stated or not _OF_TRANSPONDER.isdisjoint(map(_parted, names)):
        return None
    of_phone = [name for name in names if _OF_PHONE.fullmatch(_parted(name)) or _parted(name) == "accuracy"]
    if len(of_phone) < _LEAST_NAMES or not any(_parted(name) != "accuracy" for name in of_phone):
        return None
    beside = " and ".join(f"“{name}”" for name in of_phone[:_LEAST_NAMES])
    return replace(altitude, unit="m", because=f"as the names {beside} beside it are those of a phone")


def _of_layouts(names: list[str]) -> dict[str, Column]:
    """What the columns are where a table has all names of a program that writes them in units of its own."""
    layouts = [
        layout for layout in (OPENSKY_VELOCITY, OPENSKY_STATES, FLIGHTRADAR24) if {name for name, _ in layout.values()} <= set(names)
    ]
    if set(names) >= DUMP1090 and "gs" not in names:
        layouts.append({"ground_speed_mps": DUMP1090_SPEED})
    return {quantity: Column(quantity, name, unit) for layout in layouts for quantity, (name, unit) in layout.items()}


_COMPARED = ("est_lat_rad", "est_lon_rad", "ground_speed_mps", "nac_p", "nic", "nuc_p", "pic")
"""Quantities of which further columns are compared with the one that is read."""


def _again(columns: Mapping[str, Column], times: Sequence[Column], declared: Container[str], free: list[str], path: Path) -> list[Column]:
    further, rest = list[Column](), list(free)
    for quantity in (q for q in QUANTITIES if q.name in _COMPARED and q.name in columns and q.name not in declared):
        while (column := _known(quantity, rest, path, own=False)) is not None:
            further.append(column)
            rest.remove(column.name)
    if len(times) == 1 and "time" not in declared:
        further += [column for column in _times(rest)[:1] if column.unit not in WEEK]
    return further


_NAMES = frozenset(
    {"track", *TIME_NAMES, *(name for q in (*QUANTITIES, *LEVEL_QUANTITIES, *STATED_QUANTITIES) for name in (q.name, *q.aliases))}
)


def is_header(cells: Sequence[object]) -> bool:
    """Whether a row of a table holds names of columns and no numbers."""
    words = [str(cell) for cell in cells if cell not in (None, "")]
    return sum(_plain(word)[0] in _NAMES or _parted(word) in _NAMES for word in words if len(word) <= _LONGEST_NAME) >= _LEAST_NAMES


_LEAST_NAMES = 2
"""Names of quantities in one row that make it a header: one may be a callsign. [1]"""


_OF_TRANSPONDER = TRANSPONDER | READSB | {"callsign", "flight", "icao", "icao24", "hexident", "groundspeed", "vertrate", "baro_rate"}


def is_transponder(mapping: Assignment) -> bool:
    """Whether the names of a table are those of states of transponders, whose heights are in feet."""
    read = (column.name for column in mapping.columns.values())
    return not _OF_TRANSPONDER.isdisjoint(_plain(name)[0] for name in (*read, *mapping.unused, *(name for name, _ in mapping.statements)))


def position_time(unused: list[str]) -> Column | None:
    """The column that says when positions were valid, taken out of those that nobody uses; None where there is none."""
    for name in unused:
        if _plain(name)[0] in POSITION_TIME_NAMES:
            unused.remove(name)
            return Column("time", name, "gps_ns" if _plain(name)[0].endswith("_ns") else "utc")
    return None


_ALL_UNITS = frozenset(unit for units in UNITS.values() for unit in units if unit not in {"", "1"})


@functools.lru_cache(maxsize=1024)
def _plain(name: str) -> tuple[str, str | None]:
    """``Latitude (deg)`` and ``Latitude / deg`` to ``latitude`` and ``deg``; of a name that stands twice both columns are it."""
    stem, unit = re.sub(r"#\d{1,3}$", "", name).strip(), None
    if stem.endswith((")", "]")):
        # By searches and no pattern: one with several runs of blanks takes quadratic time.
        inside = stem[:-1]
        last_closed = max(inside.rfind(")"), inside.rfind("]"))
        opened = [at for bracket in "([" if (at := inside.find(bracket, last_closed + 1)) >= 0]
        if opened:
            stem, unit = inside[: min(opened)], inside[min(opened) + 1 :].strip().lower()
    elif (slash := stem.rfind("/")) > 0 and stem[slash + 1 :].strip().lower() in _ALL_UNITS:
        stem, unit = stem[:slash], stem[slash + 1 :].strip().lower()
    plain = re.sub(r"[\s\-.]+", "_", stem.strip().lower())
    if unit in _ABOVE_ELLIPSOID and plain in _HEIGHTS:
        # What it is above is part of its name: `Altitude` beside it is another height.
        return "ellipsoid_height", None
    return plain, unit


_ABOVE_ELLIPSOID = frozenset(("wgs84", "wgs-84", "wgs 84", "ellipsoid", "ellipsoidal", "above ellipsoid", "hae"))
_HEIGHTS = frozenset(("altitude", "alt", "height", "h"))


def _parted(name: str) -> str:
    """``latDeg`` to ``lat_deg``."""
    return _plain(re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", name))[0] if len(name) <= _LONGEST_NAME else _plain(name)[0]


def _by_form(names: list[str]) -> dict[str, str]:
    """Plain names and those taken apart at capitals, to the first column of each; a plain name counts before one taken apart."""
    return {_parted(name): name for name in reversed(names)} | {_plain(name)[0]: name for name in reversed(names)}


def _known(quantity: Quantity, names: list[str], path: Path, *, own: bool) -> Column | None:
    """Find the first known name, in the order of the aliases; ``own``: `track` is who flies, not whither, as in our own epoch table."""
    plain = _by_form(names)
    if own and quantity.name in {"track", "ground_track_rad"}:
        plain = {k: v for k, v in plain.items() if (k == "track") == (quantity.name == "track")}
    elif quantity.name == "track":
        plain.pop("track", None)
    units = UNITS[quantity.si]
    for alias, unit in quantity.aliases.items():
        if alias in plain:
            written = _written_unit(plain[alias], quantity, path)
            if unit == WRITTEN and written is None:
                continue
            return Column(quantity.name, plain[alias], written or unit, unit_stated=written is not None or alias.endswith(f"_{unit}"))
        # `hpl_nm` is `hpl` in nautical miles, whether or not the list names it so.
        for ending in units if quantity.si not in {"1", "time", "text"} else ():
            if f"{alias}_{ending}" in plain:
                return Column(quantity.name, plain[f"{alias}_{ending}"], ending, unit_stated=True)
    return None


NO_UNIT = _ABOVE_ELLIPSOID | {"", "1", "-", "geodetic", "true", "gps", "utc", "1s", "1 sigma"}
"""What stands in brackets behind a name and says nothing of its unit."""


def _written_unit(name: str, quantity: Quantity, path: Path) -> str | None:
    """The unit in brackets; None where there is none. One that is not known is no other: the number could be anything.

    Raises
    ------
    FormatError
        Naming the column and the units that are known.
    """
    written = _plain(name)[1]
    if written is None or written in NO_UNIT or quantity.si == "text":
        return None
    if written in UNITS[quantity.si]:
        return written
    known = ", ".join(u for u in UNITS[quantity.si] if u)
    what = f"its unit “{written}” is not known (known: {known}); rename the column, or {declare(f'{quantity.name}={name}:UNIT')}"
    raise FormatError(path, what, 1, name)


def _times(names: list[str], of_day: Container[str] = ()) -> list[Column]:
    """A column of a known name; one with dates goes before one of times of day, which needs another one for them."""
    return _dated_times([n for n in names if n not in of_day]) or _dated_times([n for n in names if n in of_day])


def _dated_times(names: list[str]) -> list[Column]:
    plain = _by_form(names)
    columns = [Column("time", plain[alias], unit) for alias, unit in TIME_NAMES.items() if alias in plain]
    week = [c for c in columns if c.unit == "gps_week"][:1]
    tow = [c for c in columns if c.unit == "gps_tow_s"][:1]
    single = [c for c in columns if c.unit not in {"gps_week", "gps_tow_s"}][:1]
    return single or (week + tow if week and tow else [])


def _refuse_twins(columns: dict[str, Column], declared: set[str], names: list[str], path: Path) -> None:
    """Refuse a column beside which another one has the same name but for case, blanks or a unit: the order would decide."""
    for quantity, column in columns.items():
        forms = {_plain(column.name)[0], _parted(column.name)}
        twins = [name for name in names if name != column.name and forms & {_plain(name)[0], _parted(name)}]
        if twins and quantity not in declared:
            what = f"“{column.name}” and “{twins[0]}” are one name in another writing, and nothing says which of both counts"
            raise FormatError(path, f"{what}; {declare(f'{quantity}=COLUMN')}", 1, quantity)


def _whole_week(times: list[Column], names: list[str], path: Path) -> list[Column]:
    """A week with its time of week, whichever of both was declared; the other may have a known name.

    Raises
    ------
    FormatError
        One without the other.
    """
    have = {column.unit for column in times} & set(WEEK)
    if not have:
        return times
    known = {_plain(name)[0]: name for name in reversed(names)}
    for unit, kind in WEEK.items():
        if unit not in have:
            other = next((known[alias] for alias, each in TIME_NAMES.items() if each == unit and alias in known), None)
            if other is None:
                (declared,) = have
                words = f"“{times[0].name}” is {WEEK[declared]}, and no column is {kind}; {declare(f'{unit}=COLUMN')}"
                raise FormatError(path, words, 1, "time")
            times = [*times, Column("time", other, unit)]
    return times


def _whole_day(times: list[Column], names: list[str], of_day: Container[str], path: Path) -> list[Column]:
    """A date and its time of day, in this order, where a time is one of day alone or either of both was declared.

    Raises
    ------
    FormatError
        One without the other.
    """
    both = {column.unit: column for column in times if column.unit in DAY}
    if not both:
        if len(times) != 1 or times[0].unit not in {"utc", "utc_text"} or times[0].name not in of_day:
            return times
        both = {"utc_time_of_day": Column("time", times[0].name, "utc_time_of_day")}
    plain = _by_form(names)
    if "utc_date" not in both:
        name = next((plain[alias] for alias in DATE_NAMES if alias in plain), None)
        if name is None:
            time = both["utc_time_of_day"].name
            what = f"“{time}” holds times of day and no date, and no column is named {', '.join(DATE_NAMES)}"
            how = declare("utc_date=COLUMN", f"utc_time_of_day={time}")
            raise FormatError(path, f"{what}; {how}, or write both in one column (2024-05-13T12:30:01Z)", 1, "time")
        both["utc_date"] = Column("time", name, "utc_date")
    if "utc_time_of_day" not in both:
        name = next((plain[alias] for alias, unit in TIME_NAMES.items() if unit == "utc" and plain.get(alias) in of_day), None)
        if name is None:
            date, how = both["utc_date"].name, declare("utc_time_of_day=COLUMN")
            raise FormatError(path, f"“{date}” is {DAY['utc_date']}, and no column is {DAY['utc_time_of_day']}; {how}", 1, "time")
        both["utc_time_of_day"] = Column("time", name, "utc_time_of_day")
    return [both["utc_date"], both["utc_time_of_day"]]


def _column_named(value: str, names: list[str]) -> tuple[str, str]:
    """``column:unit`` to both; a name may have a colon of its own."""
    name, separator, unit = value.rpartition(":")
    if value in names or not separator:
        return value, ""
    return name, unit


def _declared(key: str, value: str, names: list[str], path: Path, known: tuple[Quantity, ...]) -> Column:
    quantities = {q.name: q for q in known}
    name, unit = _column_named(value, names)
    if name not in names:
        short = [n for n in names if len(n) <= _LONGEST_NAME]
        near = ", ".join(difflib.get_close_matches(name[:_LONGEST_NAME], short, 3, 0.5)) or ", ".join(short[:12])
        raise FormatError(path, f"there is no column “{name}”; found: {near}", 1, key)
    if key in {"time", "time_ns"}:
        unit = unit or TIME_NAMES.get(_plain(name)[0], "utc" if key == "time" else "gps_ns")
        if unit not in TIME_UNITS:
            raise InputError("columns", value, domain=f"units of time: {', '.join(TIME_UNITS)}")
        return Column("time", name, unit)
    if key == "utc_date" and unit:
        if unit not in DATE_ORDERS:
            raise InputError("columns", value, domain=f"orders of a date: {', '.join(DATE_ORDERS)}")
        return Column("time", name, key, order=unit)
    if key in WEEK | DAY:
        return Column("time", name, key)
    if key not in quantities:
        raise InputError("columns", key, domain=f"known quantities: time, {', '.join((*WEEK, *DAY, *quantities))}")
    q = quantities[key]
    stated = unit or _written_unit(name, q, path)
    unit = stated or q.aliases.get(_plain(name)[0], q.si)
    if q.si != "text" and unit.lower() not in UNITS[q.si]:
        raise InputError("columns", value, domain=f"units of {key}: {', '.join(u for u in UNITS[q.si] if u)}")
    return Column(key, name, unit.lower(), unit_stated=bool(stated))


def _unit_of_time(name: str) -> str:
    """The unit that the name of a column suggests; ``UNIT`` where it suggests none."""
    parts = set(_parted(name).split("_"))
    sizes = {"ns": {"ns", "nsec"}, "us": {"us", "usec", "micros"}, "ms": {"ms", "msec", "millis"}, "s": {"s", "sec", "unix", "epoch"}}
    size = next((size for size, words in sizes.items() if words & parts), None)
    if size is None and not {"gps", "utc"} & parts:
        return "UNIT"
    scale = "gps" if "gps" in parts else "utc"
    return f"{scale}_{size}" if f"{scale}_{size}" in TIME_UNITS else f"{scale}_s"


_TRUTH_ALIASES = frozenset(alias for q in QUANTITIES if q.name in {"truth_lat_rad", "truth_lon_rad"} for alias in q.aliases)


def truth_as_position(names: Iterable[str]) -> dict[str, str]:
    """Of a recording that holds a true position and no estimate, its columns as those of a position: quantity to ``column:unit``."""
    of_truth = {"truth_lat_rad": "est_lat_rad", "truth_lon_rad": "est_lon_rad", "truth_h_m": "est_h_m"}
    aliases = {alias: (q.name, unit) for q in QUANTITIES for alias, unit in q.aliases.items()}
    known = {name: aliases[_plain(name)[0]] for name in names if _plain(name)[0] in aliases}
    if {"est_lat_rad", "est_lon_rad"} & {quantity for quantity, _ in known.values()}:
        return {}
    return {of_truth[quantity]: f"{name}:{unit}" for name, (quantity, unit) in known.items() if quantity in of_truth}


WITHOUT_LEVEL = (
    "positions with a covariance and no protection level are judged by `navbound analyze`; protection levels are made of observations "
    "(RINEX with navigation files, or a receiver's log with --solve) by `navbound evaluate --protection`"
)
"""What to do with a file whose protection levels are to be judged and that has none."""


def declare(*columns: str) -> str:
    """How a person declares what a column is, from the command line and in Python."""
    options = " ".join(f'--map "{column}"' for column in columns)
    return f"declare it: {options} (in Python: columns)"


def _require(columns: dict[str, Column], times: list[Column], names: list[str], path: Path, required: Sequence[str]) -> None:
    """Refuse a table without a time or a required quantity, and say what comes nearest."""
    aliases = {q.name: list(q.aliases) for q in QUANTITIES + LEVEL_QUANTITIES}
    needs = {"time": ([*times], list(TIME_NAMES))}
    needs |= {name: ([columns[name]] if name in columns else [], aliases[name]) for name in required}
    for need, (present, known) in needs.items():
        if present:
            continue
        short = [n for n in names if len(n) <= _LONGEST_NAME][:_MOST_COMPARED]
        near = {n: max(difflib.SequenceMatcher(None, _plain(n)[0], a).ratio() for a in known) for n in short}
        best = sorted(short, key=lambda n: -near[n])[:_MOST_SHOWN]
        if not best:
            raise FormatError(path, "the first line names no columns: a table begins with their names", 1, need)
        others = f" and {len(names) - len(best)} more" if len(names) > len(best) else ""
        truth = [n for n in names if _plain(n)[0] in _TRUTH_ALIASES]
        if need in POSITION and truth:
            of_truth = f"the file has the true position ({', '.join(truth[:3])}) and no estimate"
            advice = "name it with --truth beside the recording that it is the truth of"
            raise FormatError(path, f"no column holds it; {of_truth}: {advice}", 1, need)
        without = f"; {WITHOUT_LEVEL}" if need in {"hpl_m", "vpl_m"} else ""
        unit = {"time": _unit_of_time(best[0]), "est_lat_rad": "deg", "est_lon_rad": "deg"}.get(need, "m")
        more = f"; units: {', '.join(TIME_UNITS)}" if need == "time" else ""
        raise FormatError(
            path,
            f"no column holds it (known names: {', '.join(known[:6])}, ...); the file has {', '.join(best)}{others}; "
            f"if one of them is it, {declare(f'{need}=COLUMN:{unit}')}{more}{without}",
            1,
            need,
        )
