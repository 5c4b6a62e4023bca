"""An inertial unit in an aircraft that turns and descends, with the positions of a satellite receiver and the truth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import polars as pl

from navbound import gnss, ins
from navbound.scenario import load
from navbound.table.columns import COVARIANCE

RATE_HZ = 20
_NS = 1_000_000_000


@dataclass(frozen=True)
class Piece:
    """A piece of a flight.

    Attributes
    ----------
    flight : str
        Scenario.
    from_s, until_s : int
        Since its begin. [s]
    silent_s : tuple of int
        From and until: no position is solved. [s]
    seed : int
        Every random number follows from it.
    """

    flight: str
    from_s: int
    until_s: int
    silent_s: tuple[int, int]
    seed: int


@dataclass(frozen=True)
class Log:
    """Tables of a log.

    Attributes
    ----------
    imu : DataFrame
        Increments of the unit, as in `navbound.ins.Sensed`.
    fixes : DataFrame
        Every second the position solved from the ranges of that second, and the covariance of its error.
    truth : DataFrame
        Every second where the aircraft was, how fast and in which attitude; the first row begins the log.
    """

    imu: pl.DataFrame
    fixes: pl.DataFrame
    truth: pl.DataFrame


def record(piece: Piece) -> Log:
    """The log of a piece of a flight."""
    scenario = load(piece.flight)
    assert scenario.sensors is not None
    sensors = scenario.sensors.model_copy(update={"rate_hz": RATE_HZ})
    flown = ins.simulate(scenario.model_copy(update={"sensors": sensors}), seed=piece.seed)
    begin_ns = scenario.start_ns
    within = pl.col("time_ns").is_between(begin_ns + piece.from_s * _NS, begin_ns + piece.until_s * _NS)
    silent = pl.col("time_ns").is_between(begin_ns + piece.silent_s[0] * _NS, begin_ns + piece.silent_s[1] * _NS, closed="left")
    # A sample ends its interval: that of the begin belongs to what was before.
    imu = flown.imu.filter(within & (pl.col("time_ns") > begin_ns + piece.from_s * _NS))
    increments = [pl.col(f"angle_{axis}_rad").round(10) for axis in "xyz"] + [pl.col(f"velocity_{axis}_mps").round(7) for axis in "xyz"]
    motion = [pl.col(name).round(9) for name in ("roll_rad", "pitch_rad", "heading_rad")]
    truth = flown.truth.filter(within).select("time_ns", *_place("truth_"), *(pl.col(f"vel_{d}_mps").round(6) for d in "ned"), *motion)
    ranges = flown.satellites.filter(within & ~silent)
    fixes = pl.DataFrame([_fix(time_ns, own) for (time_ns,), own in ranges.group_by("time_ns", maintain_order=True)])
    return Log(imu.select("time_ns", "interval_s", *increments), fixes, truth)


def _place(prefix: str) -> list[pl.Expr]:
    """To 0.1 mm."""
    angles = [pl.col(f"{prefix}{axis}_rad").round(11).alias(f"{axis}_rad") for axis in ("lat", "lon")]
    return [*angles, pl.col(f"{prefix}h_m").round(4).alias("h_m")]


def _fix(time_ns: object, ranges: pl.DataFrame) -> dict[str, object]:
    """Weighted least squares of the ranges of an instant: position and a clock of each constellation."""
    there = ranges.select("sv_x_m", "sv_y_m", "sv_z_m").to_numpy()
    variance = (ranges["sigma_white_m"] ** 2 + ranges["sigma_correlated_m"] ** 2).to_numpy()
    constellation = ranges["satellite"].str.head(1)
    clocks = constellation.to_dummies().to_numpy().astype(np.float64)
    state = np.concatenate([6.37e6 * np.mean(there, 0) / np.linalg.norm(np.mean(there, 0)), np.zeros(clocks.shape[1])])
    for _ in range(8):
        line = there - state[:3]
        way = np.linalg.norm(line, axis=1)
        design = np.hstack([-line / way[:, None], clocks])
        covariance = np.linalg.inv(design.T @ (design / variance[:, None]))
        state = state + covariance @ (design.T @ ((ranges["range_m"].to_numpy() - way - clocks @ state[3:]) / variance))
    lat, lon, h = (float(x) for x in gnss.geodetic(state[:3]))
    east = np.array([-np.sin(lon), np.cos(lon), 0.0])
    up = np.array([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])
    axes = np.stack([east, np.cross(up, east), up])
    v = axes @ covariance[:3, :3] @ axes.T
    six = (v[0, 0], v[0, 1], v[1, 1], v[0, 2], v[1, 2], v[2, 2])
    place = {"time_ns": time_ns, "lat_rad": round(lat, 11), "lon_rad": round(lon, 11), "h_m": round(h, 4)}
    return place | {name: round(float(value), 4) for name, value in zip(COVARIANCE, six, strict=True)}
