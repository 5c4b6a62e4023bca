"""What a plan means: the scenario that is flown without errors, the satellites, and when something is not there."""

from __future__ import annotations

import itertools
import json
from dataclasses import dataclass
from datetime import timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import ValidationError

from navbound import _core, gnss
from navbound.errors import FormatError, InputError, NotFoundError
from navbound.maps.sources import NS, Times, satellites
from navbound.read.routes import load_route
from navbound.records.prediction import Outage
from navbound.run.expected.service import Service, service
from navbound.run.expected.way import Way, way
from navbound.scenario import Scenario, load
from navbound.scenario.models import GPS_EPOCH
from navbound.scenario.plan import FTE_95_NM, Plan, Window
from navbound.scenario.sensors import with_grade
from navbound.scenario.units import to_si
from navbound.time import gps_ns
from navbound.units import METRES_PER_NM

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

RATE_HZ = 10
"""Samples of the inertial unit of the flight without errors; what that changes is in docs/methods/prediction.md."""
SAMPLES_PER_STEP = 10
"""The covariance is moved once a second."""


@dataclass(frozen=True)
class Setup:
    """A plan that can be predicted.

    Attributes
    ----------
    scenario : Scenario
        With the outages as faults; what a flight of the plan flies.
    orbits : Orbits
        Satellites that exist, whether in service or not.
    since_s : float
        Departure after the reference instant of the orbits. [s]
    dated : bool
        Whether the departure is an instant of the clock.
    from_files : bool
        Whether the orbits were stated in the plan.
    windows : list of Outage
        When what is not there.
    warnings : list of str
        What the reader must know.
    fte_95_m : tuple of float
        En route and on approach. [m]
    legs : list of str
        Name of the leg between each two waypoints of the scenario.
    without_rnp : frozenset of int
        Phases of the scenario whose RNP nobody has stated.
    path_words : list of str
        What the reader must know of the path.
    sbas : Service, optional
        What the levels rest on where they are those of SBAS.
    """

    plan: Plan
    scenario: Scenario
    orbits: gnss.Orbits
    since_s: float
    dated: bool
    from_files: bool
    windows: list[Outage]
    warnings: list[str]
    fte_95_m: tuple[float, float]
    legs: list[str]
    without_rnp: frozenset[int]
    path_words: list[str]
    sbas: Service | None

    def sensors(self, **changed: Any) -> _core.Sensors:
        """The sensors of the flight without errors."""
        text = _quiet(self.scenario, **changed)
        if not self.from_files:
            return _core.Sensors(text, None)
        return _core.Sensors.of_orbits(text, list(self.orbits.satellite), self.orbits.elements(), self.since_s)

    def systems(self) -> str:
        """Letters of the constellations that the monitor uses."""
        if self.plan.equipment.monitor_systems is not None:
            return self.plan.equipment.monitor_systems
        gnss_on_board = self.scenario.sensors.gnss if self.scenario.sensors else None
        if self.plan.equipment.monitor == "raim" or self.sbas is not None or gnss_on_board is None:
            return "G"
        return "".join(dict.fromkeys(_LETTERS[name] for name in gnss_on_board.constellations))


_LETTERS = {"gps": "G", "gps-expanded": "G", "galileo": "E", "beidou": "C"}


