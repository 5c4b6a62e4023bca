"""Speed of navbound.anp: radii in batch on one core, beside a SciPy route to the same number."""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING

import numpy as np
from scipy import integrate, optimize

from clock import Row, seconds, show
from navbound import anp

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

SEED = 2022
N = 200_000


def covariances(n: int, dimension: int) -> NDArray[np.float64]:
    """Random covariances with sigma ratios uniform in (0, 1], as the specification's measurement has them."""
    rng = np.random.default_rng(SEED)
    root = np.linalg.qr(rng.normal(size=(n, dimension, dimension)))[0] * rng.uniform(0.0, 1.0, size=(n, 1, dimension))
    return np.asarray(root @ root.swapaxes(-1, -2), dtype=np.float64)


def imhof_radius(covariance: NDArray[np.float64], risk: float) -> float:
    """Radius by SciPy alone: Imhof's integral for the law of e'e, and Brent's search."""
    variances = np.linalg.eigvalsh(covariance)

    def outside(x: float) -> float:
        def integrand(u: float) -> float:
            phase = 0.5 * np.arctan(variances * u).sum() - 0.5 * x * u
            return math.sin(phase) / (u * float(np.prod((1.0 + (variances * u) ** 2) ** 0.25)))

        return 0.5 + float(integrate.quad(integrand, 0.0, np.inf, limit=500)[0]) / math.pi

    top = variances.max()
    return math.sqrt(float(optimize.brentq(lambda x: outside(x) - risk, 1e-3 * top, 40.0 * top, xtol=1e-9 * top)))


def measure() -> list[Row]:
    """One row a measurement."""
    spatial, flat = covariances(N, 3), covariances(N, 2)
    rng = np.random.default_rng(SEED + 1)
    some = 5_000
    mean, mean_flat = (
        np.einsum("nij,nj->ni", np.linalg.cholesky(v[:some] + 1e-9 * np.eye(d)), rng.normal(size=(some, d)))
        for v, d in ((spatial, 3), (flat, 2))
    )
    threads = os.environ["RAYON_NUM_THREADS"]
    rows: list[Row] = []

    def row(name: str, n: int, note: str, call: Callable[[], object], repeats: int = 5, *, goal_s: float | None = None) -> None:
        rows.append(Row(name, seconds(call, repeats) / n, n, note, goal_s))

    where = f"batch from Python, {threads} thread(s)"
    row("anp.sphere, zero mean, risk 0.05", N, where, lambda: anp.sphere(spatial, 0.05))
    row("anp.sphere, zero mean, risk 1e-5", N, where, lambda: anp.sphere(spatial, 1e-5))
    row("anp.circle, zero mean, risk 0.05", N, where, lambda: anp.circle(flat, 0.05))
    row("anp.sphere, with mean, risk 0.05", some, where, lambda: anp.sphere(spatial[:some], 0.05, mean), goal_s=1e-6)
    row("anp.circle, with mean, risk 0.05", some, where, lambda: anp.circle(flat[:some], 0.05, mean_flat), goal_s=1e-6)
    far = "means of some 20 to 60 deviations, saddle point"
    row("anp.sphere, far mean, risk 0.05", some, far, lambda: anp.sphere(spatial[:some], 0.05, 20.0 * mean), goal_s=1e-6)
    row("anp.circle, far mean, risk 0.05", some, far, lambda: anp.circle(flat[:some], 0.05, 20.0 * mean_flat), goal_s=1e-6)
    row("anp.circle, risk 1e-7 (saddle point)", 2_000, where, lambda: anp.circle(flat[:2_000], 1e-7))
    row("anp.sphere, risk 1e-7 (saddle point)", 2_000, where, lambda: anp.sphere(spatial[:2_000], 1e-7))
    few = 2
    row(
        "SciPy: Imhof integral + brentq, risk 0.05", few, "3-D, default accuracy", lambda: [imhof_radius(v, 0.05) for v in spatial[:few]], 1
    )
    return rows


if __name__ == "__main__":
    show(measure())
