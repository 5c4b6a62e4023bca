"""The input of an inertial navigator: samples, start, sensor models, settings; public as `navbound.ins`."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np

from navbound.errors import InputError
from navbound.ins.aiding import rows
from navbound.table.arguments import checked_fields
from navbound.table.arrays import whole_numbers

if TYPE_CHECKING:
    import polars as pl
    from numpy.typing import ArrayLike, NDArray

STANDARD_GRAVITY_MPS2 = 9.80665


@checked_fields
@dataclass(frozen=True, kw_only=True)
class StartSigma:
    """How well a start is known.

    Attributes
    ----------
    position_sigma_m, velocity_sigma_mps, attitude_sigma_rad
        Standard deviations: north, east, down; each axis; about north, east, down. [m, m/s, rad]
    """

    position_sigma_m: tuple[float, float, float] = (10.0, 10.0, 15.0)
    velocity_sigma_mps: float = 0.2
    attitude_sigma_rad: tuple[float, float, float] = (5e-5, 5e-5, 5e-4)


@checked_fields
@dataclass(frozen=True)
class Start(StartSigma):
    """Where the navigation begins, and how well that is known (`StartSigma`, by name).

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
    """

    time_ns: int
    position: tuple[float, float, float]
    velocity_ned_mps: tuple[float, float, float]
    attitude_rad: tuple[float, float, float]

    @classmethod
    def of_table(cls, table: pl.DataFrame) -> Start:
        """Take the first row of a table with ``time_ns``, ``lat_rad`` ... ``h_m``, ``vel_n_mps`` ..., ``roll_rad`` ... ``heading_rad``."""
        first = table.row(0, named=True)
        return cls(
            time_ns=first["time_ns"],
            position=(first["lat_rad"], first["lon_rad"], first["h_m"]),
            velocity_ned_mps=(first["vel_n_mps"], first["vel_e_mps"], first["vel_d_mps"]),
            attitude_rad=(first["roll_rad"], first["pitch_rad"], first["heading_rad"]),
        )


@checked_fields
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

    @classmethod
    def of_table(cls, table: pl.DataFrame) -> Imu:
        """Take a table with the columns of `navbound.ins.Sensed.imu`."""
        angle, velocity = (
            np.column_stack([table[f"{kind}_{axis}_{unit}"].to_numpy() for axis in "xyz"])
            for kind, unit in (("angle", "rad"), ("velocity", "mps"))
        )
        return cls(table["time_ns"].to_numpy(), angle, velocity, table["interval_s"].to_numpy())

    def columns(self) -> dict[str, NDArray[np.int64] | NDArray[np.float64]]:
        """Give contiguous columns of one length."""
        time = whole_numbers("time_ns", self.time_ns, "whole nanoseconds")
        if time.ndim != 1 or time.size == 0:
            raise InputError("time_ns", f"shape {time.shape}", domain="shape (n,), at least one sample")
        if self.interval_s is None:
            since = np.diff(time, prepend=time[0]) * 1e-9
            usual = float(np.median(since[1:])) if time.size > 1 else math.nan
            interval = np.where((since > 0.0) & (since <= 1.5 * usual), since, usual)
        else:
            interval = rows("interval_s", self.interval_s, time.shape)
        return {
            "time_ns": time,
            "interval_s": np.ascontiguousarray(interval),
            "angle_rad": rows("angle_rad", self.angle_rad, (time.size, 3)),
            "velocity_mps": rows("velocity_mps", self.velocity_mps, (time.size, 3)),
        }


@checked_fields
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


@checked_fields
@dataclass(frozen=True)
class ImuModel:
    """What the filter believes of the inertial unit.

    The defaults are those of Dai 2022 as far as they are printed (0.01 deg/h, 1e-4 g); white noise (0.002 deg/sqrt(h), 10 µg/sqrt(Hz))
    and the correlation time are ours.
    """

    gyroscope: SensorNoise = SensorNoise(math.radians(0.002 / 60.0), math.radians(0.01 / 3600.0))
    accelerometer: SensorNoise = SensorNoise(10e-6 * STANDARD_GRAVITY_MPS2, 1e-4 * STANDARD_GRAVITY_MPS2)


@checked_fields
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


@checked_fields
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


@checked_fields
@dataclass(frozen=True)
class FilterSettings:
    """How the filter works.

    Attributes
    ----------
    errors : {"correlated", "white"}
        Whether what stays in the measurements has states of its own. ``"white"`` takes everything for new at each measurement; it is
        here to show that it fails.
    form : {"tight", "loose", "federated"}
        One filter with every range; positions solved from the ranges of an instant, with three states for what stays in them; or a filter
        for the satellites, one for the rest, and a master without reset, whose covariance is an upper bound.
    reversion : bool
        Whether a filter without satellites runs beside the main one and is given with the results. The federated form has one always.
    separation_risk : float
        Risk, at an instant, of saying that both disagree when both are right.
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
    guarded : bool
        Whether the measurements of each instant are solved by themselves and test the filter (docs/methods/fused-integrity.md). A filter
        that nothing tests is never ``ok``.
    range_age_sigma_s, fix_age_sigma_s : float
        Standard deviation of the age of ranges and of solved positions: three of them times the speed are in every level. [s]
    set_after_s : float
        Time after which the bias of an unseen satellite is forgotten. [s]
    lose_s, gain_s : float
        Patience of the mode: time without an aid before it is left, time with it before it is entered. [s]
    """

    errors: Literal["correlated", "white"] = "correlated"
    form: Literal["tight", "loose", "federated"] = "tight"
    reversion: bool = False
    separation_risk: float = 1e-7
    lever_arm_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    gate_risk: float = 1e-4
    samples_per_step: int = 1
    gap_most_s: float = 1.0
    gap_acceleration_mps2: float = 1.0
    gap_rate_radps: float = 0.1
    age_most_s: float = 0.2
    guarded: bool = True
    range_age_sigma_s: float = 1e-3
    fix_age_sigma_s: float = 0.1
    set_after_s: float = 60.0
    lose_s: float = 5.0
    gain_s: float = 10.0
    clock: Clock = field(default_factory=Clock)


FORMS = ("tight", "loose", "federated")
"""In the order of the core."""


def declared_to_core(
    model: ImuModel, how: FilterSettings, start: Start | StartSigma, periods: tuple[float, float], wheels: Wheels | None
) -> dict[str, object]:
    """Give the core everything that is declared to the filter; `periods` are those of results and updates."""
    for name, value in zip(("output_period_s", "update_period_s"), periods, strict=True):
        if not 0.0 <= value < math.inf:
            raise InputError(name, value, "s", "[0, inf)")
    if how.samples_per_step < 1:
        raise InputError("samples_per_step", how.samples_per_step, "1", "[1, inf)")
    if how.form not in FORMS:
        raise InputError("form", how.form, domain=", ".join(FORMS))
    return {
        "gyroscope": [model.gyroscope.white, model.gyroscope.bias, model.gyroscope.bias_time_s],
        "accelerometer": [model.accelerometer.white, model.accelerometer.bias, model.accelerometer.bias_time_s],
        "clock": [how.clock.bias_m, how.clock.drift_mps, how.clock.frequency_m2ps, how.clock.walk_m2ps3, how.clock.inter_system_m],
        "white": how.errors == "white",
        "form": FORMS.index(how.form),
        "reversion": how.reversion,
        "separation_risk": how.separation_risk,
        "lever_arm_m": list(how.lever_arm_m),
        "gate_risk": how.gate_risk,
        "samples_per_step": how.samples_per_step,
        "gap": [how.gap_most_s, how.gap_acceleration_mps2, how.gap_rate_radps],
        "age_most_s": how.age_most_s,
        "guarded": how.guarded,
        "age_sigma_s": [how.range_age_sigma_s, how.fix_age_sigma_s],
        "set_after_s": how.set_after_s,
        "patience_s": [how.lose_s, how.gain_s],
        "position_sigma_m": list(start.position_sigma_m),
        "velocity_sigma_mps": start.velocity_sigma_mps,
        "attitude_sigma_rad": list(start.attitude_sigma_rad),
        "period_s": list(periods),
        "wheels": None if wheels is None else [*wheels.arm_m, wheels.sigma_mps, wheels.mount_rad, wheels.period_s],
    }
