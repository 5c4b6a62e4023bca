"""Lengths between points of a way and at its turns."""

from __future__ import annotations

import math

from navbound.units import EARTH_RADIUS_M


def chord_m(from_rad: tuple[float, float], to_rad: tuple[float, float]) -> float:
    """Straight distance of two points, latitude and longitude, on the mean sphere. [m]."""
    return EARTH_RADIUS_M * math.dist(_unit(*from_rad), _unit(*to_rad))


def _unit(lat_rad: float, lon_rad: float) -> tuple[float, float, float]:
    return math.cos(lat_rad) * math.cos(lon_rad), math.cos(lat_rad) * math.sin(lon_rad), math.sin(lat_rad)


def tangent_m(radius_m: float, turn_rad: float) -> float:
    """How far from the ends of an arc their tangents meet. [m]."""
    return radius_m * math.tan(0.5 * turn_rad)
