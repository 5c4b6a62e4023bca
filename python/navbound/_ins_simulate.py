"""Simulated sensors of a flight."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound import _core
from navbound.errors import InputError
from navbound.scenario import Scenario, load

if TYPE_CHECKING:
    from navbound.gnss import Navigation


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
    found = scenario if isinstance(scenario, Scenario) else load(scenario)
    if found.sensors is None:
        raise InputError("scenario", found.title, domain="a scenario with a [sensors] part")
    chosen = found.seed if seed is None else seed
    for name, value in (("flight", flight), ("seed", chosen)):
        if not (isinstance(value, int) and 0 <= value < 2**64):
            raise InputError(name, value, domain="[0, 2^64)")
    samples = truth_interval_s * found.sensors.rate_hz
    # A written interval times the rate is a whole number to some 1e-12.
    if not (0.5 <= samples < 2**63 and abs(samples - round(samples)) < 1e-6):
        raise InputError("truth_interval_s", truth_interval_s, "s", f"whole multiples of 1/{found.sensors.rate_hz} s")
    prepared = _core.Sensors(found.core_json(), None if navigation is None else navigation._core)
    tables = prepared.fly(chosen, flight, round(samples))
    names = np.array([station.name for station in found.sensors.stations], dtype=object)
    for kind in ("dme", "vor"):
        tables[kind]["station"] = names[tables[kind]["station"]].tolist()
    return Sensed(**{name: _frame(columns) for name, columns in tables.items()}, scenario=found, seed=chosen, flight=flight)


def _frame(columns: dict[str, Any]) -> pl.DataFrame:
    # An empty list of names would have no type.
    frame = pl.DataFrame(columns, schema_overrides={name: pl.String for name in ("satellite", "station") if name in columns})
    first = [name for name in ("time_ns", "satellite", "station") if name in columns]
    return frame.select(*first, pl.exclude(first))
