"""Mixture over subsets of faulty ranges, written out: one dense weighted least squares for each subset, size of fault and state.

Marginal likelihood of a reading, position and clocks with a flat prior, common columns B with unit prior, C = diag(v) + B B':

    ln w = ln prior - 1/2 [ln det C + ln det(H'C^-1 H) + r'C^-1 r],    v_i = sigma_i^2 + s^2 for i in S

No update formula of ``crates/core/src/solution/mixture.rs`` is used. ``python oracle/mixture_dense.py`` prints the values that its tests
compare with.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

SIZES = (8.0, 40.0, 200.0, 1000.0)
FAULTY = (1e-3, 0.3)


@dataclass(frozen=True)
class Case:
    """Ranges of one epoch: directions, clock of each, sigma, residual, common columns [m]."""

    unit: Array
    clock: NDArray[np.int64]
    sigma: Array
    residual: Array
    common: Array


def reading(case: Case, subset: tuple[int, ...], size: float) -> tuple[float, Array, Array]:
    """Logarithm of the marginal likelihood, displacement and covariance of the position."""
    v = case.sigma**2
    v[list(subset)] += size**2
    clocks = np.eye(case.clock.max() + 1)[case.clock]
    h = np.hstack([-case.unit, clocks[:, clocks.any(axis=0)]])
    c = np.diag(v) + case.common @ case.common.T
    weight = np.linalg.inv(c)
    normal = h.T @ weight @ h
    theta = np.linalg.solve(normal, h.T @ weight @ case.residual)
    rest = case.residual - h @ theta
    likelihood = -0.5 * (np.linalg.slogdet(c)[1] + np.linalg.slogdet(normal)[1] + rest @ weight @ rest)
    return float(likelihood), np.asarray(theta[:3], dtype=np.float64), np.asarray(np.linalg.inv(normal)[:3, :3], dtype=np.float64)


def mixture(case: Case, obstructed: float) -> tuple[float, Array, float]:
    """Evidence of obstructed against open surroundings, covariance about zero, farthest horizontal distance of weight above 1e-7."""
    n = len(case.sigma)
    deepest = min(n - 3, 6 if n <= 9 else 3 if n <= 18 else 2)
    subsets = [s for k in range(deepest + 1) for s in combinations(range(n), k)]
    rows = [(len(s), *reading(case, s, size)) for s in subsets for size in SIZES]
    top = max(r[1] for r in rows)
    weights = np.array([[q ** r[0] * (1 - q) ** (n - r[0]) * np.exp(r[1] - top) for q in FAULTY] for r in rows])
    total = weights.sum(axis=0)
    posterior = weights / total @ np.array([1 - obstructed, obstructed])
    covariance = sum(w * (r[3] + np.outer(r[2], r[2])) for w, r in zip(posterior, rows, strict=True))
    prior = weights @ np.array([0.98, 0.02])
    # Without a fault the four sizes are one reading.
    prior[:4] = prior[:4].sum()
    share = prior / (prior[3:].sum())
    far = max(float(np.hypot(*r[2][:2])) for w, r in zip(share, rows, strict=True) if w > 1e-7)
    return float(total[1] / total[0]), np.asarray(covariance), far


def case(n: int, faults: dict[int, float]) -> Case:
    """Directions by plain arithmetic, so that every language has the same."""
    k = np.arange(n)
    azimuth, elevation = np.radians(37.0 + 137.5 * k), np.radians(15.0 + (53.0 * k) % 70.0)
    level = np.cos(elevation)
    unit = np.column_stack([level * np.sin(azimuth), level * np.cos(azimuth), np.sin(elevation)])
    residual = 0.5 * np.cos(1.7 * k) + 100.0 * (k % 2)
    for index, fault in faults.items():
        residual[index] += fault
    mapping = 1.0 / np.sin(elevation)
    common = np.column_stack([0.4 * mapping, 0.3 * unit[:, 0] * mapping])
    clock = k % 2 if n > 6 else np.zeros(n, dtype=np.int64)
    if n <= 6:
        residual -= 100.0 * (k % 2)
    return Case(unit, clock, np.asarray(0.8 + 0.1 * (k % 4), dtype=np.float64), residual, common)


def main() -> None:
    """Print every case."""
    for n, faults in ((6, {}), (6, {2: 30.0}), (8, {1: 12.0, 4: 12.0}), (12, {3: -500.0, 8: 25.0})):
        evidence, covariance, far = mixture(case(n, faults), 0.25)
        upper = [covariance[i, j] for i, j in ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))]
        print(f"{n} {faults} evidence {evidence:.12e} covariance {[f'{v:.9e}' for v in upper]} far {far:.9f}")


if __name__ == "__main__":
    main()
