"""A receiver claims sigmas of 4 m east, 9 m north and 12 m up, east and north correlated by 0.6. What may be said at 95 %?

Expected output:

    circle                  18.61 m
    across a course of 030   7.21 m
    vertical                23.52 m
    joint ellipsoid, north  25.16 m (holds 99.48 % of north errors, not 95 %)
"""

import math

from navbound import anp

RISK = 0.05
covariance = [[16.0, 0.6 * 4 * 9, 0.0], [0.6 * 4 * 9, 81.0, 0.0], [0.0, 0.0, 144.0]]
horizontal = [row[:2] for row in covariance[:2]]
course = math.radians(30)

print(f"circle                  {anp.circle(horizontal, RISK):5.2f} m")
print(f"across a course of 030  {anp.along(covariance, [math.cos(course), -math.sin(course), 0.0], RISK):5.2f} m")
print(f"vertical                {anp.along(covariance, [0.0, 0.0, 1.0], RISK):5.2f} m")
print(f"joint ellipsoid, north  {anp.support(covariance, [0.0, 1.0, 0.0], RISK):5.2f} m (holds 99.48 % of north errors, not 95 %)")
