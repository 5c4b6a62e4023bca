"""Columns of flight decks, drones and telephones that speak of their own positions, under the names of their loggers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

import navbound
from navbound.read import read
from navbound.read.columns.place_names import speaks_of_place
from test_stated_accuracy import SIGMA_M, N
from test_verdict import table

if TYPE_CHECKING:
    from pathlib import Path


def state(path: Path, name: str, value: object) -> tuple[str, int]:
    verdict = navbound.analyze(table(path, N, sigma_m=SIGMA_M, added={name: [value] * N})).summary.verdict
    return verdict.id, verdict.n_judged


@pytest.mark.parametrize(
    ("name", "value", "well"),
    [
        ("OSD.gpsNum", 2, 12),
        ("gpsNum", 3, 4),
        ("gps_num", 0, 9),
        ("OSD.isGPSused", "False", "True"),
        ("gps.valid", "false", "true"),
        ("nav.fix_type", "no_fix", "3d"),
        ("provider", "network", "gps"),
        ("location_provider", "wifi", "gps"),
        ("GPSfix", "LOI", "3DDiff"),
        ("gps_fix", "DeadReckon", "3d"),
        ("pos_qual", "bad", "good"),
        ("filled", 1, 0),
    ],
)
def test_a_position_without_satellites_is_not_judged(tmp_path: Path, name: str, value: object, well: object) -> None:
    assert state(tmp_path / "a.csv", name, value) == ("nothing_judged", 0)
    assert state(tmp_path / "b.csv", name, well) == ("inside", N)


@pytest.mark.parametrize(("name", "value", "well"), [("OSD.gpsLevel", 0, 4), ("HPLfd", 5000.0, 20.0), ("gpslevel", 0, 5)])
def test_a_level_that_is_none_shows_nothing(tmp_path: Path, name: str, value: object, well: object) -> None:
    assert state(tmp_path / "a.csv", name, value)[0] != "inside"
    assert state(tmp_path / "b.csv", name, well)[0] == "inside"


@pytest.mark.parametrize(
    "text",
    ["wrong position", "GNSS interference", "position frozen", "NAV INTEG LOST", "bad position"],
)
def test_a_remark_against_positions_shows_nothing(tmp_path: Path, text: str) -> None:
    assert state(tmp_path / "a.csv", "remarks", text)[0] == "not_shown"
    assert state(tmp_path / "b.csv", "remarks", f"{text} cleared")[0] == "inside"


def test_a_column_of_north_and_south_is_one_of_a_hemisphere(tmp_path: Path) -> None:
    assert state(tmp_path / "a.csv", "northsouth", "S")[0] == "not_shown"
    both = {"northsouth": ["N"] * N, "eastwest": ["E"] * N}
    assert navbound.analyze(table(tmp_path / "b.csv", N, sigma_m=SIGMA_M, added=both)).summary.verdict.id == "inside"


def test_a_word_of_many_words_is_none_of_a_telephone(tmp_path: Path) -> None:
    assert state(tmp_path / "a.csv", "source", "opensky network") == ("inside", N)


def test_a_lateral_acceleration_is_no_latitude(tmp_path: Path) -> None:
    added = {"LatAc": np.linspace(-0.3, 0.3, N)}
    verdict = navbound.analyze(table(tmp_path / "a.csv", N, sigma_m=SIGMA_M, added=added)).summary.verdict
    assert verdict.id == "inside"
    # The latitude of an aircraft is one.
    assert [speaks_of_place(name) for name in ("LatAc", "lat_ac", "ac_lat", "latitude_aircraft")] == [False, False, True, True]


def test_milliseconds_since_a_start_are_no_time_beside_one(tmp_path: Path) -> None:
    """As the logs of drones have them."""
    path = tmp_path / "a.csv"
    rows = [f"{1000 * k},2021-09-06 02:23:{k:02d},47.0,8.{k:03d}" for k in range(30)]
    path.write_text("\n".join(["time(millisecond),datetime(utc),latitude,longitude", *rows]) + "\n", encoding="utf-8")
    reading = read(path)
    assert (reading.columns["time"], reading.epochs.height) == ("datetime(utc):utc_text", 30)


@pytest.mark.parametrize("written", ["2018/07/04 09:19:{s:02d}.5", "2018/7/4 09:19:{s:02d}.5", "2018.07.04 09:19:{s:02d}.5"])
def test_a_date_with_strokes_and_the_year_first_is_one(tmp_path: Path, written: str) -> None:
    for name, text in (("a", written), ("b", "2018-07-04T09:19:{s:02d}.5Z")):
        rows = [f"{text.format(s=k)},47.0,8.{k:03d}" for k in range(30)]
        (tmp_path / f"{name}.csv").write_text("\n".join(["time,latitude,longitude", *rows]) + "\n", encoding="utf-8")
    assert read(tmp_path / "a.csv").epochs["time_ns"].equals(read(tmp_path / "b.csv").epochs["time_ns"])


def test_a_slow_speed_with_its_unit_in_each_field_needs_no_ways(tmp_path: Path) -> None:
    rows = [f"{1_700_000_000 + k},47.0,{8.0 + k * 3e-5:.6f},{8.0 + k % 3} km/h" for k in range(30)]
    (tmp_path / "a.csv").write_text("\n".join(["time,latitude,longitude,SPEED", *rows]) + "\n", encoding="utf-8")
    run = navbound.analyze(tmp_path / "a.csv", sigma_m=5.0)
    assert run.summary.verdict.id == "inside"
    assert run.epochs["ground_speed_mps"].to_list()[:2] == pytest.approx([8.0 / 3.6, 9.0 / 3.6])
