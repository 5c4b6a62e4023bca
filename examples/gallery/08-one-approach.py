"""One recorded approach: deviation and bound against RNP 0.3."""

import navbound
from navbound import plot

run = navbound.analyze("examples/data/tracks.csv", path="LFPG/08R", sigma_m=2.5)
ax = plot.deviation(run, track=run.epochs["track"][0])
