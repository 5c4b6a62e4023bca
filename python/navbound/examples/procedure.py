"""An approach that nobody has published, to an airport in the sea: a navigation database of ARINC 424, and a flight along it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import polars as pl

from navbound import path
from navbound.examples import tracks
from navbound.run import flight
from navbound.run.expected.way import way
from navbound.scenario import load
from navbound.scenario.models import Phase, Waypoint
from navbound.scenario.plan import PlannedProcedure
from navbound.table.columns import COVARIANCE
from navbound.units import METRES_PER_FT, METRES_PER_NM

if TYPE_CHECKING:
    from datetime import datetime
    from pathlib import Path

DATABASE = "procedure.txt"
AIRPORT, IDENT, RUNWAY = "XNAV", "H27", "RW27"
THRESHOLD = (math.radians(45.0), math.radians(-5.0))
"""In the Bay of Biscay: nobody takes it for an airport."""
ELEVATION_FT, CROSSING_FT, UNDULATION_M = 300, 50, 49.0
FINAL_NM, STRAIGHT_NM, RADIUS_NM, ENTRY_NM = 5.18, 1.0, 3.0, 5.0
"""Final part, straight part before it, arc of a right angle, straight part to it: with 3 degrees the final begins at 2,000 ft."""
WRONG_NM = 3.3
"""Coded radius of the arc from the south, which its fixes contradict."""
APPROACH, BEFORE_NM = "XNAV/H27:NORTH", 75.0
"""What is flown, and from how far before its first fix."""
CRUISE_M = 4000.0
LAST_NM, STEP_S = 15.5, 2
"""What is recorded: from half a mile behind the first fix on, and every how many seconds."""
_COLUMNS = 132


@dataclass(frozen=True)
class Fix:
    """A named point."""

    name: str
    lat_rad: float
    lon_rad: float


def fixes() -> dict[str, Fix]:
    """The points of the approach: it lands westwards, and its two ways in come from the north and from the south."""
    at = {RUNWAY: THRESHOLD}

    def put(name: str, origin: str, azimuth_deg: float, nm: float) -> None:
        place = path.from_azimuth(*at[origin], math.radians(azimuth_deg)).at(nm * METRES_PER_NM)
        at[name] = float(place.lat_rad), float(place.lon_rad)

    put("FINAL", RUNWAY, 90.0, FINAL_NM)
    put("LATER", RUNWAY, 90.0, FINAL_NM + STRAIGHT_NM)
    for way_in, centre, begin, azimuth_deg in (("NORTH", "CFNOR", "BOUND", 0.0), ("SOUTH", "CFSOU", "LIMIT", 180.0)):
        put(centre, "LATER", azimuth_deg, RADIUS_NM)
        put(begin, centre, 90.0, RADIUS_NM)
        put(way_in, begin, azimuth_deg, ENTRY_NM)
    return {name: Fix(name, *place) for name, place in at.items()}


def database() -> str:
    """The records: fixed columns of ARINC 424-18; one arc has a radius that its fixes contradict."""
    at = fixes()
    threshold = at.pop(RUNWAY)
    lines = [_record("A", {14: "XNV", 22: "0", 28: "098YHN", 33: _place(threshold), 52: "E0000", 57: f"{ELEVATION_FT:05d}", 86: "MNAR"})]
    lines += [
        _record("C", {14: name, 20: "XX0", 27: "W", 33: _place(fix), 75: "E0000", 85: "NAR", 99: name}) for name, fix in sorted(at.items())
    ]
    level = round(10.0 * (ELEVATION_FT * METRES_PER_FT + UNDULATION_M))
    heights = f"{level:+06d}{ELEVATION_FT:05d}0000{CROSSING_FT}150"
    lines.append(_record("G", {14: RUNWAY, 22: "0098002700", 33: _place(threshold), 61: heights}))
    length = round(5.0 * math.pi * RADIUS_NM)
    for way_in, begin, turn, radius_nm, course in (("NORTH", "BOUND", "R", RADIUS_NM, 1800), ("SOUTH", "LIMIT", "L", WRONG_NM, 0)):
        arc = {44: turn, 57: f"{round(1000 * radius_nm):06d}", 63: f"{course:04d}", 71: f"2700{length:04d}", 107: f"CF{way_in[:3]} XXPC"}
        lines += [
            _leg(f"A{way_in}", 10, way_in, {42: "B", 48: "IF", 85: "03500"}),
            _leg(f"A{way_in}", 20, begin, {45: "010TF", 83: "+ 03000"}),
            _leg(f"A{way_in}", 30, "LATER", {45: "010RF", 83: "+ 02200"} | arc),
            _leg(f"A{way_in}", 40, "FINAL", {41: "E", 45: "010TF", 83: "+ 02000"}),
        ]
    return _numbered(
        [
            *lines,
            _leg("H", 20, "FINAL", {43: "F", 48: "IF", 83: "+ 02000", 107: f"{RUNWAY}  XXPG"}),
            _leg("H", 20, "FINAL", {39: "2W", 89: "A031"}),
            _leg("H", 30, RUNWAY, {41: "Y M", 45: "031TF", 85: f"{ELEVATION_FT + CROSSING_FT:05d}", 103: "-300"}),
        ]
    )


def _record(subsection: str, fields: dict[int, str]) -> str:
    """Fields by their first column, counted from 1."""
    line = [" "] * _COLUMNS
    for first, text in ({1: "STST", 5: "P", 7: AIRPORT, 11: "XX", 13: subsection} | fields).items():
        line[first - 1 : first - 1 + len(text)] = text
    return "".join(line)


def _leg(route: str, sequence: int, fix: str, fields: dict[int, str]) -> str:
    table = "PG" if fix == RUNWAY else "PC"
    names = {14: IDENT, 20: route, 27: f"{sequence:03d}", 30: fix, 35: f"XX{table}0", 118: "A FS"}
    return _record("F", names | fields)


def _numbered(lines: list[str]) -> str:
    """With the number of each record, and the cycle."""
    return "".join(f"{line[:123]}{number:05d}2603\n" for number, line in enumerate(lines, 1))


def _place(fix: Fix) -> str:
    """Degrees, minutes, hundredths of a second."""

    def written(angle_rad: float, signs: str, digits: int) -> str:
        hundredths = round(abs(math.degrees(angle_rad)) * 360_000)
        degrees, rest = divmod(hundredths, 360_000)
        minutes, rest = divmod(rest, 6_000)
        return f"{signs[angle_rad < 0]}{degrees:0{digits}d}{minutes:02d}{rest:04d}"

    return written(fix.lat_rad, "NS", 2) + written(fix.lon_rad, "EW", 3)


def track(folder: Path, begin: datetime, seed: int) -> pl.DataFrame:
    """Positions every two seconds of the end of a flight along the approach of the database in a folder, with their covariance."""
    flown = way(DATABASE, folder, [PlannedProcedure(database=DATABASE, name=APPROACH)], [], None)
    base = load("beijing-shanghai-drawn")
    first = flown.waypoints[0]
    far = path.from_azimuth(first["lat_rad"], first["lon_rad"], 0.0).at(BEFORE_NM * METRES_PER_NM)
    begun = {"name": "BEGIN", "lat_rad": float(far.lat_rad), "lon_rad": float(far.lon_rad), "kind": "waypoint"}
    level_m = ELEVATION_FT * METRES_PER_FT + UNDULATION_M
    crossing_m = level_m + CROSSING_FT * METRES_PER_FT
    scenario = base.model_copy(
        update={
            "operation": "approach",
            "title": APPROACH,
            "start_gps": begin,
            "duration_s": 1200.0,
            "waypoints": [Waypoint.model_validate(point) for point in (begun, *flown.waypoints)],
            "profile": base.profile.model_copy(
                update={"departure_height_m": level_m, "arrival_height_m": crossing_m, "cruise_height_m": CRUISE_M}
            ),
            "phases": [Phase(name="approach", rnp_m=METRES_PER_NM)],
        }
    )
    epochs, _ = flight.Flights(scenario.model_dump_json(), seed)(range(1))
    covariance = [pl.col(name).round(3) for name in COVARIANCE]
    rows = tracks.last_miles(epochs, STEP_S, LAST_NM).with_columns(tracks.utc())
    return rows.select("time", *tracks.place("est"), "ground_speed_kt", "vertical_rate_fpm", *covariance)
