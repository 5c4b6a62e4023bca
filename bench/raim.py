"""Speed of navbound.raim: a world grid under 24 GPS satellites, levels of detection and of exclusion, on one core."""

from __future__ import annotations

import os

os.environ.setdefault("RAYON_NUM_THREADS", "1")

import numpy as np

from araim import seconds
from navbound import araim, gnss, raim


def measure() -> list[dict[str, object]]:
    """One row a measurement: name, seconds_per_item, n, note."""
    gps, galileo = gnss.constellation("gps"), gnss.constellation("galileo")
    return _rows("GPS", gps) + _rows("GPS and Galileo", gps + galileo)


def _rows(name: str, orbits: gnss.Orbits) -> list[dict[str, object]]:
    lat, lon = np.meshgrid(np.radians(np.arange(-85, 90, 10.0)), np.radians(np.arange(-175, 180, 10.0)), indexing="ij")
    instants = np.arange(0, 86_400, 7200.0)
    few = instants[::6]
    found = raim.predict(orbits, lat, lon, 0.0, instants)
    n, least = found.hpl_m.size, lat.size * few.size
    slopes = seconds(lambda: raim.predict(orbits, lat, lon, 0.0, instants)) / n
    separated = seconds(lambda: araim.predict(orbits, lat, lon, 0.0, few, service="raim", exclusion=True), repeats=3) / least
    note = f"{found.n_sv.mean():.1f} satellites; geometry, detection and exclusion"
    return [
        {"name": f"raim by slopes, {name}", "seconds_per_item": slopes, "n": n, "note": note},
        {
            "name": f"raim by solution separation, {name}",
            "seconds_per_item": separated,
            "n": least,
            "note": "each exclusion anew",
        },
    ]
