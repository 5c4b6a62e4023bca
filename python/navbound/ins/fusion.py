"""Inertial mechanization and the navigation filter; public as `navbound.ins`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound import _core
from navbound.ins.aiding import Aiding, rows
from navbound.ins.settings import FilterSettings, Imu, ImuModel, Start, Wheels, declared_to_core
from navbound.table.arguments import checked

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


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
class Reversion:
    """The filter without satellites, and how far the one with satellites is from it; a row a result, NaN where there is nothing to say.

    Attributes
    ----------
    position : ndarray, shape (n, 3)
        Latitude, longitude, height. [rad, rad, m]
    covariance_enu_m2 : ndarray, shape (n, 3, 3)
        Of its position error. [m²]
    mode : list of str
        What keeps its position.
    separation_m, separation_limit_m : ndarray, shape (n,)
        Horizontal distance between both, and the distance in that direction which filters that are right exceed with `separation_risk`. [m]
    """

    position: NDArray[np.float64]
    covariance_enu_m2: NDArray[np.float64]
    mode: list[str]
    separation_m: NDArray[np.float64]
    separation_limit_m: NDArray[np.float64]


@dataclass(frozen=True)
class Fused(Track):
    """The filter's results; NaN with the mode ``stopped`` after a stop, and in a hole of the inertial samples until a measurement ends it.

    Attributes
    ----------
    covariance_enu_m2 : ndarray, shape (n, 3, 3)
        Of the position error. [m²]
    velocity_sigma_mps, attitude_sigma_rad : ndarray, shape (n, 3)
        Standard deviations north, east, down. [m/s, rad]
    gyroscope_bias_radps, accelerometer_bias_mps2 : ndarray, shape (n, 3)
        Estimates, body axes. [rad/s, m/s²]
    mode : list of str
        ``gnss``, ``dme_dme``, ``vor_dme``, ``coasting``, ``aligning`` (after a hole, until the tilt is known again), ``stopped``.
    status : list of str
        ``ok``, ``degraded``, ``not_available``: what may be done with the position. ``ok`` needs a level for a risk of 1e-5; the filter's
        covariance alone never makes it.
    reasons : list of list of str
        Ids of why it is no better, as in docs/methods/fused-integrity.md; empty where it is ``ok``.
    source : list of str
        Where the position comes from: ``filter``, ``snapshot`` (the ranges of the instant, or the solved position, alone: without attitude)
        or ``none``.
    hpl_m, vpl_m : ndarray, shape (n,)
        Protection levels of the position; NaN where there are none. [m]
    n_states : ndarray of int, shape (n,)
        States in the filter, with those of the one beside it. [1]
    samples : dict of str to int
        Inertial samples done, bridged, `adrift` (after a gap), late, refused, stopped; since the last new start of the filter
        (docs/methods/fused-integrity.md).
    stopped, refused : tuple of (int, str), or None
        Time and reason of the stop, and of the first refused sample. [ns]
    holes : list of tuple of (int, float)
        Holes too long to be bridged: time of the first sample after each, and how long before it the last state was. [ns, s]
    refusals : dict of str to int
        Measurements not used before any gate, by reason: ``repeated``, ``same_name`` (several sources under one name at an instant),
        ``out_of_range``, ``late``, ``no_place``, ``no_position``, ``stopped``.
    fix_delay_s : float or None
        By how much solved positions are later than their tags say, where the motion shows it: their accelerations come later than the
        unit's. [s]
    clock_jumps : int
        How often the receiver's clock has jumped and was set anew.
    left_out : list of str
        Stations left out at the end because they contradict the filter.
    further : dict of str to float
        Further states at the end, by name.
    innovations : dict of str to Innovations
        By kind of measurement, since the filter's last new start.
    reversion : Reversion or None
        The filter without satellites, where one runs beside the main one.
    """

    covariance_enu_m2: NDArray[np.float64]
    velocity_sigma_mps: NDArray[np.float64]
    attitude_sigma_rad: NDArray[np.float64]
    gyroscope_bias_radps: NDArray[np.float64]
    accelerometer_bias_mps2: NDArray[np.float64]
    mode: list[str]
    status: list[str]
    reasons: list[list[str]]
    source: list[str]
    hpl_m: NDArray[np.float64]
    vpl_m: NDArray[np.float64]
    n_states: NDArray[np.int64]
    samples: dict[str, int]
    stopped: tuple[int, str] | None
    refused: tuple[int, str] | None
    holes: list[tuple[int, float]]
    refusals: dict[str, int]
    fix_delay_s: float | None
    clock_jumps: int
    left_out: list[str]
    further: dict[str, float]
    innovations: dict[str, Innovations]
    reversion: Reversion | None


def _start(start: Start) -> dict[str, object]:
    return {
        "time_ns": start.time_ns,
        "position": list(start.position),
        "velocity_ned_mps": list(start.velocity_ned_mps),
        "attitude_rad": list(start.attitude_rad),
    }


@checked
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


@checked
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


@checked
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
    while: clock and drift, constellations, barometer, stations, satellites. Satellite ranges are coupled as ``settings.form`` says; solved
    positions of `aiding` are taken for new each time. Equations and limits in docs/methods/ins.md.

    Parameters
    ----------
    imu : Imu
        Samples; one that is not finite is left out and counted, a short hole is bridged, after a long one the filter aligns anew.
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
        Wrong shapes, a setting outside its domain. A row of a measurement that is none is refused alone and counted in ``refusals``.
    """
    model, how = imu_model or ImuModel(), settings or FilterSettings()
    periods = (output_period_s, update_period_s)
    return _fused(_core.ins_fuse(_start(start), imu.columns(), aiding.tables(), declared_to_core(model, how, start, periods, wheels)))


