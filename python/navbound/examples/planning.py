"""What a flight is planned with: an almanac of GPS and a plan that names it."""

from __future__ import annotations

import math

from navbound.gnss import constellation

ALMANAC = "almanac.al3"
WEEK = 2408
"""Of GPS, in full; its first instant is that of applicability, so that nodes count from Greenwich. 2026-03-01 is its Sunday."""
NOMINAL = "gps-expanded"
"""27 slots of the standard positioning service's performance standard."""
_SEM_INCLINATION = 0.3
"""What inclinations count from. Provenance: standard (definition of a SEM almanac). [semicircles]"""

PLAN = f"""title = "Beijing to Shanghai, satellites jammed for ten minutes, one of them out of service"
flight = "beijing-shanghai"
departure_utc = 2026-03-01T06:00:00Z
orbits = ["{ALMANAC}"]

[equipment]
constellations = ["gps"]
monitor = "raim"

[[jamming]]
from_min = 40
until_min = 50

[[notices]]
satellites = ["G05"]
"""


def almanac() -> str:
    """Nominal orbits as a SEM almanac: count and title, week and time of applicability, then the satellites; angles in semicircles."""
    orbits = constellation(NOMINAL)
    lines = [f"{len(orbits.satellite)} NAVBOUND.ALM", f"{WEEK % 1024} 0"]
    for k, name in enumerate(orbits.satellite):
        tilt = orbits.inclination_rad[k] / math.pi - _SEM_INCLINATION
        angles = [_half_turns(values[k]) for values in (orbits.node_rad, orbits.perigee_rad, orbits.mean_anomaly_rad)]
        node, perigee, anomaly = angles
        rate = orbits.node_rate_radps[k] / math.pi
        lines += ["", name[1:], "0", "0"]
        lines.append(f"{orbits.eccentricity[k]:.13E} {tilt:.13E} {rate:.13E}")
        lines.append(f"{math.sqrt(orbits.semi_major_m[k]):.13E} {node:.13E} {perigee:.13E}")
        lines += [f"{anomaly:.13E} {0.0:.13E} {0.0:.13E}", "0", "11"]
    return "\n".join(lines) + "\n"


def _half_turns(angle_rad: float) -> float:
    """In [-1, 1)."""
    return (angle_rad / math.pi + 1.0) % 2.0 - 1.0
