"""Where an aircraft should be, second by second, from the threshold to its stand."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from navbound import _core

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.scenario.taxi import Taxi

    Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Movement:
    """The path at whole seconds; arrays have one element a second.

    Attributes
    ----------
    along_m, speed_mps : ndarray
        Distance from the first point, and speed. [m, m/s]
    lat_rad, lon_rad, course_rad : ndarray
        The path there. [rad]
    phase : ndarray of str
        Sub-phase.
    leg : ndarray of int
        Number of the leg.
    coasts : ndarray of bool
        Whether the transition point lies behind.
    per_radian_m : (float, float)
        Metres east and north for a radian of longitude and latitude.
    core : Ground
        The simulator, which drove the route and draws the errors of each flight.
    """

    along_m: Floats
    speed_mps: Floats
    lat_rad: Floats
    lon_rad: Floats
    course_rad: Floats
    phase: NDArray[np.str_]
    leg: NDArray[np.int64]
    coasts: NDArray[np.bool_]
    per_radian_m: tuple[float, float]
    core: _core.Ground

    def beside(self, right_m: Floats) -> tuple[Floats, Floats]:
        """Latitude and longitude of a place beside each point of the path. [rad]."""
        east_m, north_m = self.per_radian_m
        lat_rad = self.lat_rad - right_m * np.sin(self.course_rad) / north_m
        return lat_rad, self.lon_rad + right_m * np.cos(self.course_rad) / east_m


def move(taxi: Taxi) -> Movement:
    """Drive the route as fast as sub-phases, turns and brakes allow.

    Raises
    ------
    InputError
        A route whose turns overlap, brakes too weak for it.
    """
    core = _core.Ground(taxi.core_json())
    driven = core.movement()
    phases = np.array([p.phase for p in taxi.points])
    return Movement(
        along_m=driven["along_m"],
        speed_mps=driven["speed_mps"],
        lat_rad=driven["lat_rad"],
        lon_rad=driven["lon_rad"],
        course_rad=driven["course_rad"],
        phase=phases[driven["phase"].astype(np.int64)].astype(np.str_),
        leg=driven["leg"].astype(np.int64),
        coasts=driven["along_m"] >= driven["transition_m"],
        per_radian_m=tuple(driven["per_radian_m"]),
        core=core,
    )
