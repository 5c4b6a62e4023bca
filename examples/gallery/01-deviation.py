"""A flight beside its path: the deviation, the 95 % bound of the total error on both sides, and the RNP of each phase."""

import navbound
from navbound import plot

run = navbound.fly("beijing-shanghai-drawn")
ax = plot.deviation(run)
