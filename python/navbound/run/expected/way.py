"""The way of a plan that names procedures: waypoints, the name of each leg, and the RNP of each as published."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound import path, procedures
from navbound.errors import FormatError, NavboundError
from navbound.path import lengths
from navbound.procedures.legs import STATES
from navbound.procedures.names import parts
from navbound.units import METRES_PER_NM

if TYPE_CHECKING:
    from pathlib import Path

    from navbound.procedures import Database, Leg, Procedure
    from navbound.records.run import Waypoint
    from navbound.scenario.models import Phase
    from navbound.scenario.plan import PlannedProcedure

CORNER_RAD = math.radians(30.0)
"""Most of an arc that is one turn of the path: larger ones are several turns of one radius. Provenance: ours. [rad]"""
LOOSE = 1e-6
"""The turns of an arc are so much narrower than published: turns that touch in one point fit then whatever the rounding. Ours. [1]"""
SAME_M = 1.0
"""Points nearer than this are one. Provenance: ours. [m]"""
STAND_IN_M = METRES_PER_NM
"""What the simulator takes for a leg without an RNP; nothing is judged by it. [m]"""
JOIN = "not published"
"""Phase of a leg that joins what the plan names."""


@dataclass
class Way:
    """Points in the order flown.

    Attributes
    ----------
    waypoints : list of dict
        As a scenario has them, their names all different.
    legs : list of str
        Name of the leg between each two of them; the corners of an arc share it.
    requirements : list of (str, float)
        Phase and RNP of each; NaN where it is not known. [m]
    words : list of str
        What the reader must know of the path.
    """

    waypoints: list[dict[str, Any]] = field(default_factory=list)
    legs: list[str] = field(default_factory=list)
    requirements: list[tuple[str, float]] = field(default_factory=list)
    words: list[str] = field(default_factory=list)

    def add(self, name: str, place: tuple[float, float], leg: str, requirement: tuple[str, float], radius_m: float | None = None) -> None:
        """Go on to a point; nothing where the way is there already."""
        if self.waypoints and self.to_m(*place) < SAME_M:
            return
        if self.waypoints:
            self.legs.append(leg)
            self.requirements.append(requirement)
        taken = {w["name"] for w in self.waypoints}
        unique = next(n for n in (name, *(f"{name} ({k})" for k in range(2, len(taken) + 3))) if n not in taken)
        self.waypoints.append({"name": unique, "lat_rad": place[0], "lon_rad": place[1], "kind": "waypoint", "radius_m": radius_m})

    def to_m(self, lat_rad: float, lon_rad: float) -> float:
        """Distance from the last point. [m]."""
        last = self.waypoints[-1]
        from_rad, to_rad = (last["lat_rad"], last["lon_rad"]), (lat_rad, lon_rad)
        return lengths.chord_m(from_rad, to_rad)

    @property
    def last(self) -> str:
        """Name of the last point."""
        return str(self.waypoints[-1]["name"])

    def phases(self) -> tuple[list[dict[str, Any]], frozenset[int]]:
        """Phases of a scenario, and which of them have no RNP."""
        phases, unknown = list[dict[str, Any]](), set[int]()
        for k, (name, rnp_m) in enumerate(self.requirements):
            end = self.waypoints[k + 1]["name"]
            if phases and _same(self.requirements[k - 1], (name, rnp_m)):
                phases[-1]["until_waypoint"] = end
                continue
            if not math.isfinite(rnp_m):
                unknown.add(len(phases))
            phases.append({"name": name, "rnp_m": rnp_m if math.isfinite(rnp_m) else STAND_IN_M, "until_waypoint": end})
        phases[-1]["until_waypoint"] = None
        return phases, frozenset(unknown)


def _same(a: tuple[str, float], b: tuple[str, float]) -> bool:
    return a[0] == b[0] and (a[1] == b[1] or (math.isnan(a[1]) and math.isnan(b[1])))


def way(file: str | Path, folder: Path, named: list[PlannedProcedure], route: list[Waypoint], requirements: list[Phase] | None) -> Way:
    """Departures, then the route, then arrivals and approaches.

    Parameters
    ----------
    file : str or Path
        The plan, for errors.
    folder : Path
        Where its files are.
    named : list of PlannedProcedure
        Procedures in the order flown.
    route : list of Waypoint
        Points of the route; may be empty.
    requirements : list of Phase, optional
        RNP of the route.

    Raises
    ------
    FormatError
        A procedure that the database does not have, a leg that is no path, or parts in another order.
    """
    whole, is_en_route = Way(), False
    bases: dict[str, Database] = {}
    for index, one in enumerate(named):
        key = f"procedures[{index}]"
        procedure = _loaded(file, folder, one, key, bases)
        if procedure.kind != "sid" and not is_en_route:
            is_en_route = True
            _follow_route(file, whole, route, requirements)
        elif procedure.kind == "sid" and is_en_route:
            raise FormatError(file, f"{one.name!r} is a departure; departures come before arrivals and approaches", field=f"{key}.name")
        _follow(file, whole, procedure, f"{key}.name")
    if not is_en_route:
        _follow_route(file, whole, route, requirements)
    if len(whole.waypoints) < 2:
        raise FormatError(file, "has no leg with a path", field="procedures")
    return whole


def _loaded(file: str | Path, folder: Path, one: PlannedProcedure, key: str, bases: dict[str, Database]) -> Procedure:
    beside = folder / one.database
    try:
        airport, ident, transition = parts(one.name)
        if one.database not in bases:
            bases[one.database] = procedures.read(beside)
        return bases[one.database].procedure(airport, ident, transition, line=one.line, defaults=one.defaults)
    except FormatError as e:
        raise FormatError(file, str(e), field=f"{key}.database") from e
    except NavboundError as e:
        raise FormatError(file, str(e), field=key) from e


def _follow_route(file: str | Path, whole: Way, route: list[Waypoint], requirements: list[Phase] | None) -> None:
    """The route, under the requirements of the plan."""
    if not route:
        if requirements:
            raise FormatError(file, "are for a route; the legs of procedures have their own RNP", field="requirements")
        return
    left = list(requirements or [])
    if not left:
        raise FormatError(file, "is missing: the route outside the procedures has requirements of its own", field="requirements")
    for index, phase in enumerate(left):
        until = phase.until_waypoint
        if phase.until_before_end_m is not None:
            raise FormatError(
                file, "is a place before the end; beside procedures name a waypoint", field=f"requirements[{index}].until_before_end"
            )
        if until is not None and until not in {w.name for w in route}:
            raise FormatError(file, f"{until!r} is not a waypoint of the route", field=f"requirements[{index}].until_waypoint")
        if (until is None) != (index == len(left) - 1):
            raise FormatError(file, "the last requirement, and no other, lasts to the end of the route", field=f"requirements[{index}]")
    joined = bool(whole.waypoints)
    for point in route:
        name = whole.last if whole.waypoints else ""
        published = joined and point is route[0]
        whole.add(
            point.name,
            (point.lat_rad, point.lon_rad),
            f"{name}-{point.name}",
            (JOIN, math.nan) if published else (left[0].name, left[0].rnp_m),
        )
        if left[0].until_waypoint == point.name:
            left.pop(0)


def _follow(file: str | Path, whole: Way, procedure: Procedure, key: str) -> None:
    """The legs of a procedure, from fix to fix."""
    name = procedure.name
    for k, leg in enumerate(procedure.legs):
        if leg.state == "holding":
            whole.words.append(f"The hold at {leg.fix} of {name} is not flown.")
        elif leg.state == "point" and leg.lat_rad is not None and leg.lon_rad is not None:
            _join(whole, leg.fix, leg.lat_rad, leg.lon_rad, name)
        elif leg.has_path and math.isfinite(leg.length_m):
            _leg(whole, procedure, k, leg)
        else:
            what = f"leg {leg.sequence:03d} ({leg.fix or '-'} {leg.terminator}) of {name}: {STATES[leg.state]}"
            raise FormatError(file, f"{what}; a plan flies from fix to fix: name the waypoints of this part in a route", field=key)
    unknown = [leg for leg in procedure.legs if leg.has_path and not math.isfinite(leg.rnp_m)]
    if unknown:
        named = ", ".join(leg.fix or leg.terminator for leg in unknown)
        whole.words.append(f"{len(unknown)} legs of {name} have no RNP ({named}): they are not judged.")
    whole.words += [*procedure.notes, *procedure.doubts]


def _join(whole: Way, fix: str, lat_rad: float, lon_rad: float, name: str) -> None:
    """The first fix of a procedure, by a straight leg from where the way is."""
    if whole.waypoints and (apart_m := whole.to_m(lat_rad, lon_rad)) >= SAME_M:
        whole.words.append(
            f"{name} begins {apart_m / METRES_PER_NM:.2f} NM from {whole.last}: the leg between them is not published, has no RNP and is "
            "not judged."
        )
    whole.add(fix, (lat_rad, lon_rad), f"{whole.last if whole.waypoints else ''}-{fix}", (JOIN, math.nan))


def _leg(whole: Way, procedure: Procedure, k: int, leg: Leg) -> None:
    """A straight leg by its end, an arc by the corners of a path whose turns are the arc; its ends are corners, as it has no room there."""
    begin = procedure.core.at(k, np.zeros(1))
    fix = leg.fix or leg.terminator
    _join(whole, f"begin of {fix}", float(begin["lat_rad"][0]), float(begin["lon_rad"][0]), f"The leg to {fix} of {procedure.name}")
    title, requirement = f"{whole.last}-{fix}", (leg.part, leg.rnp_m)
    if leg.state != "full":
        whole.words.append(f"The leg to {fix} of {procedure.name}: {STATES[leg.state]}.")
    radius_m = leg.radius_m or 0.0
    turn = leg.length_m / radius_m if radius_m else 0.0
    n = math.ceil(turn / CORNER_RAD - 1e-9)
    if n:
        whole.waypoints[-1]["radius_m"] = 0.0
        step_m = leg.length_m / n
        at = procedure.core.at(k, np.arange(n, dtype=np.float64) * step_m)
        # The tangents of two points of an arc meet at this distance from each.
        tangent_m = lengths.tangent_m(radius_m, turn / n)
        for j in range(n):
            corner = path.from_azimuth(float(at["lat_rad"][j]), float(at["lon_rad"][j]), float(at["course_rad"][j])).at(tangent_m)
            whole.add(f"{fix} arc {j + 1}", (float(corner.lat_rad), float(corner.lon_rad)), title, requirement, radius_m * (1 - LOOSE))
    end = procedure.core.at(k, np.array([leg.length_m]))
    whole.add(fix, (float(end["lat_rad"][0]), float(end["lon_rad"][0])), title, requirement, 0.0 if n else None)
