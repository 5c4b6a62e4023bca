"""A receiver that stands: what it measures, and the broadcast records that go with it."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from navbound import _core
from navbound.gnss import Navigation, Observations

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Station:
    """Where a receiver stands, when it measures, and what goes wrong.

    Attributes
    ----------
    lat_rad, lon_rad, h_m : float
        Antenna, WGS-84. [rad, m]
    begin_ns : int
        First epoch, GPS time. [ns]
    step_s : float
        Between epochs. [s]
    n_epochs : int
        How many. [1]
    seed : int
        Every random number follows from it.
    mask_rad : float
        Nothing is received below. [rad]
    outages_s : tuple
        From and until after the first epoch: nothing is received. [s]
    wrong : tuple
        Satellite, from and until after the first epoch [s], error at once [m] and growing [m/s].
    galileo : bool
        With Galileo beside GPS.
    """

    lat_rad: float
    lon_rad: float
    h_m: float
    begin_ns: int
    step_s: float
    n_epochs: int
    seed: int
    mask_rad: float = float(np.radians(5.0))
    outages_s: tuple[tuple[float, float], ...] = ()
    wrong: tuple[tuple[str, tuple[float, float], float, float], ...] = ()
    galileo: bool = True


@dataclass(frozen=True)
class StationRecording:
    """What a station measured, what the satellites broadcast, and the receiver's clock.

    Attributes
    ----------
    observations : Observations
        C1C, L1C, D1C, S1C of both constellations; C2L and its like of GPS, C5Q and its like of Galileo.
    navigation : Navigation
        LNAV of GPS, I/NAV of Galileo, the ionosphere of GPS.
    clock_m : ndarray, shape (n,)
        Receiver clock minus GPS time at each epoch: truth. [m]
    """

    observations: Observations
    navigation: Navigation
    clock_m: NDArray[np.float64]


def measure(station: Station, name: str) -> StationRecording:
    """Measurements of a station; `name` is the marker."""
    observations, navigation, clock_m = _core.simulate_station(asdict(station), name)
    return StationRecording(Observations(observations, Path(name)), Navigation(navigation, [Path(name)]), clock_m)
