"""What ground monitors may miss."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from navbound import _core
from navbound.gbas.models import Service, check_service, monitor_curves
from navbound.table.arguments import checked
from navbound.table.arrays import flatten, unflatten

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@checked
def fault_probability(n_sv: ArrayLike, rate_per_hour: ArrayLike, tau_s: float = 100.0) -> float:
    """Probability of a satellite fault that monitors with memory do not yet show (navi.673 equation 9).

    Parameters
    ----------
    n_sv, rate_per_hour : array_like
        How many satellites have which rate: 18 at 1e-5 give 5.000e-6. [1, 1/h]
    tau_s : float
        Decorrelation time of the monitors. [s]

    Raises
    ------
    InputError
        A rate outside [0, 3600 / tau_s).
    """
    _, (n, rate) = flatten(n_sv=(n_sv, ()), rate_per_hour=(rate_per_hour, ()))
    return _core.gbas_fault_probability(list(zip(n.tolist(), rate.tolist(), strict=True)), tau_s)


@checked
def missed_by_monitor(error_m: ArrayLike, service: Service = "D", *, stretch: float | None = None) -> NDArray[np.float64]:
    """Probability that the ground monitors miss a range error (ICAO Annex 10 appendix B, which was not read: inferred; GAST F too).

    Parameters
    ----------
    error_m : array_like
        Size of the range error. [m]
    service : {"D", "F"}
        Whose curve.
    stretch : float, optional
        How many times larger an error must be than under the standard's curve; the service's own without it. [1]

    Raises
    ------
    InputError
        An unknown service, a stretch that is not positive.
    """
    check_service(service)
    shape, (error,) = flatten(error_m=(error_m, ()))
    return unflatten(_core.gbas_missed_by_monitor(service, _stretch(service, stretch), error), shape)


@checked
def missed_detection_limit(
    error_m: ArrayLike,
    *,
    containment_m: ArrayLike,
    sigma_tse_m: ArrayLike,
    projection: ArrayLike,
    allotted_risk: ArrayLike,
    p_fault: ArrayLike,
    bias_hor_m: ArrayLike = 0.0,
) -> NDArray[np.float64]:
    """Largest missed detection of ground monitors that keeps the risk (navi.673 equations 7, 8 and 10).

    Parameters
    ----------
    error_m : array_like
        Size of the range error. [m]
    containment_m, sigma_tse_m : array_like
        Total system containment and standard deviation of the total system error. [m]
    projection : array_like
        Metres of position for a metre of range: 2 (GAST D), 0.7 (GAST F). [1]
    allotted_risk : array_like
        Risk allotted to the hypothesis. [1]
    p_fault : array_like
        Probability of the fault, :func:`fault_probability`. [1]
    bias_hor_m : array_like
        Horizontal effect of nominal biases. [m]

    Raises
    ------
    InputError
        A number outside its domain.
    """
    hazards = (containment_m, sigma_tse_m, bias_hor_m, projection, allotted_risk, p_fault)
    names = ("containment_m", "sigma_tse_m", "bias_hor_m", "projection", "allotted_risk", "p_fault")
    shape, (error, *rows) = flatten(error_m=(error_m, ()), **{n: (v, ()) for n, v in zip(names, hazards, strict=True)})
    return unflatten(_core.gbas_missed_detection_limit(error, np.ascontiguousarray(np.stack(rows, axis=-1))), shape)


@checked
def monitor_margin(
    *,
    service: Service,
    containment_m: ArrayLike,
    sigma_tse_m: ArrayLike,
    projection: ArrayLike,
    allotted_risk: ArrayLike,
    p_fault: ArrayLike,
    bias_hor_m: ArrayLike = 0.0,
    stretch: float | None = None,
) -> NDArray[np.float64]:
    """Decades between :func:`missed_detection_limit` and :func:`missed_by_monitor` where they are closest; the monitor suffices from 0 on.

    Parameters and errors as those two.
    """
    check_service(service)
    hazards = (containment_m, sigma_tse_m, bias_hor_m, projection, allotted_risk, p_fault)
    names = ("containment_m", "sigma_tse_m", "bias_hor_m", "projection", "allotted_risk", "p_fault")
    shape, rows = flatten(**{n: (v, ()) for n, v in zip(names, hazards, strict=True)})
    table = np.ascontiguousarray(np.stack(rows, axis=-1))
    return unflatten(_core.gbas_monitor_margin(service, _stretch(service, stretch), table), shape)


def _stretch(service: Service, stretch: float | None) -> float:
    return monitor_curves()[service].stretch if stretch is None else stretch
