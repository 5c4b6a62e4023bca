"""Speed of navbound.sbas: levels of many users and epochs from the recorded MSAS hour, on one core."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clock import Row, seconds, show
from navbound import gnss, sbas

if TYPE_CHECKING:
    pass

FOLDER = Path(__file__).parents[1].parent / "shared" / "data" / "sbas"
WEEK_S = 2353 * 604_800


def measure() -> list[Row]:
    """One row a measurement. Nothing where the recorded hour is absent."""
    if not FOLDER.is_dir():
        return []
    log = sbas.read(FOLDER / "msas137_2025046_17h.ems")
    navigation = FOLDER / "gps_2025046_17h_rinex3.nav"
    instants = (WEEK_S + np.arange(580_000, 583_200, dtype=np.int64)) * 1_000_000_000
    place: dict[str, Any] = {"lat_rad": 0.6167, "lon_rad": 2.4351, "h_m": 50.0}
    alone = seconds(lambda: sbas.protection_levels(log, navigation, instants, **place, mode="pa"))
    lat, lon = (a.ravel() for a in np.meshgrid(np.radians(np.linspace(26, 44, 40)), np.radians(np.linspace(128, 146, 50))))
    few = instants[::64]
    users = seconds(lambda: sbas.protection_levels(log, navigation, few[:, None], lat_rad=lat, lon_rad=lon, h_m=0.0, mode="pa"), repeats=3)
    setup = seconds(lambda: sbas.protection_levels(log, navigation, few[:1], **place, mode="pa"))
    n = few.size * lat.size
    computed = sbas.protection_levels(log, navigation, few[:, None], lat_rad=lat, lon_rad=lon, h_m=0.0, mode="pa")
    satellites = float(computed.n_sv.mean())
    sky = sbas.satellites(log, navigation, few[:1, None], lat_rad=lat, lon_rad=lon, h_m=0.0, mode="pa")
    most = int(np.bincount(sky.epoch).max())
    full = np.flatnonzero(np.bincount(sky.epoch) == most)
    rows = np.isin(sky.epoch, full)
    az, el, sigma = (np.tile(c[rows].reshape(full.size, most), (100, 1)) for c in (sky.az_rad, sky.el_rad, sky.sigma_m))
    level = seconds(lambda: 6.0 * gnss.covariance(az, el, sigma).sigma_major_m) / az.shape[0]
    observations = gnss.read_observations(FOLDER / "virtual_user_2025046_17h.25O.gz")
    records = gnss.read_navigation(navigation)
    solved = seconds(lambda: sbas.solve(observations, records, log, mode="pa"))
    read = seconds(lambda: sbas.read(FOLDER / "msas137_2025046_17h.ems"))
    place_words = "an epoch: corrections, orbits, grid and level"
    users_words = f"a user and epoch: geometry, grid and level; {satellites:.1f} satellites"
    level_words = f"a user and epoch: angles and sigmas of {most} satellites to the horizontal level"
    record_words = "an epoch: smoothing, corrections, position and level"
    return [
        Row("sbas read, EMS hour", read / 3600, 3600, "a message"),
        Row("sbas decode and hear, navigation read", setup / 3600, 3600, "a message"),
        Row("sbas one user", (alone - setup) / instants.size, instants.size, place_words),
        Row("sbas many users", (users - setup) / n, n, users_words, goal_s=1e-6),
        Row("sbas level alone", level, az.shape[0], level_words, goal_s=0.3e-6),
        Row("sbas positions of a recording", (solved - setup) / observations.n_epochs, observations.n_epochs, record_words),
    ]


if __name__ == "__main__":
    show(measure())
