"""Approaches in tables that hold little: a column that is absent is unknown at every epoch, a rule without its column is named."""

import math

import polars as pl
import pytest

from navbound.read.approaches import find
from navbound.read.runways import runway

N = 200
NAME = "LSZH/14"


def _landing() -> pl.DataFrame:
    """Six miles along the centreline at 60 m/s, on a 3 degree slope; positions by a flat map, good to metres at this distance."""
    of = runway(NAME)
    before_m = [60.0 * (N - i) for i in range(N)]
    north = [-b * math.cos(of.course_rad) / 6.371e6 for b in before_m]
    east = [-b * math.sin(of.course_rad) / (6.371e6 * math.cos(of.lat_rad)) for b in before_m]
    return pl.DataFrame(
        {
            "track": ["a"] * N,
            "time_ns": [1_600_000_000_000_000_000 + i * 1_000_000_000 for i in range(N)],
            "est_lat_rad": [of.lat_rad + d for d in north],
            "est_lon_rad": [of.lon_rad + d for d in east],
            "altitude_m": [of.elevation_m + b * math.tan(math.radians(3.0)) for b in before_m],
            "ground_track_rad": [of.course_rad] * N,
            "vertical_rate_mps": [-3.0] * N,
            "status": ["ok"] * N,
        }
    )


ABSENT = [
    [],
    ["ground_track_rad"],
    ["vertical_rate_mps"],
    ["altitude_m"],
    ["ground_track_rad", "vertical_rate_mps", "altitude_m"],
]


@pytest.mark.parametrize("absent", ABSENT)
def test_an_absent_column_is_unknown_at_every_epoch(absent: list[str]) -> None:
    of = runway(NAME)
    whole = find(_landing(), [of])
    approaches = find(_landing().drop(absent), [of])
    assert approaches.epochs.height == whole.epochs.height > N // 2
    assert len(approaches.notes) == len(absent), "each rule without its column is named"
