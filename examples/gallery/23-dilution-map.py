"""Dilution of precision over the world: what it is below for 95 % of a day."""

from navbound import maps, plot

ax = plot.availability(maps.make("dop", grid=maps.Grid.degrees(10.0)), name="pdop_p95")
