"""Procedures: a navigation database of the national size to all its procedures, its contradictions, and positions beside a path.

The national file is not in the shared data. Where NAVBOUND_CIFP names one it is read; else the largest shared file, and its time is scaled
by lines to the 397,415 of the FAA's cycle 2604: the goal stays that of the national file.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from clock import Row, seconds, show

ROOT = Path(__file__).parents[1]
NATIONAL_LINES = 397_415
GOAL_S = 0.6
N = 20_000


def measure() -> list[Row]:
    """One row a measurement."""
    from navbound import path, procedures  # noqa: PLC0415

    named = os.environ.get("NAVBOUND_CIFP")
    shared = ROOT.parent / "shared" / "data" / "procedures"
    file = Path(named) if named else max(shared.glob("K???.txt"), key=lambda f: f.stat().st_size)
    base = procedures.read(file)
    share = NATIONAL_LINES / base.n_lines
    note = f"{file.name}, {base.n_lines} lines" + ("" if share == 1 else f", scaled by {share:.0f}")
    rows = [
        Row("procedures, national file to all procedures", share * seconds(lambda: procedures.read(file)), 1, note, GOAL_S),
        Row("procedures, contradictions of it", share * seconds(base.contradictions), 1, note),
    ]
    flown = procedures.read(shared / "KDEN.txt").procedure("KDEN", "H16RZ", "CLFFF")
    time_s = np.arange(N, dtype=np.float64)
    per = {}
    for name, leg in (("TF", 3), ("RF", 2)):
        at = flown.core.at(leg, np.linspace(10.0, flown.legs[leg].length_m - 10.0, N))
        # Some 13 m beside the leg, as an aircraft flies.
        lat, lon = at["lat_rad"] + 2e-6, at["lon_rad"]
        per[name] = seconds(lambda lat=lat, lon=lon: flown.follow(time_s, lat, lon)) / N  # type: ignore[misc]
        rows.append(Row(f"procedures, follow on {name}", per[name], N, "one position 13 m beside: active leg, foot and status"))
    corners = np.array([(x.lat_rad, x.lon_rad) for x in flown.legs], dtype=np.float64)
    route = path.route(corners[:, 0], corners[:, 1])
    at = flown.core.at(3, np.linspace(10.0, flown.legs[3].length_m - 10.0, N))
    rows.append(Row("procedures, existing route", seconds(lambda: route.project(at["lat_rad"], at["lon_rad"])) / N, N, "to compare with"))
    return rows


if __name__ == "__main__":
    show(measure())
