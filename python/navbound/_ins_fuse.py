"""Inertial mechanization and the navigation filter; public as `navbound.ins`."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from navbound import _core
from navbound._ins_aiding import Aiding, rows
from navbound.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

STANDARD_GRAVITY_MPS2 = 9.80665


@dataclass(frozen=True)
class Start:
    """Where the navigation begins.

    Attributes
    ----------
    time_ns : int
        GPS time. [ns]
    position : tuple of float
        Latitude, longitude, height above the ellipsoid. [rad, rad, m]
    velocity_ned_mps : tuple of float
        North, east, down. [m/s]
    attitude_rad : tuple of float
        Roll, pitch, heading of the body axes forward, right, down. [rad]
    position_sigma_m, velocity_sigma_mps, attitude_sigma_rad
        Standard deviations: north, east, down; each axis; about north, east, down. [m, m/s, rad]
    """

    time_ns: int
    position: tuple[float, float, float]
    velocity_ned_mps: tuple[float, float, float]
    attitude_rad: tuple[float, float, float]
    position_sigma_m: tuple[float, float, float] = (10.0, 10.0, 15.0)
    velocity_sigma_mps: float = 0.2
    attitude_sigma_rad: tuple[float, float, float] = (5e-5, 5e-5, 5e-4)


@dataclass(frozen=True)
class Imu:
    """Increments of an inertial unit over its sampling intervals, body axes forward, right, down.

    Attributes
    ----------
    time_ns : array_like of int, shape (n,)
        End of each interval, GPS time. [ns]
    angle_rad : array_like, shape (n, 3)
        Integral of the angular rate. [rad]
    velocity_mps : array_like, shape (n, 3)
        Integral of the specific force. [m/s]
    interval_s : array_like, shape (n,) or (), optional
        Length of each interval; without it the time since the sample before, or the median of those where that is more than half as long
        again or not positive: a hole, or a time that runs backwards. [s]
    """

    time_ns: ArrayLike
    angle_rad: ArrayLike
    velocity_mps: ArrayLike
    interval_s: ArrayLike | None = None

    def columns(self) -> dict[str, NDArray[np.int64] | NDArray[np.float64]]:
        """Give contiguous columns of one length."""
        time = np.ascontiguousarray(np.asarray(self.time_ns, dtype=np.int64))
        if time.ndim != 1 or time.size == 0:
            raise InputError("time_ns", f"shape {time.shape}", domain="shape (n,), at least one sample")
        if self.interval_s is None:
            since = np.diff(time, prepend=time[0]) * 1e-9
            usual = float(np.median(since[1:])) if time.size > 1 else math.nan
            interval = np.where((since > 0.0) & (since <= 1.5 * usual), since, usual)
        else:
            interval = np.broadcast_to(np.asarray(self.interval_s, dtype=np.float64), time.shape)
        return {
            "time_ns": time,
            "interval_s": np.ascontiguousarray(interval),
            "angle_rad": rows("angle_rad", self.angle_rad, (time.size, 3)),
            "velocity_mps": rows("velocity_mps", self.velocity_mps, (time.size, 3)),
        }


@dataclass(frozen=True)
class SensorNoise:
    """White noise and a first-order Gauss-Markov bias of each axis.

    Attributes
    ----------
    white : float
        Angle random walk [rad/sqrt(s)] or velocity random walk [m/s/sqrt(s)].
    bias : float
        Standard deviation of the bias. [rad/s or m/s²]
    bias_time_s : float
        Its correlation time. [s]
    """

    white: float
    bias: float
    bias_time_s: float = 3600.0


@dataclass(frozen=True)
class ImuModel:
    """What the filter believes of the inertial unit.

    The defaults are those of Dai 2022 as far as they are printed (0.01 deg/h, 1e-4 g); white noise (0.002 deg/sqrt(h), 10 µg/sqrt(Hz))
    and the correlation time are ours.
    """

    gyroscope: SensorNoise = SensorNoise(math.radians(0.002 / 60.0), math.radians(0.01 / 3600.0))
    accelerometer: SensorNoise = SensorNoise(10e-6 * STANDARD_GRAVITY_MPS2, 1e-4 * STANDARD_GRAVITY_MPS2)


@dataclass(frozen=True)
class Clock:
    """What the filter believes of the receiver's clock, as lengths; the default is a temperature-compensated crystal (inferred).

    Attributes
    ----------
    bias_m, drift_mps : float
        Standard deviations after the first range. [m, m/s]
    frequency_m2ps, walk_m2ps3 : float
        Power densities of white frequency noise and of its random walk. [m²/s, m²/s³]
    inter_system_m : float
        Standard deviation of the bias between constellations. [m]
    """

    bias_m: float = 1e4
    drift_mps: float = 100.0
    frequency_m2ps: float = 0.009
    walk_m2ps3: float = 0.0355
    inter_system_m: float = 100.0


@dataclass(frozen=True)
class Wheels:
    """The vehicle rolls where its wheels point: no sideways or upward velocity at a point. An assumption; not for aircraft.

    Attributes
    ----------
    arm_m : tuple of float
        The point, seen from the inertial unit, body axes. [m]
    sigma_mps : float
        Standard deviation of both velocities. [m/s]
    mount_rad : float
        Standard deviation of the angles between body axes and wheels, two constants that the filter estimates. [rad]
    period_s : float
        Time between uses. [s]
    """

    arm_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    sigma_mps: float = 0.1
    mount_rad: float = 0.05
    period_s: float = 0.1


@dataclass(frozen=True)
class FilterSettings:
    """How the filter works.

    Attributes
    ----------
    errors : {"correlated", "white"}
        Whether what stays in the measurements has states of its own. ``"white"`` takes everything for new at each measurement; it is
        here to show that it fails.
    lever_arm_m : tuple of float
        From the inertial unit to the antenna, body axes. [m]
    gate_risk : float
        Risk of throwing away a good measurement.
    samples_per_step : int
        Samples that share a step of the covariance; 1 is every sample.
    gap_most_s, gap_acceleration_mps2, gap_rate_radps : float
        Longest hole that is bridged, and the deviations of acceleration and rate that it may hide. [s, m/s², rad/s]
    age_most_s : float
        Oldest measurement used, against the last sample. [s]
    set_after_s : float
        Time after which the bias of an unseen satellite is forgotten. [s]
    lose_s, gain_s : float
        Patience of the mode: time without an aid before it is left, time with it before it is entered. [s]
    """

    errors: Literal["correlated", "white"] = "correlated"
    lever_arm_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    gate_risk: float = 1e-4
    samples_per_step: int = 1
    gap_most_s: float = 1.0
    gap_acceleration_mps2: float = 1.0
    gap_rate_radps: float = 0.1
    age_most_s: float = 0.2
    set_after_s: float = 60.0
    lose_s: float = 5.0
    gain_s: float = 10.0
    clock: Clock = field(default_factory=Clock)


@dataclass(frozen=True)
class Track:
    """Position, velocity and attitude, shape (n, 3) each: [rad, rad, m], north, east, down [m/s], roll, pitch, heading [rad]."""

    time_ns: NDArray[np.int64]
    position: NDArray[np.float64]
    velocity_ned_mps: NDArray[np.float64]
    attitude_rad: NDArray[np.float64]


@dataclass(frozen=True)
class Innovations:
    """What the innovations of one kind of measurement say.

    Attributes
    ----------
    n_used, n_gated, n_refused : int
        Scalars used, thrown away by the gate, refused before it.
    mean_square : float
        Mean squared normalised innovation (NIS); 1 for a filter that is right, and also for many that are not.
    lag_one : float
        Correlation with the innovation before of the same source; white ones stay within ``2 / sqrt(n_pairs)``.
    n_pairs : int
        Pairs behind it.
    """

    n_used: int
    n_gated: int
    n_refused: int
    mean_square: float
    lag_one: float
    n_pairs: int


@dataclass(frozen=True)
class Fused(Track):
    """The filter's results; NaN with the mode ``stopped`` after a stop.

    Attributes
    ----------
    covariance_enu_m2 : ndarray, shape (n, 3, 3)
        Of the position error. [m²]
    velocity_sigma_mps, attitude_sigma_rad : ndarray, shape (n, 3)
        Standard deviations north, east, down. [m/s, rad]
    gyroscope_bias_radps, accelerometer_bias_mps2 : ndarray, shape (n, 3)
        Estimates, body axes. [rad/s, m/s²]
    mode : list of str
        ``gnss``, ``dme_dme``, ``vor_dme``, ``coasting``, ``stopped``.
    n_states : ndarray of int, shape (n,)
        States in the filter. [1]
    samples : dict of str to int
        Inertial samples done, bridged, late, refused, stopped.
    stopped, refused : tuple of (int, str), or None
        Time and reason of the stop, and of the first refused sample. [ns]
    further : dict of str to float
        Further states at the end, by name.
    innovations : dict of str to Innovations
        By kind of measurement.
    """

    covariance_enu_m2: NDArray[np.float64]
    velocity_sigma_mps: NDArray[np.float64]
    attitude_sigma_rad: NDArray[np.float64]
    gyroscope_bias_radps: NDArray[np.float64]
    accelerometer_bias_mps2: NDArray[np.float64]
    mode: list[str]
    n_states: NDArray[np.int64]
    samples: dict[str, int]
    stopped: tuple[int, str] | None
    refused: tuple[int, str] | None
    further: dict[str, float]
    innovations: dict[str, Innovations]


def _start(start: Start) -> dict[str, object]:
    return {
        "time_ns": start.time_ns,
        "position": list(start.position),
        "velocity_ned_mps": list(start.velocity_ned_mps),
        "attitude_rad": list(start.attitude_rad),
    }


def coarse_attitude(force_mps2: ArrayLike, velocity_ned_mps: ArrayLike) -> tuple[float, float, float]:
    """Roll and pitch from the mean specific force at rest, heading from the course over the ground afterwards.

    ``roll = atan2(-f_y, -f_z)``, ``pitch = atan2(f_x, hypot(f_y, f_z))``, ``heading = atan2(v_E, v_N)``.

    Parameters
    ----------
    force_mps2 : array_like, shape (3,)
        Body axes. [m/s²]
    velocity_ned_mps : array_like, shape (3,)
        North, east, down, at least 1 m/s horizontally; the heading is the body's only where it moves where its nose points. [m/s]

    Returns
    -------
    tuple of float
        Roll, pitch, heading. [rad]

    Raises
    ------
    InputError
        A force that is not gravity within a tenth, or a speed too low for a course.
    """
    force, velocity = rows("force_mps2", force_mps2, (3,)), rows("velocity_ned_mps", velocity_ned_mps, (3,))
    roll, pitch, heading = _core.ins_coarse(force.tolist(), velocity.tolist())
    return roll, pitch, heading


def mechanize(imu: Imu, start: Start) -> Track:
    """Pure inertial navigation: strapdown mechanization in north, east, down with two-sample coning and sculling.

    Earth and transport rate, Somigliana gravity with free-air terms; equations in docs/methods/ins.md. Nothing holds the height: its
    error grows e-fold in about 570 s.

    Parameters
    ----------
    imu : Imu
        n samples.
    start : Start
        State at its time, before the first sample; its standard deviations are not used.

    Returns
    -------
    Track
        After each sample.

    Raises
    ------
    InputError
        A sample that is not finite, a time that does not increase, a place within 0.1 degree of a pole.
    """
    columns = imu.columns()
    table = _core.ins_mechanize(_start(start), columns)
    time = np.asarray(columns["time_ns"], dtype=np.int64)
    return Track(time, table[:, :3].copy(), table[:, 3:6].copy(), table[:, 6:9].copy())


def fuse(
    imu: Imu,
    aiding: Aiding,
    start: Start,
    *,
    imu_model: ImuModel | None = None,
    settings: FilterSettings | None = None,
    output_period_s: float = 1.0,
    update_period_s: float = 0.0,
    wheels: Wheels | None = None,
) -> Fused:
    """Run a flight through the closed-loop error-state filter.

    Fifteen states of the inertial navigator (phi-angle error model, north, east, down) and one for everything that stays wrong for a
    while: clock and drift, constellations, barometer, stations, satellites. Satellite ranges are coupled tightly, solved positions
    loosely, by what `aiding` holds. Equations and limits in docs/methods/ins.md.

    Parameters
    ----------
    imu : Imu
        Samples; one that is not finite is left out and counted, a hole is bridged or stops the filter.
    aiding : Aiding
        Measurements with their budgets.
    start : Start
        State and its standard deviations.
    imu_model : ImuModel, optional
        What the filter believes of the inertial unit.
    settings : FilterSettings, optional
        How it works.
    output_period_s : float
        Time between results; 0 gives one a sample. [s]
    update_period_s : float
        Least time between two uses of a kind of measurement; 0 uses all. [s]
    wheels : Wheels, optional
        An assumption about a road vehicle.

    Returns
    -------
    Fused
        Results, modes and the innovations' verdict.

    Raises
    ------
    InputError
        Wrong shapes, a setting outside its domain, a measured place that is none.
    """
    model, how = imu_model or ImuModel(), settings or FilterSettings()
    for name, value in (("output_period_s", output_period_s), ("update_period_s", update_period_s)):
        if not 0.0 <= value < math.inf:
            raise InputError(name, value, "s", "[0, inf)")
    if how.samples_per_step < 1:
        raise InputError("samples_per_step", how.samples_per_step, "1", "[1, inf)")
    told = {
        "gyroscope": [model.gyroscope.white, model.gyroscope.bias, model.gyroscope.bias_time_s],
        "accelerometer": [model.accelerometer.white, model.accelerometer.bias, model.accelerometer.bias_time_s],
        "clock": [how.clock.bias_m, how.clock.drift_mps, how.clock.frequency_m2ps, how.clock.walk_m2ps3, how.clock.inter_system_m],
        "white": how.errors == "white",
        "lever_arm_m": list(how.lever_arm_m),
        "gate_risk": how.gate_risk,
        "samples_per_step": how.samples_per_step,
        "gap": [how.gap_most_s, how.gap_acceleration_mps2, how.gap_rate_radps],
        "age_most_s": how.age_most_s,
        "set_after_s": how.set_after_s,
        "patience_s": [how.lose_s, how.gain_s],
        "position_sigma_m": list(start.position_sigma_m),
        "velocity_sigma_mps": start.velocity_sigma_mps,
        "attitude_sigma_rad": list(start.attitude_sigma_rad),
        "period_s": [output_period_s, update_period_s],
        "wheels": None if wheels is None else [*wheels.arm_m, wheels.sigma_mps, wheels.mount_rad, wheels.period_s],
    }
    return _fused(_core.ins_fuse(_start(start), imu.columns(), aiding.tables(), told))


def _fused(found: dict[str, Any]) -> Fused:
    table = found["rows"]
    upper = table[:, [9, 10, 12, 10, 11, 13, 12, 13, 14]].reshape(-1, 3, 3)
    return Fused(
        time_ns=found["time_ns"],
        position=table[:, :3].copy(),
        velocity_ned_mps=table[:, 3:6].copy(),
        attitude_rad=table[:, 6:9].copy(),
        covariance_enu_m2=upper,
        velocity_sigma_mps=table[:, 15:18].copy(),
        attitude_sigma_rad=table[:, 18:21].copy(),
        gyroscope_bias_radps=table[:, 21:24].copy(),
        accelerometer_bias_mps2=table[:, 24:27].copy(),
        mode=found["mode"],
        n_states=found["n_states"],
        samples=dict(zip(("done", "bridged", "late", "refused", "stopped"), found["samples"], strict=True)),
        stopped=found["stopped"],
        refused=found["refused"],
        further=dict(found["further"]),
        innovations={kind: Innovations(*numbers) for kind, numbers in found["innovations"].items()},
    )
