"""The example files: which there are, what is in them, and how each is made."""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from navbound import write
from navbound.errors import InputError
from navbound.examples import inertial, planning, procedure, service, tracks
from navbound.examples.levels import levels
from navbound.examples.station import Station, measure

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

_HOUR_NS = 3600 * 10**9
BEGIN_NS = (2408 * 168 + 9) * _HOUR_NS
"""2026-03-01 09:00:00 of GPS time, a Sunday."""
STATION = Station(
    lat_rad=float(np.radians(48.99)),
    lon_rad=float(np.radians(2.57)),
    h_m=120.0,
    begin_ns=BEGIN_NS,
    step_s=30.0,
    n_epochs=240,
    seed=60,
    outages_s=((2400.0, 2700.0),),
    wrong=(("G10", (4500.0, 5400.0), 40.0, 0.1),),
)
"""Two hours at the airport of Paris; five minutes without a signal; a satellite whose ranges are 40 m and more too long."""
SERVICE = service.Service(
    begin_s=BEGIN_NS // 10**9,
    duration_s=3600,
    seed=67,
    centre_rad=(STATION.lat_rad, STATION.lon_rad),
    wrong=("G24", (1500, 1800)),
    silent=((2985, 3045),),
)
"""The first hour of the station: a satellite that must not be used for five minutes, and a minute without a message."""
LOG = replace(STATION, step_s=1.0, n_epochs=180, seed=61, outages_s=(), wrong=())
"""Three minutes every second, on which nothing happens."""
DAY = replace(STATION, begin_ns=BEGIN_NS - 9 * _HOUR_NS, n_epochs=2880, seed=62, outages_s=((30_000.0, 30_600.0),), wrong=())
"""A day every 30 s, ten minutes of it without a signal."""
TRAFFIC = tracks.Day(begin=datetime(2026, 3, 1, 5), apart_s=2500.0, n_flights=24, step_s=2, seed=63)
"""Twelve approaches to each runway."""
PIECE = inertial.Piece("beijing-shanghai", from_s=6040, until_s=6280, silent_s=(6160, 6220), seed=65)
"""Four minutes of a descent with a turn, one of them without a position of the receiver."""
APPROACH_BEGIN, APPROACH_SEED = datetime(2026, 3, 1, 10), 66
"""GPS time at which the flight begins that ends with the approach of the navigation database."""
PLACE_ECEF_M = (4189135.1896, 188029.6189, 4789919.6247)
"""The antenna of all, Earth-fixed: truth. [m]"""


@dataclass(frozen=True)
class Example:
    """An example.

    Attributes
    ----------
    files : tuple of str
        Names of its files.
    contents : str
        What is in them, in a sentence.
    make : callable
        Writes them into a folder.
    """

    files: tuple[str, ...]
    contents: str
    make: Callable[[Path], None]


def _rinex(folder: Path) -> None:
    recording = measure(STATION, "PARIS")
    write.observations(recording.observations, folder / "station.rnx")
    write.navigation(recording.navigation, folder / "broadcast.rnx")


def _sbas(folder: Path) -> None:
    write.ems(service.messages(SERVICE, measure(STATION, "PARIS")), service.PRN, folder / "service.ems")


def _ubx(folder: Path) -> None:
    recording = measure(LOG, "PARIS")
    write.ubx(recording.observations, folder / "receiver.ubx")
    write.navigation(recording.navigation, folder / "receiver-broadcast.rnx")


def _tracks(folder: Path) -> None:
    reported, truth = tracks.record(TRAFFIC)
    reported.write_csv(folder / "tracks.csv")
    truth.write_csv(folder / "tracks-truth.csv")


def _levels(folder: Path) -> None:
    levels(DAY, PLACE_ECEF_M).write_csv(folder / "levels.csv")


def _imu(folder: Path) -> None:
    log = inertial.record(PIECE)
    log.imu.write_csv(folder / "imu.csv")
    log.fixes.write_csv(folder / "fixes.csv")
    log.truth.write_csv(folder / "motion.csv")


def _procedure(folder: Path) -> None:
    (folder / procedure.DATABASE).write_text(procedure.database(), encoding="ascii", newline="\n")
    procedure.track(folder, APPROACH_BEGIN, APPROACH_SEED).write_csv(folder / "procedure-track.csv")


def _plan(folder: Path) -> None:
    (folder / planning.ALMANAC).write_text(planning.almanac(), encoding="ascii", newline="\n")
    (folder / "plan.toml").write_text(planning.PLAN, encoding="ascii", newline="\n")


EXAMPLES: dict[str, Example] = {
    "rinex": Example(("station.rnx", "broadcast.rnx"), "two hours of a station, an outage, a faulty satellite", _rinex),
    "sbas": Example(("service.ems",), "an hour of the messages of an SBAS satellite for the station, an alert and a gap", _sbas),
    "ubx": Example(("receiver.ubx", "receiver-broadcast.rnx"), "three minutes of a u-blox receiver's raw measurements", _ubx),
    "tracks": Example(("tracks.csv", "tracks-truth.csv"), "a day's approaches to two runways, and where the aircraft were", _tracks),
    "levels": Example(("levels.csv",), "a day of protection levels with their errors", _levels),
    "imu": Example(
        ("imu.csv", "fixes.csv", "motion.csv"), "four minutes of an inertial unit, a receiver's positions, the true motion", _imu
    ),
    "procedure": Example(
        (procedure.DATABASE, "procedure-track.csv"),
        "a navigation database with one contradiction, and a flight along its approach",
        _procedure,
    ),
    "plan": Example((planning.ALMANAC, "plan.toml"), "an almanac of GPS, and the plan of a flight that uses it", _plan),
}
"""Examples by name."""


def make(names: Sequence[str], folder: str | Path) -> list[Path]:
    """Make examples in a folder.

    Parameters
    ----------
    names : sequence of str
        Of :data:`EXAMPLES`; none means all.
    folder : str or Path
        Where; made if it is not there.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    InputError
        A name that is none.
    """
    for name in names:
        if name not in EXAMPLES:
            raise InputError("names", name, domain=f"one of {', '.join(EXAMPLES)}")
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    files = []
    for name in names or EXAMPLES:
        EXAMPLES[name].make(place)
        files += [place / file for file in EXAMPLES[name].files]
    return files
