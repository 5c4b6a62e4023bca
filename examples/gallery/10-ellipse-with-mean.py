"""The same error with a mean: the circle around the estimate must reach farther, the ellipse moves."""

from navbound import plot

ax = plot.ellipse([[60.0, 12.0], [12.0, 110.0]], risk=0.05, mean_m=[9.0, -4.0])
