"""The shipped runway table and what is looked up in it."""

from __future__ import annotations

import gzip
import math
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from navbound import InputError
from navbound.read.runways import near, runway, table

SHARED = Path(__file__).parents[2] / "shared" / "data"
SOURCE = SHARED / "infra" / "navaids" / "ourairports_runways.csv.gz"
SHIPPED = Path(__file__).parents[1] / "python" / "navbound" / "data" / "runways.csv.gz"

HEAD = (
    "# Runway ends, WGS-84. Source: OurAirports, runways.csv, repository davidmegginson/ourairports-data, commit 1fb3eea; public domain "
    "(Unlicense).\n# Reduced for navbound: see README.md beside this file.\n"
)


def reduced() -> bytes:
    """The shipped table, made again from its source as python/navbound/data/README.md says."""
    both = pl.read_csv(SOURCE, infer_schema=False)
    both = both.filter(
        pl.all_horizontal(pl.col(f"{e}_{c}").is_not_null() for e in ("le", "he") for c in ("latitude_deg", "longitude_deg", "ident")),
        pl.col("closed") == "0",
    )
    ends = [("low", "le"), ("high", "he")]
    columns = {new: pl.col(f"{old}_ident") for new, old in ends}
    columns |= {
        f"{new}_{a}_deg": pl.col(f"{old}_{b}_deg").cast(pl.Float64).round(7)
        for new, old in ends
        for a, b in (("lat", "latitude"), ("lon", "longitude"))
    }
    columns |= {f"{new}_elevation_ft": pl.col(f"{old}_elevation_ft") for new, old in ends}
    columns |= {f"{new}_displaced_ft": pl.col(f"{old}_displaced_threshold_ft") for new, old in ends}
    out = both.select(airport="airport_ident", length_ft="length_ft", **columns)
    m_per_deg = 6.371e6 * math.pi / 180
    apart = (
        m_per_deg
        * (
            (pl.col("low_lat_deg") - pl.col("high_lat_deg")) ** 2
            + ((pl.col("low_lon_deg") - pl.col("high_lon_deg")) * pl.col("low_lat_deg").radians().cos()) ** 2
        ).sqrt()
    )
    displaced = 0.3048 * pl.sum_horizontal(pl.col(f"{e}_displaced_ft").cast(pl.Float64) for e, _ in ends)
    out = out.filter(apart >= 100, displaced <= 0.7 * apart)
    return (HEAD + out.sort("airport", "low").write_csv()).encode()


@pytest.mark.skipif(not SOURCE.exists(), reason="the source table is not at hand")
def test_the_shipped_table_is_the_reduction_of_its_source() -> None:
    assert gzip.decompress(SHIPPED.read_bytes()) == reduced()


def test_every_runway_has_two_ends_and_each_end_its_opposite() -> None:
    ends = table()
    assert ends.height > 25_000
    assert ends.height % 2 == 0
    assert ends.select(pl.all_horizontal(pl.all().is_not_null().all())).item()
    there = ends.select("airport", lat="lat_rad", lon="lon_rad")
    back = ends.select("airport", lat="far_lat_rad", lon="far_lon_rad")
    assert there.sort("airport", "lat", "lon").equals(back.sort("airport", "lat", "lon"))


# Thresholds, courses and displacements of the independent reference, aircraft/cross_track_reference.json: 1e-7 deg, 1e-4 deg, 0.1 m.
@pytest.mark.parametrize(
    ("name", "lat_deg", "lon_deg", "course_deg", "displaced_m"),
    [
        ("LFPB/07", 48.9648197, 2.4240858, 67.7866, 300.2),
        ("LFPG/08R", 48.9929008, 2.56566, 85.2635, 0.0),
        ("LFPG/26L", 48.9948997, 2.6024301, -94.7087, 0.0),
        ("LFPO/06", 48.7212748, 2.3205131, 61.8231, 299.9),
        ("lfpo/25", 48.7263544, 2.396374, -105.5346, 434.9),
    ],
)
def test_thresholds_are_those_of_the_reference(name: str, lat_deg: float, lon_deg: float, course_deg: float, displaced_m: float) -> None:
    threshold = runway(name)
    # Half of the last digit printed, for two roundings: 1e-7 deg.
    assert abs(math.degrees(threshold.lat_rad) - lat_deg) <= 1e-7
    assert abs(math.degrees(threshold.lon_rad) - lon_deg) <= 1e-7
    # The table's coordinates are rounded to 1 cm; over a runway of 2.4 km that turns the course by 2.4e-4 deg at most.
    assert abs((math.degrees(threshold.course_rad) - course_deg + 180) % 360 - 180) <= 3e-4
    assert abs(threshold.displaced_m - displaced_m) <= 0.05


@pytest.mark.parametrize(
    ("name", "says"),
    [("LFPG/99", "no runway of LFPG of that name; there are 08H, 08L"), ("LFPX/08", "nearest"), ("LFPG", "LFPG/08R"), ("/08", "LFPG/08R")],
)
def test_an_unknown_runway_is_refused_with_what_there_is(name: str, says: str) -> None:
    with pytest.raises(InputError, match="path = ") as refusal:
        runway(name)
    assert says in str(refusal.value)


def test_runways_near_a_position_include_those_beyond_the_date_line() -> None:
    at_paris = near(np.radians([48.96]), np.radians([2.5]))
    assert {"LFPG/08R", "LFPB/27"} <= {r.name for r in at_paris}
    assert "KJFK/04L" not in {r.name for r in at_paris}
    fiji = table().filter(pl.col("lon_rad").abs() > math.radians(179.5)).row(0, named=True)
    beyond = near(np.array([fiji["lat_rad"]]), np.array([fiji["lon_rad"] - math.copysign(2 * math.pi, fiji["lon_rad"])]))
    assert f"{fiji['airport']}/{fiji['end']}" in {r.name for r in beyond}
