"""Whose a position is: what others computed or repeat is none that the aircraft claims anything of, in files as live."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import polars as pl
import pytest

import navbound
from navbound.live.sinks import tables
from navbound.read.tables.epochs import read
from test_fleet_claims import session
from test_verdict import table
from test_who_and_when import DEG_PER_M, SPEED_MPS

N = 60
KNOT, FOOT = 0.514444, 0.3048
PLACES: list[dict[str, Any]] = [
    {"type": "adsb_icao"},
    {"type": "adsb_icao_nt"},
    {"type": "adsb_other"},
    {"type": "adsb_of_tomorrow"},
    {"type": "adsr_icao"},
    {"type": "tisb_trackfile"},
    {"type": "mlat"},
    {"type": "mode_s"},
    {"type": "adsc"},
    {"type": "other"},
    {"type": "unknown"},
    {"type": ""},
    {"type": "of_tomorrow"},
    {"type": None},
    {"type": "adsb_icao", "mlat": ["gs", "lat", "lon"]},
    {"type": "adsb_icao", "tisb": ["lon"]},
    {"type": "adsb_icao", "mlat": ["gs", "track"], "tisb": []},
]
"""What readsb may say of a position, each a claim of its own."""


def foreign_live(tmp_path: Path, claim: dict[str, Any]) -> bool:
    """Whether the decoder of live lines takes the position for that of others."""
    reason: str | None = tables.epochs(session(tmp_path, [claim]))["reason_id"][0]
    assert reason in {None, "foreign_position"}
    return reason is not None


def reported(path: Path) -> bool:
    """Whether every position of a file is reported; none is in another way."""
    reasons = set(navbound.analyze(path).epochs["reason_id"])
    assert reasons in ({None}, {"reported"})
    return reasons == {"reported"}


def trace(tmp_path: Path, sources: list[str | None], details: list[dict[str, Any] | None], n_items: int = 11) -> Path:
    rows = [
        [k, 48.0 + k * SPEED_MPS * DEG_PER_M, 2.0, 30_000, SPEED_MPS / KNOT, 0.0, 0, 0, each, source, 30_500][:n_items]
        for k, (source, each) in enumerate(zip(sources, details, strict=True))
    ]
    path = tmp_path / "trace.json"
    path.write_text(json.dumps({"icao": "3c6444", "timestamp": 1_700_000_000, "trace": rows}), encoding="utf-8")
    return path


def lines(tmp_path: Path, claim: dict[str, Any]) -> Path:
    """States of an aircraft as readsb sends them, an object a line."""
    own = {"hex": "3c6444", "lon": 2.0, "gs": SPEED_MPS / KNOT, "track": 0.0, "seen_pos": 0.0, "nic": 8, "nac_p": 10, "sil": 3}
    states = [own | {"now": 1_700_000_000 + k, "lat": 48.0 + k * SPEED_MPS * DEG_PER_M} | claim for k in range(N)]
    path = tmp_path / "states.json"
    path.write_text("\n".join(json.dumps(each) for each in states), encoding="utf-8")
    return path


@pytest.mark.parametrize("claim", PLACES, ids=str)
@pytest.mark.parametrize("where", ["row", "details", "lines"])
def test_a_file_of_readsb_says_whose_a_position_is_as_its_live_lines_do(tmp_path: Path, where: str, claim: dict[str, Any]) -> None:
    claimed = {"nac_p": 10, "nic": 8} | claim
    if where == "lines":
        path = lines(tmp_path, claim)
    else:
        own = claimed if where == "details" else {key: value for key, value in claimed.items() if key != "type"}
        source = claim["type"] if where == "row" else None
        path = trace(tmp_path, [source] * N, [own, *[None] * (N - 1)])
    assert reported(path) == foreign_live(tmp_path, claim)


@pytest.mark.parametrize("kind", ["json", "parquet"])
def test_what_an_object_in_a_record_states_is_a_column(tmp_path: Path, kind: str) -> None:
    """Recordings keep the message of a receiver in their records: what it says of the position counts as if it stood beside it."""
    foreign = {"type": "tisb_icao", "nic": 0, "nac_p": 0, "own": {"sil": 0, "track": 1.0}}
    own = {"type": "adsb_icao", "nic": 8, "nac_p": 10, "own": {"sil": 3, "track": 1.0}}
    for message, shown in ((own, True), (foreign, False)):
        states = [
            {
                "now": 1_700_000_000 + k,
                "hex": "3c6444",
                "lat": 48.0 + k * SPEED_MPS * DEG_PER_M,
                "lon": 2.0,
                "track": 0.0,
                "message": message,
            }
            for k in range(N)
        ]
        path = tmp_path / f"states.{kind}"
        if kind == "json":
            path.write_text(json.dumps(states), encoding="utf-8")
        else:
            pl.DataFrame(states).write_parquet(path)
        for piece_rows in (None, 7):
            run = navbound.analyze(path, piece_rows=piece_rows)
            assert (run.summary.verdict.id == "inside") == shown
            assert set(run.epochs["status"]) == ({"ok"} if shown else {"not_available"})
        # Of two of one name each keeps the keys that lead to it.
        assert any("message.own.track" in words for words in run.summary.assumptions)


def test_a_trace_without_a_source_anywhere_is_reported(tmp_path: Path) -> None:
    claimed: list[dict[str, Any] | None] = [{"nac_p": 10, "nic": 8}] * N
    assert reported(trace(tmp_path, [None] * N, claimed))
    # Older traces have no item of the source.
    assert reported(trace(tmp_path, [None] * N, claimed, n_items=9))


def test_a_line_without_a_source_is_reported_beside_lines_with_one(tmp_path: Path) -> None:
    path = lines(tmp_path, {})
    states = [json.loads(line) for line in path.read_text().splitlines()]
    path.write_text("\n".join(json.dumps(state | ({"type": "adsb_icao"} if k % 2 else {})) for k, state in enumerate(states)))
    epochs = navbound.analyze(path).epochs
    assert epochs["reason_id"].to_list() == ["reported", None] * (N // 2)


def test_a_list_of_the_details_counts_until_another_source_is_stated(tmp_path: Path) -> None:
    computed, own = {"type": "mlat", "mlat": ["lat", "lon"]}, {"type": "adsb_icao", "mlat": []}
    of_mlat = ["mlat", "mlat", None, "mlat"]
    sources = [*of_mlat, "adsb_icao", "adsb_icao", "mlat", "adsb_icao"]
    epochs = navbound.analyze(trace(tmp_path, sources, [{"nac_p": 10} | computed, *[None] * 5, {"nac_p": 10} | own, None])).epochs
    # An accuracy that came beside a position of others is none of the rows after it.
    assert epochs["reason_id"].to_list() == ["reported"] * 4 + ["no_covariance"] * 2 + ["reported", "no_covariance"]
    # Where the source of the row is another than its list says, the list counts for the rows of that source.
    contradicting = {"nac_p": 10, "type": "adsb_icao", "mlat": ["lat"]}
    one = navbound.analyze(trace(tmp_path, ["adsb_icao"] * N, [{"nac_p": 10, "type": "mlat"}, *[None] * (N - 1)])).epochs
    assert one["reason_id"].to_list() == ["reported", *["no_covariance"] * (N - 1)]
    assert reported(trace(tmp_path, ["adsb_icao"] * N, [contradicting, *[None] * (N - 1)]))


def test_a_geometric_altitude_of_a_trace_is_no_pressure_altitude(tmp_path: Path) -> None:
    path = trace(tmp_path, ["adsb_icao"] * N, [None] * N)
    content = json.loads(path.read_text())
    for row in content["trace"][::2]:
        row[6], row[10] = 8, None
    path.write_text(json.dumps(content))
    epochs = read(path).epochs
    assert epochs["altitude_m"].to_list() == [None, 30_000 * FOOT] * (N // 2)
    assert epochs["est_h_m"].to_list() == pytest.approx([30_000 * FOOT, 30_500 * FOOT] * (N // 2), rel=1e-15)


def stating(tmp_path: Path, name: str, value: object) -> tuple[bool, list[str]]:
    run = navbound.analyze(table(tmp_path / "a.csv", N, added={name: [value] * N}))
    return set(run.epochs["reason_id"]) == {"reported"}, run.summary.verdict.unread


@pytest.mark.parametrize(
    ("value", "foreign"),
    [
        ("ADS-B", False),
        ("adsb_icao", False),
        ("UAT", False),
        ("FLARM", False),
        ("GNSS", False),
        (0, False),
        (3, False),
        ("3.0", False),
        ("Multilateration", True),
        ("MLAT", True),
        ("WAM", True),
        ("radar", True),
        ("PSR", True),
        ("ASTERIX", True),
        ("estimated", True),
        ("Interpolated", True),
        ("TIS-B", True),
        (1, True),
        (2, True),
        ("2.0", True),
        # A word that nobody knows claims nothing.
        (4, True),
        ("unknown", True),
        ("of tomorrow", True),
    ],
)
def test_a_column_of_how_positions_came_decides(tmp_path: Path, value: object, foreign: bool) -> None:
    assert stating(tmp_path, "position_source", value) == (foreign, [])


@pytest.mark.parametrize(
    "name",
    [
        *("Position Source", "positionSource", "pos_source", "position_origin"),
        *("type", "source", "sourceType", "data_source", "surveillance_type", "position_type"),
    ],
)
@pytest.mark.parametrize(("value", "foreign"), [("Wide-area multilateration", True), ("GPS", False)])
def test_such_a_column_has_many_names(tmp_path: Path, name: str, value: str, foreign: bool) -> None:
    assert stating(tmp_path, name, value) == (foreign, [])


@pytest.mark.parametrize("name", ["source", "position_source"])
@pytest.mark.parametrize("value", ["ADS-B/MLAT", "multilat", "Multilaterated position", "MLAT (ground)", "fused ADS-B + WAM", "SSR Mode S"])
def test_a_name_of_several_words_is_foreign_by_one_of_them(tmp_path: Path, name: str, value: str) -> None:
    assert stating(tmp_path, name, value) == (True, [])


@pytest.mark.parametrize(
    ("name", "value", "against"),
    [
        ("Reporting Facility", "FlightAware MLAT", True),
        ("sensor", "T-MLAT7", True),
        ("comment", "multilaterated", True),
        ("source", "T-MLAT1", True),
        ("source", "Projected", True),
        ("PosStale", "true", True),
        ("CST", 1, True),
        ("CST", 0, False),
        ("update_type", "M", True),
        ("update_type", "A", False),
        ("sensor", "LFPG north", False),
    ],
)
def test_whose_a_position_is_may_stand_anywhere(tmp_path: Path, name: str, value: object, against: bool) -> None:
    run = navbound.analyze(table(tmp_path / "a.csv", N, added={name: [value] * N}))
    assert (run.summary.verdict.id == "inside") != against


def test_a_column_without_a_name_is_seen_by_its_place(tmp_path: Path) -> None:
    path = table(tmp_path / "a.csv", N, added={"remark": ["GPS PRIMARY LOST"] * N})
    path.write_text(path.read_text().replace("remark", "", 1))
    run = navbound.analyze(path)
    assert run.summary.verdict.id == "not_shown"
    path.write_text(path.read_text().replace("GPS PRIMARY LOST", "12"))
    run = navbound.analyze(path)
    assert run.summary.verdict.id == "inside"
    assert any("columns not used: column " in each for each in run.summary.assumptions)


def test_a_word_of_such_a_column_that_is_not_known_is_named(tmp_path: Path) -> None:
    assert stating(tmp_path, "source", "B738") == (False, ["source (b738)"])


@pytest.mark.parametrize(
    ("name", "value", "foreign"),
    [
        ("mlat", 1, True),
        ("is_mlat", "true", True),
        ("multilateration", "yes", True),
        ("isTISB", "Y", True),
        ("mlat", 0, False),
        ("isTISB", "false", False),
        ("mlat", "[]", False),
        ("tisb", "['gs']", False),
        ("mlat", "['gs', 'lat']", True),
    ],
)
def test_a_column_of_whether_others_computed_a_position_decides(tmp_path: Path, name: str, value: object, foreign: bool) -> None:
    assert stating(tmp_path, name, value) == (foreign, [])


@pytest.mark.parametrize("piece_rows", [None, 7])
def test_lists_of_a_parquet_file_decide_row_by_row(tmp_path: Path, piece_rows: int | None) -> None:
    rows = pl.read_csv(table(tmp_path / "a.csv", 4 * 7))
    rows.with_columns(pl.Series("mlat", [[], ["gs"], ["lat", "lon"], None] * 7)).write_parquet(tmp_path / "a.parquet")
    run = navbound.analyze(tmp_path / "a.parquet", piece_rows=piece_rows)
    assert run.epochs["reason_id"].to_list() == [None, None, "reported", None] * 7
    assert run.summary.verdict.unread == []
