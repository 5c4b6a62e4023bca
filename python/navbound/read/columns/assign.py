"""What each column of a file is: declared, or known by its name and what stands beside it."""

from __future__ import annotations

import difflib
import math
import re
from dataclasses import replace
from typing import TYPE_CHECKING

from navbound.errors import FormatError, InputError
from navbound.read.beside.places import find
from navbound.read.columns import hemispheres
from navbound.read.columns.column import NO_COLUMN, OF_TRANSPONDER, POSITION, Assignment, Column
from navbound.read.columns.lacking import refuse_twins, require
from navbound.read.columns.naming import LONGEST_NAME, by_form, column_named, parted_form, plain_form, written_unit
from navbound.read.columns.timed import known_times, of_times
from navbound.read.own_positions import HEARD, READSB
from navbound.read.quantities import (
    DATE_ORDERS,
    DAY,
    DUMP1090,
    DUMP1090_SPEED,
    FLIGHTRADAR24,
    GARMIN,
    GARMIN_COLUMNS,
    GARMIN_TRACK,
    LEVEL_QUANTITIES,
    OPENSKY_STATES,
    OPENSKY_VELOCITY,
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
from navbound.read.statements.kinds import ACCURACY_WORDS, AGE, NUC, READSB_TYPE, kind_of

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Mapping, Sequence
    from pathlib import Path

    from navbound.read.statements.kinds import Kind


def assign(
    names: Iterable[str],
    declared: Mapping[str, str] | None,
    path: Path,
    *,
    needs: Sequence[str] = POSITION,
    texts: Container[str] = (),
    blank: Container[str] = (),
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
    blank : container of str
        Columns of text in which nothing is written at first.
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
    declared, stated_sides = hemispheres.apart(declared, names, path)
    quantities = QUANTITIES + (STATED_QUANTITIES if tuple(needs) == POSITION else LEVEL_QUANTITIES)
    own = {"time_ns", "est_lat_rad"} <= set(names) or any(plain_form(name)[0] == "track" and name in texts for name in names)
    columns: dict[str, Column] = {}
    times: list[Column] = []
    known = {"time", "time_ns", *WEEK, *DAY, *(q.name for q in quantities)}
    beside = {key: value for key, value in (where_present or {}).items() if key in known and column_named(value, names)[0] in names}
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
    if {plain_form(name)[0] for name in names} & TRANSPONDER:
        quantities = tuple(q for q in quantities if q.name != "alert")
    states = {q: c for q, c in _of_layouts(names).items() if c.name not in taken and q not in absent}
    columns = states | columns
    taken |= {c.name for c in states.values()}
    letters = hemispheres.named([n for n in names if n not in taken and n in texts], [n for n in names if n not in taken and n in blank])
    beside_letters = taken.union(*letters.values())
    for quantity in quantities:
        if quantity.name not in columns and quantity.name not in absent:
            assigned = _known(quantity, [n for n in names if n not in taken | beside_letters], path, own=own)
            if assigned is not None:
                columns[quantity.name] = assigned
                taken.add(assigned.name)
    columns |= _of_phone(columns, names)
    columns |= hemispheres.signed(columns, letters, names, stated_sides)
    taken |= {name for c in columns.values() for name in (c.hemisphere, c.variation) if name}
    times = of_times(times, [n for n in names if n not in taken], of_day, path)
    taken |= {c.name for c in times}
    require(columns, times, names, path, needs)
    refuse_twins(columns, set(declared or {}), names, path)
    free = [n for n in names if n not in taken]
    kinds = _kinds(free, {plain_form(name)[0] for name in names}, texts)
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
    return Assignment(columns, times, unused, statements, again, places, absent, speed, stated_of, frozenset(stated_sides))


def _kinds(free: list[str], plain: set[str], texts: Container[str]) -> dict[str, Kind | None]:
    """What columns that nobody reads state of the validity or the integrity of positions, beside the plain names of all columns."""
    # Programs write the keys of objects with points between them: `OSD.isGPSused`, `gps.valid`.
    kinds = {name: kind_of(plain_form(name)[0]) or kind_of(plain_form(name.rpartition(".")[2])[0]) for name in free}
    in_words = [name for name in free if name in texts and parted_form(name) in ACCURACY_WORDS.names]
    kinds |= dict.fromkeys(in_words, ACCURACY_WORDS)
    if plain & TRANSPONDER:
        kinds.pop("alert", None)
    if plain >= READSB:
        kinds |= {name: READSB_TYPE for name in free if plain_form(name)[0] == "type"}
    if plain >= HEARD:
        kinds |= {name: AGE for name in free if plain_form(name)[0] == "seen"}
    return kinds


def kinds_within(names: Iterable[str]) -> dict[str, Kind]:
    """What keys of objects in fields state of positions: each by itself, or behind the names of its field and object.

    The `type` of what has coordinates says what it is.
    """
    names = list(names)
    shapes = {name.rpartition(".")[0] for name in names if name.endswith((".coordinates", ".geometry")) or ".geometry." in name}
    kinds = {name: kind_of(plain_form(name.rpartition(".")[2])[0]) or kind_of(plain_form(name)[0]) for name in names}
    return {
        name: kind
        for name, kind in kinds.items()
        if kind is not None and not (name.endswith(".type") and name.rpartition(".")[0] in shapes)
    }


def _speed_without_unit(free: list[str]) -> str:
    """The first column of a name that is in use for a speed in several units."""
    plain, (speed,) = by_form(free), (quantity for quantity in QUANTITIES if quantity.name == "ground_speed_mps")
    names = (alias for alias, unit in speed.aliases.items() if unit == WRITTEN)
    return next((plain[alias] for alias in names if alias in plain), "")


_OF_PHONE = re.compile(r"(?:horizontal|vertical|speed|bearing|course|altitude)_accuracy(?:_.*)?")
"""Accuracies as the location services of Android, iOS and browsers name them, whose altitudes are in metres. Provenance: standard, from
knowledge of the interfaces."""


def _of_phone(columns: Mapping[str, Column], names: list[str]) -> dict[str, Column]:
    """An altitude in feet by its name alone beside two accuracies of a phone; its location service has it in metres."""
    altitude = columns.get("altitude_m")
    if altitude is None or altitude.unit != "ft" or altitude.unit_stated or not OF_TRANSPONDER.isdisjoint(map(parted_form, names)):
        return {}
    of_phone = [name for name in names if _OF_PHONE.fullmatch(parted_form(name)) or parted_form(name) == "accuracy"]
    if len(of_phone) < _LEAST_NAMES or not any(parted_form(name) != "accuracy" for name in of_phone):
        return {}
    beside = " and ".join(f"“{name}”" for name in of_phone[:_LEAST_NAMES])
    return {"altitude_m": replace(altitude, unit="m", because=f"as the names {beside} beside it are those of a phone")}


def _of_layouts(names: list[str]) -> dict[str, Column]:
    """What the columns are where a table has all names of a program that writes them in units of its own."""
    layouts = [
        layout for layout in (OPENSKY_VELOCITY, OPENSKY_STATES, FLIGHTRADAR24) if {name for name, _ in layout.values()} <= set(names)
    ]
    if set(names) >= DUMP1090 and "gs" not in names:
        layouts.append({"ground_speed_mps": DUMP1090_SPEED})
    if set(names) >= GARMIN:
        layouts.append({quantity: column for quantity, column in GARMIN_COLUMNS.items() if column[0] in names})
    columns = {
        quantity: Column(quantity, name, unit, unit_stated=set(names) >= GARMIN)
        for layout in layouts
        for quantity, (name, unit) in layout.items()
    }
    if set(names) >= GARMIN.union(GARMIN_TRACK):
        columns["ground_track_rad"] = Column("ground_track_rad", GARMIN_TRACK[0], "deg", unit_stated=True, variation=GARMIN_TRACK[1])
    return columns


_COMPARED = ("est_lat_rad", "est_lon_rad", "ground_speed_mps", "nac_p", "nic", "nuc_p", "pic")
"""Quantities of which further columns are compared with the one that is read."""


def _again(columns: Mapping[str, Column], times: Sequence[Column], declared: Container[str], free: list[str], path: Path) -> list[Column]:
    further, rest = list[Column](), list(free)
    for quantity in (q for q in QUANTITIES if q.name in _COMPARED and q.name in columns and q.name not in declared):
        while (column := _known(quantity, rest, path, own=False)) is not None:
            further.append(column)
            rest.remove(column.name)
    if len(times) == 1 and "time" not in declared:
        further += [column for column in known_times(rest)[:1] if column.unit not in WEEK]
    return further


_NAMES = frozenset(
    {"track", *TIME_NAMES, *(name for q in (*QUANTITIES, *LEVEL_QUANTITIES, *STATED_QUANTITIES) for name in (q.name, *q.aliases))}
)


def is_header(cells: Sequence[object]) -> bool:
    """Whether a row of a table holds names of columns and no numbers."""
    words = [str(cell) for cell in cells if cell not in (None, "")]
    return sum(plain_form(word)[0] in _NAMES or parted_form(word) in _NAMES for word in words if len(word) <= LONGEST_NAME) >= _LEAST_NAMES


_LEAST_NAMES = 2
"""Names of quantities in one row that make it a header: one may be a callsign. [1]"""


def _known(quantity: Quantity, names: list[str], path: Path, *, own: bool) -> Column | None:
    """Find the first known name, in the order of the aliases; ``own``: `track` is who flies, not whither, as in our own epoch table."""
    plain = by_form(names)
    if own and quantity.name in {"track", "ground_track_rad"}:
        plain = {k: v for k, v in plain.items() if (k == "track") == (quantity.name == "track")}
    elif quantity.name == "track":
        plain.pop("track", None)
    units = UNITS[quantity.si]
    for alias, unit in quantity.aliases.items():
        if alias in plain:
            written = written_unit(plain[alias], quantity, path)
            if unit == WRITTEN and written is None:
                continue
            return Column(quantity.name, plain[alias], written or unit, unit_stated=written is not None or alias.endswith(f"_{unit}"))
        # `hpl_nm` is `hpl` in nautical miles, whether or not the list names it so.
        for ending in units if quantity.si not in {"1", "time", "text"} else ():
            if f"{alias}_{ending}" in plain:
                return Column(quantity.name, plain[f"{alias}_{ending}"], ending, unit_stated=True)
    return None


def _declared(key: str, value: str, names: list[str], path: Path, known: tuple[Quantity, ...]) -> Column:
    quantities = {q.name: q for q in known}
    name, unit = column_named(value, names)
    if name not in names:
        short = [n for n in names if len(n) <= LONGEST_NAME]
        near = ", ".join(difflib.get_close_matches(name[:LONGEST_NAME], short, 3, 0.5)) or ", ".join(short[:12])
        raise FormatError(path, f"there is no column “{name}”; found: {near}", 1, key)
    if key in {"time", "time_ns"}:
        unit = unit or TIME_NAMES.get(plain_form(name)[0], "utc" if key == "time" else "gps_ns")
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
        raise InputError("columns", key, domain=f"known quantities: time, {', '.join((*WEEK, *DAY, *hemispheres.STATED, *quantities))}")
    q = quantities[key]
    stated = unit or written_unit(name, q, path)
    unit = stated or q.aliases.get(plain_form(name)[0], q.si)
    if q.si != "text" and unit.lower() not in UNITS[q.si]:
        raise InputError("columns", value, domain=f"units of {key}: {', '.join(u for u in UNITS[q.si] if u)}")
    return Column(key, name, unit.lower(), unit_stated=bool(stated))
