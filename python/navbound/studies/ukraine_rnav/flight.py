"""The flight of the Ukraine study: route, stations, and four ways to navigate it, each as a track of the epoch table."""

from __future__ import annotations

import importlib.resources
import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import _core, dme, path
from navbound.read import runways
from navbound.records.material import Material
from navbound.records.run import CovarianceOrigin, Waypoint
from navbound.status import USABLE, sentences, statuses
from navbound.units import METRES_PER_NM

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

DEPARTURE, DESTINATION = "UKBB/18L", "UKHH/08"
POINTS_DEG = {
    "GOTAP": (50.255, 31.82),
    "LULAP": (50.25527778, 32.35305556),
    "IZERA": (50.21277778, 33.88527778),
    "OKSAR": (50.08305556, 34.63388889),
    "UDVIR": (50.06527778, 35.18777778),
}
"""En-route points near the direct line: facts restated from the Russian AIS's ARINC 424 set, cycle 2207. The choice of them is ours."""

SPEED_MPS = 220.0
CRUISE_M = 10_058.4
"""33 000 ft, taken as a height above the ellipsoid. Ours."""
GRADIENT = 0.0524
"""Climb and descent at 3 degrees. Ours."""
STEP_S = 5.0
TURN_M = 5_000.0
START_NS = 1_224_244_818_000_000_000
"""2018-10-22 12:00:00 UTC: the times of the table need an origin, and nothing depends on it. [ns]"""
SIGMA_ALTITUDE_M = 30.0
"""Standard deviation of the altitude, common to all ranges. Ours. [m]"""
RNP_M = METRES_PER_NM
"""RNP 1: what DME/DME is to support in terminal airspace. [m]"""
PRIOR_WITHIN_M = 5_000.0
"""How far the position predicted from five seconds before may be off: less than the way to the mirror of any admissible pair. Ours. [m]"""

PAIR, ALL, VOR = "optimal-pair", "all-in-view", "vor-dme"
LABELS = {PAIR: "Optimal DME pair", ALL: "All DMEs in view", VOR: "Best VOR/DME"}


@dataclass(frozen=True)
class Flight:
    """The path in space and time, and what the network offers along it."""

    along_m: Floats
    lat_rad: Floats
    lon_rad: Floats
    h_m: Floats
    course_rad: Floats
    leg: NDArray[np.int64]
    stations: dme.Stations
    selection: dme.Selection
    waypoints: list[Waypoint]

    @property
    def time_ns(self) -> NDArray[np.int64]:
        """GPS time [ns]."""
        return START_NS + np.round(1e9 * self.along_m / SPEED_MPS).astype(np.int64)


def network() -> dme.Stations:
    """The en-route DMEs of Ukraine."""
    with importlib.resources.as_file(importlib.resources.files("navbound").joinpath("data/ukraine-stations.csv")) as file:
        return dme.read_stations(file)


def flight(stations: dme.Stations) -> Flight:
    """Fly the route and ask at every epoch what the stations offer."""
    start, end = runways.runway(DEPARTURE), runways.runway(DESTINATION)
    inner = {name: (float(np.radians(lat)), float(np.radians(lon))) for name, (lat, lon) in POINTS_DEG.items()}
    named = {start.name: (start.lat_rad, start.lon_rad)} | inner | {end.name: (end.lat_rad, end.lon_rad)}
    places = np.array(list(named.values()))
    radius = np.full(len(places), TURN_M)
    radius[[0, -1]] = 0.0
    route = path.route(places[:, 0], places[:, 1], radius)
    along = np.arange(0.0, route.length_m, STEP_S * SPEED_MPS)
    on = route.at(along)
    climb, descent = start.elevation_m + GRADIENT * along, end.elevation_m + GRADIENT * (route.length_m - along)
    h_m = np.minimum(CRUISE_M, np.minimum(climb, descent))
    time_ns = START_NS + np.round(1e9 * along / SPEED_MPS).astype(np.int64)
    selection = dme.select(time_ns, on.lat_rad, on.lon_rad, h_m, stations, sigma_altitude_m=SIGMA_ALTITUDE_M)
    points = [Waypoint(name=n, lat_rad=lat, lon_rad=lon, kind="waypoint" if n in inner else "runway") for n, (lat, lon) in named.items()]
    beacons = [
        Waypoint(name=n, lat_rad=float(a), lon_rad=float(b), kind="station")
        for n, a, b in zip(stations.ident, stations.lat_rad, stations.lon_rad, strict=True)
    ]
    return Flight(along, on.lat_rad, on.lon_rad, h_m, on.course_rad, on.leg, stations, selection, points + beacons)