def setup(file: str | Path, plan: Plan) -> Setup:
    """Join a plan with its scenario, route, satellites and notices.

    Raises
    ------
    FormatError
        What the plan says does not fit together: file, key and what is allowed.
    """
    folder = Path(file).parent
    base = _base(file, folder, plan)
    table = base.model_dump(mode="python")
    _equip(file, table, plan)
    flown = _lay_route(file, folder, table, plan)
    _lay_heights(table, plan)
    orbits, start_ns, since_s = _orbits(file, folder, plan, table)
    table["start_gps"] = GPS_EPOCH + timedelta(microseconds=start_ns // 1000)
    clear = _checked(file, table | {"faults": []}, [])
    windows, warnings = _windows(file, plan, clear, start_ns, orbits)
    warnings += _not_in_orbits(table, orbits)
    during = [w for w in windows if w.start_s < clear.duration_s and w.end_s > 0]
    scenario = _checked(file, table | {"faults": []}, [_fault(w) for w in during])
    fte = [nm * METRES_PER_NM for nm in FTE_95_NM[plan.equipment.steering]]
    own = plan.equipment.fte_95_m
    fte_95_m = (fte[0], fte[1]) if own is None else (own, own)
    return Setup(
        plan=plan,
        scenario=scenario,
        orbits=orbits,
        since_s=since_s,
        dated=plan.departure_utc is not None,
        from_files=bool(plan.orbits),
        windows=windows,
        warnings=warnings,
        fte_95_m=fte_95_m,
        legs=[f"{a.name}-{b.name}" for a, b in itertools.pairwise(scenario.waypoints)] if flown is None else flown.legs,
        without_rnp=frozenset() if flown is None else flown.phases()[1],
        path_words=_path_words(plan, flown),
        sbas=None if plan.sbas is None else service(file, folder, plan.sbas, start_ns),
    )


def _path_words(plan: Plan, flown: Way | None) -> list[str]:
    if flown is None:
        return []
    parts = [f"procedure {one.name} of {one.database}{f', line {one.line}' if one.line else ''}" for one in plan.procedures]
    return [
        f"Path: {', '.join([*([plan.route] if plan.route else []), *parts])}. Fixes are flown by, arcs are as published; "
        "the vertical profile is the scenario's, not the published altitudes.",
        *flown.words,
    ]


def _not_in_orbits(table: dict[str, Any], orbits: gnss.Orbits) -> list[str]:
    receiver = table["sensors"]["gnss"]
    there = {name[0] for name in orbits.satellite}
    absent = [] if receiver is None else [name for name in receiver["constellations"] if _LETTERS[name] not in there]
    return [f"The orbits have no satellite of {', '.join(absent)}: the prediction is without them."] if absent else []


def _base(file: str | Path, folder: Path, plan: Plan) -> Scenario:
    beside = folder / plan.flight
    try:
        base = load(beside if beside.is_file() else plan.flight)
    except NotFoundError as e:
        raise FormatError(file, f"{plan.flight!r} is neither a shipped scenario nor a file beside the plan", field="flight") from e
    if base.sensors is None or base.filter is None:
        raise FormatError(file, f"{plan.flight!r} has no [sensors] and [filter]: nothing to predict", field="flight")
    return base


def _equip(file: str | Path, table: dict[str, Any], plan: Plan) -> None:
    sensors, equipment = table["sensors"], plan.equipment
    if equipment.inertial is not None:
        graded = with_grade({"sensors": {"imu": {"grade": equipment.inertial}}})
        sensors["imu"] = to_si(graded, {})["sensors"]["imu"]
    if sensors["gnss"] is not None:
        if equipment.constellations is not None:
            if not equipment.constellations:
                raise FormatError(
                    file, 'names no constellation; without = ["gnss"] leaves the receiver out', field="equipment.constellations"
                )
            sensors["gnss"]["constellations"] = equipment.constellations
        if equipment.mask_rad is not None:
            sensors["gnss"]["mask_rad"] = equipment.mask_rad
    for name in equipment.without:
        sensors[name] = None
    if plan.stations is not None:
        sensors["stations"] = [s.model_dump() for s in plan.stations]
    sensors["faults"] = []


def _lay_heights(table: dict[str, Any], plan: Plan) -> None:
    """Heights of the plan; the end of the initial climb moves with the departure."""
    profile = table["profile"]
    if plan.departure_height_m is not None:
        higher_m = plan.departure_height_m - profile["departure_height_m"]
        for name in ("departure_height_m", "initial_climb_height_m"):
            profile[name] += higher_m
    for name, value in (("cruise_height_m", plan.cruise_height_m), ("arrival_height_m", plan.arrival_height_m)):
        if value is not None:
            profile[name] = value


def _lay_route(file: str | Path, folder: Path, table: dict[str, Any], plan: Plan) -> Way | None:
    """Lay the plan's own path, where it has one; that of procedures is returned."""
    if plan.duration_s is not None:
        table["duration_s"] = plan.duration_s
    if plan.procedures:
        if plan.duration_s is None:
            raise FormatError(file, "is missing: a path of its own has a time of its own", field="duration_s")
        points = load_route(folder / plan.route).waypoints if plan.route else []
        flown = way(file, folder, plan.procedures, points, plan.requirements)
        table["waypoints"], table["phases"] = flown.waypoints, flown.phases()[0]
        return flown
    if plan.requirements is not None:
        table["phases"] = [p.model_dump() for p in plan.requirements]
    if plan.route is None:
        return None
    for key, value in (("duration_s", plan.duration_s), ("requirements", plan.requirements)):
        if value is None:
            raise FormatError(file, "is missing: a route of its own has a time and requirements of its own", field=key)
    waypoints = load_route(folder / plan.route).waypoints
    table["waypoints"] = [{"name": w.name, "lat_rad": w.lat_rad, "lon_rad": w.lon_rad, "kind": "waypoint"} for w in waypoints]
    return None


def _orbits(file: str | Path, folder: Path, plan: Plan, table: dict[str, Any]) -> tuple[gnss.Orbits, int, float]:
    """Satellites, GPS time of the departure, and that time after the orbits' instant."""
    departure = None if plan.departure_utc is None else gps_ns(plan.departure_utc)
    scenario_ns = (table["start_gps"] - GPS_EPOCH) // timedelta(microseconds=1) * 1000
    receiver = table["sensors"]["gnss"]
    if not plan.orbits:
        if departure is not None:
            raise FormatError(file, "needs orbits of a date: an almanac or a navigation file", field="departure_utc")
        names = ["gps"] if receiver is None else receiver["constellations"]
        nominal = satellites(names, Times(None, 60.0, 60.0), 0.0, 0.0).orbits
        # Nominal orbits count from the begin of GPS time, as a flight of the scenario has them.
        return nominal, scenario_ns, scenario_ns / NS
    names = [str(folder / name) if (folder / name).is_file() else name for name in plan.orbits]
    length = max(60.0, float(table["duration_s"]))
    try:
        sky = satellites(names, Times(departure, length, length), 0.0, 0.0)
    except InputError as e:
        key = "departure_utc" if e.argument in {"start_ns", "near_ns"} else "orbits"
        value = plan.departure_utc if key == "departure_utc" else e.value
        raise FormatError(file, f"{value} is not accepted; expected {e.domain}", field=key) from e
    start_ns = departure if departure is not None else sky.orbits.reference_ns
    if start_ns is None:
        return sky.orbits, scenario_ns, 0.0
    return sky.orbits, start_ns, float(sky.time_s[0])


def _checked(file: str | Path, table: dict[str, Any], faults: list[dict[str, Any]]) -> Scenario:
    table = table | {"sensors": table["sensors"] | {"faults": faults}}
    try:
        scenario = Scenario.model_validate(table)
        scenario.check()
    except ValidationError as e:
        error = e.errors()[0]
        raise FormatError(file, error["msg"], field=".".join(map(str, error["loc"]))) from e
    except InputError as e:
        turn = e.index if e.argument == "radius_m" else None
        where = "" if turn is None else f" (the turn at {table['waypoints'][turn]['name']})"
        raise FormatError(file, f"the flight of the plan: {e}{where}") from e
    return scenario


def _windows(file: str | Path, plan: Plan, scenario: Scenario, start_ns: int, orbits: gnss.Orbits) -> tuple[list[Outage], list[str]]:
    """When what is not there, and what is strange about it."""
    clock = _Clock(file, scenario, start_ns)
    warnings: list[str] = []
    windows: list[Outage] = []
    for index, window in enumerate(plan.jamming):
        begin, end = clock.of(window, f"jamming[{index}]")
        if _open(window):
            warnings.append(f"Jamming from {begin / 60:.0f} min has no end: it is taken to last to the end of the flight.")
        windows.append(Outage(what="jamming", names=[], start_s=begin, end_s=end))
    stations = {s.name for s in scenario.sensors.stations} if scenario.sensors else set()
    for index, notice in enumerate(plan.notices):
        begin, end = clock.of(notice, f"notices[{index}]")
        satellites_out = _known(notice.satellites, set(orbits.satellite), "orbits", warnings)
        stations_out = _known(notice.stations, stations, "stations of the plan", warnings)
        if satellites_out:
            windows.append(Outage(what="satellites", names=satellites_out, start_s=begin, end_s=end))
        if stations_out:
            windows.append(Outage(what="stations", names=stations_out, start_s=begin, end_s=end))
    for away in (w for w in windows if not w.start_s < scenario.duration_s or not w.end_s > 0):
        named = f" of {', '.join(away.names)}" if away.names else ""
        span = f"{away.start_s / 60:.0f} to {away.end_s / 60:.0f} min after departure"
        warnings.append(f"What is not there{named} from {span} is not during the flight.")
    return windows, warnings


def _open(window: Window) -> bool:
    return window.until_s is None and window.until_utc is None and window.until_along_m is None


def _known(names: Sequence[str], known: set[str], where: str, warnings: list[str]) -> list[str]:
    for name in names:
        if name not in known:
            warnings.append(f"A notice names {name}, which is not among the {where}: it changes nothing.")
    return [name for name in names if name in known]


def _fault(window: Outage) -> dict[str, Any]:
    begin = max(window.start_s, 0.0)
    times = {"start_s": begin, "duration_s": window.end_s - begin}
    match window.what:
        case "jamming":
            return {"kind": "interference", **times}
        case "satellites":
            return {"kind": "satellite-outage", "satellites": window.names, **times}
        case "stations":
            return {"kind": "station-outage", "stations": window.names, **times}


class _Clock:
    """Windows in seconds after the departure."""

    def __init__(self, file: str | Path, scenario: Scenario, start_ns: int) -> None:
        self.file, self.scenario, self.start_ns = file, scenario, start_ns
        self._along: NDArray[np.float64] | None = None

    def of(self, window: Window, key: str) -> tuple[float, float]:
        """Begin and end; without a begin the whole flight."""
        end = self.scenario.duration_s
        if window.from_utc is not None:
            begin = (gps_ns(window.from_utc) - self.start_ns) / NS
            return begin, max(begin, end) if window.until_utc is None else (gps_ns(window.until_utc) - self.start_ns) / NS
        if window.from_along_m is not None:
            until = window.until_along_m
            return self._when(window.from_along_m, f"{key}.from_along"), end if until is None else self._when(until, f"{key}.until_along")
        if window.from_s is None:
            return 0.0, end
        return window.from_s, max(window.from_s, end) if window.until_s is None else window.until_s

    def _when(self, along_m: float, key: str) -> float:
        if self._along is None:
            # A flight without a filter takes hundredths of a second.
            self._along = _core.Outlook(self.scenario.model_copy(update={"filter": None}).core_json()).fly(0, 0, 1)["along_m"]
        along = self._along
        if not along_m <= along[-1]:
            raise FormatError(self.file, f"{along_m:.0f} m is beyond the end of the route, {along[-1]:.0f} m", field=key)
        return float(np.argmax(along >= along_m))


def _quiet(scenario: Scenario, **changed: Any) -> str:
    """The scenario for the flight without errors, for the core.

    Without noise the inertial unit repeats itself, which an envelope takes for frozen. The filter without satellites, which only judges
    the main one, has nothing to say.
    """
    data = json.loads(scenario.core_json())
    data["sensors"] |= {"rate_hz": RATE_HZ, "path": "planned", "envelope": None}
    data["filter"] |= {"samples_per_step": SAMPLES_PER_STEP, "reversion": False}
    data["sensors"] |= changed
    return json.dumps(data)
