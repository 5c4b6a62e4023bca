"""Positions that drift aside of the stated track, each minute within its limits, show in all; what tracks are rounded to is no drift."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import polars as pl
import pytest

import navbound

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

WORDS = "drift aside"
EARTH_M_PER_DEG = 111_195.0


def drifting(
    speed_mps: float,
    drift_mps: float,
    *,
    n_s: int = 1200,
    every_s: int = 1,
    from_s: int = 0,
    course_deg: float = 40.3,
    reported: Callable[[NDArray[np.float64]], NDArray[np.float64]] = lambda course: course,
) -> pl.DataFrame:
    """A straight flight, whose positions go to the right from some second on."""
    time_s = np.arange(0, n_s, every_s)
    sin, cos = math.sin(math.radians(course_deg)), math.cos(math.radians(course_deg))
    flown_m, aside_m = speed_mps * time_s, drift_mps * np.maximum(0, time_s - from_s)
    lat_deg = 48.0 + (flown_m * cos - aside_m * sin) / EARTH_M_PER_DEG
    # A loxodrome: east by the latitude of each step.
    east_deg = np.diff(flown_m * sin + aside_m * cos) / (EARTH_M_PER_DEG * np.cos(np.radians(lat_deg[:-1])))
    lon_deg = 2.0 + np.concatenate([[0.0], np.cumsum(east_deg)])
    course = reported(np.full(time_s.size, course_deg))
    speeds = {"ground_speed_mps": np.full(time_s.size, speed_mps), "track_deg": course % 360.0}
    accuracy = {name: np.full(time_s.size, 5.0) for name in ("sigma_e_m", "sigma_n_m")}
    return pl.DataFrame({"time_s": 1.7e9 + time_s, "lat_deg": lat_deg, "lon_deg": lon_deg} | speeds | accuracy)


def doubts(tmp_path: Path, table: pl.DataFrame) -> list[str]:
    path = tmp_path / "a.csv"
    table.write_csv(path)
    whole, pieces = (navbound.analyze(path, piece_rows=rows).summary.verdict.position_doubts for rows in (None, 333))
    assert whole == pieces
    return list(whole)


@pytest.mark.parametrize("every_s", [1, 5])
@pytest.mark.parametrize(("speed_mps", "drift_mps"), [(70.0, 5.0), (70.0, -5.0), (110.0, 8.0), (28.0, 3.75), (230.0, 10.0)])
def test_a_slow_drift_aside_shows_in_all(tmp_path: Path, speed_mps: float, drift_mps: float, every_s: int) -> None:
    assert [WORDS in each for each in doubts(tmp_path, drifting(speed_mps, drift_mps, every_s=every_s))] == [True]


@pytest.mark.parametrize("course_deg", [0.0, 40.0, 90.0])
def test_a_drift_shows_beside_a_round_course_and_behind_an_hour_that_was_right(tmp_path: Path, course_deg: float) -> None:
    table = drifting(70.0, 5.0, course_deg=course_deg, n_s=4800, from_s=3600)
    assert any(WORDS in each for each in doubts(tmp_path, table))


@pytest.mark.parametrize(
    ("course_deg", "reported"),
    [
        (40.99, np.floor),
        (40.49, np.round),
        (41.9, lambda course: 360.0 / 128.0 * np.floor(course * 128.0 / 360.0)),
        (40.6, lambda course: 360.0 / 256.0 * np.floor(course * 256.0 / 360.0)),
        # Components in whole knots, cut.
        (40.3, lambda course: course + 0.3),
    ],
)
def test_what_tracks_are_rounded_to_is_no_drift(tmp_path: Path, course_deg: float, reported: Callable[..., NDArray[np.float64]]) -> None:
    for speed_mps in (28.0, 110.0, 230.0):
        table = drifting(speed_mps, 0.0, n_s=7200, every_s=4, course_deg=course_deg, reported=reported)
        assert doubts(tmp_path, table) == []


def test_a_drift_that_comes_back_is_the_noise_of_a_track(tmp_path: Path) -> None:
    """A track with an error of 3 degrees to either side, by turns each three minutes."""
    table = drifting(70.0, 0.0, n_s=7200)
    sway = 3.0 * np.sign(np.sin(np.arange(7200) * 2.0 * np.pi / 360.0))
    assert doubts(tmp_path, table.with_columns(track_deg=pl.col("track_deg") + pl.Series(sway))) == []


def test_a_course_of_the_way_that_led_to_its_row_ends_where_it_leads(tmp_path: Path) -> None:
    """Turns of three degrees a second in rows of eight: over a minute the mean of two rows is 12 degrees late."""
    course = np.radians(3.0 * np.arange(300) * 8.0)
    way = 110.0 * 8.0 * np.sinc(math.radians(12.0) / np.pi)
    places = [np.concatenate([[0.0], np.cumsum(way * part(course[:-1] + math.radians(12.0)))]) for part in (np.sin, np.cos)]
    led = np.concatenate([course[:1], course[:-1] + math.radians(12.0)])
    table = drifting(110.0, 0.0, n_s=2400, every_s=8).with_columns(
        lat_deg=pl.Series(48.0 + places[1] / EARTH_M_PER_DEG),
        lon_deg=pl.Series(2.0 + places[0] / EARTH_M_PER_DEG / math.cos(math.radians(48.0))),
        track_deg=pl.Series(np.degrees(led) % 360.0),
    )
    assert doubts(tmp_path, table) == []
    off = table.with_columns(track_deg=(pl.col("track_deg") + 345.0) % 360.0)
    assert any("positions end elsewhere" in each for each in doubts(tmp_path, off))
