"""Every approach of a day to two runways over each other, by distance to the threshold, with the band of 95 % of the deviations."""

import navbound
from navbound import plot

run = navbound.analyze("examples/data/tracks.csv", path="LFPG/08R,LFPG/09L", sigma_m=2.5)
ax = plot.approaches(run)
