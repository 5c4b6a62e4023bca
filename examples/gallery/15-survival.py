"""Is the 95 % circle one? The share of the errors beyond it, at one, must not be above the stated 5 %."""

import navbound
from navbound import plot

epochs = navbound.fly("beijing-shanghai-drawn", flights=8).epochs
ax = plot.survival(epochs["nse_h_m"].to_numpy(), epochs["anp_circle_m"].to_numpy(), 0.05)
