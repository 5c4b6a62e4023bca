"""Speed of navbound.dme on one core: positions from four and from two ranges, selection along a flight, coverage of Europe."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clock import Row, seconds, show
from navbound import dme
from navbound.studies.ukraine_rnav.flight import network

if TYPE_CHECKING:
    from collections.abc import Callable

SEED = 2018
N = 20_000
NEAR = ("BRP", "KSN", "STB", "YHT")


def measure() -> list[Row]:
    """Every figure of this module."""
    generator = np.random.Generator(np.random.Philox(SEED))
    four = network().only(*NEAR)
    place = (float(np.radians(49.9)), float(np.radians(31.5)))
    slant = dme.sights(*place, 9000.0, four).slant_m
    ranges = slant + dme.range_sigma(slant) * generator.standard_normal((N, 4))
    pairs = np.where(np.arange(4) < 2, ranges, np.nan)
    prior = {"prior_lat_rad": place[0], "prior_lon_rad": place[1]}
    lon = np.radians(np.linspace(31.0, 36.0, 2000))
    track = (np.arange(2000) * 10**9, np.full(2000, place[0]), lon, np.full(2000, 10_000.0))
    lat_map, lon_map = np.meshgrid(np.radians(np.arange(36.0, 60.0, 0.5)), np.radians(np.arange(-10.0, 30.0, 0.5)), indexing="ij")
    europe = dme.stations().near(lat_map, lon_map, 350e3)
    requirement = {"rnp_m": 1852.0, "fte_m": 926.0, "sigma_altitude_m": 30.0}
    jobs: list[tuple[str, Callable[[], object], int, str]] = [
        ("dme solve, four ranges, prior", lambda: dme.solve(ranges, four, 9000.0, sigma_altitude_m=30.0, **prior), N, "an epoch"),
        ("dme solve, four ranges, no prior", lambda: dme.solve(ranges, four, 9000.0, sigma_altitude_m=30.0), N, "both meetings settled"),
        ("dme solve, pair and prior", lambda: dme.solve(pairs, four, 9000.0, sigma_altitude_m=30.0, **prior), N, "both meetings settled"),
        ("dme select, 15 stations", lambda: dme.select(*track, network(), sigma_altitude_m=30.0), 2000, "an epoch"),
        (
            f"dme coverage, Europe, {len(europe)} stations",
            lambda: dme.coverage(lat_map, lon_map, 9500.0, europe, **requirement),
            lat_map.size,
            f"a point of {lat_map.size}",
        ),
    ]
    return [Row(name, seconds(action) / n, n, note) for name, action, n, note in jobs]


if __name__ == "__main__":
    show(measure())
