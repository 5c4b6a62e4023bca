"""Levels that are too small by a factor of thirty: misleading and hazardous epochs are counted where they are."""

import numpy as np

from navbound import plot

rng = np.random.default_rng(1)
error = np.abs(rng.normal(0.0, 12.0, 20_000))
ax = plot.stanford(error, rng.uniform(5.0, 60.0, 20_000), 40.0)
