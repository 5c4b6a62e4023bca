"""Which epochs of a solved receiver log were judged, and why the others were not."""

import navbound
from navbound import plot

run = navbound.analyze(["examples/data/station.rnx", "examples/data/broadcast.rnx"])
ax = plot.status(run)
