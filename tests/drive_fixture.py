"""The recorded drive of a car: reading, running the filter, and tuning it on one part of the drive to judge it on the other.

``python tests/drive_fixture.py`` tunes both parts anew and prints what stands in `FOLDS`, and what each is worth on the other part.
"""

from __future__ import annotations

import gzip
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from navbound import anp, ins

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
STANDARD_GRAVITY = 9.80665
GPS_EPOCH_UNIX_S = 315_964_800
FOLDER = Path(__file__).parents[2] / "shared" / "data" / "gnss_imu" / "rtkx_drive_0708"

BEGIN_S = 39.75
"""The car begins to move; the filter is started here. Times are those since the first fix."""
MIDDLE_S = 235.0
"""End of the fifth of eleven outages: the drive is cut here into the part that is tuned and the part that is judged."""
END_S = 549.0


def gps_ns(unix_like_s: Floats) -> NDArray[np.int64]:
    """GPS time counted from 1970, as the recordings have it."""
    return np.round((unix_like_s - GPS_EPOCH_UNIX_S) * 1e9).astype(np.int64)


@dataclass(frozen=True)
class Tuning:
    """Declared of the unit: white noise and biases (of 1000 s), delay of its time tags, slip of the wheels (none: free)."""

    delay_s: float
    gyroscope_white: float
    accelerometer_white: float
    gyroscope_bias: float
    accelerometer_bias: float
    wheels_mps: float | None

    def without_wheels(self) -> Tuning:
        """The same, free to slip."""
        return replace(self, wheels_mps=None)


WHOLE = Tuning(0.2, 1.5e-3, 0.02, 3e-4, 0.03, 0.2)
"""Chosen on the whole drive: in-sample."""


