"""What becomes of the risk stated for the EE bound (experimental, not integrity) under other laws than the one it was derived for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from navbound import sbas, tse
from navbound.studies.error_extraction.records import RiskOfLaw, RiskOfMemory

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Draw = Callable[[np.random.Generator, tuple[int, int]], Floats]

WINDOW, WEIGHT, BETA = 50, 0.5, 1.2
DRAWS = 100_000
"""Windows drawn; the tail beyond each is exact, so that risks far below one in a hundred thousand are seen."""
SMALL_RISK = 5e-8
SMALL_CASES = ((60.0, 7e-7, 5e-8), (100.0, 2e-5, 5e-6), (300.0, 2.2e-3, 5e-5), (600.0, 1.3e-2, 5e-4), (1800.0, 8.4e-2, 5e-4))
"""Correlation time [s], what was computed for it before, and half of its last digit."""
RESPONSE = 1000
"""Samples of the filter's response that are kept: 0.98^1000 is 2e-9."""


@dataclass(frozen=True)
class _Law:
    """A law of independent errors' sizes."""

    name: str
    draw: Draw
    tail: Callable[[Floats], Floats]
    stated: tuple[tuple[float, float, float], ...]
    """Risk of the bound, what was computed for it before, half of its last digit."""
    inside: bool = True
    """Whether the error that is judged is in the window too."""
    weight: float = WEIGHT


def _student_draw(generator: np.random.Generator, shape: tuple[int, int]) -> Floats:
    return np.abs(generator.standard_t(4.0, shape))


def _student_tail(x: Floats) -> Floats:
    """P(abs(t) > x) with four degrees of freedom: (1 - c)² (2 + c) / 2, c = x / sqrt(x² + 4), without the cancellation in 1 - c."""
    c = x / np.sqrt(x * x + 4.0)
    rest = 4.0 / (x * x + 4.0) / (1.0 + c)
    return np.asarray(rest * rest * (2.0 + c) / 2.0)


def _mixture_draw(generator: np.random.Generator, shape: tuple[int, int]) -> Floats:
    return np.abs(generator.standard_normal(shape)) * np.where(generator.random(shape) < 0.05, 5.0, 1.0)


def _mixture_tail(x: Floats) -> Floats:
    return np.asarray(0.95 * tse.exceedance_risk(0.0, 1.0, x) + 0.05 * tse.exceedance_risk(0.0, 5.0, x))


def _exponential_draw(generator: np.random.Generator, shape: tuple[int, int]) -> Floats:
    return generator.standard_exponential(shape)


def _exponential_tail(x: Floats) -> Floats:
    return np.asarray(np.exp(-x))


LAWS = (
    _Law(
        "exponential, outside the window, equal weights",
        _exponential_draw,
        _exponential_tail,
        ((1e-3, 1.0e-3, 5e-5), (1e-5, 1.0e-5, 5e-7), (5e-8, 5.0e-8, 5e-10)),
        inside=False,
        weight=1.0,
    ),
    _Law(
        "exponential, outside the window",
        _exponential_draw,
        _exponential_tail,
        ((1e-3, 1.1e-3, 5e-5), (1e-5, 1.3e-5, 5e-7), (5e-8, 8.4e-8, 5e-10)),
        inside=False,
    ),
    _Law("exponential", _exponential_draw, _exponential_tail, ((1e-3, 2.5e-4, 5e-6), (1e-5, 6e-8, 5e-9))),
    _Law("Student, 4 degrees of freedom", _student_draw, _student_tail, ((1e-3, 9.6e-4, 5e-6), (1e-5, 4.2e-5, 5e-7), (5e-8, 1.4e-6, 5e-8))),
    _Law("Gaussian, 5 % at 5 sigma", _mixture_draw, _mixture_tail, ((1e-3, 4.6e-3, 5e-5), (1e-5, 3.8e-5, 5e-7))),
)
"""Those of the specification whose risks a hundred thousand windows can tell; below 1e-11 they cannot."""


