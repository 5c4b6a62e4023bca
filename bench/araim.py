"""Speed of navbound.araim: a world grid under 24 GPS and 24 Galileo satellites, detection and exclusion, on one core."""

from __future__ import annotations

import os

os.environ.setdefault("RAYON_NUM_THREADS", "1")

import math
import time
from typing import TYPE_CHECKING

import numpy as np

from navbound import araim, gnss

if TYPE_CHECKING:
    from collections.abc import Callable


def seconds(call: Callable[[], object], repeats: int = 5) -> float:
    """Best CPU time of a call."""
    best = math.inf
    for _ in range(repeats):
        start = time.process_time()
        call()
        best = min(best, time.process_time() - start)
    return best


def measure() -> list[dict[str, object]]:
    """One row a measurement: name, seconds_per_item, n, note."""
    orbits = gnss.constellation("gps") + gnss.constellation("galileo")
    lat, lon = np.meshgrid(np.radians(np.arange(-85, 90, 10.0)), np.radians(np.arange(-175, 180, 10.0)), indexing="ij")
    instants = np.arange(0, 86_400, 3600.0)

    def levels(every: int, *, service: str = "lpv-200", exclusion: bool = False) -> araim.Levels:
        return araim.predict(orbits, lat, lon, 0.0, instants[::every], service=service, exclusion=exclusion)

    found = levels(1)
    n, ok = found.vpl_m.size, found.status == "ok"
    note = f"{found.n_sv.mean():.1f} satellites, {found.n_modes.mean():.1f} modes, mean VPL {found.vpl_m[ok].mean():.2f} m"
    few = levels(12, exclusion=True).vpl_m.size
    rows = [
        ("araim detection, geometry and sigmas", seconds(lambda: levels(1)) / n, n, note),
        ("araim with exclusion", seconds(lambda: levels(12, exclusion=True), repeats=3) / few, few, "every likely fault excluded in turn"),
        ("raim detection", seconds(lambda: levels(1, service="raim")) / n, n, "one fault at a time"),
        (
            "raim with exclusion",
            seconds(lambda: levels(12, service="raim", exclusion=True), repeats=3) / few,
            few,
            "every satellite in turn",
        ),
    ]
    return [{"name": name, "seconds_per_item": each, "n": items, "note": words} for name, each, items, words in rows]
