"""Positions and path from above, the alerts of the monitor marked."""

import polars as pl

import navbound
from navbound import plot

run = navbound.fly("beijing-shanghai-misled")
epochs = run.epochs
last = epochs.filter(pl.col("time_ns") > epochs["time_ns"].max() - 480 * 10**9)
ax = plot.ground_track(last)
