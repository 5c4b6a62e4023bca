"""Satellites of GPS over a place, with the mask."""

import math

import numpy as np

from navbound import gnss, plot

orbits = gnss.constellation("gps")
az, el = gnss.directions(orbits, [math.radians(49.0)], [math.radians(2.5)], 0.0, 3600.0)
names = list(orbits.satellite)
ax = plot.sky(np.ravel(az), np.ravel(el), names=names, used=np.ravel(el) > math.radians(5.0), mask_rad=math.radians(5.0))
