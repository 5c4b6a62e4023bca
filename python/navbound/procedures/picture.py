"""What a picture of a procedure shows: the plan in metres east and north of its middle, and the profile along it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from navbound.units import EARTH_RADIUS_M

if TYPE_CHECKING:
    from navbound.procedures.legs import Leg, Procedure

ARC_STEP_M = 200.0
OPEN_M = 5_000.0
"""Of a leg without an end so much is drawn (ours). [m]"""


@dataclass(frozen=True)
class Line:
    """One leg in the plan.

    Attributes
    ----------
    leg : int
        Index in ``Procedure.legs``.
    east_m, north_m : ndarray
        Its points. [m]
    open_end : bool
        Whether it goes on.
    """

    leg: int
    east_m: np.ndarray
    north_m: np.ndarray
    open_end: bool


@dataclass(frozen=True)
class Mark:
    """A fix in plan and profile.

    Attributes
    ----------
    name : str
        Fix.
    east_m, north_m : float
        Where. [m]
    along_m : float
        Distance along the procedure where its leg ends; NaN where it is not defined. [m]
    altitude_m : float
        The first coded altitude; NaN without one. [m]
    altitude : str
        As coded, with its description.
    """

    name: str
    east_m: float
    north_m: float
    along_m: float
    altitude_m: float
    altitude: str


@dataclass(frozen=True)
class Picture:
    """Plan and profile.

    Attributes
    ----------
    lines : list of Line
        Legs with a path.
    marks : list of Mark
        Fixes, in the order flown.
    """

    lines: list[Line]
    marks: list[Mark]


def picture(procedure: Procedure) -> Picture:
    """Plan and profile of a procedure.

    Parameters
    ----------
    procedure : Procedure
        From :func:`navbound.path.procedure`.
    """
    places = [(x.lat_rad, x.lon_rad) for x in procedure.legs if x.lat_rad is not None and x.lon_rad is not None]
    if not places:
        return Picture([], [])
    lat0, lon0 = np.mean([p[0] for p in places]), places[0][1]

    def plan(lat_rad: np.ndarray, lon_rad: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        # Longitudes across 180 degrees stay beside each other.
        east = (lon_rad - lon0 + math.pi) % math.tau - math.pi
        return EARTH_RADIUS_M * math.cos(lat0) * east, EARTH_RADIUS_M * (lat_rad - lat0)

    lines = []
    for k, leg in enumerate(procedure.legs):
        if leg.has_path and leg.length_m > 0:
            length = leg.length_m if math.isfinite(leg.length_m) else OPEN_M
            n = max(2, math.ceil(length / ARC_STEP_M)) if leg.radius_m else 2
            at = procedure.core.at(k, np.linspace(0.0, length, n))
            lines.append(Line(k, *plan(at["lat_rad"], at["lon_rad"]), open_end=not math.isfinite(leg.length_m)))
    marks = [_mark(leg, plan) for leg in procedure.legs if leg.lat_rad is not None]
    return Picture(lines, marks)


def _mark(leg: Leg, plan: object) -> Mark:
    east, north = plan(np.array([leg.lat_rad]), np.array([leg.lon_rad]))  # type: ignore[operator]
    along = leg.begin_m + (leg.length_m if leg.has_path and leg.state != "holding" else 0.0)
    altitude = leg.altitude_m[0]
    return Mark(leg.fix, float(east[0]), float(north[0]), along, math.nan if altitude is None else altitude, altitude_words(leg))


def altitude_words(leg: Leg) -> str:
    """Coded altitudes with their description; blank means at."""
    first, second = leg.altitude_fields
    sign = {"+": "≥ ", "-": "≤ ", "B": "between ", "": ""}.get(leg.altitude_description, f"{leg.altitude_description} ")
    shown = [text.lstrip("0") or "0" for text in (first, second) if text]
    return f"{sign}{' and '.join(shown)}" if shown else ""
