"""Horizontal protection level and error over a day against the alert limit of APV-I; outages are hatched."""

import navbound
from navbound import plot

ax = plot.levels(navbound.evaluate("examples/data/levels.csv", levels="APV-I"), service="APV-I")
