"""Errors across the path over their stated deviation, beside the normal law. Errors of one flight are correlated: it is no test."""

import navbound
from navbound import plot

epochs = navbound.fly("beijing-shanghai-drawn").epochs
ax = plot.histogram(epochs["nse_cross_m"].to_numpy(), sigma_m=epochs["sigma_cross_m"].to_numpy())