def held_laws(*, seed: int = 2012) -> list[RiskOfLaw]:
    """How often independent errors of several laws, known exactly, pass the noise bound.

    ::

        P(E > k S), S = w sum over the older half + (2 - w) sum over the newer; of E in the window itself: P(E > k S' / (1 - k (2 - w)))

    Returns
    -------
    list of RiskOfLaw
        ``reproducible`` where what was stated before is within four standard errors, from independent windows, and half its last digit.
    """
    laws = []
    for index, law in enumerate(LAWS):
        sizes = law.draw(np.random.Generator(np.random.Philox([seed, index])), (DRAWS, WINDOW))
        weights = np.repeat([law.weight, 2.0 - law.weight], WINDOW // 2)
        for risk, stated, half_digit in law.stated:
            k = sbas.extraction_factor(risk, window=WINDOW, weight=law.weight).k
            own = 2.0 - law.weight if law.inside else 0.0
            others = sizes[:, :-1] @ weights[:-1] if law.inside else sizes @ weights
            mean, error = _mean(law.tail(k * others / (1.0 - k * own)))
            again = abs(mean - stated) <= 4.0 * error + half_digit
            verdict = "reproducible" if again else "not reproducible"
            one = {"law": law.name, "risk": risk, "stated": stated, "found": mean, "standard_error": error, "verdict": verdict}
            laws.append(RiskOfLaw.model_validate(one))
    return laws


def held_small(*, seed: int = 2012) -> list[RiskOfMemory]:
    """How often Gauss-Markov errors pass the noise bound whose stated risk is 5e-8: the Gaussian tail given each window, exactly.

    Returns
    -------
    list of RiskOfMemory
        As :func:`held_laws`.
    """
    normals = np.random.Generator(np.random.Philox([seed, len(LAWS)])).standard_normal((DRAWS, WINDOW))
    rows = _responses()
    k = sbas.extraction_factor(SMALL_RISK, window=WINDOW, weight=WEIGHT).k
    weights = BETA * np.repeat([WEIGHT, 2.0 - WEIGHT], WINDOW // 2)
    lags = np.abs(np.subtract.outer(np.arange(rows.shape[1]), np.arange(rows.shape[1])))
    risks = []
    for tau_s, stated, half_digit in SMALL_CASES:
        joint = rows @ np.exp(-lags / tau_s) @ rows.T
        window, across, own = joint[:-1, :-1], joint[:-1, -1], joint[-1, -1]
        gain = np.linalg.solve(window, across)
        extracted = normals @ np.linalg.cholesky(window).T
        bound = k * (np.abs(extracted) @ weights)
        mean, error = _mean(np.asarray(tse.exceedance_risk(extracted @ gain, float(np.sqrt(own - across @ gain)), bound)))
        again = abs(mean - stated) <= 4.0 * error + half_digit
        verdict = "reproducible" if again else "not reproducible"
        one = {"tau_s": tau_s, "risk": SMALL_RISK, "stated": stated, "found": mean, "standard_error": error, "verdict": verdict}
        risks.append(RiskOfMemory.model_validate(one))
    return risks


def _responses() -> Floats:
    """Rows that make the last 50 extracted errors of the errors before, by the filter's response; beneath them the last corrected one."""
    position = np.zeros((2 * RESPONSE, 3))
    position[RESPONSE, 2] = 1.0
    extraction = sbas.error_extraction(np.arange(2 * RESPONSE) * 1_000_000_000, position, np.zeros(3))
    response = extraction.ee_error_enu_m[RESPONSE:, 2]
    rows = np.zeros((WINDOW + 1, RESPONSE + WINDOW))
    for i in range(WINDOW):
        rows[i, i + 1 : i + 1 + RESPONSE] = response[::-1]
    rows[WINDOW] = -rows[WINDOW - 1]
    rows[WINDOW, -1] += 1.0
    return rows


def _mean(shares: Floats) -> tuple[float, float]:
    """Mean and its standard error."""
    return float(shares.mean()), float(shares.std(ddof=1) / np.sqrt(shares.size))
