"""Speed of navbound.rnp: the RNP state of many navigation errors, and its memory from epoch to epoch."""

from __future__ import annotations

import numpy as np

from clock import Row, seconds, show
from navbound import rnp

SEED = 2018
N = 1_000_000


def measure() -> list[Row]:
    """One row a measurement."""
    error = np.abs(np.random.default_rng(SEED).normal(0.0, 600.0, N))
    states = rnp.StateClassifier([0.1, 0.3, 1.0, 4.0])
    note = "an epoch, four levels and beyond"
    return [
        Row("rnp state, most likely", seconds(lambda: states.classify(error)) / N, N, note),
        Row("rnp state, posteriors", seconds(lambda: states.posterior(error)) / N, N, note),
        Row("rnp state with memory", seconds(lambda: states.remember(error)) / N, N, note),
    ]


if __name__ == "__main__":
    show(measure())
