"""The ellipse and the circle that hold a horizontal error with 95 %: the circle is what ANP reports."""

from navbound import plot

ax = plot.ellipse([[60.0, 12.0], [12.0, 110.0]], risk=0.05)
