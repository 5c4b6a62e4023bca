"""The numbers of a map against a slow transcription that shares nothing with it: Kepler's orbits, rotations, an inverse, counting."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from navbound import gnss, maps
from navbound.maps.sources import Times
from navbound.maps.statistics import PERCENTILES, percentile_name

MASK_RAD = math.radians(10.0)
STEP_S, EPOCHS = 600.0, 144
# WGS-84 and IS-GPS-200.
A_M, F, MU, OMEGA = 6_378_137.0, 1 / 298.257223563, 3.986005e14, 7.2921151467e-5
Vector = tuple[float, float, float]


def satellites(orbits: gnss.Orbits, t: float) -> list[Vector]:
    """Circular orbits in the frame that turns with the Earth."""
    listed = []
    for k in range(len(orbits.satellite)):
        a, i, node = float(orbits.semi_major_m[k]), float(orbits.inclination_rad[k]), float(orbits.node_rad[k])
        u = float(orbits.perigee_rad[k]) + float(orbits.mean_anomaly_rad[k]) + math.sqrt(MU / a**3) * t
        lon = node - OMEGA * t
        x, y, z = a * math.cos(u), a * math.sin(u) * math.cos(i), a * math.sin(u) * math.sin(i)
        listed.append((x * math.cos(lon) - y * math.sin(lon), x * math.sin(lon) + y * math.cos(lon), z))
    return listed


def pdop_and_hdop(lat: float, lon: float, seen: list[Vector]) -> tuple[float, float]:
    """Of every satellite above the mask, one clock."""
    n = A_M / math.sqrt(1 - F * (2 - F) * math.sin(lat) ** 2)
    own = (n * math.cos(lat) * math.cos(lon), n * math.cos(lat) * math.sin(lon), n * (1 - F) ** 2 * math.sin(lat))
    rows = []
    for place in seen:
        d = [p - o for p, o in zip(place, own, strict=True)]
        east = -math.sin(lon) * d[0] + math.cos(lon) * d[1]
        north = -math.sin(lat) * (math.cos(lon) * d[0] + math.sin(lon) * d[1]) + math.cos(lat) * d[2]
        up = math.cos(lat) * (math.cos(lon) * d[0] + math.sin(lon) * d[1]) + math.sin(lat) * d[2]
        r = math.sqrt(east**2 + north**2 + up**2)
        if math.asin(up / r) >= MASK_RAD:
            rows.append([east / r, north / r, up / r, 1.0])
    q = np.linalg.inv(np.array(rows).T @ np.array(rows))
    return math.sqrt(q[0, 0] + q[1, 1] + q[2, 2]), math.sqrt(q[0, 0] + q[1, 1])


def not_exceeded(values: list[float], percent: float) -> float:
    """The smallest number found that at least this share of all numbers does not exceed, by counting."""
    return min(v for v in values if sum(w <= v for w in values) >= percent / 100 * len(values) - 1e-9)


def test_a_map_is_what_counting_gives() -> None:
    """Six cells from the equator to the pole, a day at ten minutes, two satellites out; limits that part the cells."""
    limit = 3.0
    grid = maps.Grid.degrees(30.0, (0.0, 90.0, 30.0, 90.0))
    times = Times(duration_s=EPOCHS * STEP_S, step_s=STEP_S)
    made = maps.make("dop", grid=grid, limits={"pdop": limit}, times=times, mask_rad=MASK_RAD, without=("G03", "G17"))
    every = gnss.constellation("gps")
    assert float(np.abs(every.eccentricity).max()) == 0.0, "the transcription knows circles only"
    names = [name for name in every.satellite if name not in {"G03", "G17"}]
    sky = [
        [place for name, place in zip(every.satellite, satellites(every, k * STEP_S), strict=True) if name in names] for k in range(EPOCHS)
    ]
    shares = []
    for row in made.points.iter_rows(named=True):
        numbers = [pdop_and_hdop(row["lat_rad"], row["lon_rad"], seen) for seen in sky]
        for column, values in zip(("pdop", "hdop"), zip(*numbers, strict=True), strict=True):
            for percent in PERCENTILES:
                # The rate of an orbit and of the Earth are known to 1e-9 here and there: over a day some centimetres of 26 000 km.
                expected = not_exceeded(list(values), percent)
                assert row[percentile_name(column, percent)] == pytest.approx(expected, rel=1e-7), (column, percent)
        shares.append(sum(pdop <= limit for pdop, _ in numbers) / EPOCHS)
        assert row["p_available"] == shares[-1]
    assert len(set(shares)) > 2, "the limit parts nothing"
    # The area between two parallels is the difference of the sines of their latitudes, and each row here has two cells.
    rows = [math.sin(math.radians(b)) - math.sin(math.radians(a)) for a, b in pairwise((0.0, 30.0, 60.0, 90.0))]
    for coverage in made.summary.coverage:
        area = sum(rows[k // 2] / 2 for k, share in enumerate(shares) if share >= coverage.available)
        # Cosines of the middle of rows of 30 degrees stand for the differences of sines: the same but for one factor.
        assert coverage.share == pytest.approx(area, abs=1e-12)
