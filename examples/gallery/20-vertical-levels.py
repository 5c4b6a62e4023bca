"""Vertical ones against LPV-200, whose limit of 35 m is exceeded now and then."""

import navbound
from navbound import plot

ax = plot.levels(navbound.evaluate("examples/data/levels.csv", levels="LPV-200"), service="LPV-200", vertical=True)
