"""How long the 95 % radius is, in deviations of the larger axis, from a line (1.96) to a circle (2.45)."""

import numpy as np
from matplotlib import pyplot

from navbound import anp

ratio = np.linspace(0.0, 1.0, 101)
covariance = np.zeros((101, 2, 2))
covariance[:, 0, 0], covariance[:, 1, 1] = 1.0, ratio**2
_, ax = pyplot.subplots(layout="constrained")
ax.plot(ratio, anp.circle(covariance, 0.05))
ax.set(title="95 % radius", xlabel="smaller over larger deviation [1]", ylabel="radius / larger deviation [1]")
