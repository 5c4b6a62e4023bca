"""A day of protection levels in a Stanford diagram: every epoch is in one region."""

import navbound
from navbound import plot

day = navbound.evaluate("examples/data/levels.csv", levels="APV-I").epochs
ax = plot.stanford(day["vpe_m"].to_numpy(), day["vpl_m"].to_numpy(), 50.0)
