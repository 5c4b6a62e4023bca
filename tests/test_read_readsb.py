"""Files that readsb writes: altitudes that say "ground", and the states of all aircraft at one time."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import polars as pl
import pytest

from navbound.read import pieces
from navbound.read.tables.epochs import Reading, read
from test_who_and_when import DEG_PER_M, SPEED_MPS

NOW_S, KNOT_MPS, FOOT_M = 1_700_000_000, 1852 / 3600, 0.3048
GPS_NOW_NS = (NOW_S - 315_964_800 + 18) * 1_000_000_000
"""GPS time begins on 1980-01-06 and is 18 s ahead of UTC since 2017."""


def state(k: int, **keys: Any) -> dict[str, Any]:
    """One aircraft as readsb describes it, `k` seconds after the begin of its flight."""
    own = {"hex": "3c6444", "type": "adsb_icao", "flight": "DLH9 ", "alt_baro": 3500, "gs": SPEED_MPS / KNOT_MPS, "track": 0.0}
    claims = {
        "lat": 48.0 + k * SPEED_MPS * DEG_PER_M,
        "lon": 2.0,
        "nic": 8,
        "nac_p": 10,
        "sil": 3,
        "seen_pos": 0.25,
        "mlat": [],
        "tisb": [],
    }
    return own | claims | keys


def lines(tmp_path: Path, states: list[dict[str, Any]]) -> Path:
    path = tmp_path / "states.jsonl"
    path.write_text("\n".join(json.dumps({"now": NOW_S + k} | each) for k, each in enumerate(states)), encoding="utf-8")
    return path


@pytest.mark.parametrize("word", ["ground", "Ground", " GROUND "])
@pytest.mark.parametrize("name", ["alt_baro", "altitude", "alt_geom"])
def test_an_altitude_that_says_ground_is_none_and_no_damage(tmp_path: Path, name: str, word: str) -> None:
    states = [state(k) for k in range(20)]
    for k, each in enumerate(states):
        del each["alt_baro"]
        each[name] = word if k < 15 else 3500
    reading = read(lines(tmp_path, states))
    column = "est_h_m" if name == "alt_geom" else "altitude_m"
    assert reading.rejected == []
    assert reading.epochs[column][:15].null_count() == 15
    assert reading.epochs[column][15:].to_list() == pytest.approx([3500 * FOOT_M] * 5)
    assert reading.epochs["nac_p"].to_list() == [10.0] * 20
    assert [note for note in reading.notes if "ground" in note] == [
        f"states.jsonl: 15 rows say “ground” in place of an altitude in “{name}”: they have a position and no altitude"
    ]


def csv(tmp_path: Path, name: str, values: list[str]) -> Path:
    rows = [f"3c6444,{NOW_S + k},{48.0 + k * SPEED_MPS * DEG_PER_M},2.0,{each},10,8" for k, each in enumerate(values)]
    path = tmp_path / "states.csv"
    path.write_text("\n".join([f"hex,now,lat,lon,{name},nac_p,nic", *rows]) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize("piece_rows", [None, 7])
def test_a_text_table_may_say_ground_too(tmp_path: Path, piece_rows: int | None) -> None:
    path = csv(tmp_path, "alt_baro", ["ground"] * 30 + ["100"] * 10)
    reading = read(path) if piece_rows is None else pieces.read_pieces(path, piece_rows=piece_rows)
    parts = [reading.epochs] if isinstance(reading, Reading) else list(reading.epochs())
    altitudes = pl.concat(parts)["altitude_m"]
    assert altitudes[:30].null_count() == 30
    assert altitudes[30:].to_list() == pytest.approx([100 * FOOT_M] * 10)
    assert reading.rejected == []
    assert sum("30 rows say “ground”" in note for note in reading.notes) == 1


@pytest.mark.parametrize(("name", "word"), [("alt_baro", "grounds"), ("alt_baro", "on"), ("gs", "ground"), ("nac_p", "ground")])
def test_no_other_word_and_no_other_column_may_say_so(tmp_path: Path, name: str, word: str) -> None:
    reading = read(lines(tmp_path, [state(k, **({name: word} if k == 3 else {})) for k in range(20)]))
    assert [(each.reason, each.count) for each in reading.rejected] == [(f"{name}: not a number; row used without it", 1)]
