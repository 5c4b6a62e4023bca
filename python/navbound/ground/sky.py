"""Where an aircraft flies and rolls second by second, its approach included, and the satellites over it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from navbound import gnss
from navbound.gbas.modes import MODES, Mode

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.ground.motion import Movement
    from navbound.scenario.taxi import Taxi

    Floats = NDArray[np.float64]

GLIDE_RAD = np.radians(3.0)
STEPS = 5
"""Instants a second at which phase aids the filter: over a fifth of one the speed in a turn changes by millimetres a second."""
FLARE_M = 100.0
"""Over some such lengths of way the path bends from the glide to the runway."""


@dataclass(frozen=True)
class Way:
    """The approach, straight along the runway, and the way on the ground; one row a second.

    Attributes
    ----------
    position : ndarray, shape (lead + n, 3)
        Latitude, longitude, height. [rad, rad, m]
    lead : int
        Seconds before the threshold, with which the movement on the ground begins.
    """

    position: Floats
    lead: int


@dataclass(frozen=True)
class Sky:
    """Satellites over the aircraft, one row an instant; both angles NaN below the horizon [rad]."""

    names: tuple[str, ...]
    systems: NDArray[np.int64]
    az_rad: Floats
    el_rad: Floats

    def rows(self, which: slice) -> Sky:
        """Some of the instants."""
        return Sky(self.names, self.systems, self.az_rad[which], self.el_rad[which])


def mode_of(taxi: Taxi) -> Mode:
    """The processing mode of a scenario."""
    return next(m for m in MODES if m.id == taxi.navigation.mode)


def way(taxi: Taxi, movement: Movement) -> Way:
    """Where the aircraft is, from some minutes before the threshold on: so long its filter has run by then."""
    lead = round(taxi.navigation.settled_s)
    east_m, north_m = movement.per_radian_m
    back = movement.speed_mps[0] * np.arange(-lead, 0.0)
    lat = np.append(movement.lat_rad[0] + back * np.cos(movement.course_rad[0]) / north_m, movement.lat_rad)
    lon = np.append(movement.lon_rad[0] + back * np.sin(movement.course_rad[0]) / east_m, movement.lon_rad)
    along = np.append(back, movement.along_m)
    # Three degrees far before touching down, level behind it, smooth in between.
    above = np.tan(GLIDE_RAD) * FLARE_M * np.logaddexp(0.0, (taxi.motion.touchdown_along_m - along) / FLARE_M)
    return Way(np.stack([lat, lon, taxi.height_m + above], axis=-1), lead)


def look(taxi: Taxi, flown: Way) -> Sky:
    """Where the nominal satellites of the mode stand, :data:`STEPS` times a second."""
    names = [taxi.navigation.gps if name == "gps" else name for name in mode_of(taxi).systems]
    orbits = gnss.constellation(names[0])
    for name in names[1:]:
        orbits += gnss.constellation(name)
    whole = np.arange(len(flown.position))
    fine = np.arange(STEPS * (len(whole) - 1) + 1) / STEPS
    lat_rad, lon_rad, h_m = (np.interp(fine, whole, column) for column in flown.position.T)
    az, el = gnss.directions(orbits, lat_rad, lon_rad, h_m, taxi.second_of_day - flown.lead + fine)
    up = el > 0
    return Sky(orbits.satellite, orbits.constellation, np.where(up, az, np.nan), np.where(up, el, np.nan))


def line(az_rad: Floats, el_rad: Floats) -> Floats:
    """Unit vectors to satellites, east, north, up; shape (..., 3)."""
    return np.stack([np.cos(el_rad) * np.sin(az_rad), np.cos(el_rad) * np.cos(az_rad), np.sin(el_rad)], axis=-1)
