"""An error that grows across the path: the monitor's caution and warning, and where no bound is left."""

import polars as pl

import navbound
from navbound import plot

run = navbound.fly("beijing-shanghai-misled")
epochs = run.epochs
last = epochs.filter(pl.col("time_ns") > epochs["time_ns"].max() - 480 * 10**9)
ax = plot.bounds(last, integrity=True)
