"""Latitude and longitude in one field, as the export of a flight by Flightradar24 has them."""

from __future__ import annotations

import math
from datetime import UTC, datetime
from pathlib import Path

import pytest

import navbound
from navbound import FormatError
from navbound.read.tables.epochs import read

N = 40
BEGIN_S = 1_700_000_000
KNOT, FOOT = 1852.0 / 3600.0, 0.3048
HEADER = "Timestamp,UTC,Callsign,Position,Altitude,Speed,Direction"


def row(k: int, position: str | None = None) -> str:
    """A flight to the north at 480 kt: one second is 0.002222 degrees of a meridian of 60 NM a degree."""
    place = f'"{48.0 + k * 480.0 / 3600.0 / 60.0:.6f},-2.250000"' if position is None else position
    utc = datetime.fromtimestamp(BEGIN_S + k, UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    return f"{BEGIN_S + k},{utc},ABC12,{place},30000,480,0"


def export(tmp_path: Path, *positions: str, header: str = HEADER, n: int = N) -> Path:
    rows = [row(k) for k in range(n)] + [row(n + k, each) for k, each in enumerate(positions)]
    path = tmp_path / "flight.csv"
    path.write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    return path


def test_an_export_of_a_flight_is_read(tmp_path: Path) -> None:
    reading = read(export(tmp_path))
    last = reading.epochs.row(-1, named=True)
    assert last["est_lat_rad"] == pytest.approx(math.radians(48.0 + (N - 1) / 450.0), abs=math.radians(5e-7))
    assert last["est_lon_rad"] == math.radians(-2.25)
    assert last["altitude_m"] == 30_000 * FOOT
    assert last["ground_speed_mps"] == pytest.approx(480.0 * KNOT, rel=1e-12)
    assert (last["ground_track_rad"], last["track"]) == (0.0, "ABC12")
    assert reading.columns["est_lat_rad"] == "position latitude:deg"
    assert (reading.unused, reading.unread, reading.position_doubts, reading.epochs.height) == (["UTC"], [], [], N)


@pytest.mark.parametrize("piece_rows", [None, 7])
def test_such_a_flight_is_judged_in_pieces_too(tmp_path: Path, piece_rows: int | None) -> None:
    run = navbound.analyze(export(tmp_path), spec="RNP 1", sigma_m=30.0, piece_rows=piece_rows)
    assert set(run.epochs["reason_id"]) == {None}
    assert (run.summary.verdict.id, run.epochs.height) == ("inside", N)


def test_a_field_that_is_no_pair_is_refused_with_its_row(tmp_path: Path) -> None:
    reading = read(export(tmp_path, '"48.1"', '""', '"48.1,2.2,3.3"', "north"))
    assert reading.epochs.height == N
    assert sum(each.count for each in reading.rejected) == 4


def test_a_text_of_that_name_is_no_pair(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("Timestamp,UTC,Callsign,Position,Altitude,Speed,Direction\n" + "\n".join(row(k, "Captain") for k in range(N)))
    with pytest.raises(FormatError, match="est_lat_rad: no column holds it"):
        read(path)


def test_beside_a_latitude_and_a_longitude_pairs_are_compared_with_them(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    rows = [f'{BEGIN_S + k},48.0,{2.0 + 0.001 * k},"1.0,2.0"' for k in range(N)]
    path.write_text("timestamp,lat,lon,position\n" + "\n".join(rows))
    reading = read(path)
    assert (reading.columns["est_lat_rad"], len(reading.position_doubts)) == ("lat:deg", 2)


@pytest.mark.parametrize("separator", [";", "\t"])
def test_other_separators_need_no_quotation_marks(tmp_path: Path, separator: str) -> None:
    path = tmp_path / "a.csv"
    rows = [f"{BEGIN_S + k}{separator}48.{k:03d}, 2.5{separator}x" for k in range(N)]
    path.write_text(f"time{separator}LatLon{separator}note\n" + "\n".join(rows))
    epochs = read(path).epochs
    assert epochs["est_lon_rad"].unique().to_list() == [math.radians(2.5)]
    assert epochs["est_lat_rad"][-1] == pytest.approx(math.radians(48.039), abs=1e-15)
