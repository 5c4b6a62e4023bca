"""Speed of navbound.maps: dilutions of a one-degree world over a day at five minutes, 18.7 million user-epochs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from clock import Row, seconds, show, wall
from navbound import gnss, maps

if TYPE_CHECKING:
    pass

DAY_S = np.arange(288) * 300.0
# Latitude by latitude, so that the memory is that of one.
DAY = """
import numpy as np
from navbound import gnss, maps
lat, lon = maps.Grid.degrees(1.0).points()
orbits = gnss.constellation("gps")
def job():
    for k in range(0, lat.size, 3600):
        gnss.dop_map(orbits, lat[k:k + 3600], lon[k:k + 3600], 0.0, np.arange(288) * 300.0)
"""


def measure() -> list[Row]:
    """One row a measurement."""
    rows: list[Row] = []
    lat, lon = maps.Grid.degrees(10.0).points()
    n = len(lat) * len(DAY_S)
    for words, names in (("gps", ("gps",)), ("gps and galileo", ("gps", "galileo"))):
        orbits = gnss.constellation(names[0])
        for name in names[1:]:
            orbits += gnss.constellation(name)
        spent = seconds(lambda orbits=orbits: gnss.dop_map(orbits, lat, lon, 0.0, DAY_S), 5)  # type: ignore[misc]
        day = f"a one-degree day {spent * 64_800 / len(lat):.1f} s of CPU"
        note = f"{len(orbits.satellite)} satellites, mask 5 deg, four dilutions, a user-epoch; {day}"
        rows.append(Row(f"dop_map {words}", spent / n, n, note))
    few = maps.Grid.degrees(30.0)
    lat, lon = few.points()
    orbits = gnss.constellation("gps")

    def by_angles() -> None:
        sky = gnss.geometry(orbits, lat[:, None], lon[:, None], 0.0, DAY_S, mask_rad=math.radians(5.0))
        gnss.dop(sky.az_rad, sky.el_rad, orbits.constellation)

    n = len(lat) * len(DAY_S)
    rows.append(Row("geometry and dop gps", seconds(by_angles, 2) / n, n, "the same through angles"))
    grid = maps.Grid.degrees(2.0)
    spent = seconds(lambda: maps.make("dop", grid=grid), 1)
    n = len(grid) * len(DAY_S)
    note = f"with percentiles and coverage, a user-epoch; a one-degree day {spent * 64_800 / len(grid):.1f} s of CPU"
    rows.append(Row("map dop gps", spent / n, n, note))
    n = 64_800 * len(DAY_S)
    whole, spent = wall(DAY, repeats=1)
    note = f"a user-epoch; the whole day computed, {whole:.1f} s of wall clock on all cores, {spent:.1f} s CPU"
    return [*rows, Row("dop_map gps, one-degree day", whole / n, n, note, goal_s=10.0 / n)]


if __name__ == "__main__":
    show(measure())
