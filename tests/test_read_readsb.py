"""Files that readsb writes: altitudes that say "ground", and the states of all aircraft at one time."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import polars as pl
import pytest

import navbound
from navbound.errors import FormatError
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


def snapshot(k: int, aircraft: list[dict[str, Any]], name: str = "aircraft", per_second: int = 1) -> dict[str, Any]:
    return {"now": (NOW_S + k) * per_second, "messages": 1_000 + k, name: aircraft}


def write(tmp_path: Path, text: str, name: str = "aircraft.json") -> Path:
    (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path / name


def two_and_silent(k: int) -> list[dict[str, Any]]:
    """Two aircraft, and one that has not sent a position."""
    return [
        state(k),
        state(k, hex="3c6445", lon=3.0, flight="DLH8 ", nac_p=9),
        {"hex": "3c6446", "type": "adsb_icao", "mlat": [], "seen": 0.1},
    ]


@pytest.mark.parametrize(("name", "per_second"), [("aircraft", 1), ("ac", 1000)])
def test_a_snapshot_of_all_aircraft_has_one_row_a_track_at_its_time(tmp_path: Path, name: str, per_second: int) -> None:
    reading = read(write(tmp_path, json.dumps(snapshot(0, two_and_silent(0), name, per_second), indent=1)))
    assert reading.epochs["track"].to_list() == ["3c6444", "3c6445"]
    assert reading.epochs["time_ns"].to_list() == [GPS_NOW_NS] * 2
    assert reading.epochs["nac_p"].to_list() == [10.0, 9.0]
    assert reading.epochs["position_time_ns"].to_list() == [GPS_NOW_NS - 250_000_000] * 2
    assert reading.source.n_rows == 3
    assert [(each.reason, each.count) for each in reading.rejected] == [("lat: empty", 1)]
    assert reading.left_out["track"].to_list() == ["3c6446"]


@pytest.mark.parametrize("joined", ["lines", "list", "files"])
def test_several_snapshots_are_the_rows_of_their_aircraft(tmp_path: Path, joined: str) -> None:
    taken = [snapshot(k, two_and_silent(k)) for k in range(12)]
    if joined == "files":
        files = [write(tmp_path, json.dumps(each), f"a{k}.json") for k, each in enumerate(taken)]
    else:
        files = [write(tmp_path, json.dumps(taken) if joined == "list" else "\n".join(map(json.dumps, taken)))]
    (tmp_path / "single").mkdir()
    of_lines = lines(tmp_path / "single", [state(k) for k in range(12)])
    run, single = navbound.analyze(files), navbound.analyze(of_lines)
    assert run.epochs["track"].unique().sort().to_list() == ["3c6444", "3c6445"]
    names = ["time_ns", "est_lat_rad", "est_lon_rad", "status", "cov_ee_m2"]
    assert run.epochs.filter(pl.col("track") == "3c6444").select(names).equals(single.epochs.select(names))
    assert set(run.epochs["status"]) == {"ok"}


def test_an_aircraft_whose_last_position_stands_apart_leaves_the_others_their_age(tmp_path: Path) -> None:
    lost = {"hex": "3c6446", "type": "adsb_icao", "lastPosition": {"lat": 48.0, "lon": 2.0, "nic": 8, "rc": 186, "seen_pos": 70.5}}
    reading = read(write(tmp_path, json.dumps(snapshot(0, [lost, state(0), state(0, hex="3c6445", seen_pos=1.5)]))))
    assert reading.epochs.select("track", "position_time_ns").rows() == [
        ("3c6444", GPS_NOW_NS - 250_000_000),
        ("3c6445", GPS_NOW_NS - 1_500_000_000),
    ]


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (snapshot(0, []), "a list of no aircraft"),
        (snapshot(0, [{"hex": "3c6444", "now": 1}]), "no object without “now”"),
        (snapshot(0, [1]), "no object without “now”"),  # type: ignore[list-item]
        ([snapshot(0, [state(0)]), state(1)], "the object 2 is no list of aircraft"),
        ({"now": True, "aircraft": []}, "neither a column"),
        ({"now": "today", "aircraft": []}, "neither a column"),
    ],
)
def test_what_is_no_snapshot_is_refused_in_words(tmp_path: Path, content: object, says: str) -> None:
    with pytest.raises(FormatError, match=says):
        read(write(tmp_path, json.dumps(content)))


def test_columns_of_a_list_each_are_a_table_whatever_their_names(tmp_path: Path) -> None:
    columns = {"now": [NOW_S, NOW_S + 1], "lat": [48.0, 48.0009], "lon": [2.0, 2.0], "aircraft": ["D-AIPA", "D-AIPA"]}
    assert read(write(tmp_path, json.dumps(columns))).epochs.height == 2


def test_an_aircraft_of_dump1090_without_a_type_is_of_the_usual_one(tmp_path: Path) -> None:
    """dump1090 writes the type of an unusual source alone, and the speed in knots; one such aircraft took the others away."""
    aircraft = [state(0, hex=f"3c64{k:02x}", speed=SPEED_MPS / KNOT_MPS) for k in range(6)]
    for each in aircraft:
        del each["gs"], each["type"]
    path = tmp_path / "aircraft.json"
    path.write_text(json.dumps({"now": NOW_S, "aircraft": [*aircraft, aircraft[0] | {"type": "adsb_icao_nt", "hex": "3c6500"}]}))
    summary = navbound.analyze(path).summary
    assert summary.n_status.get("ok", 0) == 7
    assert any("in which the aircraft moved up to 62 m:" in each for each in summary.assumptions)
    # readsb writes it always: without it nothing is claimed.
    path.write_text(json.dumps({"now": NOW_S, "aircraft": [*aircraft, aircraft[0] | {"type": "adsb_icao", "hex": "3c6500"}]}))
    assert navbound.analyze(path).summary.n_status.get("ok", 0) == 1


def test_how_far_an_aircraft_without_a_speed_moved_is_not_known(tmp_path: Path) -> None:
    states = [state(k) for k in range(20)]
    for each in states:
        del each["gs"]
    words = " ".join(navbound.analyze(lines(tmp_path, states)).summary.assumptions)
    assert "up to 0.25 s old, in which nobody knows how far the aircraft moved" in words


def test_when_an_aircraft_was_heard_is_an_age_and_no_word_of_quality(tmp_path: Path) -> None:
    """No position is newer than the last message; of two ages the larger counts."""
    taken = [snapshot(k, [state(k, seen=0.1 if k < 6 else 30.0)]) for k in range(12)]
    reading = read(write(tmp_path, "\n".join(map(json.dumps, taken))))
    assert not any("seen" in each for each in reading.unread)
    assert reading.epochs["status"].to_list() == ["ok"] * 6 + ["not_available"] * 6
    ages_ns = reading.epochs["time_ns"] - reading.epochs["position_time_ns"]
    assert ages_ns.to_list() == [250_000_000] * 6 + [30_000_000_000] * 6


def test_what_is_seen_elsewhere_is_no_age(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text("time,lat,lon,seen\n" + "".join(f"{NOW_S + k},48.{k:03d},2.0,12\n" for k in range(12)))
    reading = read(path)
    assert reading.unread == ["seen"]
    assert "position_time_ns" not in reading.epochs.columns


@pytest.mark.parametrize("form", ["json", "csv"])
@pytest.mark.parametrize("listed", ["mlat", "tisb"])
def test_an_accuracy_that_others_gave_is_none_of_the_aircraft(tmp_path: Path, listed: str, form: str) -> None:
    rows = [
        {"now": 1_700_000_000 + k, "hex": "3c6444", "lat": 48 + k * 1e-4, "lon": 2.5, "type": "adsb_icao", "nac_p": 9, "seen_pos": 0.1}
        | {listed: ["gs", "nac_p"]}
        for k in range(60)
    ]
    if form == "json":
        (tmp_path / "a.json").write_text("\n".join(json.dumps(row) for row in rows))
    else:
        head = ",".join(rows[0])
        lines = [",".join(f'"{value}"' if isinstance(value, list) else str(value) for value in row.values()) for row in rows]
        (tmp_path / "a.csv").write_text("\n".join([head, *lines]) + "\n")
    verdict = navbound.analyze(tmp_path / f"a.{form}", spec="RNP 0.3").summary.verdict
    assert (verdict.id, verdict.n_reason) == ("nothing_judged", {"no_covariance": 60})


def test_an_accuracy_that_others_gave_is_none_of_a_trace(tmp_path: Path) -> None:
    details = {"type": "adsb_icao", "nac_p": 9, "tisb": ["nac_p"]}
    rows = [[float(k), 48 + k * 1e-3, 2.5, 3000, 216.0, 0.0, 0, 0, details, "adsb_icao"] for k in range(60)]
    (tmp_path / "trace_full_3c6444.json").write_text(json.dumps({"icao": "3c6444", "timestamp": 1_700_000_000.0, "trace": rows}))
    verdict = navbound.analyze(tmp_path / "trace_full_3c6444.json", spec="RNP 0.3").summary.verdict
    assert verdict.n_reason == {"no_covariance": 60}
