"""Where RAIM with GPS alone has a level within 0.3 NM all day, and where not."""

from navbound import maps, plot
from navbound.maps.sources import Times

day = maps.make("raim", grid=maps.Grid.degrees(15.0), times=Times(None, 86_400.0, 1200.0), limits={"hpl_m": 555.6})
ax = plot.availability(day)
