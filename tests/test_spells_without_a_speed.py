"""What positions lose in spells without a usable speed adds up, however short each is, in a recording and live."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

import navbound
from navbound import _core, live
from navbound.live.settings import Settings
from navbound.live.sinks import tables

if TYPE_CHECKING:
    import polars as pl

SPEED_MPS, N, PERIOD_S = 240.0, 1400, 140
SPELLS = 9


def in_spell(k: int, length_s: int) -> bool:
    return 20 <= k % PERIOD_S < 20 + length_s and k // PERIOD_S < SPELLS


def way(length_s: int, share: float) -> list[float]:
    """The way at each second, a share of the speed in spells [m]."""
    north_m, places = 0.0, list[float]()
    for k in range(N):
        places.append(north_m)
        north_m += SPEED_MPS * (share if in_spell(k, length_s) else 1.0)
    return places


def table(path: Path, length_s: int, share: float, cell: str, keep: Callable[[int], bool] = lambda _: True) -> Path:
    places = way(length_s, share)
    rows = [
        f"{1_700_000_000 + k},{40.0 + places[k] / 111_195:.8f},2.0,{cell if in_spell(k, length_s) else SPEED_MPS},10,8,3"
        for k in range(N)
        if keep(k)
    ]
    path.write_text("\n".join(["time_s,lat_deg,lon_deg,ground_speed_mps,nac_p,nic,sil", *rows]) + "\n", encoding="ascii")
    return path


@pytest.mark.parametrize("cell", ["", "-1", "9999"])
@pytest.mark.parametrize("length_s", [49, 65])
def test_half_of_the_way_in_nine_spells_shows_nothing(tmp_path: Path, length_s: int, cell: str) -> None:
    """Nine times 49 s at 120 m/s are 53 km."""
    path = table(tmp_path / "a.csv", length_s, 0.5, cell)
    verdict = navbound.analyze(path, spec="RNP 1").summary.verdict
    assert verdict.id == "not_shown"
    assert any("positions fall behind the recording's own speeds by" in each.lower() for each in verdict.position_doubts)
    pieces = navbound.analyze(path, spec="RNP 1", piece_rows=100).summary.verdict
    assert pieces.position_doubts == verdict.position_doubts


@pytest.mark.parametrize("length_s", [9, 49, 65])
def test_a_whole_way_in_such_spells_is_shown(tmp_path: Path, length_s: int) -> None:
    assert navbound.analyze(table(tmp_path / "a.csv", length_s, 1.0, ""), spec="RNP 1").summary.verdict.id == "inside"


def test_rows_that_are_missing_in_a_spell_hide_no_lack(tmp_path: Path) -> None:
    """Rows 12 s apart: an aircraft at 60 degrees of bank leaves 0.97 of its way between them."""
    path = table(tmp_path / "a.csv", 49, 0.5, "", keep=lambda k: not in_spell(k, 49) or k % 12 == 0)
    assert navbound.analyze(path, spec="RNP 1").summary.verdict.id == "not_shown"


def lived(folder: Path, length_s: int, share: float) -> pl.DataFrame:
    places = way(length_s, share)
    record: dict[str, Any] = {"v": 1, "track": "A", "est_lon_rad": 0.03, "sigma_m": 5.0}
    lines = [
        record
        | {
            "time_ns": 1_317_644_000_000_000_000 + k * 1_000_000_000,
            "est_lat_rad": 0.7 + places[k] / 6_371_000,
            "ground_speed_mps": None if in_spell(k, length_s) else SPEED_MPS,
        }
        for k in range(N)
    ]
    session = live.Session(folder, Settings(format="json", rnp_m=1852.0))
    session.take(_core.live_input("chunk", None, b"".join(json.dumps(each).encode() + b"\n" for each in lines)))
    session.finish()
    return tables.epochs(folder)


@pytest.mark.parametrize(("length_s", "share", "stale"), [(49, 0.5, True), (65, 0.5, True), (49, 1.0, False)])
def test_live_spells_of_null_add_up(tmp_path: Path, length_s: int, share: float, stale: bool) -> None:
    reasons = lived(tmp_path / "out", length_s, share)["reason_id"].to_list()
    assert (reasons[-1] == "position_stale") == stale
    assert set(reasons[:60]) == {None}
    if not stale:
        assert set(reasons) == {None}


def test_slow_vehicles_are_compared_as_well(tmp_path: Path) -> None:
    """At 70 m/s: nine times 49 s at 35 m/s are 15.4 km, of which 5.6 km may be slowing by 1 m/s2 to halfway."""
    path, share = table(tmp_path / "a.csv", 49, 0.5, ""), 70.0 / SPEED_MPS
    head, *rows = path.read_text(encoding="ascii").splitlines()
    slow = []
    for row in rows:
        time_s, lat, lon, speed, *more = row.split(",")
        slow.append(",".join([time_s, f"{40.0 + share * (float(lat) - 40.0):.8f}", lon, speed and "70.0", *more]))
    path.write_text("\n".join([head, *slow]) + "\n", encoding="ascii")
    assert navbound.analyze(path, spec="RNP 1").summary.verdict.id == "not_shown"