class Drive:
    """The car: 100 Hz inertial unit (x backward, y right, z up: found from its correlation with the RTK), RTK at 4 Hz."""

    def __init__(self, folder: Path) -> None:
        with gzip.open(folder / "imu_1934_timetagged.csv.gz", "rt") as file:
            imu = np.loadtxt(file, delimiter=",", skiprows=1)
        with gzip.open(folder / "peer_solution_at_gnss_epochs.csv.gz", "rt") as file:
            peer = np.loadtxt(file, delimiter=",", skiprows=1)
        lines = [line.split() for line in (folder / "gnss_1934_sf.pos").read_text().splitlines() if not line.startswith("%")]
        rtk = np.array([[float(x) for x in line[2:]] for line in lines])
        stamps = [datetime.strptime(f"{x[0]} {x[1]}", "%Y/%m/%d %H:%M:%S.%f").replace(tzinfo=UTC).timestamp() for x in lines]
        self.time_s = np.array(stamps)
        self.since_s = self.time_s - self.time_s[0]
        self.imu_s = imu[:, 0]
        self.force = imu[:, 1:4] * [-1, 1, -1] * STANDARD_GRAVITY
        self.rate = np.radians(imu[:, 4:7]) * [-1, 1, -1]
        self.position = np.column_stack([np.radians(rtk[:, :2]), rtk[:, 2]])
        self.sigma_enu = rtk[:, [6, 5, 7]]
        self.outage = peer[:, 8] > 0
        self.peer = np.column_stack([np.radians(peer[:, 5:7]), peer[:, 7]])
        self.metres = np.array([6.3615e6, 6.3885e6 * np.cos(self.position[0, 0]), 1.0])

    def fused(self, tuning: Tuning, outage: Flags, until_s: float = np.inf) -> ins.Fused:
        """Forward only. Levelling and the gyroscopes' bias from 33 s at rest before the drive, which nothing is judged on.

        The stated velocity is the difference of two positions, an eighth of a second old: nothing new, and not used.
        """
        imu_s = self.imu_s - tuning.delay_s
        rest = (imu_s > self.time_s[0] + 4) & (imu_s < self.time_s[0] + 37)
        begin = int(np.argmin(np.abs(self.since_s - BEGIN_S)))
        velocity = (self.position[begin] - self.position[begin - 1]) * self.metres / 0.25 * [1, 1, -1]
        start = ins.Start(
            int(gps_ns(self.time_s[begin : begin + 1])[0]),
            tuple(self.position[begin]),
            tuple(velocity),
            ins.coarse_attitude(self.force[rest].mean(0), velocity),
            position_sigma_m=(0.1, 0.1, 0.1),
            velocity_sigma_mps=0.15,
            attitude_sigma_rad=(np.radians(1.0), np.radians(1.0), np.radians(3.0)),
        )
        after = (imu_s > self.time_s[begin]) & (imu_s < self.time_s[0] + until_s)
        interval = float(np.median(np.diff(imu_s)))
        rate = self.rate - self.rate[rest].mean(0)
        imu = ins.Imu(gps_ns(imu_s[after]), rate[after] * interval, self.force[after] * interval, interval)
        used = ~outage & (self.time_s > self.time_s[begin]) & (self.since_s < until_s)
        fixes = ins.Fixes(gps_ns(self.time_s[used]), self.position[used], self.variance(used))
        model = ins.ImuModel(
            ins.SensorNoise(tuning.gyroscope_white, tuning.gyroscope_bias, 1000.0),
            ins.SensorNoise(tuning.accelerometer_white, tuning.accelerometer_bias, 1000.0),
        )
        wheels = None if tuning.wheels_mps is None else ins.Wheels(sigma_mps=tuning.wheels_mps, mount_rad=0.1, period_s=0.1)
        # The filter by itself: a tuning that is tried may be a wrong one, and what stands beside a filter would hide it.
        how = ins.FilterSettings(guarded=False)
        return ins.fuse(imu, ins.Aiding(fixes=fixes), start, imu_model=model, settings=how, output_period_s=0.0, wheels=wheels)

    def variance(self, epochs: Flags) -> Floats:
        """Of the RTK: 2 cm for what the stated centimetre leaves out: seven printed decimals of a degree, vibration, the lever arm."""
        variance: Floats = np.einsum("ni,ij->nij", self.sigma_enu[epochs] ** 2, np.eye(3)) + 0.02**2 * np.eye(3)
        return variance

    def error(self, fused: ins.Fused, epochs: Flags) -> tuple[Floats, Floats]:
        """East and north error at epochs of the RTK, and the covariance there."""
        at = gps_ns(self.time_s[epochs])
        estimate = np.column_stack([np.interp(at, fused.time_ns, fused.position[:, k]) for k in range(2)])
        near = np.searchsorted(fused.time_ns, at).clip(0, fused.time_ns.size - 1)
        return ((estimate - self.position[epochs, :2]) * self.metres[:2])[:, ::-1], fused.covariance_enu_m2[near][:, :2, :2]

    def in_outages(self, tuning: Tuning, low_s: float, high_s: float) -> tuple[Floats, Flags]:
        """Horizontal errors in the outages of a part of the drive, and whether each is inside the 95 % circle."""
        judged = self.outage & (self.since_s >= low_s) & (self.since_s < high_s)
        error, covariance = self.error(self.fused(tuning, self.outage), judged)
        h = np.hypot(error[:, 0], error[:, 1])
        return h, h <= anp.circle(covariance, 0.05)

    def likelihood(self, tuning: Tuning, low_s: float, high_s: float) -> tuple[float, float]:
        """Mean log-likelihood and mean square of innovations in a part of the drive: of the first fix after 15 s without any.

        Five runs, in which the receiver is heard for 5 s of every 20, shifted by 4 s each; before the part it is always heard. Nothing else
        of the drive is looked at: no error against the RTK but that of predicting it.
        """
        log, square = [], []
        for shift in range(0, 20, 4):
            silent = (self.since_s > low_s) & ((self.since_s - low_s - shift) % 20 >= 5)
            fused = self.fused(tuning, silent, high_s)
            first = ~silent & np.append(False, silent[:-1]) & (self.since_s > low_s + 20) & (self.since_s < high_s)
            before = np.searchsorted(fused.time_ns, gps_ns(self.time_s[first])) - 1
            step_s = (gps_ns(self.time_s[first]) - fused.time_ns[before]) * 1e-9
            predicted = fused.position[before, :2] + fused.velocity_ned_mps[before, :2] * step_s[:, None] / self.metres[:2]
            z = ((self.position[first, :2] - predicted) * self.metres[:2])[:, ::-1]
            s = fused.covariance_enu_m2[before][:, :2, :2] + self.variance(first)[:, :2, :2]
            q = np.einsum("ni,nij,nj->n", z, np.linalg.inv(s), z)
            log.extend(-0.5 * (q + np.log(np.linalg.det(s))))
            square.extend(q / 2)
        return float(np.mean(log)), float(np.mean(square))

    def followed(self, tuning: Tuning, low_s: float, high_s: float) -> float:
        """Horizontal variance of the innovations with the receiver always on, in a part of the drive. [m²]."""
        fused = self.fused(tuning, np.zeros_like(self.outage), high_s)
        part = (self.since_s > max(low_s, BEGIN_S + 20)) & (self.since_s < high_s)
        before = np.searchsorted(fused.time_ns, gps_ns(self.time_s[part])) - 1
        step_s = (gps_ns(self.time_s[part]) - fused.time_ns[before]) * 1e-9
        predicted = fused.position[before, :2] + fused.velocity_ned_mps[before, :2] * step_s[:, None] / self.metres[:2]
        return float(np.mean(((self.position[part, :2] - predicted) * self.metres[:2]) ** 2))


