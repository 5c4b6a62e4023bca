"""Which navigation specification is being met: probabilities of the states of RNP while the position is misled."""

import polars as pl

import navbound
from navbound import plot

run = navbound.fly("beijing-shanghai-misled")
epochs = run.epochs
last = epochs.filter(pl.col("time_ns") > epochs["time_ns"].max() - 480 * 10**9)
ax = plot.states(last, names=run.summary.states)
