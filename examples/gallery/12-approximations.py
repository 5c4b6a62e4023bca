"""How far the published approximations of the total error are from the exact bound, by flight technical error."""

import numpy as np
from matplotlib import pyplot

from navbound import tse

fte = np.linspace(0.0, 4.0, 201)
exact = tse.exact(fte, 1.0, 0.05)
_, ax = pyplot.subplots(layout="constrained")
ax.plot(fte, 100 * (tse.sqsm(fte, np.diag([1.0, 4.0]), 0.05) / exact - 1), label="SQSM, deviation along twice that across")
ax.plot(fte, 100 * (tse.ltem(fte, 1.0, 0.05) / exact - 1), label="LTEM")
ax.axhline(0.0, color="black", linewidth=0.8)
ax.set(title="Approximations of the 95 % total error", xlabel="|FTE| / sigma [1]", ylabel="above the exact bound [%]")
ax.legend(frameon=False)
