"""Positions that drift aside of the reported track within the limits of each minute: by the sums of `core::monitor::drift`."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import polars as pl
import pytest

import navbound

EARTH_M_PER_DEG = 111_195.0


def led_off(drift_mps: float, *, seconds: int = 1500, grid_deg: float = 0.0, track: str = "a") -> pl.DataFrame:
    """Straight on at 70 m/s and 40.3 degrees, with a drift to the right."""
    time_s, course = np.arange(seconds), math.radians(40.3)
    east_m = 70.0 * time_s * math.sin(course) + drift_mps * time_s * math.cos(course)
    north_m = 70.0 * time_s * math.cos(course) - drift_mps * time_s * math.sin(course)
    lat_deg = 48.0 + north_m / EARTH_M_PER_DEG
    stated = 40.3 + 0.2 * (time_s % 2)
    return pl.DataFrame(
        {
            "track": track,
            "time_s": 1.7e9 + time_s,
            "lat_deg": lat_deg,
            "lon_deg": 2.0 + east_m / (EARTH_M_PER_DEG * np.cos(np.radians(0.5 * (lat_deg + 48.0)))),
            "track_deg": grid_deg * np.round(stated / grid_deg) if grid_deg else stated,
            "ground_speed_mps": 70.0 + 0.1 * (time_s % 3),
            "sigma_e_m": 3.0,
            "sigma_n_m": 3.0,
        }
    )


def drifts(tmp_path: Path, table: pl.DataFrame) -> list[str]:
    path = tmp_path / "a.csv"
    table.write_csv(path)
    whole, pieces = (navbound.analyze(path, piece_rows=rows).summary.verdict.position_doubts for rows in (None, 123))
    words = [each for each in whole if "drift aside" in each]
    assert words == [each for each in pieces if "drift aside" in each]
    return words


@pytest.mark.parametrize(("drift_mps", "shows"), [(0.0, False), (1.3, False), (4.0, True), (-4.0, True), (5.0, True)])
def test_a_drift_shows_beyond_its_share(tmp_path: Path, drift_mps: float, *, shows: bool) -> None:
    assert bool(drifts(tmp_path, led_off(drift_mps))) == shows


@pytest.mark.parametrize(("grid_deg", "shows"), [(0.0, True), (1.0, True), (360.0 / 256.0, False), (360.0 / 128.0, False)])
def test_a_track_may_be_off_by_what_it_is_rounded_to(tmp_path: Path, grid_deg: float, *, shows: bool) -> None:
    assert bool(drifts(tmp_path, led_off(4.0, grid_deg=grid_deg))) == shows


def test_the_track_that_drifts_most_is_named(tmp_path: Path) -> None:
    table = pl.concat([led_off(0.0, track="b"), led_off(4.0, track="c"), led_off(4.4, track="d")])
    (words,) = drifts(tmp_path, table)
    assert "(track d, 2 of 3 tracks)" in words
