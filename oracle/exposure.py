"""Risk that a sampled Gauss-Markov process leaves a band within an hour, by its transition kernel: no simulation, no crossing theory.

The chance of being inside at every sample is the integral of the transition density over the band, sample after sample; on Gauss-Legendre
nodes that is a matrix, and after a few correlation times each step multiplies by its largest eigenvalue.
"""

from __future__ import annotations

import numpy as np

HOUR_S = 3600.0


def risk_in_an_hour(level: float, tau_s: float, sample_period_s: float, n_nodes: int = 2000) -> float:
    """Risk to be outside ±level (in standard deviations) at least once in an hour."""
    memory = np.exp(-sample_period_s / tau_s)
    spread = np.sqrt(-np.expm1(-2.0 * sample_period_s / tau_s))
    nodes, weights = np.polynomial.legendre.leggauss(n_nodes)
    nodes, weights = nodes * level, weights * level

    def density(z: np.ndarray) -> np.ndarray:
        return np.asarray(np.exp(-0.5 * z * z) / np.sqrt(2.0 * np.pi))

    step = density((nodes[None, :] - memory * nodes[:, None]) / spread) / spread * weights[None, :]
    inside = density(nodes) * weights
    n_samples = round(HOUR_S / sample_period_s)
    n_direct = min(n_samples - 1, int(20 * tau_s / sample_period_s) + 1)
    ratio = 1.0
    for _ in range(n_direct):
        before = inside.sum()
        inside = inside @ step
        ratio = inside.sum() / before
    log_inside = np.log(inside.sum()) + (n_samples - 1 - n_direct) * np.log(ratio)
    return float(-np.expm1(log_inside))


if __name__ == "__main__":
    for tau in (1.0, 5.0, 10.0, 19.0, 20.0, 60.0, 360.0):
        for u in (3.5, 4.4171734134690221, 5.5):
            print(f"    ({tau!r}, {u!r}, {risk_in_an_hour(u, tau, 1.0):.4e}),")