GRID = {
    "gyroscope_white": (0.4e-3, 0.75e-3, 1.5e-3, 3e-3, 6e-3),
    "accelerometer_white": (0.01, 0.02, 0.04, 0.08),
    "gyroscope_bias": (3e-4, 1e-3, 3e-3),
    "accelerometer_bias": (0.03, 0.1, 0.3),
    "wheels_mps": (0.05, 0.1, 0.2, 0.4, 0.8),
}
DELAYS_S = (0.1, 0.125, 0.15, 0.175, 0.2, 0.225, 0.25)


def likeliest(drive: Drive, tuning: Tuning, name: str, low_s: float, high_s: float) -> Tuning:
    """One number of a tuning, by the innovations of a part."""
    tries = [replace(tuning, **{name: value}) for value in GRID[name]]
    return max(tries, key=lambda t: drive.likelihood(t, low_s, high_s)[0])


def tuned(drive: Drive, low_s: float, high_s: float, *, wheels: bool) -> Tuning:
    """The delay by the smallest innovations, then coordinate by coordinate the likeliest of the grid, twice over."""
    first = WHOLE.without_wheels()
    best = replace(
        WHOLE if wheels else first, delay_s=min(DELAYS_S, key=lambda d: drive.followed(replace(first, delay_s=d), low_s, high_s))
    )
    for name in [name for name in GRID if wheels or name != "wheels_mps"] * 2:
        best = likeliest(drive, best, name, low_s, high_s)
    return best


PARTS = ((BEGIN_S, MIDDLE_S), (MIDDLE_S, END_S))
FOLDS = {
    True: (Tuning(0.15, 3e-3, 0.02, 3e-4, 0.03, 0.2), Tuning(0.225, 3e-3, 0.04, 3e-4, 0.03, 0.2)),
    False: (Tuning(0.15, 3e-3, 0.01, 3e-4, 0.03, None), Tuning(0.225, 3e-3, 0.02, 3e-4, 0.03, None)),
}
"""With wheels and without: what `tuned` finds on the first part, and on the second."""


def words(h: Floats, inside: Flags) -> str:
    """What is judged, in a line."""
    return f"{np.sqrt(np.mean(h**2)):.3f} m RMS, {np.quantile(h, 0.95):.3f} m, {inside.mean():.3f} inside, {h.size} epochs"


def main() -> None:
    """Tune both parts and judge each on the other."""
    drive = Drive(FOLDER)
    for wheels in (True, False):
        judged = []
        for part, other in (PARTS, PARTS[::-1]):
            result = tuned(drive, *part, wheels=wheels)
            judged.append(drive.in_outages(result, *other))
            print(result, drive.likelihood(result, *part))
            print("held out", words(*judged[-1]))
            print("own part", words(*drive.in_outages(result, *part)), flush=True)
        h, inside = (np.concatenate(x) for x in zip(*judged, strict=True))
        print("both", words(h, inside), flush=True)


if __name__ == "__main__":
    main()
