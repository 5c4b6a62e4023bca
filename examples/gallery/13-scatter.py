"""Errors of a flight's position, the circle of their own covariance and that of the stated one."""

import navbound
from navbound import plot

ax = plot.scatter(navbound.fly("beijing-shanghai-drawn"))
