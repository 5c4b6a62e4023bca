"""GBAS error models and the tables of surface movement, each number with its mark."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from navbound import _core
from navbound.errors import InputError
from navbound.table.arguments import checked, checked_fields
from navbound.table.arrays import flatten, unflatten

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

Service = Literal["D", "F"]
SERVICES = ("D", "F")
"""GBAS approach service types: single-frequency code smoothed over 30 s, ionosphere-free code smoothed over 100 s."""


@checked_fields
@dataclass(frozen=True)
class Mark:
    """How one number is held.

    Attributes
    ----------
    name : str
        The number.
    held : {"printed", "re-derived", "standard", "ours", "inferred"}
        How.
    why : str
        Where from, or by which fit.
    """

    name: str
    held: str
    why: str


@checked_fields
@dataclass(frozen=True)
class SubPhase:
    """What one sub-phase of surface movement asks. Nearly every number is inferred: print none without its mark.

    Attributes
    ----------
    id, title : str
        ``RET``, ``rapid exit taxiway``.
    containment_m, hal_m : float
        Total system containment and horizontal alert limit. [m]
    integrity_risk, continuity_risk : float
        Of the sub-phase. [1]
    speed_mps, exposure_s : float
        Largest speed and duration. [m/s, s]
    marks : tuple of Mark
        How each is held.
    """

    id: str
    title: str
    containment_m: float
    hal_m: float
    integrity_risk: float
    continuity_risk: float
    speed_mps: float
    exposure_s: float
    marks: tuple[Mark, ...]


@checked_fields
@dataclass(frozen=True)
class Carrier:
    """Errors of phase differenced in time.

    Attributes
    ----------
    noise_m : float
        Noise of one phase. [m]
    troposphere_gradient : float
        Zenith gradient. [m/m]
    clock_mps : float
        Drift of satellite clock and orbit. [m/s]
    ionosphere_gradient : float or None
        Vertical gradient, None for dual frequency. [m/m]
    marks : tuple of Mark
        How each is held.
    """

    noise_m: float
    troposphere_gradient: float
    clock_mps: float
    ionosphere_gradient: float | None
    marks: tuple[Mark, ...] = ()

    def numbers(self) -> list[float]:
        """The four numbers, NaN for no ionosphere."""
        ionosphere = np.nan if self.ionosphere_gradient is None else self.ionosphere_gradient
        return [self.noise_m, self.troposphere_gradient, self.clock_mps, ionosphere]


@checked_fields
@dataclass(frozen=True)
class FaultRates:
    """Rates of faults in one of the paper's cases.

    Attributes
    ----------
    id : {"A", "B"}
        Which.
    gps_per_hour, galileo_per_hour : float
        Of a satellite. [1/h]
    gps_wide_per_hour, galileo_wide_per_hour : float
        Of the whole constellation, beside another one. [1/h]
    decorrelation_s : float
        How long a fault may act before monitors with memory show it. [s]
    satellites : int
        Over all constellations.
    marks : tuple of Mark
        How each is held.
    """

    id: str
    gps_per_hour: float
    galileo_per_hour: float
    gps_wide_per_hour: float
    galileo_wide_per_hour: float
    decorrelation_s: float
    satellites: int
    marks: tuple[Mark, ...]


@checked_fields
@dataclass(frozen=True)
class Allocation:
    """How the integrity risk of a sub-phase is shared out; shares of it [1].

    Attributes
    ----------
    no_fault_and_receiver : float
        H0 and H1 together.
    ground : float
        H2 before coasting.
    coasting_ground, coasting_fault : float
        H2a and H2c while coasting.
    unmonitored : float
        Share of ``coasting_fault`` below which faults together need no monitoring.
    receiver_fault : float
        Probability of a faulty reference receiver.
    axes : int
        Coordinates the first share is split among.
    marks : tuple of Mark
        How each is held.
    """

    no_fault_and_receiver: float
    ground: float
    coasting_ground: float
    coasting_fault: float
    unmonitored: float
    receiver_fault: float
    axes: int
    marks: tuple[Mark, ...]


@checked_fields
@dataclass(frozen=True)
class ErrorBudget:
    """What flight technical and path definition error take of a containment.

    Attributes
    ----------
    containment_risk : float
        Risk that the total system error leaves it. [1]
    sigma_fte_m, sigma_pde_m : float
        Standard deviations. [m]
    marks : tuple of Mark
        How each is held.
    """

    containment_risk: float
    sigma_fte_m: float
    sigma_pde_m: float
    marks: tuple[Mark, ...]


@checked_fields
@dataclass(frozen=True)
class MonitorCurve:
    """A ground monitor's missed detection against the size of a range error.

    Attributes
    ----------
    id : {"D", "F"}
        Service.
    stretch : float
        How many times larger an error must be than under the standard's curve. [1]
    projection : float
        Worst horizontal metres of position for a metre of range. [1]
    start_m, end_m : float
        Where the standard's curve begins to fall and where its floor begins. [m]
    marks : tuple of Mark
        How each is held.
    """

    id: str
    stretch: float
    projection: float
    start_m: float
    end_m: float
    marks: tuple[Mark, ...]


@checked_fields
@dataclass(frozen=True)
class RangeSigma:
    """Standard deviations of smoothed, corrected ranges; arrays have the shape of the elevations [m].

    Attributes
    ----------
    sigma_m, sigma_h1_m : ndarray
        Everything; everything when one reference receiver is faulty.
    ground_m, air_m, troposphere_m, ionosphere_m : ndarray
        The parts.
    """

    sigma_m: NDArray[np.float64]
    sigma_h1_m: NDArray[np.float64]
    ground_m: NDArray[np.float64]
    air_m: NDArray[np.float64]
    troposphere_m: NDArray[np.float64]
    ionosphere_m: NDArray[np.float64]


@checked_fields
@dataclass(frozen=True)
class Inertial:
    """The inertial system of the study, the receiver's clock and the white parts of its ranges.

    Attributes
    ----------
    gyro_bias_radps, gyro_walk_radprts : float
        Bias and angular random walk. [rad/s, rad/√s]
    accelerometer_bias_mps2, accelerometer_walk_mpsprts : float
        Bias and velocity random walk. [m/s², m/s/√s]
    clock_h0_s, clock_h_minus_2_per_s : float
        Powers of the clock's white frequency noise and of its frequency walk. [s, 1/s]
    doppler_mps, receiver_noise_m : float
        Deviations of a range rate, and of the white part of a smoothed range. [m/s, m]
    marks : tuple of Mark
        How each is held.
    """

    gyro_bias_radps: float
    gyro_walk_radprts: float
    accelerometer_bias_mps2: float
    accelerometer_walk_mpsprts: float
    clock_h0_s: float
    clock_h_minus_2_per_s: float
    doppler_mps: float
    receiver_noise_m: float
    marks: tuple[Mark, ...]


@cache
def _tables() -> dict[str, Any]:
    return _core.surface_tables()


def _marks(rows: list[tuple[str, str, str]]) -> tuple[Mark, ...]:
    return tuple(Mark(*row) for row in rows)


def _marked(row: dict[str, Any]) -> dict[str, Any]:
    return {**row, "marks": _marks(row["marks"])}


def sub_phases() -> dict[str, SubPhase]:
    """The sub-phases from runway to stand by their names; rebuilt, see each one's marks."""
    return {row["id"]: SubPhase(**_marked(row)) for row in _tables()["sub_phases"]}


