"""Where an aircraft should be, second by second, from the threshold to its stand."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from navbound import path
from navbound.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.gbas import SubPhase
    from navbound.path import Path
    from navbound.scenario.taxi import Taxi

    Floats = NDArray[np.float64]

STEP_M = 1.0
"""Between points at which speeds are worked out."""
NEAR_RAD = 1e-5
"""Over which the metres of a radian are taken: some 60 m."""


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


def move(taxi: Taxi, limits: dict[str, SubPhase]) -> Movement:
    """Drive the route as fast as sub-phases, turns and brakes allow.

    Raises
    ------
    InputError
        A route whose turns overlap, brakes too weak for it.
    """
    points = taxi.points
    lat, lon = np.array([p.lat_rad for p in points]), np.array([p.lon_rad for p in points])
    road = path.route(lat, lon, [p.radius_m for p in points])
    marks = road.waypoints_along_m
    grid = np.append(np.arange(0.0, road.length_m, STEP_M), road.length_m)
    phases = _phases(taxi, marks, grid)
    speed = _speeds(taxi, road, grid, phases, limits)
    # Between two points of the grid the acceleration is constant, so the mean speed is the mean of both.
    elapsed = np.concatenate([[0.0], np.cumsum(np.diff(grid) / ((speed[1:] + speed[:-1]) / 2))])
    seconds = np.arange(0.0, np.floor(elapsed[-1]) + 1.0)
    along = np.interp(seconds, elapsed, grid)
    places = road.at(along)
    transition = marks[[p.name for p in points].index(taxi.navigation.transition)]
    return Movement(
        along_m=along,
        speed_mps=np.interp(along, grid, speed),
        lat_rad=places.lat_rad,
        lon_rad=places.lon_rad,
        course_rad=places.course_rad,
        phase=_phases(taxi, marks, along),
        leg=np.asarray(places.leg),
        coasts=along >= transition,
        per_radian_m=_per_radian(float(lat.mean()), float(lon.mean())),
    )


def _phases(taxi: Taxi, marks: Floats, along: Floats) -> NDArray[np.str_]:
    begins = [(m, p.phase) for m, p in zip(marks, taxi.points, strict=True) if p.phase is not None]
    number = np.searchsorted([m for m, _ in begins], along, side="right") - 1
    return np.array([name for _, name in begins])[np.maximum(number, 0)]


def _speeds(taxi: Taxi, road: Path, grid: Floats, phases: NDArray[np.str_], limits: dict[str, SubPhase]) -> Floats:
    """Largest speeds at the points of the grid: limits, turns, then what acceleration and brakes make of them."""
    motion = taxi.motion
    most: Floats = np.array([motion.touchdown_speed_mps if p == "RWY" else limits[p].speed_mps for p in phases])
    turned = np.abs(np.angle(np.exp(1j * np.diff(road.at(grid).course_rad, append=road.at(grid[-1:]).course_rad))))
    spacing = np.diff(grid, append=grid[-1] + STEP_M)
    # The bound applies at both ends of a step that turns.
    turning = np.sqrt(motion.lateral_acceleration_mps2 * spacing / np.maximum(turned, 1e-9))
    speed: Floats = np.minimum(most, np.minimum(turning, np.roll(turning, 1)))
    speed[-1] = 0.0
    for k in range(len(grid) - 2, -1, -1):
        braked = np.sqrt(speed[k + 1] ** 2 + 2 * motion.braking_mps2 * spacing[k])
        if grid[k] >= motion.touchdown_along_m:
            speed[k] = min(speed[k], braked)
        elif braked < speed[k]:
            raise InputError(
                "motion.braking_mps2", motion.braking_mps2, "m/s²", "brakes that slow the aircraft down in time after touching down"
            )
    for k in range(1, len(grid) - 1):
        speed[k] = min(speed[k], np.sqrt(speed[k - 1] ** 2 + 2 * motion.acceleration_mps2 * spacing[k - 1]))
    return speed


def _per_radian(lat: float, lon: float) -> tuple[float, float]:
    """Metres of a radian of longitude and of latitude: lengths of two short geodesics."""
    east = path.route([lat, lat], [lon - NEAR_RAD / 2, lon + NEAR_RAD / 2]).length_m
    north = path.route([lat - NEAR_RAD / 2, lat + NEAR_RAD / 2], [lon, lon]).length_m
    return east / NEAR_RAD, north / NEAR_RAD
