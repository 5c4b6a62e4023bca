"""Simulated sensors of a flight."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound import _core
from navbound.errors import InputError
from navbound.gnss import Navigation
from navbound.scenario import Scenario, load
from navbound.scenario.sensors import Imu
from navbound.table.arguments import checked

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True)
class Sensed:
    """What the sensors of a simulated flight delivered, and the truth. Body axes are forward, right, down; every sensor sits in one place.

    Attributes
    ----------
    truth : polars.DataFrame
        True motion, from the begin: ``truth_lat_rad``, ``truth_lon_rad``, ``truth_h_m``; velocity ``vel_n_mps``, ``vel_e_mps``,
        ``vel_d_mps``; attitude ``roll_rad``, ``pitch_rad``, ``heading_rad``; specific force ``force_x_mps2`` ... and angular rate against
        inertial space ``rate_x_radps`` ..., body axes.
    imu : polars.DataFrame
        Increments over the interval that ends at ``time_ns``, body axes: ``interval_s``; ``angle_x_rad`` ...; ``velocity_x_mps`` ....
    satellites : polars.DataFrame
        Code ranges corrected for everything that is known: ``satellite``; its place and velocity at transmission in the Earth-fixed axes of
        reception ``sv_x_m`` ..., ``sv_vx_mps`` ...; ``range_m`` with the standard deviations of its white and its slow part and the
        correlation time of the latter; ``range_rate_mps``, ``sigma_rate_mps``; accumulated carrier ``phase_m``, ``sigma_phase_m``.
    dme : polars.DataFrame
        Slant ranges: ``station``, its place ``station_x_m`` ... (Earth-fixed), ``slant_m``, ``sigma_white_m``, ``sigma_bias_m``.
    vor : polars.DataFrame
        Bearings of the aircraft from the station, clockwise from true north: ``station``, ``station_lat_rad`` ..., ``bearing_rad``,
        ``sigma_white_rad``, ``sigma_bias_rad``.
    baro : polars.DataFrame
        Heights above the ellipsoid as the altimeter says them: ``baro_h_m``, ``sigma_white_m``, ``sigma_bias_m``, ``correlation_time_s``.
    clock : polars.DataFrame
        True offset and drift of the satellite receiver's clock: ``clock_m``, ``drift_mps``.
    scenario : Scenario
        What was flown.
    seed, flight : int
        Which random numbers.
    """

    truth: pl.DataFrame
    imu: pl.DataFrame
    satellites: pl.DataFrame
    dme: pl.DataFrame
    vor: pl.DataFrame
    baro: pl.DataFrame
    clock: pl.DataFrame
    scenario: Scenario
    seed: int
    flight: int


@checked
def simulate(
    scenario: str | Path | Scenario,
    flight: int = 0,
    seed: int | None = None,
    *,
    truth_interval_s: float = 1.0,
    navigation: Navigation | None = None,
) -> Sensed:
    """Sensors of a simulated flight.

    Parameters
    ----------
    scenario : str, Path or Scenario
        Name of a shipped scenario, path of a file, or one already read; it needs a ``[sensors]`` part.
    flight : int, optional
        Its number chooses the random streams.
    seed : int, optional
        In place of the scenario's.
    truth_interval_s : float, optional
        Time between rows of the truth, a whole multiple of the inertial unit's interval. [s]
    navigation : Navigation, optional
        Broadcast messages that cover the flight, in place of nominal constellations; from :func:`navbound.gnss.read_navigation`.

    Returns
    -------
    Sensed
        The same scenario, seed and number give the same numbers, whatever else is flown.

    Raises
    ------
    InputError
        A scenario that is not there or has no sensors, a number or seed outside its domain, an interval that is no multiple, messages
        that do not cover the flight.
    FormatError
        A scenario file that cannot be flown.
    """
    loaded = scenario if isinstance(scenario, Scenario) else load(scenario)
    if loaded.sensors is None:
        raise InputError("scenario", loaded.title, domain="a scenario with a [sensors] part")
    seed_used = loaded.seed if seed is None else seed
    for name, value in (("flight", flight), ("seed", seed_used)):
        if not (isinstance(value, int) and 0 <= value < 2**64):
            raise InputError(name, value, domain="[0, 2^64)")
    samples = _samples(truth_interval_s, loaded.sensors.rate_hz)
    prepared = _core.Sensors(loaded.core_json(), None if navigation is None else navigation._core)
    tables = prepared.fly(seed_used, flight, samples)
    names = np.array([station.name for station in loaded.sensors.stations], dtype=object)
    for kind in ("dme", "vor"):
        tables[kind]["station"] = names[tables[kind]["station"]].tolist()
    return Sensed(**{name: _frame(columns) for name, columns in tables.items()}, scenario=loaded, seed=seed_used, flight=flight)


def _samples(interval_s: float, rate_hz: int) -> int:
    """Samples of the inertial unit between rows of the truth."""
    samples = interval_s * rate_hz
    # A written interval times the rate is a whole number to some 1e-12.
    if not (0.5 <= samples < 2**63 and abs(samples - round(samples)) < 1e-6):
        raise InputError("truth_interval_s", interval_s, "s", f"whole multiples of 1/{rate_hz} s")
    return round(samples)


@dataclass(frozen=True)
class Rolled:
    """What an inertial unit on wheels delivered, and the truth: tables as in `Sensed`.

    Attributes
    ----------
    truth : polars.DataFrame
        From the begin.
    imu : polars.DataFrame
        Every sample.
    """

    truth: pl.DataFrame
    imu: pl.DataFrame


@checked
def roll(
    start_ns: int, position: ArrayLike, unit: Imu, *, rate_hz: int = 10, seed: int = 0, flight: int = 0, truth_interval_s: float = 1.0
) -> Rolled:
    """Inertial unit of a vehicle that rolls along given positions, turning without bank.

    Its way is a spline with a knot each second, so that force and rate are smooth; it follows the positions to centimetres where they run
    straight and to decimetres where a turn begins or ends. It comes and goes straight on.

    Parameters
    ----------
    start_ns : int
        GPS time of the first position. [ns]
    position : array_like, shape (n, 3)
        Latitude, longitude, height above the ellipsoid at whole seconds, ten or more. [rad, rad, m]
    unit : navbound.scenario.sensors.Imu
        Errors of the unit.
    rate_hz : int, optional
        Samples a second, a divisor of 10^9 from 10 to 200.
    seed, flight : int, optional
        Choose the random streams.
    truth_interval_s : float, optional
        Time between rows of the truth, a whole multiple of the unit's interval. [s]

    Returns
    -------
    Rolled
        The same numbers for the same arguments.

    Raises
    ------
    InputError
        Fewer than ten positions, one that is not finite or within a degree of a pole, a vehicle that stands still, errors or a rate
        outside their domains.
    """
    points = np.asarray(position, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise InputError("position", f"shape {points.shape}", domain="shape (n, 3)")
    if not (isinstance(rate_hz, int) and 0 <= rate_hz < 2**32):
        raise InputError("rate_hz", rate_hz, "1/s", "divisors of 10^9 from 10 to 200")
    for name, value in (("flight", flight), ("seed", seed)):
        if not (isinstance(value, int) and 0 <= value < 2**64):
            raise InputError(name, value, domain="[0, 2^64)")
    tables = _core.ins_roll(
        start_ns, np.ascontiguousarray(points), unit.model_dump_json(), (rate_hz, _samples(truth_interval_s, rate_hz)), (seed, flight)
    )
    return Rolled(_frame(tables["truth"]), _frame(tables["imu"]))


def _frame(columns: dict[str, Any]) -> pl.DataFrame:
    # An empty list of names would have no type.
    frame = pl.DataFrame(columns, schema_overrides={name: pl.String for name in ("satellite", "station") if name in columns})
    first = [name for name in ("time_ns", "satellite", "station") if name in columns]
    return frame.select(*first, pl.exclude(first))
