"""Directions of what is slow, noisy or turning: stated noise is no contradiction, and what is exchanged or turned shows."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import polars as pl
import pytest

import navbound

WORDS = "direction of the reported track"
EARTH_M_PER_DEG = 111_195.0


def moved(
    speed_mps: float,
    sigma_m: float,
    *,
    n: int = 900,
    every_s: int = 1,
    course_deg: float = 10.0,
    turn_deg_s: float = 0.0,
    states_speed: bool = True,
    behind: bool = False,
) -> pl.DataFrame:
    """A vehicle with white noise as large as it states, at one speed and one rate of turn."""
    rng = np.random.default_rng(7)
    time_s, fine = np.arange(n) * every_s, 20
    course = np.radians(course_deg + turn_deg_s * np.arange(n * every_s * fine) / fine)
    at = time_s * fine
    flown = [np.cumsum(speed_mps / fine * part(course))[at] for part in (np.sin, np.cos)]
    reported = course[at]
    if behind:
        # The course of the way that led to each row.
        way = np.arctan2(*(np.diff(each) for each in flown))
        reported = np.concatenate([way[:1], way])
    east_m, north_m = (each + rng.normal(0.0, sigma_m, n) for each in flown)
    table = {
        "time_s": 1.7e9 + time_s,
        "lat_deg": 48.0 + north_m / EARTH_M_PER_DEG,
        "lon_deg": 2.0 + east_m / (EARTH_M_PER_DEG * math.cos(math.radians(48.0))),
        "track_deg": np.degrees(reported) % 360.0,
        "sigma_e_m": np.full(n, sigma_m),
        "sigma_n_m": np.full(n, sigma_m),
    }
    return pl.DataFrame(table | ({"ground_speed_mps": np.full(n, speed_mps)} if states_speed else {}))


def doubts(tmp_path: Path, table: pl.DataFrame) -> list[str]:
    path = tmp_path / "a.csv"
    table.write_csv(path)
    whole, pieces = (navbound.analyze(path, piece_rows=rows).summary.verdict.position_doubts for rows in (None, 123))
    assert [each for each in whole if WORDS in each] == [each for each in pieces if WORDS in each]
    return list(whole)


@pytest.mark.parametrize("states_speed", [True, False])
@pytest.mark.parametrize(("speed_mps", "sigma_m"), [(2.0, 10.0), (5.0, 5.0), (7.0, 10.0), (12.0, 10.0), (12.0, 60.0), (30.0, 20.0)])
def test_noise_as_large_as_stated_is_no_contradiction(tmp_path: Path, speed_mps: float, sigma_m: float, *, states_speed: bool) -> None:
    for turn_deg_s in (0.0, 6.0):
        table = moved(speed_mps, sigma_m, states_speed=states_speed, turn_deg_s=turn_deg_s)
        assert not [each for each in doubts(tmp_path, table) if WORDS in each]


@pytest.mark.parametrize(
    ("speed_mps", "sigma_m", "every_s", "states_speed"),
    [
        (2.0, 1.0, 1, True),
        (2.0, 1.0, 1, False),
        (2.0, 5.0, 4, True),
        (5.0, 5.0, 1, True),
        (5.0, 5.0, 1, False),
        (12.0, 10.0, 1, True),
        (12.0, 10.0, 4, True),
        (12.0, 10.0, 1, False),
    ],
)
def test_what_is_exchanged_shows_at_slow_speeds(
    tmp_path: Path, speed_mps: float, sigma_m: float, every_s: int, *, states_speed: bool
) -> None:
    table = moved(speed_mps, sigma_m, every_s=every_s, states_speed=states_speed)
    exchanged = table.rename({"lat_deg": "lon_deg", "lon_deg": "lat_deg"})
    assert any("exchanged at" in each for each in doubts(tmp_path, exchanged))


@pytest.mark.parametrize("change", [pl.col("track_deg") + 30.0, pl.col("track_deg").radians(), 360.0 - pl.col("track_deg")])
def test_a_track_that_is_another_shows_at_slow_speeds(tmp_path: Path, change: pl.Expr) -> None:
    table = moved(5.0, 3.0, course_deg=70.0).with_columns(track_deg=change % 360.0)
    assert any(WORDS in each for each in doubts(tmp_path, table))


@pytest.mark.parametrize(("speed_mps", "turn_deg_s", "every_s"), [(30.0, 25.0, 2), (28.0, 15.0, 5), (110.0, 8.0, 8), (200.0, 8.0, 8)])
def test_the_course_of_the_way_that_led_to_a_row_is_a_course(tmp_path: Path, speed_mps: float, turn_deg_s: float, every_s: int) -> None:
    """As loggers state it that have positions alone; one that is 60 degrees off against the turn shows as ever."""
    table = moved(speed_mps, 1.0, n=400, turn_deg_s=turn_deg_s, every_s=every_s, behind=True)
    assert not [each for each in doubts(tmp_path, table) if WORDS in each]
    off = table.with_columns(track_deg=(pl.col("track_deg") + 300.0) % 360.0)
    assert any(WORDS in each for each in doubts(tmp_path, off))


@pytest.mark.parametrize(("speed_mps", "turn_deg_s", "every_s"), [(20.0, 60.0, 4), (28.0, 40.0, 5), (12.0, 60.0, 4)])
def test_circles_between_rows_are_no_contradiction(tmp_path: Path, speed_mps: float, turn_deg_s: float, every_s: int) -> None:
    table = moved(speed_mps, 1.0, n=400, turn_deg_s=turn_deg_s, every_s=every_s)
    assert not [each for each in doubts(tmp_path, table) if WORDS in each]


@pytest.mark.parametrize(("speed_mps", "turn_deg_s", "every_s"), [(20.0, 60.0, 1), (26.0, 45.0, 1), (26.0, 45.0, 2), (45.0, 60.0, 1)])
def test_steep_circles_travel_as_far_as_they_say(tmp_path: Path, speed_mps: float, turn_deg_s: float, every_s: int) -> None:
    """Beyond 60 degrees of bank, as models and gliders fly: a leg of five seconds is most of a circle."""
    table = moved(speed_mps, 1.0, n=400, turn_deg_s=turn_deg_s, every_s=every_s)
    assert not [each for each in doubts(tmp_path, table) if "less far" in each]
    # Half of the speed shows in circles, too.
    half = moved(speed_mps, 1.0, n=400, turn_deg_s=turn_deg_s, every_s=every_s).with_columns(ground_speed_mps=pl.lit(2.0 * speed_mps))
    assert [each for each in doubts(tmp_path, half) if "less far" in each]
