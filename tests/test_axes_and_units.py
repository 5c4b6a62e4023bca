"""Exchanged axes, radians and feet are doubted where the table shows them."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import navbound
from test_verdict import M_PER_RAD, START_NS

N = 200


def words(tmp_path: Path, **changed: object) -> str:
    """A flight north-east from 48 N 2 E at 70 m/s with its track, and what is changed of it."""
    k = np.arange(N)
    lat, lon = 0.84 + 50.0 * k / M_PER_RAD, 0.035 + 30.0 * k / (M_PER_RAD * math.cos(0.84))
    columns = {
        "gps_time_ns": START_NS + k * 1_000_000_000,
        "lat_deg": np.degrees(lat),
        "lon_deg": np.degrees(lon),
        "height_m": np.full(N, 3000.0),
        "alt_m": np.full(N, 2950.0),
        "track_deg": np.full(N, math.degrees(math.atan2(30.0, 50.0))),
        "sigma_e_m": np.full(N, 3.0),
        "sigma_n_m": np.full(N, 3.0),
    } | changed
    path = tmp_path / "a.csv"
    rows = zip(*(map(repr, np.asarray(values).tolist()) for values in columns.values()), strict=True)
    lines = [",".join(row) for row in [tuple(columns), *rows]]
    path.write_text("\n".join(lines))
    whole, pieces = (navbound.analyze(path, piece_rows=piece_rows).summary for piece_rows in (1000, 7))
    assert (whole.assumptions, whole.verdict.position_doubts) == (pieces.assumptions, pieces.verdict.position_doubts)
    return " ".join([*whole.assumptions, *whole.verdict.position_doubts])


def test_a_sound_table_has_no_doubt(tmp_path: Path) -> None:
    doubts = words(tmp_path)
    assert not any(each in doubts for each in ("exchanged", "radians", "3.28 times", "reported track"))


def test_exchanged_axes_move_where_nobody_flies(tmp_path: Path) -> None:
    k = np.arange(N)
    lat, lon = 0.84 + 60.0 * k / M_PER_RAD, 0.035 + 5.0 * k / (M_PER_RAD * math.cos(0.84))
    doubts = words(tmp_path, lat_deg=np.degrees(lon), lon_deg=np.degrees(lat), track_deg=np.full(N, math.degrees(math.atan2(5.0, 60.0))))
    assert "with latitude and longitude exchanged at 199" in doubts


def test_a_latitude_in_radians_beside_degrees(tmp_path: Path) -> None:
    k = np.arange(N)
    doubts = words(tmp_path, lat_deg=0.84 + 50.0 * k / M_PER_RAD, lon_deg=np.degrees(0.2) + 0.0003 * k)
    assert "“lat_deg” was read as degrees, but all its values are small enough to be radians" in doubts


@pytest.mark.parametrize(("name", "metres"), [("height_m", 3000.0), ("alt_m", 2950.0)])
def test_feet_in_a_column_of_metres(tmp_path: Path, name: str, metres: float) -> None:
    doubts = words(tmp_path, **{name: np.full(N, metres / 0.3048)})
    assert f"“{name}” was read as m, and is 3.28 times" in doubts


def test_longitudes_from_0_to_360_are_the_same_places(tmp_path: Path) -> None:
    """Through the meridian of Greenwich westwards: 0.01 becomes 359.99."""
    k = np.arange(N)
    lon = 0.02 - 0.0004 * k
    doubts = words(tmp_path, lon_deg=lon % 360.0, lat_deg=np.full(N, 48.0), track_deg=np.full(N, 270.0))
    assert "0 position jumps that cannot be flown" in doubts
    assert "reported track" not in doubts
