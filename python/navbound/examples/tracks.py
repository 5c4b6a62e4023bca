"""A day's approaches to two parallel runways: what a network of receivers would have recorded of them, and where the aircraft were."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime, timedelta

import numpy as np
import polars as pl

from navbound import path, time
from navbound.read.runways import Runway, runway
from navbound.run import flight
from navbound.scenario import Scenario, load
from navbound.scenario.models import Phase, Waypoint
from navbound.units import METRES_PER_FT, METRES_PER_NM, MPS_PER_KT

RUNWAYS = ("LFPG/08R", "LFPG/09L")
"""In turn: the southern and the northern pair of Paris, landing eastwards."""
FLIGHT = "beijing-shanghai-drawn"
"""Guidance, gusts and navigation are its own."""
BEFORE_NM = (90.0, 22.0)
"""Of the two points before the threshold: where a flight begins, and where it joins the extended centreline. Ours."""
OFFSETS_NM = (14.0, -11.0, 6.0, -17.0, 0.0)
"""How far to the left of the extended centreline flights begin, in turn. Ours."""
LAST_NM = 12.0
"""What is recorded of a flight."""
RNP_NM = 0.3


@dataclass(frozen=True)
class Day:
    """Approaches, one after the other.

    Attributes
    ----------
    begin : datetime
        GPS time at which the first flight begins.
    apart_s : float
        Between flights. [s]
    n_flights : int
        How many. [1]
    step_s : int
        Between rows of a flight. [s]
    seed : int
        Every random number follows from it.
    """

    begin: datetime
    apart_s: float
    n_flights: int
    step_s: int
    seed: int


def approach(to: Runway, offset_nm: float, begin: datetime) -> Scenario:
    """A flight of twenty minutes that ends at a threshold."""
    far, joined = (to.centreline.at(-nm * METRES_PER_NM) for nm in BEFORE_NM)
    aside = path.from_azimuth(float(far.lat_rad), float(far.lon_rad), to.course_rad - 0.5 * np.pi).at(offset_nm * METRES_PER_NM)
    base = load(FLIGHT)
    points = (
        ("START", float(aside.lat_rad), float(aside.lon_rad), "waypoint"),
        ("JOIN", float(joined.lat_rad), float(joined.lon_rad), "waypoint"),
    )
    waypoints = [Waypoint.model_validate({"name": n, "lat_rad": lat, "lon_rad": lon, "kind": kind}) for n, lat, lon, kind in points]
    return base.model_copy(
        update={
            "operation": "approach",
            "title": f"Approach to {to.name}",
            "start_gps": begin,
            "duration_s": 1200.0,
            "waypoints": [*waypoints, Waypoint(name=to.name, lat_rad=to.lat_rad, lon_rad=to.lon_rad, kind="runway")],
            "profile": base.profile.model_copy(
                update={"departure_height_m": to.elevation_m, "arrival_height_m": to.elevation_m + 15.0, "cruise_height_m": 4000.0}
            ),
            "phases": [Phase(name="approach", rnp_m=RNP_NM * METRES_PER_NM)],
        }
    )


def record(day: Day) -> tuple[pl.DataFrame, pl.DataFrame]:
    """Positions of the last miles of every flight as a network of receivers reports them, and where the aircraft were then.

    Returns
    -------
    reported, truth : DataFrame
        Rows of both at the same instants: `time` (UTC), `icao24`, `callsign`, degrees to seven decimals, heights above the ellipsoid. What
        is reported beside the position: speed over the ground and vertical rate, no accuracy.
    """
    to = [runway(name) for name in RUNWAYS]
    parts = []
    for k in range(day.n_flights):
        flown = approach(to[k % len(to)], OFFSETS_NM[k % len(OFFSETS_NM)], day.begin + timedelta(seconds=k * day.apart_s))
        epochs, _ = flight.Flights(flown.model_dump_json(), day.seed)(range(k, k + 1))
        parts.append(last_miles(epochs, day.step_s, LAST_NM).with_columns(icao24=pl.lit(f"f0{k:04x}"), callsign=pl.lit(f"NVB{k + 1:03d}")))
    every = pl.concat(parts)
    every = every.with_columns(utc()).sort("time_ns", "icao24")
    who = ("time", "icao24", "callsign")
    return every.select(*who, *place("est"), "ground_speed_kt", "vertical_rate_fpm"), every.select(*who, *place("truth"))


def utc() -> pl.Expr:
    """`time`, as a network of receivers writes it."""
    return pl.col("time_ns").map_elements(lambda t: time.utc_text(t).replace(" ", "T") + "Z", return_dtype=pl.String).alias("time")


def last_miles(epochs: pl.DataFrame, step_s: int, last_nm: float) -> pl.DataFrame:
    """Every so many seconds of the end of a flight; the vertical rate is that of the second before, to the 64 ft/min of a transponder."""
    feet_per_minute = 60.0 / METRES_PER_FT / 64.0 * pl.col("truth_h_m").diff()
    rows = epochs.with_columns(
        vertical_rate_fpm=(64 * feet_per_minute.round(0)).cast(pl.Int64, strict=False),
        ground_speed_kt=(pl.col("ground_speed_mps") / MPS_PER_KT).round(0).cast(pl.Int64),
    )
    near = pl.col("along_m").max() - pl.col("along_m") <= last_nm * METRES_PER_NM
    return rows.filter(near & (pl.col("time_ns") // 1_000_000_000 % step_s == 0))


def place(whose: str) -> list[pl.Expr]:
    """Degrees to seven decimals, height above the ellipsoid to the centimetre."""
    degrees = [pl.col(f"{whose}_{axis}_rad").degrees().round(7).alias(f"{axis}_deg") for axis in ("lat", "lon")]
    return [*degrees, pl.col(f"{whose}_h_m").round(2).alias("height_m")]
