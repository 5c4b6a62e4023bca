"""The RNP-state classifier and the navigation error it classifies, transcribed from the formulas with mpmath; slow, for tests only."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

from mpmath import exp, log, mp, mpf, ncdf, npdf, pi, quad, sqrt

mp.dps = 40


def table(boundaries: list[float]) -> tuple[list[Any], list[Any]]:
    """Means and deviations by crossing densities: mu = B + sigma sqrt(-2 ln(rho sigma sqrt(2 pi))), as the source meant it."""
    b = [mpf(x) for x in boundaries]
    sigma = [b[0] / 3] + [(b[k] - b[k - 1]) / 6 for k in range(1, len(b))]
    sigma.append(sigma[-1])
    mean = [mpf(0)]
    for k in range(len(b) - 1):
        rho = npdf(b[k], mean[k], sigma[k])
        mean.append(b[k] + sigma[k + 1] * sqrt(-2 * log(rho * sigma[k + 1] * sqrt(2 * pi))))
    mean.append(2 * b[-1] - mean[-1])
    return mean, sigma


def printed_radicands(boundaries: list[float]) -> list[float]:
    """2 ln(rho_i sigma_{i+1} sqrt(2 pi)) of the recursion as printed: the argument of its square root."""
    mean, sigma = table(boundaries)
    b = [mpf(x) for x in boundaries]
    densities = [npdf(b[k], mean[k], sigma[k]) for k in range(len(b))]
    return [float(2 * log(rho * sigma[k + 1] * sqrt(2 * pi))) for k, rho in enumerate(densities)]


def log_posterior(boundaries: list[float], x: float, *, guarded: bool) -> list[float]:
    """Posterior of each state with equal priors, by dividing densities."""
    mean, sigma = table(boundaries)
    n = len(mean)
    at = [mpf(x)] * (n - 1) + [min(mpf(x), mean[-1]) if guarded else mpf(x)]
    densities = [npdf(at[k], mean[k], sigma[k]) for k in range(n)]
    return [float(log(d / sum(densities))) for d in densities]


def probabilities(boundaries: list[float], offset: float, sigma: float) -> list[float]:
    """Mass of the law of the error between neighbouring boundaries, both signs, by its distribution function."""
    with mp.workdps(200):
        edges = [mpf(0), *map(mpf, boundaries), mp.inf]

        def below(x: Any) -> Any:
            return ncdf(x, mpf(offset), mpf(sigma))

        return [float(below(high) - below(low) + below(-low) - below(-high)) for low, high in pairwise(edges)]


def probability_within(boundary: float, sum_of_squares: float, n: int) -> float:
    """P(95 % error <= boundary) by integrating the posterior of the deviation under the prior 1/sigma."""
    k = mpf("1.9599639845400542355")

    def weight(s: Any) -> Any:
        return s ** (-n - 1) * exp(-mpf(sum_of_squares) / (2 * s * s))

    scale = sqrt(mpf(sum_of_squares) / n)
    edges = [scale * f for f in (0, 0.3, 0.6, 1, 1.5, 3, 10, 100)]
    limit = mpf(boundary) / k
    below = [e for e in edges if e < limit] + [limit]
    return float(quad(weight, below) / quad(weight, [*edges, mp.inf]))
