"""RRAIM: a GBAS fix carried on by time-differenced carrier phase, with single- and multi-fault protection levels.

Source: Song, Milner and No 2024, NAVIGATION 71(4), navi.673, equations 11 to 17, rebuilt (our copy lost its formulas): propagation
re-derived and verified; single fault after Lee and McLaughlin 2008, inferred; multi-fault after Blanch et al. 2015, standard. Details in
docs/methods/gbas.md.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound import _core
from navbound.errors import ConflictError, InputError
from navbound.gbas import Factors, Form, Ordering, factors, range_sigma
from navbound.gbas.arguments import spread, systems
from navbound.gbas.models import Service
from navbound.status import availability, reasons_of
from navbound.table.arguments import checked
from navbound.table.arrays import flatten, unflatten

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray


__all__ = ["Levels", "protection_levels"]

_SYSTEMS = 5


@dataclass(frozen=True)
class Levels:
    """Protection levels after coasting; arrays have the shape of the skies, NaN exactly where ``status`` is not ``ok``.

    Attributes
    ----------
    hpl_h0_m, hpl_h1_m, hpl_h2c_m, hpl_m : ndarray
        Single-fault levels: without a fault, with a reference receiver faulty at the fix, with a satellite that fails while coasting, and
        the largest. [m]
    hpl_multi_e_m, hpl_multi_n_m, hpl_multi_m : ndarray
        Multi-fault levels east, north and horizontal; NaN also where ``multi_reason`` says why. [m]
    accuracy_m : ndarray
        95 %. [m]
    sigma_major_m, bias_gain : ndarray
        Deviation in the worst direction; metres for a metre of bias in every range. [m, 1]
    covariance_enu_m2 : ndarray, shape (..., 3, 3)
        Covariance now. [m²]
    subset_sigma_m, subset_separation_m, subset_bias_gain, subset_threshold_m : ndarray, shape (..., n)
        With each satellite away: deviation, deviation of the separation, gain of the bias, and the separation above which the satellite
        is held to be faulty, k_FA times its deviation. [m, m, 1, m]
    n_sv, n_modes : ndarray of int
        Satellites followed; modes of faults monitored.
    p_not_monitored : ndarray
        Probability of faults that are not. [1]
    status, reason, multi_reason : ndarray of str
        ``ok`` or ``not_available``, and why; why there is no multi-fault level.
    reason_id, multi_reason_id : ndarray of str
        The same as ids of ``navbound.status.REASONS``, empty where there is a level.
    """

    hpl_h0_m: NDArray[np.float64]
    hpl_h1_m: NDArray[np.float64]
    hpl_h2c_m: NDArray[np.float64]
    hpl_m: NDArray[np.float64]
    hpl_multi_e_m: NDArray[np.float64]
    hpl_multi_n_m: NDArray[np.float64]
    hpl_multi_m: NDArray[np.float64]
    accuracy_m: NDArray[np.float64]
    sigma_major_m: NDArray[np.float64]
    bias_gain: NDArray[np.float64]
    covariance_enu_m2: NDArray[np.float64]
    subset_sigma_m: NDArray[np.float64]
    subset_separation_m: NDArray[np.float64]
    subset_bias_gain: NDArray[np.float64]
    subset_threshold_m: NDArray[np.float64]
    n_sv: NDArray[np.int64]
    n_modes: NDArray[np.int64]
    p_not_monitored: NDArray[np.float64]
    status: NDArray[np.str_]
    reason: NDArray[np.str_]
    multi_reason: NDArray[np.str_]
    reason_id: NDArray[np.str_]
    multi_reason_id: NDArray[np.str_]

    @property
    def cov_ee_m2(self) -> NDArray[np.float64]:
        """Variance east [m²]."""
        return self.covariance_enu_m2[..., 0, 0]

    @property
    def cov_en_m2(self) -> NDArray[np.float64]:
        """Covariance of east and north [m²]."""
        return self.covariance_enu_m2[..., 0, 1]

    @property
    def cov_nn_m2(self) -> NDArray[np.float64]:
        """Variance north [m²]."""
        return self.covariance_enu_m2[..., 1, 1]


@checked
def protection_levels(  # noqa: PLR0917 - satellites then, satellites now, their phases, their systems
    az_rad: ArrayLike,
    el_rad: ArrayLike,
    az_now_rad: ArrayLike,
    el_now_rad: ArrayLike,
    sigma_td_m: ArrayLike,
    constellation: Sequence[int] | NDArray[np.int64] | None = None,
    *,
    service: Service = "D",
    sigma_m: ArrayLike | None = None,
    sigma_h1_m: ArrayLike | None = None,
    aided_covariance_m2: ArrayLike | None = None,
    bias_m: ArrayLike = 0.0,
    integrity_risk: float = 1.25e-9,
    k: Factors | None = None,
    continuity_risk: float = 1.25e-5,
    allotted_risk: float = 2.34375e-10,
    p_sat: Mapping[int, float] | None = None,
    p_const: Mapping[int, float] | None = None,
    p_threshold: float | None = None,
    ordering: Ordering = "exact",
    form: Form = "major",
    biased_threshold: bool = False,
) -> Levels:
    """Protection levels of a fix carried on by carrier phase (navi.673 equations 14 to 17, rebuilt).

    Parameters
    ----------
    az_rad, el_rad : array_like, shape (..., n)
        Satellites at the fix, azimuth clockwise from true north; both NaN for one that was not used. [rad]
    az_now_rad, el_now_rad : array_like, shape (..., n)
        The same satellites now; both NaN for one that was lost. [rad]
    sigma_td_m : array_like, shape (..., n) or ()
        Standard deviation of each phase differenced over the coasting time, :func:`navbound.gbas.carrier_sigma`. [m]
    constellation : sequence of int, shape (n,), optional
        Index of each satellite's system in ``gnss.CONSTELLATIONS``; without it all share one clock.
    service, sigma_m, sigma_h1_m, bias_m, integrity_risk, k, ordering, form
        As :func:`navbound.gbas.protection_levels`; ``aided_covariance_m2`` likewise.
    continuity_risk : float
        For the thresholds; the default is the study's, inferred. [1]
    allotted_risk : float
        Integrity risk of faults that begin while coasting; the default is 18.75 % of the study's, inferred. [1]
    p_sat, p_const : mapping of int to float, optional
        Prior of a fault while coasting by constellation index: of one satellite (without it 1e-5/h over a minute), of all. [1]
    p_threshold : float, optional
        Faults together rarer than this are not monitored; a tenth of ``allotted_risk`` without it. [1]
    biased_threshold : bool
        Make room for biases in the single-fault thresholds.

    Returns
    -------
    Levels
        ``not_available`` where the satellites, or all but one of them, do not determine the position.

    Raises
    ------
    InputError
        Numbers outside their domains, shapes that do not fit.
    """
    shape, (az, el, az_now, el_now, sigma_td) = flatten(
        az_rad=(az_rad, ()), el_rad=(el_rad, ()), az_now_rad=(az_now_rad, ()), el_now_rad=(el_now_rad, ()), sigma_td_m=(sigma_td_m, ())
    )
    if not shape or shape[-1] == 0:
        raise InputError("az_rad", f"shape {shape}", domain="shape (..., n), n at least 1")
    leading, width = shape[:-1], shape[-1]
    multipliers = k or factors(integrity_risk)
    job = {
        "fix": fix(
            az,
            el,
            shape,
            constellation=systems(width, constellation),
            service=service,
            sigma_m=sigma_m,
            sigma_h1_m=sigma_h1_m,
            aided_covariance_m2=aided_covariance_m2,
        ),
        "az_now_rad": az_now,
        "el_now_rad": el_now,
        "sigma_td_m": sigma_td,
        "bias_m": spread("bias_m", bias_m, leading, ()),
        "rule": rule(multipliers, continuity_risk, allotted_risk, ordering=ordering, form=form, biased_threshold=biased_threshold),
        "p_sat": by_system("p_sat", p_sat, 1e-5 / 60),
        "p_const": by_system("p_const", p_const, 0.0),
        "p_threshold": 0.1 * allotted_risk if p_threshold is None else p_threshold,
    }
    levels = _core.rraim_levels(job)
    reason, reason_id = reasons_of(levels, leading)
    multi, multi_id = (np.array(levels.pop(name), dtype=np.str_).reshape(leading) for name in ("multi_reason", "multi_reason_id"))
    covariance = levels.pop("cov_enu_m2").reshape(*leading, 3, 3)
    subsets = levels.pop("subsets").reshape(*leading, width, 4)
    counts: dict[str, Any] = {name: unflatten(np.nan_to_num(levels.pop(name)).astype(np.int64), leading) for name in ("n_sv", "n_modes")}
    columns: dict[str, Any] = {name: unflatten(values, leading) for name, values in levels.items()}
    return Levels(
        covariance_enu_m2=covariance,
        subset_sigma_m=subsets[..., 0],
        subset_separation_m=subsets[..., 1],
        subset_bias_gain=subsets[..., 2],
        subset_threshold_m=subsets[..., 3],
        status=availability(reason_id),
        reason=reason,
        multi_reason=multi,
        reason_id=reason_id,
        multi_reason_id=multi_id,
        **counts,
        **columns,
    )


def fix(
    az: NDArray[np.float64],
    el: NDArray[np.float64],
    shape: tuple[int, ...],
    *,
    constellation: list[int],
    service: Service,
    sigma_m: ArrayLike | None = None,
    sigma_h1_m: ArrayLike | None = None,
    aided_covariance_m2: ArrayLike | None = None,
) -> dict[str, Any]:
    """The skies at the fix as the core takes them."""
    if (sigma_m is None) != (sigma_h1_m is None):
        raise ConflictError("sigma_m", needs=("sigma_h1_m",)) if sigma_h1_m is None else ConflictError("sigma_h1_m", needs=("sigma_m",))
    if sigma_m is None:
        model = range_sigma(el, service)
        sigma, sigma_h1 = model.sigma_m, model.sigma_h1_m
    else:
        sigma, sigma_h1 = (np.asarray(spread(n, v, shape, ())) for n, v in (("sigma_m", sigma_m), ("sigma_h1_m", sigma_h1_m)))
    return {
        "az_rad": az,
        "el_rad": el,
        "sigma_m": sigma,
        "sigma_h1_m": sigma_h1,
        "constellation": constellation,
        "aided_m2": spread("aided_covariance_m2", aided_covariance_m2, shape[:-1], (3, 3)),
    }


def rule(
    k: Factors, continuity_risk: float, allotted_risk: float, *, ordering: str, form: str, biased_threshold: bool = False
) -> dict[str, Any]:
    """Multipliers and risks as the core takes them."""
    for argument, value, allowed in (("ordering", ordering, ("exact", "rss", "sum")), ("form", form, ("major", "norm"))):
        if value not in allowed:
            raise InputError(argument, value, domain=", ".join(allowed))
    return {
        "k_ff": k.k_ffmd,
        "k_md": k.k_md,
        "continuity_risk": continuity_risk,
        "allotted_risk": allotted_risk,
        "form": form,
        "ordering": ordering,
        "biased_threshold": biased_threshold,
    }


def by_system(name: str, values: Mapping[int, float] | None, default: float) -> list[float]:
    """One number a constellation."""
    if values is None:
        return [default] * _SYSTEMS
    for index in values:
        if index not in range(_SYSTEMS):
            raise InputError(name, index, domain="indices of gnss.CONSTELLATIONS")
    return [float(values.get(index, 0.0)) for index in range(_SYSTEMS)]