def material(flown: Flight, seed: int) -> Material:
    """Draw ranges and bearings, solve every epoch in each way, and hand the tracks over for judging.

    The estimate is kept on the path, as an autopilot keeps it; the truth stands off by the navigation error that the drawn errors gave.
    """
    generator = np.random.Generator(np.random.Philox(seed))
    seen = dme.sights(flown.lat_rad, flown.lon_rad, flown.h_m, flown.stations)
    measured = seen.slant_m + dme.range_sigma(seen.slant_m) * generator.standard_normal(seen.slant_m.shape)
    bearings = seen.bearing_rad + dme.VOR_SIGMA_RAD * generator.standard_normal(seen.bearing_rad.shape)
    h_m = flown.h_m + SIGMA_ALTITUDE_M * generator.standard_normal(flown.h_m.shape)
    both = _selected(flown.selection.used, len(flown.stations))
    vor = flown.selection.vor
    row, column = np.arange(len(vor)), np.maximum(vor, 0)
    station = np.column_stack((flown.stations.lat_rad, flown.stations.lon_rad, flown.stations.h_m))[column]
    by_bearing = dme.solve_vor(measured[row, column], bearings[row, column], station, h_m, sigma_altitude_m=SIGMA_ALTITUDE_M)
    tracks = {
        PAIR: _table(flown, _solved(flown, np.where(both, measured, np.nan), h_m), h_m, flown.selection.used[:, 0] >= 0, PAIR),
        ALL: _table(
            flown, _solved(flown, np.where(seen.usable, measured, np.nan), h_m), h_m, np.isfinite(flown.selection.all_en_m2[:, 0, 0]), ALL
        ),
        VOR: _table(flown, by_bearing, h_m, vor >= 0, VOR),
    }
    return Material(
        epochs=pl.concat(tracks.values()),
        kind="fly",
        title="UKBB to UKHH on DME and VOR",
        requirement="RNP 1",
        sample_period_s=STEP_S,
        assumptions=_assumptions(),
        covariance=CovarianceOrigin(id="simulated"),
        labels=dict(LABELS),
        waypoints=flown.waypoints,
        seed=seed,
        settings={"stations": list(flown.stations.ident), "speed_mps": SPEED_MPS, "cruise_m": CRUISE_M, "step_s": STEP_S},
    )


def _assumptions() -> list[str]:
    return [
        "Range deviations max(0.085 NM, 0.125 %) and 0.05 NM, pairs from 30 to 150 degrees, stations from 3 to 160 NM and up to "
        "40 degrees: inferred, the texts were not read.",
        f"VOR bearings with a standard deviation of {np.degrees(dme.VOR_SIGMA_RAD):.2f} degrees: inferred, the text was not read.",
        f"Altitude known to {SIGMA_ALTITUDE_M:g} m (standard deviation), common to all ranges; heights are above the ellipsoid: ours.",
        "The covariance of a VOR/DME position is linear: two deviations of a bearing at 60 NM also put it 350 m short along the radial, "
        "which the covariance does not say.",
        "Errors of ranges, bearings and altitude are drawn anew at every epoch; a real station's stay for minutes and hours.",
        "No terrain: a station is seen above the horizon of a smooth Earth of four thirds the radius.",
        "Stations and points are those of cycle 2207; route, profile and speed are ours: the authors' are not known.",
    ]


def _selected(pairs: NDArray[np.int64], m: int) -> NDArray[np.bool_]:
    """Pairs as places of their stations to a mask of shape (n, m)."""
    mask: NDArray[np.bool_] = (pairs[:, :, None] == np.arange(m)).any(axis=1)
    return mask


def _solved(flown: Flight, slant_m: Floats, h_m: Floats) -> dme.Positions:
    return dme.solve(
        slant_m,
        flown.stations,
        h_m,
        sigma_altitude_m=SIGMA_ALTITUDE_M,
        prior_lat_rad=flown.lat_rad,
        prior_lon_rad=flown.lon_rad,
        prior_within_m=PRIOR_WITHIN_M,
    )


def _table(flown: Flight, positions: dme.Positions, h_m: Floats, offered: NDArray[np.bool_], track: str) -> pl.DataFrame:
    reason_id = np.where(offered, positions.reason_id, "no_station_pair")
    status, reason = statuses(reason_id), sentences(reason_id)
    usable = np.isin(status, USABLE)
    lat, lon = (
        np.where(usable, solved, path_) for solved, path_ in ((positions.lat_rad, flown.lat_rad), (positions.lon_rad, flown.lon_rad))
    )
    on_path = np.column_stack((flown.lat_rad, flown.lon_rad, flown.h_m))
    nse = _core.navigation_error(np.column_stack((lat, lon, h_m)), on_path)
    legs = ["-".join(pair) for pair in itertools.pairwise([DEPARTURE, *POINTS_DEG, DESTINATION])]

    def known(values: Floats) -> Floats:
        return np.where(usable, values, np.nan)

    table = pl.DataFrame(
        {
            "track": np.full(len(lat), track),
            "time_ns": flown.time_ns,
            "est_lat_rad": flown.lat_rad,
            "est_lon_rad": flown.lon_rad,
            "est_h_m": flown.h_m,
            "path_lat_rad": flown.lat_rad,
            "path_lon_rad": flown.lon_rad,
            "path_h_m": flown.h_m,
            "course_rad": flown.course_rad,
            "along_m": flown.along_m,
            "fte_m": np.where(usable, 0.0, np.nan),
            **{f"nse_{axis}_m": known(nse[:, k]) for k, axis in enumerate("enu")},
            **{f"cov_{'enu'[i]}{'enu'[j]}_m2": known(positions.covariance_enu_m2[:, i, j]) for j in range(3) for i in range(j + 1)},
            "rnp_m": np.full(len(lat), RNP_M),
            "ground_speed_mps": np.full(len(lat), SPEED_MPS),
            "leg": np.array(legs)[flown.leg],
            "status": status,
            "reason_id": reason_id,
            "reason": reason,
        }
    )
    return table.with_columns(pl.col(pl.Float64).fill_nan(None), pl.col("reason_id", "reason").replace("", None))
