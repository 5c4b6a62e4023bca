"""Units in which people state lengths and speeds, in SI: navbound computes in SI, and people read and write these."""

from __future__ import annotations

import math

METRES_PER_NM = 1852.0
"""International nautical mile (ICAO Annex 5). [m]"""
METRES_PER_FT = 0.3048
"""International foot (ICAO Annex 5). [m]"""
MPS_PER_KT = METRES_PER_NM / 3600.0
"""A nautical mile an hour. [m/s]"""
EARTH_RADIUS_M = 6_371_000.0
"""Mean radius of the Earth, for lengths on a sphere. [m]"""


def shortening(lat_rad: float) -> float:
    """How long a radian of longitude is in radians of latitude."""
    return math.cos(lat_rad)
