"""One call of one number or one epoch, as a program makes it that has no arrays: checks, conversion, the core, the result."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clock import Row, seconds, show
from navbound import anp, araim, tse

if TYPE_CHECKING:
    from collections.abc import Callable

CALLS = 2_000


def sky(n: int) -> tuple[np.ndarray, list[int]]:
    """Satellites of two constellations all around, low and high."""
    azimuth, elevation = np.arange(n) * 2.4, np.radians(8 + 75 * ((np.arange(n) * 7) % n) / n)
    unit = np.column_stack([np.cos(elevation) * np.sin(azimuth), np.cos(elevation) * np.cos(azimuth), np.sin(elevation)])
    return unit, [0 if k % 2 == 0 else 2 for k in range(n)]


def measure() -> list[Row]:
    """Seconds a call."""
    covariance, mean = np.array([[9.0, 2.0], [2.0, 4.0]]), np.array([1.0, 2.0])
    unit, constellation = sky(17)
    sigma = np.full(17, 1.5)
    cases: list[tuple[str, Callable[[], object], float | None]] = [
        ("call tse.exact, numbers", lambda: tse.exact(3.0, 8.0, 0.05), 3e-6),
        ("call tse.ltem, numbers", lambda: tse.ltem(3.0, 8.0, 0.05), 3e-6),
        ("call tse.sqsm, one covariance", lambda: tse.sqsm(3.0, covariance, 0.05), 3e-6),
        ("call tse.exceedance_risk, numbers", lambda: tse.exceedance_risk(3.0, 8.0, 30.0), 3e-6),
        ("call anp.circle, one covariance and mean", lambda: anp.circle(covariance, 0.05, mean), None),
        ("call araim.protection_levels, one epoch", lambda: araim.protection_levels(unit, constellation, sigma, sigma), 15e-6),
    ]

    def many(call: Callable[[], object]) -> Callable[[], None]:
        def run() -> None:
            for _ in range(CALLS):
                call()

        return run

    return [Row(name, seconds(many(call)) / CALLS, CALLS, "one call after another", goal) for name, call, goal in cases]


if __name__ == "__main__":
    show(measure())
