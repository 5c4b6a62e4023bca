"""Speed of navbound.raim: a world grid under 24 GPS satellites, and 24 Galileo more, levels of detection and of exclusion."""

from __future__ import annotations

import numpy as np

from clock import Row, seconds, show
from navbound import araim, gnss, raim


def measure() -> list[Row]:
    """One row a measurement."""
    gps, galileo = gnss.constellation("gps"), gnss.constellation("galileo")
    return _rows("GPS", gps) + _rows("GPS and Galileo", gps + galileo)


def _rows(name: str, orbits: gnss.Orbits) -> list[Row]:
    lat, lon = np.meshgrid(np.radians(np.arange(-85, 90, 10.0)), np.radians(np.arange(-175, 180, 10.0)), indexing="ij")
    instants = np.arange(0, 86_400, 7200.0)
    few = instants[::6]
    computed = raim.predict(orbits, lat, lon, 0.0, instants)
    n, least = computed.hpl_m.size, lat.size * few.size
    slopes = seconds(lambda: raim.predict(orbits, lat, lon, 0.0, instants)) / n
    separated = seconds(lambda: araim.predict(orbits, lat, lon, 0.0, few, service="raim", exclusion=True), repeats=3) / least
    return [
        Row(f"raim by slopes, {name}", slopes, n, f"{computed.n_sv.mean():.1f} satellites; geometry, detection and exclusion"),
        Row(f"raim by solution separation, {name}", separated, least, "each exclusion anew"),
    ]


if __name__ == "__main__":
    show(measure())
