"""A body at rest with everything around it, in a few lines: for tests of the filter that need thousands of quick epochs."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navbound import ins

sys.path.insert(0, str(Path(__file__).parents[1] / "oracle"))

import ins_truth as oracle

Floats = NDArray[np.float64]
MODEL = ins.ImuModel()
PLACE, ATTITUDE = (0.72, 1.9, 100.0), (0.02, -0.03, 1.0)


def axes() -> Floats:
    """North, east, down at the place, columns, Earth-fixed."""
    columns: Floats = np.asarray(oracle.ecef_from_ned(np.array([PLACE]))[0], dtype=np.float64)
    return columns


def place_ecef(ned_m: Floats) -> Floats:
    """Earth-fixed positions at offsets from the place."""
    origin = np.asarray(oracle.ecef(np.array([PLACE])), dtype=np.float64)[0]
    return np.asarray(origin + ned_m @ axes().T, dtype=np.float64)


@dataclass(frozen=True)
class Standing:
    """Samples of a unit at rest with errors of the model, and a start that is wrong as it says."""

    imu: ins.Imu
    start: ins.Start
    time_ns: NDArray[np.int64]


def standing(seed: int, duration_s: float, rate_hz: int = 10, model: ins.ImuModel = MODEL) -> Standing:
    """Errors as the filter believes them: white noise and a bias of its deviation, constant over the short time."""
    draw = np.random.default_rng(seed)
    true = oracle.fly(oracle.standing, 2 / rate_hz, rate_hz)
    n, dt = round(duration_s * rate_hz), 1 / rate_hz
    increments: list[Floats] = []
    for part, sensor in ((true.angle_rad, model.gyroscope), (true.velocity_mps, model.accelerometer)):
        wrong = sensor.bias * draw.normal(size=3) * dt + sensor.white * np.sqrt(dt) * draw.normal(size=(n, 3))
        increments.append(part[1] + wrong)
    time_ns = np.round(np.arange(1, n + 1) * dt * 1e9).astype(np.int64)
    start = ins.Start(0, PLACE, (0.0, 0.0, 0.0), ATTITUDE)
    offset, velocity, turn = draw.normal(size=3), draw.normal(size=3) * start.velocity_sigma_mps, draw.normal(size=3)
    offset, turn = offset * start.position_sigma_m, turn * start.attitude_sigma_rad
    position = (PLACE[0] + offset[0] / 6.3625e6, PLACE[1] + offset[1] / (6.3875e6 * np.cos(PLACE[0])), PLACE[2] - offset[2])
    # At small roll and pitch a turn about the vertical is one of the heading; the others turn with the heading into pitch and roll.
    c, s = np.cos(ATTITUDE[2]), np.sin(ATTITUDE[2])
    attitude = np.array(ATTITUDE) - [c * turn[0] + s * turn[1], -s * turn[0] + c * turn[1], turn[2]]
    wrong_start = ins.Start(0, position, tuple(velocity), tuple(attitude))
    return Standing(ins.Imu(time_ns, increments[0], increments[1], dt), wrong_start, time_ns)


def satellites(seed: int, time_ns: NDArray[np.int64], *, white_m: float, slow_m: float, tau_s: float, n: int = 9) -> ins.SatelliteRanges:
    """Ranges to satellites that stand in the sky, a clock that drifts, Gauss-Markov errors."""
    draw = np.random.default_rng(seed + 10_000)
    azimuth, elevation = 2 * np.pi * np.arange(n) / n * 2, np.radians(np.linspace(12, 80, n))
    sight = np.stack([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), -np.sin(elevation)], 1)
    where, ranges = place_ecef(2.2e7 * sight), np.full(n, 2.2e7)
    dt = np.diff(time_ns, prepend=0) * 1e-9
    slow = slow_m * draw.normal(size=n)
    rows: list[Any] = []
    for k, step in enumerate(dt):
        keep = np.exp(-step / tau_s)
        slow = keep * slow + slow_m * np.sqrt(1 - keep**2) * draw.normal(size=n)
        rows.append(ranges + 12_345.0 + 0.5 * time_ns[k] * 1e-9 + slow + white_m * draw.normal(size=n))
    names = [f"{'G' if k % 2 else 'C'}{k + 1:02}" for k in range(n)]
    return ins.SatelliteRanges(
        time_ns=np.repeat(time_ns, n),
        satellite=names * time_ns.size,
        position_ecef_m=np.tile(where, (time_ns.size, 1)),
        velocity_ecef_mps=0.0 * np.tile(where, (time_ns.size, 1)),
        range_m=np.concatenate(rows),
        sigma_white_m=white_m,
        sigma_correlated_m=slow_m,
        correlation_time_s=tau_s,
    )


def some(sky: ins.SatelliteRanges, keep: NDArray[np.bool_]) -> ins.SatelliteRanges:
    """Some of the ranges, with their white part alone."""
    position, velocity, measured = (np.asarray(a)[keep] for a in (sky.position_ecef_m, sky.velocity_ecef_mps, sky.range_m))
    names = [name for name, kept in zip(sky.satellite, keep, strict=True) if kept]
    return ins.SatelliteRanges(np.asarray(sky.time_ns)[keep], names, position, velocity, measured, sky.sigma_white_m, 0.0, 60.0)


def error_enu(fused: ins.Fused) -> Floats:
    """Estimate minus truth. [m]"""
    d = fused.position - np.array(PLACE)
    return np.stack([d[:, 1] * 6.3875e6 * np.cos(PLACE[0]), d[:, 0] * 6.3625e6, d[:, 2]], 1)


def true_start(flown: ins.Sensed) -> ins.Start:
    """The truth at the begin of a simulated flight."""
    first = flown.truth.row(0, named=True)
    return ins.Start(
        time_ns=first["time_ns"],
        position=(first["truth_lat_rad"], first["truth_lon_rad"], first["truth_h_m"]),
        velocity_ned_mps=(first["vel_n_mps"], first["vel_e_mps"], first["vel_d_mps"]),
        attitude_rad=(first["roll_rad"], first["pitch_rad"], first["heading_rad"]),
    )
