"""Speed of navbound.maps: dilutions of a one-degree world over a day at five minutes, 18.7 million user-epochs; process CPU time."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

import numpy as np

from navbound import gnss, maps

if TYPE_CHECKING:
    from collections.abc import Callable

DAY_S = np.arange(288) * 300.0


def seconds(call: Callable[[], object], repeats: int) -> float:
    """Best CPU time of a call."""
    best = math.inf
    for _ in range(repeats):
        start = time.process_time()
        call()
        best = min(best, time.process_time() - start)
    return best


def measure() -> list[dict[str, object]]:
    """One row a measurement: name, seconds_per_item, n, note."""
    rows: list[dict[str, object]] = []
    lat, lon = maps.Grid.degrees(10.0).points()
    n = len(lat) * len(DAY_S)
    for words, names in (("gps", ("gps",)), ("gps and galileo", ("gps", "galileo"))):
        orbits = gnss.constellation(names[0])
        for name in names[1:]:
            orbits += gnss.constellation(name)
        spent = seconds(lambda orbits=orbits: gnss.dop_map(orbits, lat, lon, 0.0, DAY_S), 5)  # type: ignore[misc]
        day = f"a one-degree day {spent * 64_800 / len(lat):.1f} s of CPU"
        note = f"{len(orbits.satellite)} satellites, mask 5 deg, four dilutions, a user-epoch; {day}"
        rows.append({"name": f"dop_map {words}", "seconds_per_item": spent / n, "n": n, "note": note})
    few = maps.Grid.degrees(30.0)
    lat, lon = few.points()
    orbits = gnss.constellation("gps")

    def by_angles() -> None:
        sky = gnss.geometry(orbits, lat[:, None], lon[:, None], 0.0, DAY_S, mask_rad=math.radians(5.0))
        gnss.dop(sky.az_rad, sky.el_rad, orbits.constellation)

    n = len(lat) * len(DAY_S)
    rows.append({"name": "geometry and dop gps", "seconds_per_item": seconds(by_angles, 2) / n, "n": n, "note": "the same through angles"})
    grid = maps.Grid.degrees(2.0)
    spent = seconds(lambda: maps.make("dop", grid=grid), 1)
    n = len(grid) * len(DAY_S)
    note = f"with percentiles and coverage, a user-epoch; a one-degree day {spent * 64_800 / len(grid):.1f} s of CPU"
    rows.append({"name": "map dop gps", "seconds_per_item": spent / n, "n": n, "note": note})
    return rows


if __name__ == "__main__":
    for entry in measure():
        print(f"{entry['name']:40s} {1e9 * float(str(entry['seconds_per_item'])):9.1f} ns  {entry['note']}")
