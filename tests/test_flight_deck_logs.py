"""Logs of Garmin's flight decks: a local time with its offset, units in a line of their own, a magnetic course, levels of SBAS."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta, timezone
from typing import TYPE_CHECKING

import numpy as np
import pytest

import navbound
from navbound.errors import FormatError
from navbound.read import read
from navbound.read.pieces.reading import read_pieces

if TYPE_CHECKING:
    from pathlib import Path

N, SPEED_MPS, VARIATION_DEG = 60, 60.0, 3.3
BEGIN = datetime(2026, 5, 1, 10, 0, 0, tzinfo=UTC)
M_PER_DEG = 6_371_000 * np.pi / 180
NAMES = (
    "  Lcl Date, Lcl Time, UTCOfst, AtvWpt,     Latitude,    Longitude,  AltMSL, GndSpd,   TRK,  AltGPS, MagVar, GPSfix,  HAL, HPLwas, "
    "HPLfd, VPLwas"
)
UNITS = (
    "#yyy-mm-dd, hh:mm:ss,   hh:mm,  ident,      degrees,      degrees,  ft msl,     kt,   deg,  ft wgs,    deg,   enum,   mt,     mt, "
    "   mt,     mt"
)


def row(k: int, *, offset: str = "-06:00", fix: str = "3DDiff", hpl: str = "8", variation: float | str = VARIATION_DEG) -> str:
    """A second of a flight to the north-east at 60 m/s, 1000 ft above the ellipsoid."""
    hours = int(offset[:3]) if offset.startswith(("+", "-")) else 0
    local = (BEGIN + timedelta(seconds=k)).astimezone(timezone(timedelta(hours=hours)))
    along_m = SPEED_MPS * k / np.sqrt(2)
    lat = 47.0 + along_m / M_PER_DEG
    lon = -97.0 + along_m / (M_PER_DEG * np.cos(np.radians(47.0)))
    place = f"{lat:13.7f}, {lon:13.7f}" if fix != "NoSoln" else "             ,             "
    when = f"{local:%Y-%m-%d}, {local:%H:%M:%S},  {offset}"
    level = hpl if fix == "3DDiff" else ""
    return f"{when},   KAAA, {place},   900.0, 116.6,  41.7,  1000.0, {variation}, {fix}, 1852, {level}, 20, {level}"


def log(path: Path, rows: list[str]) -> Path:
    path.write_text(
        "\n".join(['#airframe_info, log_version="1.00", airframe_name="Of ours",', UNITS, NAMES, *rows]) + "\n", encoding="utf-8"
    )
    return path


def test_a_log_is_read_with_its_offset_its_units_and_a_true_track(tmp_path: Path) -> None:
    reading = read(log(tmp_path / "a.csv", [row(k) for k in range(N)]))
    epochs = reading.epochs
    assert (reading.rejected, epochs.height) == ([], N)
    gps_s = (BEGIN - datetime(1980, 1, 6, tzinfo=UTC)).total_seconds() + 18.0
    np.testing.assert_array_equal(epochs["time_ns"].to_numpy(), (gps_s + np.arange(N)) * 1e9)
    # A foot has 0.3048 m and a nautical mile 1852 m.
    np.testing.assert_allclose(epochs["est_h_m"].to_numpy(), 304.8, rtol=1e-12)
    np.testing.assert_allclose(epochs["ground_speed_mps"].to_numpy(), 116.6 * 1852 / 3600, rtol=1e-12)
    np.testing.assert_allclose(epochs["ground_track_rad"].degrees().to_numpy(), 41.7 + VARIATION_DEG, rtol=1e-12)
    np.testing.assert_array_equal(epochs.select("hpl_m", "vpl_m").to_numpy(), np.full((N, 2), 8.0))
    assert [reading.columns[name] for name in ("time", "hpl_m")] == [
        "Lcl Date:ymd, Lcl Time:utc_time_of_day, UTCOfst:utc_offset",
        "HPLwas:m",
    ]
    pieces = read_pieces(tmp_path / "a.csv").pieces
    assert [each["time_ns"][0] for each in pieces][:1] == [epochs["time_ns"][0]]


@pytest.mark.parametrize(
    ("offset", "hours"), [("+00:00", 0), ("00:00", 0), ("-00:00", 0), ("+05:00", 5), ("+05", 5), ("-06", -6), ("0", 0)]
)
def test_an_offset_is_ahead_of_utc_whatever_sign_it_has(tmp_path: Path, offset: str, hours: int) -> None:
    rows = [row(k, offset=offset) for k in range(N)]
    assert f"{(10 + hours):02d}:00:00" in rows[0]
    assert read(log(tmp_path / "a.csv", rows)).epochs["time_ns"][0] == read(log(tmp_path / "b.csv", [row(0)] * 2)).epochs["time_ns"][0]


@pytest.mark.parametrize("odd", ["", "east", "+5.5", "1:5"])
def test_a_time_whose_offset_is_none_is_no_time(tmp_path: Path, odd: str) -> None:
    rows = [row(k, offset="+00:00") for k in range(N)]
    rows[20] = rows[20].replace("+00:00", odd)
    (refused,) = read(log(tmp_path / "a.csv", rows)).rejected
    assert (refused.count, refused.first_line) == (1, 24)


def test_a_local_time_without_its_offset_is_not_guessed(tmp_path: Path) -> None:
    path = log(tmp_path / "a.csv", [row(k) for k in range(N)])
    path.write_text(path.read_text(encoding="utf-8").replace("UTCOfst", "Column"), encoding="utf-8")
    with pytest.raises(FormatError, match="time: no column holds it"):
        read(path)


def test_where_the_deck_has_no_solution_there_is_no_position(tmp_path: Path) -> None:
    rows = [row(k, fix="NoSoln" if 20 <= k < 30 else "3D" if 40 <= k < 45 else "3DDiff") for k in range(N)]
    run = navbound.analyze(log(tmp_path / "a.csv", rows), spec="RNP 0.3", sigma_m=5.0)
    assert (run.summary.verdict.n_judged, run.summary.verdict.n_missing) == (N - 15, 10)
    assert run.epochs["hpl_m"].is_nan().sum() + run.epochs["hpl_m"].null_count() == 5
    assert run.summary.verdict.id != "inside"
    whole = navbound.analyze(log(tmp_path / "b.csv", [row(k) for k in range(N)]), spec="RNP 0.3", sigma_m=5.0)
    assert (whole.summary.verdict.id, whole.summary.verdict.n_judged) == ("inside", N)


@pytest.mark.parametrize(("name", "usual", "unit", "id_"), [("HPLwas", "mt", "nm", "not_shown"), ("HPLwas", "mt", "ft", "inside")])
def test_a_level_in_another_unit_than_the_usual_one_is_compared_in_it(tmp_path: Path, name: str, usual: str, unit: str, id_: str) -> None:
    path = log(tmp_path / "a.csv", [row(k) for k in range(N)])
    units = [usual if each.strip() == name else written for each, written in zip(NAMES.split(","), UNITS.split(","), strict=True)]
    at = [each.strip() for each in NAMES.split(",")].index(name)
    units[at] = unit
    path.write_text(path.read_text(encoding="utf-8").replace(UNITS, ",".join(units)), encoding="utf-8")
    run = navbound.analyze(path, spec="RNP 0.3", sigma_m=5.0)
    assert run.summary.verdict.id == id_
    assert "hpl_m" not in run.epochs.columns
    assert any(f"{name} [{unit}]" in each for each in run.summary.verdict.unread)


def test_a_speed_in_another_unit_than_the_usual_one_is_read_in_it(tmp_path: Path) -> None:
    path = log(tmp_path / "a.csv", [row(k).replace(" 116.6,", " 216.0,") for k in range(N)])
    path.write_text(path.read_text(encoding="utf-8").replace("    kt,", "  km/h,"), encoding="utf-8")
    epochs = read(path).epochs
    np.testing.assert_allclose(epochs["ground_speed_mps"].to_numpy(), 60.0, rtol=1e-12)


@pytest.mark.parametrize("variation", ["", "none"])
def test_a_magnetic_course_without_its_variation_is_no_track(tmp_path: Path, variation: str) -> None:
    epochs = read(log(tmp_path / "a.csv", [row(k, variation=variation if k == 7 else VARIATION_DEG) for k in range(N)])).epochs
    assert epochs["ground_track_rad"].is_nan().sum() + epochs["ground_track_rad"].null_count() == 1
    assert epochs.height == N
