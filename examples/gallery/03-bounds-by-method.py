"""The exact bound of the total error beside the published approximations, on the last eight minutes of a flight."""

import polars as pl

import navbound
from navbound import plot

epochs = navbound.fly("beijing-shanghai-degraded").epochs
last = epochs.filter(pl.col("time_ns") > epochs["time_ns"].max() - 480 * 10**9)
ax = plot.bounds(last, methods=["tse-exact", "tse-ltem", "tse-ctem-foot", "tse-sqsm"])