def fault_rates() -> dict[str, FaultRates]:
    """Case A and case B."""
    return {row["id"]: FaultRates(**_marked(row)) for row in _tables()["fault_rates"]}


def allocation() -> Allocation:
    """The allocation tree."""
    return Allocation(**_marked(_tables()["allocation"]))


def error_budget() -> ErrorBudget:
    """The error budget behind the accuracy requirement."""
    return ErrorBudget(**_marked(_tables()["error_budget"]))


def monitor_curves() -> dict[str, MonitorCurve]:
    """Ground monitors by service."""
    return {row["id"]: MonitorCurve(**_marked(row)) for row in _tables()["monitor_curves"]}


def carriers() -> dict[str, Carrier]:
    """Phase differenced in time: ``single`` and ``dual`` frequency."""
    return {name: Carrier(**_marked(_tables()[f"carrier_{name}"])) for name in ("single", "dual")}


def model_marks() -> dict[str, tuple[Mark, ...]]:
    """How the numbers of the error models and of the inertial system are held, by service and ``inertial``."""
    models = {name: _marks(rows) for name, _, rows in _tables()["error_models"]}
    return {**models, "inertial": inertial().marks}


def inertial() -> Inertial:
    """The inertial system of the study and what goes with it in the filter."""
    return Inertial(**_marked(_tables()["inertial"]))


def multipath_times() -> dict[str, tuple[float, float]]:
    """Shortest and longest time constant of smoothed multipath by service [s]."""
    return {name: (ends[0], ends[1]) for name, ends in _tables()["multipath_s"]}


def check_service(service: str) -> None:
    """Refuse a service that is not there."""
    if service not in SERVICES:
        raise InputError("service", service, domain="D, F")


@checked
def range_sigma(el_rad: ArrayLike, service: Service = "D") -> RangeSigma:
    """Error model of a smoothed, corrected range (navi.673 equations 18 and 19, rebuilt).

    Parameters
    ----------
    el_rad : array_like
        Elevations, NaN for a satellite that is not used. [rad]
    service : {"D", "F"}
        GAST D or GAST F.

    Returns
    -------
    RangeSigma
        NaN where the elevation is.

    Raises
    ------
    InputError
        An elevation outside (0, pi/2], an unknown service.
    """
    check_service(service)
    shape, (el,) = flatten(el_rad=(el_rad, ()))
    used = ~np.isnan(el)
    out = np.full((el.size, 6), np.nan)
    out[used] = _core.gbas_range_sigma(service, np.ascontiguousarray(el[used]))
    return RangeSigma(*(unflatten(np.ascontiguousarray(out[:, k]), shape) for k in range(6)))


@checked
def carrier_sigma(el_rad: ArrayLike, speed_mps: ArrayLike, coasting_s: ArrayLike, carrier: Carrier) -> NDArray[np.float64]:
    """Standard deviation of phase differenced over a coasting time (navi.673 equation 20, rebuilt).

    Parameters
    ----------
    el_rad : array_like
        Elevations, NaN for a satellite that is not followed. [rad]
    speed_mps, coasting_s : array_like
        Speed over the ground, and time since the fix. [m/s, s]
    carrier : Carrier
        From :func:`carriers`, or of your own.

    Returns
    -------
    ndarray
        In the common shape, NaN where the elevation is. [m]

    Raises
    ------
    InputError
        An elevation outside (0, pi/2], a negative speed or time.
    """
    shape, (el, speed, time) = flatten(el_rad=(el_rad, ()), speed_mps=(speed_mps, ()), coasting_s=(coasting_s, ()))
    used = ~np.isnan(el)
    out = np.full(el.size, np.nan)
    out[used] = _core.gbas_carrier_sigma(carrier.numbers(), *(np.ascontiguousarray(a[used]) for a in (el, speed, time)))
    return unflatten(out, shape)
