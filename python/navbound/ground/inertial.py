"""The inertial navigator on taxi-in: simulated samples, the filter that GBAS ranges and then carrier phase aid.

Before the transition point the filter has corrected, smoothed ranges and their rates; behind it only phase differenced over a fifth of a
second, as range rates. What stays in a range is a state of its own, with the noise of equation 4 in one of its two forms.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound import gbas, gnss, ins
from navbound.ground.sky import STEPS, line, mode_of
from navbound.ins.settings import STANDARD_GRAVITY_MPS2

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.ground.motion import Movement
    from navbound.ground.sky import Sky, Way
    from navbound.scenario.taxi import Taxi

    Floats = NDArray[np.float64]

RATE_HZ = 10
"""Samples a second of the inertial unit (printed)."""
SECOND_NS = 1_000_000_000
AWAY_M = 2.2e7
"""Distance of the places that stand for satellites: their directions count."""
HOW = ins.FilterSettings(set_after_s=3600.0, guarded=False)
"""A satellite whose ranges disagree for a while is not one that rises anew. The integrity of this position is that of GBAS and RRAIM, whose
levels rest on the covariance of this filter alone; satellites here are stand-ins at one distance, which no snapshot describes."""
KNOWN = ins.StartSigma(position_sigma_m=(10.0, 10.0, 15.0), velocity_sigma_mps=0.2, attitude_sigma_rad=(2e-4, 2e-4, 2e-3))
"""How well an aligned system knows its state some minutes before landing (ours)."""


@dataclass(frozen=True)
class Solved:
    """Position of the filter from the threshold on, one row a second; NaN where it has stopped.

    Attributes
    ----------
    error_enu_m : ndarray, shape (n, 3)
        Estimate minus truth. [m]
    covariance_m2 : ndarray, shape (n, 3, 3)
        What the filter says of it. [m²]
    """

    error_enu_m: Floats
    covariance_m2: Floats


class Inertial:
    """What all flights of a scenario share."""

    def __init__(self, taxi: Taxi, movement: Movement, flown: Way, sky: Sky) -> None:
        self.taxi, self.movement, self.flown, self.sky = taxi, movement, flown, sky
        self.start_ns = taxi.start_ns - flown.lead * SECOND_NS
        self.parts = gbas.inertial()
        unit, gravity = taxi.imu, STANDARD_GRAVITY_MPS2
        # A wrong scale of gravity is a bias to a filter that has no state for scales.
        bias = math.hypot(unit.accelerometer_bias_mps2, unit.accelerometer_scale * gravity)
        self.model = ins.ImuModel(
            ins.SensorNoise(unit.gyro_noise_radprts, math.hypot(unit.gyro_bias_radps, unit.gyro_in_run_radps), unit.in_run_time_s),
            ins.SensorNoise(unit.accelerometer_noise_mpsprts, math.hypot(bias, unit.accelerometer_in_run_mps2), unit.in_run_time_s),
        )
        service = mode_of(taxi).service
        self.shortest_s, self.longest_s = gbas.multipath_times()[service]
        sigma = gbas.range_sigma(sky.el_rad[::STEPS], service)
        self.multipath_m = np.hypot(sigma.ground_m, sigma.air_m)
        self.white_m = np.sqrt(sigma.troposphere_m**2 + sigma.ionosphere_m**2 + self.parts.receiver_noise_m**2)

    def flight(self, seed: int, track: int) -> InertialFlight:
        """Samples and clock of one flight."""
        return InertialFlight(self, seed, track)


class InertialFlight:
    """One flight: what its sensors deliver, whatever is solved of it."""

    def __init__(self, shared: Inertial, seed: int, track: int) -> None:
        self.shared = shared
        wide = len(shared.sky.names)
        numbers = {"rate_hz": RATE_HZ, "seed": seed, "flight": track}
        rolled = ins.roll(shared.start_ns, shared.flown.position, shared.taxi.imu, truth_interval_s=1 / STEPS, **numbers)
        self.imu = ins.Imu.of_table(rolled.imu)
        columns = (("truth_lat_rad", "truth_lon_rad", "truth_h_m"), ("vel_n_mps", "vel_e_mps", "vel_d_mps"))
        self.truth, self.velocity = (rolled.truth.select(names).to_numpy() for names in columns)
        attitude = rolled.truth.select("roll_rad", "pitch_rad", "heading_rad").row(0)
        draw, core, clock, n = (seed, track), shared.movement.core, ins.Clock(), len(shared.flown.position)
        self.start = self._start(draw, attitude)
        # The noise that the filter believes in.
        self.clock_m, self.drift_mps = core.clock(draw, len(self.truth), (clock.frequency_m2ps, clock.walk_m2ps3))
        self.doppler_mps = shared.parts.doppler_mps * core.doppler(draw, n, wide).reshape(n, wide)
        lat, lon, h = np.ascontiguousarray(self.truth.T)
        receiver, self.place = (gnss.places(lat, lon, h, shared.sky.az_rad, shared.sky.el_rad, away) for away in (0.0, AWAY_M))
        self.ray_mps = np.gradient(self.place - receiver, 1.0 / STEPS, axis=0)

    def _start(self, draw: tuple[int, int], attitude: tuple[float, ...]) -> ins.Start:
        """A start that is as wrong as it says."""
        position, velocity, turn = np.reshape(self.shared.movement.core.start(draw), (3, 3))
        offset = position * KNOWN.position_sigma_m
        east_m, north_m = self.shared.movement.per_radian_m
        lat, lon, h = self.truth[0]
        return ins.Start(
            self.shared.start_ns,
            (lat + offset[0] / north_m, lon + offset[1] / east_m, h - offset[2]),
            tuple(self.velocity[0] + velocity * KNOWN.velocity_sigma_mps),
            # At small roll and pitch a turn about the vertical is one of the heading.
            tuple(np.asarray(attitude) + turn * KNOWN.attitude_sigma_rad),
            position_sigma_m=KNOWN.position_sigma_m,
            velocity_sigma_mps=KNOWN.velocity_sigma_mps,
            attitude_sigma_rad=KNOWN.attitude_sigma_rad,
        )

    def solve(self, range_error_m: Floats, phase_error_m: Floats, sigma_rate_mps: Floats) -> Solved:
        """Run the filter.

        Parameters
        ----------
        range_error_m : ndarray, shape (fixes, n)
            Errors of the ranges from the begin to the last fix, NaN for one that is not used. [m]
        phase_error_m, sigma_rate_mps : ndarray, shape (steps + 1, n), (steps, n)
            Errors of phase at the last fix and each instant after, NaN for one that is not followed, and the deviation of the rates they
            make. [m, m/s]
        """
        shared = self.shared
        satellites = ins.SatelliteRanges(**self._joined(self._ranges(range_error_m), self._rates(phase_error_m, sigma_rate_mps)))
        fused = ins.fuse(self.imu, ins.Aiding(satellites=satellites), self.start, imu_model=shared.model, settings=HOW)
        n = len(shared.flown.position)
        second = np.round((fused.time_ns - shared.start_ns) / SECOND_NS).astype(np.int64)
        error, covariance = np.full((n, 3), np.nan), np.full((n, 3, 3), np.nan)
        east_m, north_m = shared.movement.per_radian_m
        away = fused.position - self.truth[STEPS * second]
        error[second] = np.stack([away[:, 1] * east_m, away[:, 0] * north_m, away[:, 2]], axis=-1)
        covariance[second] = fused.covariance_enu_m2
        return Solved(error[shared.flown.lead :], covariance[shared.flown.lead :])

    def _joined(self, *parts: dict[str, Floats]) -> dict[str, Any]:
        """Columns of ranges and of rates, satellites by name."""
        columns = {name: np.concatenate([part[name] for part in parts]) for name in parts[0] if name != "number"}
        numbers = np.concatenate([part["number"] for part in parts]).astype(np.int64)
        return {**columns, "satellite": [self.shared.sky.names[k] for k in numbers]}

    def _ranges(self, error_m: Floats) -> dict[str, Floats]:
        """Ranges and their rates at whole seconds; the first belongs to the start."""
        shared = self.shared
        used = ~np.isnan(error_m)
        used[0] = False
        second, number = np.nonzero(used)
        sky, instant = shared.sky, STEPS * second
        towards = line(sky.az_rad[instant, number], sky.el_rad[instant, number])
        velocity_enu = self.velocity[:, [1, 0, 2]] * (1.0, 1.0, -1.0)
        multipath = shared.multipath_m[second, number]
        ratio = self.shared.longest_s / self.shared.shortest_s
        bounds = shared.taxi.navigation.covariance == "bound"
        return {
            "time_ns": shared.start_ns + second * SECOND_NS,
            "number": number,
            "position_ecef_m": self.place[instant, number],
            "velocity_ecef_mps": self.ray_mps[instant, number],
            "range_m": AWAY_M + self.clock_m[instant] + error_m[second, number],
            "sigma_white_m": shared.white_m[second, number],
            # Langel et al. 2021: driven as by the shortest time constant, kept as by the longest.
            "sigma_correlated_m": multipath * (math.sqrt(ratio) if bounds else 1.0),
            "sigma_first_m": multipath * (math.sqrt(2.0 / (1.0 + 1.0 / ratio)) if bounds else 1.0),
            "correlation_time_s": np.full(second.size, shared.longest_s),
            # Towards a satellite that turns about the aircraft only the aircraft's own velocity counts.
            "rate_mps": self.drift_mps[instant] + self.doppler_mps[second, number] - (towards * velocity_enu[instant]).sum(axis=-1),
            "sigma_rate_mps": np.full(second.size, shared.parts.doppler_mps),
        }

    def _rates(self, error_m: Floats, sigma_mps: Floats) -> dict[str, Floats]:
        """Phase differenced from instant to instant, as range rate in the middle."""
        change = np.diff(error_m, axis=0)
        step, number = np.nonzero(~np.isnan(change))
        after = len(self.truth) - len(change) + step
        before = after - 1
        here, there = self.place[before, number], self.place[after, number]
        none = np.full(step.size, np.nan)
        return {
            "time_ns": self.shared.start_ns + (2 * before + 1) * (SECOND_NS // (2 * STEPS)),
            "number": number,
            "position_ecef_m": (here + there) / 2,
            "velocity_ecef_mps": (there - here) * STEPS,
            "range_m": none,
            "sigma_white_m": none,
            "sigma_correlated_m": none,
            "sigma_first_m": none,
            "correlation_time_s": none,
            # Both places are equally far: what changes is the clock and the error.
            "rate_mps": (self.clock_m[after] - self.clock_m[before] + change[step, number]) * STEPS,
            "sigma_rate_mps": sigma_mps[step, number],
        }
