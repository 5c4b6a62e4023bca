"""The same with a covariance that is four times too small: the line passes above the stated risk, and the mark is red."""

import navbound
from navbound import plot

epochs = navbound.fly("beijing-shanghai-drawn", flights=8).epochs
ax = plot.survival(epochs["nse_h_m"].to_numpy(), 0.5 * epochs["anp_circle_m"].to_numpy(), 0.05)
