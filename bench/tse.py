"""Speed of navbound.tse on one core: prepared and iterative exact bound, the quicker bounds, SciPy and a quadrature."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy import integrate, optimize, special, stats

from clock import Row, seconds, show
from navbound import tse

if TYPE_CHECKING:
    from collections.abc import Callable

SEED = 2014
N = 1_000_000
# Epochs whose inputs and results, together with the table, stay in the second level of the cache.
FIT = 32_768
RISK = 0.05


def by_quadrature(offset: tuple[float, float], sigma: tuple[float, float], slope: float) -> float:
    """One epoch as published: the two-dimensional density over the strip, and a search for the limit."""

    def beyond(limit: float) -> float:
        def inside(x: float) -> float:
            middle, half = slope * x, limit * math.sqrt(1 + slope * slope)
            strip = special.ndtr((middle + half - offset[1]) / sigma[1]) - special.ndtr((middle - half - offset[1]) / sigma[1])
            return float(strip) * math.exp(-0.5 * ((x - offset[0]) / sigma[0]) ** 2) / (sigma[0] * math.sqrt(2 * math.pi))

        return 1 - float(integrate.quad(inside, offset[0] - 8 * sigma[0], offset[0] + 8 * sigma[0], epsabs=1e-10)[0]) - RISK

    return float(optimize.brentq(beyond, 0.1, 200.0, xtol=1e-9))


def measure() -> list[Row]:
    """Seconds an epoch of each method, one thread."""
    rng = np.random.default_rng(SEED)
    fte, sigma = rng.normal(0, 20, N), rng.uniform(5, 15, N)
    risks = np.full(N // 10, RISK)
    few, fit = slice(0, N // 10), slice(0, FIT)
    covariance = np.array([[60.0, 12.0], [12.0, 110.0]]) * rng.uniform(0.5, 2, (N // 10, 1, 1))
    offset = rng.normal(0, 20, (N // 10, 2))
    prepared = tse.Exact(RISK)
    jobs: list[tuple[str, Callable[[], object], int, str]] = [
        ("tse exact, prepared", lambda: prepared(fte, sigma), N, "a table for one risk"),
        ("tse ltem", lambda: tse.ltem(fte, sigma, RISK), N, "same loop and checks as the prepared exact bound"),
        ("tse exact, in cache", lambda: prepared(fte[fit], sigma[fit]), FIT, "the same, epochs that stay in the cache"),
        ("tse ltem, in cache", lambda: tse.ltem(fte[fit], sigma[fit], RISK), FIT, "the same, epochs that stay in the cache"),
        ("tse preparation", lambda: tse.Exact(RISK), 1, "the table itself, once a risk"),
        ("tse exact, iterative", lambda: tse.exact(fte[few], sigma[few], risks), N // 10, "three Halley steps"),
        ("tse exceedance risk", lambda: tse.exceedance_risk(fte[few], sigma[few], 30.0), N // 10, "risk and its logarithm"),
        ("tse ctem", lambda: tse.ctem(offset, covariance, RISK), N // 10, "eigenvectors and secular equation"),
        ("tse sqsm", lambda: tse.sqsm(fte[few], covariance, RISK), N // 10, "eigenvalues"),
        (
            "scipy foldnorm.ppf",
            lambda: stats.foldnorm.ppf(1 - RISK, np.abs(fte[:300] / sigma[:300])) * sigma[:300],
            300,
            "the same number, vectorised",
        ),
    ]
    measured = [Row(name, seconds(action, 7) / n, n, note) for name, action, n, note in jobs]
    quadrature = seconds(lambda: by_quadrature((3.0, 6.0), (10.0, 6.0), 2.0), repeats=2)
    return [*measured, Row("quadrature and search", quadrature, 1, "SciPy quad inside brentq, as published")]


if __name__ == "__main__":
    show(measure())
