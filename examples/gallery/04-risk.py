"""The risk of a total error beyond RNP while the ranging gets worse and better again."""

import polars as pl

import navbound
from navbound import plot

run = navbound.fly("beijing-shanghai-degraded")
epochs = run.epochs
last = epochs.filter(pl.col("time_ns") > epochs["time_ns"].max() - 480 * 10**9)
ax = plot.risk(last, required=1e-5)
