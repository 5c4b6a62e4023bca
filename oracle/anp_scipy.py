"""Radial and shaped probabilities of Gaussian errors by SciPy's general-purpose integrators: slow, and nothing shared with navbound."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy import integrate, optimize, stats

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


def ball(covariance: Floats, mean: Floats, radius: float) -> float:
    """Inside probability of a disc or ball: the conditional normal interval, integrated over the other axes with `nquad`."""
    d = len(mean)
    values, axes = np.linalg.eigh(covariance)
    centre = axes.T @ mean
    sigma = np.sqrt(values)
    normals = [stats.norm(c, s) for c, s in zip(centre, sigma, strict=True)]

    def interval(*y: float) -> float:
        h = math.sqrt(max(radius**2 - sum(v * v for v in y), 0.0))
        widest = normals[d - 1]
        density = math.prod(float(n.pdf(v)) for n, v in zip(normals, y, strict=False))
        return density * float(widest.cdf(h) - widest.cdf(-h))

    if d == 2:
        return float(integrate.quad(interval, -radius, radius, epsabs=1e-12, epsrel=1e-10, limit=200)[0])

    def limits(y: float, /) -> list[float]:
        h = math.sqrt(max(radius**2 - y * y, 0.0))
        return [-h, h]

    return float(integrate.nquad(interval, [limits, [-radius, radius]], opts={"epsabs": 1e-8, "epsrel": 1e-8})[0])


def imhof_outside(variances: Floats, noncentral: Floats, x: float) -> float:
    """P(sum lambda_j (Z_j + delta_j)^2 > x) by Imhof's integral; `noncentral` is delta squared."""

    def integrand(u: float) -> float:
        t = variances * u
        phase = 0.5 * float((np.arctan(t) + noncentral * t / (1 + t * t)).sum()) - 0.5 * x * u
        size = float(np.prod((1 + t * t) ** 0.25)) * math.exp(0.5 * float((noncentral * t * t / (1 + t * t)).sum()))
        return math.sin(phase) / (u * size)

    period = 4 * math.pi / x
    total = 0.0
    for k in range(400):
        total += integrate.quad(integrand, max(k * period, 1e-300), (k + 1) * period, epsabs=1e-12)[0]
    return 0.5 + total / math.pi


def rice_radius(sigma: float, distance: float, risk: float) -> float:
    """Radius of a round horizontal error with a mean: the non-central chi-square law."""
    return sigma * math.sqrt(float(stats.ncx2.isf(risk, 2, (distance / sigma) ** 2)))


def maxwell_radius(sigma: float, distance: float, risk: float) -> float:
    """The same in space."""
    return sigma * math.sqrt(float(stats.ncx2.isf(risk, 3, (distance / sigma) ** 2)))


def folded_half_width(bias: float, sigma: float, risk: float) -> float:
    """Half-width of a biased error along a line by Brent's search on the two tails."""

    def excess(r: float) -> float:
        return math.log(float(stats.norm.sf(r, bias, sigma) + stats.norm.cdf(-r, bias, sigma)) / risk)

    return float(optimize.brentq(excess, 0.0, abs(bias) + 36 * sigma, xtol=1e-14 * (abs(bias) + sigma)))


def box_inside(covariance: Floats, half: Floats) -> float:
    """Probability of a box around zero, by SciPy's multivariate normal."""
    inside = stats.multivariate_normal.cdf(
        half, mean=np.zeros(len(half)), cov=covariance, lower_limit=-half, maxpts=2_000_000, abseps=1e-9, releps=1e-9
    )
    return float(inside)