def _covariance(table: NDArray[np.float64]) -> NDArray[np.float64]:
    return table[:, [9, 10, 12, 10, 11, 13, 12, 13, 14]].reshape(-1, 3, 3)


def _reversion(fields: tuple[NDArray[np.float64], list[str], NDArray[np.float64]] | None) -> Reversion | None:
    if fields is None:
        return None
    table, mode, apart = fields
    return Reversion(table[:, :3].copy(), _covariance(table), mode, apart[:, 0].copy(), apart[:, 1].copy())


def _fused(fields: dict[str, Any]) -> Fused:
    table = fields["rows"]
    return Fused(
        time_ns=fields["time_ns"],
        position=table[:, :3].copy(),
        velocity_ned_mps=table[:, 3:6].copy(),
        attitude_rad=table[:, 6:9].copy(),
        covariance_enu_m2=_covariance(table),
        velocity_sigma_mps=table[:, 15:18].copy(),
        attitude_sigma_rad=table[:, 18:21].copy(),
        gyroscope_bias_radps=table[:, 21:24].copy(),
        accelerometer_bias_mps2=table[:, 24:27].copy(),
        mode=fields["mode"],
        status=fields["status"],
        reasons=fields["reasons"],
        source=fields["source"],
        hpl_m=fields["hpl_m"],
        vpl_m=fields["vpl_m"],
        n_states=fields["n_states"],
        samples=dict(zip(("done", "bridged", "adrift", "late", "refused", "stopped"), fields["samples"], strict=True)),
        stopped=fields["stopped"],
        refused=fields["refused"],
        holes=fields["holes"],
        refusals=dict(fields["refusals"]),
        fix_delay_s=fields["fix_delay_s"],
        clock_jumps=fields["clock_jumps"],
        left_out=fields["left_out"],
        further=dict(fields["further"]),
        innovations={kind: Innovations(*numbers) for kind, numbers in fields["innovations"].items()},
        reversion=_reversion(fields["reversion"]),
    )
