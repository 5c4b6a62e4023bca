"""Recorded drives and flights as `navbound.ins.fuse` takes them, with a declared level.

``python tests/recordings.py`` runs the fault campaign on them. Levels are declared by the kind of receiver: 1 m of RTK, 20 m of a single
frequency. Nothing of the filter was chosen here; noise, axes and delay of the car and of the aircraft are those of `drive_fixture` and of
the tests of the filter, of the highway typical figures of a phone's unit.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.io import loadmat

from drive_fixture import BEGIN_S, FOLDER, WHOLE, Drive, gps_ns
from navbound import ins
from navbound.studies.fault_campaign.recorded import Recording, run
from navbound.studies.fault_campaign.table import markdown


def drive(level_m: float = 1.0) -> Recording:
    """The car with RTK of centimetres: its own positions are the truth."""
    car = Drive(FOLDER)
    imu_s = car.imu_s - WHOLE.delay_s
    rest = (imu_s > car.time_s[0] + 4) & (imu_s < car.time_s[0] + 37)
    begin = int(np.argmin(np.abs(car.since_s - BEGIN_S)))
    velocity = (car.position[begin] - car.position[begin - 1]) * car.metres / 0.25 * [1, 1, -1]
    start = ins.Start(
        int(gps_ns(car.time_s[begin : begin + 1])[0]),
        tuple(car.position[begin]),
        tuple(velocity),
        ins.coarse_attitude(car.force[rest].mean(0), velocity),
        position_sigma_m=(0.1, 0.1, 0.1),
        velocity_sigma_mps=0.15,
        attitude_sigma_rad=(np.radians(1.0), np.radians(1.0), np.radians(3.0)),
    )
    after = imu_s > car.time_s[begin]
    interval = float(np.median(np.diff(imu_s)))
    imu = ins.Imu(gps_ns(imu_s[after]), (car.rate - car.rate[rest].mean(0))[after] * interval, car.force[after] * interval, interval)
    used = car.time_s > car.time_s[begin]
    fixes = ins.Fixes(gps_ns(car.time_s[used]), car.position[used], car.variance(used), hpl_m=level_m, vpl_m=3 * level_m)
    model = ins.ImuModel(
        ins.SensorNoise(WHOLE.gyroscope_white, WHOLE.gyroscope_bias, 1000.0),
        ins.SensorNoise(WHOLE.accelerometer_white, WHOLE.accelerometer_bias, 1000.0),
    )
    return Recording(imu, fixes, start, model, gps_ns(car.time_s[used]), car.position[used])


@dataclass(frozen=True)
class Aircraft:
    """The small aircraft from its take-off run on: levelled at rest a minute before, heading from the course.

    ``data`` is what the file holds, ``after`` the samples from the start until ``until_s``.
    """

    data: Any
    after: np.ndarray
    recording: Recording


def aircraft(until_s: float = np.inf, level_m: float = np.nan) -> Aircraft:
    """Deviations of a single-frequency receiver, wide enough for errors that stay from second to second (ours)."""
    data = loadmat(FOLDER.parent / "umn_thor_75" / "thor_flight75.mat", squeeze_me=True, struct_as_record=False)["flight_data"]
    time_s, interval = data.time, float(np.median(np.diff(data.time)))
    force, rate = np.column_stack([data.ax, data.ay, data.az]), np.column_stack([data.p, data.q, data.r])
    position = np.column_stack([np.radians(data.lat), np.radians(data.lon), data.alt])
    velocity = np.column_stack([data.vn, data.ve, data.vd])
    time_ns = _ns(time_s)
    received = np.append(False, np.diff(data.GPS_TOW) > 0) & (data.satVisible >= 4)
    rest = (time_s > 142) & (time_s < 156)
    begin = int(np.flatnonzero(received & (np.hypot(data.vn, data.ve) > 10) & (time_s > 195))[0])
    after = (np.arange(time_s.size) > begin) & (time_s < until_s)
    start = ins.Start(
        int(time_ns[begin]),
        tuple(position[begin]),
        tuple(velocity[begin]),
        ins.coarse_attitude(force[rest].mean(0), velocity[begin]),
        position_sigma_m=(3.0, 3.0, 5.0),
        velocity_sigma_mps=0.5,
        # It has pitched up since it stood.
        attitude_sigma_rad=(np.radians(10), np.radians(10), np.radians(15)),
    )
    used = received & after
    n = int(used.sum())
    covariance, moving = np.tile(np.diag([4.0, 4.0, 16.0]), (n, 1, 1)), np.tile(0.25 * np.eye(3), (n, 1, 1))
    imu = ins.Imu(time_ns[after], (rate - rate[rest].mean(0))[after] * interval, force[after] * interval, interval)
    model = ins.ImuModel(ins.SensorNoise(5e-3, 5e-3, 1000.0), ins.SensorNoise(0.1, 0.5, 300.0))
    fixes = ins.Fixes(time_ns[used], position[used], covariance, velocity[used], moving, hpl_m=level_m, vpl_m=3 * level_m)
    return Aircraft(data, after, Recording(imu, fixes, start, model, time_ns[used], position[used]))


def flight(level_m: float = 20.0) -> Recording:
    """The small aircraft until it stands again: its receiver is the only truth."""
    return aircraft(560.0, level_m).recording


def highway(level_m: float = 20.0) -> Recording:
    """A minute of highway with a phone's unit and a live u-blox; the fused pose that comes with it is the truth, of unknown accuracy."""
    folder = FOLDER.parent / "comma2k19_ex1"
    pose, log = folder / "global_pose", folder / "processed_log"
    truth_s, ecef = np.load(pose / "frame_times"), np.load(pose / "frame_positions")
    truth = np.column_stack(_geodetic(ecef))
    imu_s = np.load(log / "IMU" / "accelerometer" / "t")
    force, rate = np.load(log / "IMU" / "accelerometer" / "value"), np.load(log / "IMU" / "gyro" / "value")
    fix_s, fix = np.load(log / "GNSS" / "live_gnss_ublox" / "t"), np.load(log / "GNSS" / "live_gnss_ublox" / "value")
    position = np.column_stack([np.radians(fix[:, :2]), fix[:, 4]])
    course = np.radians(fix[:, 5])
    velocity = np.column_stack([fix[:, 2] * np.cos(course), fix[:, 2] * np.sin(course), np.zeros(course.size)])
    bias = np.load(log / "IMU" / "gyro_bias" / "value")[0]
    interval = float(np.median(np.diff(imu_s)))
    begin = 10
    after, used = imu_s > fix_s[begin], (np.arange(fix_s.size) > begin)
    n = int(used.sum())
    start = ins.Start(
        int(_ns(fix_s[begin : begin + 1])[0]),
        tuple(position[begin]),
        tuple(velocity[begin]),
        ins.coarse_attitude(force[:200].mean(0), velocity[begin]),
        position_sigma_m=(3.0, 3.0, 5.0),
        velocity_sigma_mps=0.5,
        attitude_sigma_rad=(np.radians(5), np.radians(5), np.radians(10)),
    )
    fixes = ins.Fixes(_ns(fix_s[used]), position[used], np.tile(np.diag([4.0, 4.0, 16.0]), (n, 1, 1)), hpl_m=level_m, vpl_m=3 * level_m)
    imu = ins.Imu(_ns(imu_s[after]), (rate - bias)[after] * interval, force[after] * interval, interval)
    model = ins.ImuModel(ins.SensorNoise(5e-3, 5e-3, 1000.0), ins.SensorNoise(0.1, 0.5, 300.0))
    return Recording(imu, fixes, start, model, _ns(truth_s), truth)


def _ns(boot_s: np.ndarray) -> np.ndarray:
    return np.round(boot_s * 1e9).astype(np.int64)


def _geodetic(ecef: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Latitude, longitude [rad] and height [m] on WGS 84, by Bowring's closed form. Provenance: standard."""
    a, f = 6378137.0, 1 / 298.257223563
    b, e2 = a * (1 - f), f * (2 - f)
    x, y, z = ecef.T
    p = np.hypot(x, y)
    beta = np.arctan2(z * a, p * b)
    lat = np.arctan2(z + e2 / (1 - e2) * b * np.sin(beta) ** 3, p - e2 * a * np.cos(beta) ** 3)
    return lat, np.arctan2(y, x), p / np.cos(lat) - a / np.sqrt(1 - e2 * np.sin(lat) ** 2)


if __name__ == "__main__":
    for recording in (drive(), flight(), highway()):
        print(markdown(run([recording])))
