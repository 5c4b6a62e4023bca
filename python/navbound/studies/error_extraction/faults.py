"""Faults put into a vertical position error, and when the EE bound (experimental, not integrity) notices."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from navbound import sbas
from navbound.errors import InputError
from navbound.studies.error_extraction.records import FaultEntry, RiskOfMemory, Spread
from navbound.studies.gauss_markov import gauss_markov

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

ONSET = 600
"""Samples before the fault: twice what the filter needs to settle. 1 Hz."""
LENGTH = 1600
"""Samples of the fault: the slowest noticed one is noticed after some 1000 s."""
SIGMA_M, TAU_S = 0.3, 30.0
"""Nominal error, Gauss-Markov; with this tau the nominal bound is the stated 10 m."""
SIGMA_VELOCITY_MPS = 0.0028
BIAS_BOUND_M = 6.0
VAL_M = 50.0

QUANTITIES = ("peak bound [m]", "first error > bound [s]", "first bound >= VAL [s]", "error > VAL with bound < VAL [s]")

FAULTS: dict[str, tuple[float, float, tuple[float | None, ...]]] = {
    "step 5 m": (5.0, 0.0, (66.0, None, 13.0, None)),
    "step 10 m": (10.0, 0.0, (121.0, 362.0, 5.0, None)),
    "step 40 m": (40.0, 0.0, (454.0, 255.0, 1.0, None)),
    "ramp 0.01 m/s": (0.0, 0.01, (18.0, 917.0, None, None)),
    "ramp 0.05 m/s": (0.0, 0.05, (29.0, 248.0, None, 997.0)),
    "ramp 0.1 m/s": (0.0, 0.1, (51.0, 189.0, 71.0, 502.0)),
    "ramp 0.5 m/s": (0.0, 0.5, (222.0, 177.0, 16.0, 218.0)),
}
"""Each fault by its step [m] and slope [m/s], and what was computed for it before, from one run: the quantities in their order."""


RISK_OF_CASES = 1e-3
CASES_OF_RISK = (
    (30.0, 3.7e-4, 5e-6),
    (60.0, 5e-3, 5e-4),
    (100.0, 1.9e-2, 5e-4),
    (300.0, 0.11, 5e-3),
    (600.0, 0.21, 5e-3),
    (1800.0, 0.43, 5e-3),
)
"""Correlation time [s], what was computed for it before, and half of its last digit."""
RISK_RUNS, RISK_LENGTH = 400, 1200
"""Independent runs, and samples in each; the first third, in which the filter settles, is not counted."""


def inject(*, runs: int = 100, seed: int = 2012) -> list[FaultEntry]:
    """Put every fault into many runs of nominal error.

    Parameters
    ----------
    runs : int
        Runs a fault, with the same nominal errors for every fault.
    seed : int
        Of the nominal errors.

    Returns
    -------
    list of FaultEntry
        ``reproducible`` where the number stated before, from one run, lies within those of all runs, or where both never happen.

    Raises
    ------
    InputError
        Fewer than 20 runs: their range would say nothing about another run.
    """
    if not runs >= 20:
        raise InputError("runs", runs, "1", "[20, inf)")
    generator = np.random.Generator(np.random.Philox(seed))
    nominal = SIGMA_M * gauss_markov(generator.standard_normal((runs, ONSET + LENGTH)), TAU_S)
    velocity = np.zeros((*nominal.shape, 3))
    velocity[..., 2] = SIGMA_VELOCITY_MPS * generator.standard_normal(nominal.shape)
    since = np.arange(-ONSET, LENGTH).astype(np.float64)
    entries = []
    for fault, (step_m, slope_mps, stated) in FAULTS.items():
        position = np.zeros_like(velocity)
        position[..., 2] = nominal + np.where(since >= 0.0, step_m + slope_mps * since, 0.0)
        entries += _entries(fault, stated, position, velocity)
    return entries


def overshoot_m(step_m: float = 10.0) -> float:
    """Largest corrected error after a step of an error that is otherwise nothing."""
    position = np.zeros((2 * ONSET, 3))
    position[ONSET:, 2] = step_m
    extraction = sbas.error_extraction(np.arange(2 * ONSET) * 1_000_000_000, position, np.zeros(3))
    return float(np.abs(extraction.ee_position_enu_m[:, 2]).max())


def risks_of_cases(*, seed: int = 2012) -> list[RiskOfMemory]:
    """How often errors of several correlation times pass the noise bound whose stated risk is 1e-3.

    Returns
    -------
    list of RiskOfMemory
        ``reproducible`` where the share stated before is within four standard errors, from independent runs, and half its last digit.
    """
    generator = np.random.Generator(np.random.Philox(seed))
    times = np.arange(RISK_LENGTH) * 1_000_000_000
    risks = []
    for tau_s, stated, half_digit in CASES_OF_RISK:
        position = np.zeros((RISK_RUNS, RISK_LENGTH, 3))
        position[..., 2] = gauss_markov(generator.standard_normal((RISK_RUNS, RISK_LENGTH)), tau_s)
        extracted = sbas.error_extraction(times, position, np.zeros(3), risk_v=RISK_OF_CASES)
        error, bound = np.abs(extracted.ee_position_enu_m[..., 2]), extracted.ee_noise_v_m
        shares = np.mean((error > bound)[:, RISK_LENGTH // 3 :], axis=1)
        mean, standard_error = float(shares.mean()), float(shares.std(ddof=1) / np.sqrt(RISK_RUNS))
        again = abs(mean - stated) <= 4.0 * standard_error + half_digit
        risks.append(
            RiskOfMemory(
                tau_s=tau_s,
                risk=RISK_OF_CASES,
                stated=stated,
                found=mean,
                standard_error=standard_error,
                verdict="reproducible" if again else "not reproducible",
            )
        )
    return risks


def _entries(fault: str, stated: tuple[float | None, ...], position: Floats, velocity: Floats) -> list[FaultEntry]:
    times = np.arange(position.shape[1]) * 1_000_000_000
    extraction = sbas.error_extraction(times, position, velocity, bias_h_m=BIAS_BOUND_M, bias_v_m=BIAS_BOUND_M)
    bound, error = extraction.ee_bound_v_m[:, ONSET:], np.abs(extraction.ee_position_enu_m[:, ONSET:, 2])
    numbers = (
        bound.max(axis=1),
        _first(error > bound),
        _first(bound >= VAL_M),
        _first((error > VAL_M) & (bound < VAL_M)),
    )
    return [_entry(fault, name, before, values) for name, before, values in zip(QUANTITIES, stated, numbers, strict=True)]


def _first(happened: NDArray[np.bool_]) -> Floats:
    """Seconds from onset to the first time, NaN where it never happened."""
    return np.where(happened.any(axis=1), happened.argmax(axis=1), np.nan)


def _entry(fault: str, quantity: str, stated: float | None, values: Floats) -> FaultEntry:
    never = float(np.isnan(values).mean())
    some = values[~np.isnan(values)]
    least, median, most = (float(f(some)) for f in (np.min, np.median, np.max)) if some.size else (None, None, None)
    within = stated is not None and least is not None and most is not None and least <= stated <= most
    again = never > 0.5 if stated is None else within
    return FaultEntry.model_validate(
        {
            "fault": fault,
            "quantity": quantity,
            "stated": stated,
            "found": Spread(least=least, median=median, most=most, share_never=never),
            "verdict": "reproducible" if again else "not reproducible",
        }
    )
