"""Keys of live records beside those of the contract: heard where tables know them, and otherwise said and counted."""

from __future__ import annotations

import json
from contextlib import closing
from typing import TYPE_CHECKING

import polars as pl
import pytest

from navbound import _core, live
from navbound.live import statements
from navbound.live.settings import Settings
from navbound.live.sinks import metrics, tables
from navbound.read.statements.kinds import kind_of
from navbound.read.statements.names import BARE_LENGTHS, speaks_of_accuracy, speaks_of_integrity, speaks_of_level

if TYPE_CHECKING:
    from pathlib import Path


def lines(n: int, **more: object) -> list[bytes]:
    """Records once a second of an aircraft that flies north, some keys added."""
    record = {"v": 1, "track": "A", "est_lon_rad": 0.03, "ground_speed_mps": 70.0, "sigma_m": 5.0} | more
    times = [
        record | {"time_ns": 1_317_644_000_000_000_000 + k * 1_000_000_000, "est_lat_rad": 0.85 + k * 70 / 6_371_000} for k in range(n)
    ]
    return [json.dumps(each).encode() + b"\n" for each in times]


def chunk(content: list[bytes]) -> bytes:
    return _core.live_input("chunk", None, b"".join(content))


def lived(folder: Path, **more: object) -> tuple[pl.DataFrame, dict[str, int]]:
    """Epochs of a session of a few such records, and the keys that it did not read."""
    session = live.Session(folder, Settings(format="json", rnp_m=555.6))
    session.take(chunk(lines(20, **more)))
    unread = session.passed_over()
    session.finish()
    return tables.epochs(folder), unread


HEARD = (
    "err2d error2d hpe hpe95 hAcc95 h95 mrse "
    "hAcc h_acc HACC_mm eph eph_m ehe epe cep95 2drms horizontalAccuracy position_accuracy accuracy sigma_h ANP HIL hil_nm "
    "HorizontalIntegrityLimit containment_radius"
)


@pytest.mark.parametrize("key", HEARD.split())
def test_an_accuracy_or_a_level_under_a_name_of_tables_is_heard(tmp_path: Path, key: str) -> None:
    epochs, unread = lived(tmp_path / "out", **{key: 5000.0})
    assert (set(epochs["status"]), set(epochs["alert"]), unread) == ({"invalid_input"}, {"unavailable"}, {})


AGAINST: list[dict[str, object]] = [
    {"nav": {"status": "DR"}},
    {"gps": {"valid": False}},
    {"properties": {"position": {"trusted": False}}},
    {"sensors": [{"valid": True}, {"valid": False}]},
    {"flags": ["healthy", "spoofed"]},
    {"flags": "OK|SPOOFED"},
    {"note": "GNSS JAMMED"},
    {"alerts": ["UNABLE RNP"]},
    {"numSV": 2},
    {"sil": 0},
    {"trust": 0},
    {"navSource": "IRS"},
    {"is_suspicious": 1},
    {"position_latency_ms": 35000},
    {"info": '{"status": "ok", "integrity": "FAILED"}'},
    {"aux": {"type": "Point", "coordinates": [12.5, 48.0]}},
    {"aux": '{"type": "Point", "coordinates": [12.5, 48.0]}'},
    {"aux": "SRID=4326;POINT(12.5 48.0)"},
    {"aux": "+48.0000+012.5000/"},
    {"aux": "48 0.0 N 12 30.0 E"},
    {"geom": [48.0, 12.5]},
    {"gps_position": "48.01, 12.52"},
    {"gps_lat_lon": "48.01, 12.52"},
    {"latLon2": [48.01, 12.52]},
    {"lat_dir": "S"},
    {"N/S": "South"},
    {"EW": "W"},
    {"gps": {"lonRef": "w"}},
    {"hemisphere": "SE"},
    {"gps": '{"lat": 48.71, "integrity": "FAILED"}'},
    {"payload": '[{"lat": 48.71, "valid": false}]'},
    {"gps": {"lat": 48.71, "lon": 1.72, "word": "unheard of"}},
    {"gps": {"lat": 48.0, "lon": 12.5}},
    {"sensors": [{"lat": 48.71, "valid": False}]},
    {"gps": [48.0, 12.5]},
    {"gps": "48.01, 12.52"},
    {"gps": [1, 0]},
    {"gps_lat": "4842.6", "gps_lat_dir": "S"},
    {"gps": {"lat": "4801.0", "lat_dir": "N"}},
    {"latitude": 48.71, "latitude_ref": "S"},
    {"lat": "48.03 deg"},
    {"lat": "48,03"},
    {"gps": {"GPSLatitude": [48, 6, 0.0], "GPSLongitude": [1, 43, 8.0]}},
    {"horizontal_error": 2500.0},
    {"acc95": "2.5 km"},
]
NOT_AGAINST: list[dict[str, object]] = [
    {"alerts": []},
    {"numSV": 9},
    {"numSV": None},
    {"sil": 3},
    {"confidence": 0.95},
    {"navSource": "GPS"},
    {"position_latency_ms": 300},
    {"flags": ["healthy"]},
    {"wind": {"speed": 10, "from": 200}},
    {"sensors": [{"valid": True}]},
    {"info": '{"wind": 3, "integrity": "normal"}'},
    {"aux": {"type": "Point", "coordinates": [1.72, 48.71]}},
    {"aux": "48 42.5 N 1 43.2 E"},
    {"destination": "SRID=4326;POINT(12.5 48.0)"},
    {"levels": [48.0, 12.5]},
    {"geom": [0.0, 0.0]},
    {"gps_lat_lon": "48.71, 1.72"},
    {"lat_dir": "N", "lon_dir": "E"},
    {"hemisphere": "NE"},
    {"dest_lat_dir": "S"},
    {"wind_from": "S"},
    {"lat_counter": 17},
    {"rx": {"ns": "N"}},
    {"gps": {"lat": 48.71, "lon": 1.72, "alt": 100.0}},
    {"fix": {"latitude": 48.71, "longitude": 1.72}},
    {"waypoints": [{"lat": 10.0, "lon": 10.0}]},
    {"gps": {"lat": 48.71, "lon": 1.72, "speed": 70.0, "heading": 0.0, "time": "12:00:00"}},
    {"camera": {"lat": 10.0, "lon": 10.0}},
    {"flight_plan": {"legs": [{"lat": 10.0, "lon": 10.0}]}},
    {"others": [{"id": "b", "lat": 10.0, "lon": 10.0}]},
    {"gps": [48.71, 1.72]},
    {"gps": "48.71, 1.72"},
    {"lat": "4842.6", "lat_dir": "N", "lon": "00143.2", "lon_dir": "E"},
    {"nmea": {"lat": "4842.6", "lat_dir": "N", "lon": "00143.2", "lon_dir": "E"}},
    {"lat": 48.71, "ns": "N", "lon": 1.72, "ew": "E"},
    {"lat": "48.71 deg", "lon": "1,7200"},
    {"gps": {"GPSLatitude": [48, 42, 9.0], "GPSLatitudeRef": "N", "GPSLongitude": [1, 43, 8.0], "GPSLongitudeRef": "E"}},
    {"obstacles": [{"lat": 10.0, "lon": 10.0}], "to_lat": 10.0, "lat_ms": 12.5},
]


@pytest.mark.parametrize("more", AGAINST, ids=str)
def test_a_statement_in_a_list_an_object_or_a_text_is_heard(tmp_path: Path, more: dict[str, object]) -> None:
    epochs, _ = lived(tmp_path / "out", **more)
    assert (set(epochs["status"]), set(epochs["alert"])) == ({"invalid_input"}, {"unavailable"})


@pytest.mark.parametrize("more", NOT_AGAINST, ids=str)
def test_what_says_nothing_against_a_position_leaves_it(tmp_path: Path, more: dict[str, object]) -> None:
    epochs, _ = lived(tmp_path / "out", **more)
    assert set(epochs["status"]) == {"ok"}


def test_what_speaks_against_positions_is_counted_by_name_and_outlives_a_stop(tmp_path: Path) -> None:
    session = live.Session(tmp_path / "out", Settings(format="json", rnp_m=555.6))
    session.take(chunk(lines(20, valid=False, gps_lat=10.0, gps_lon=1.72)))
    session.snapshot()
    session.close()
    with closing(live.Session(tmp_path / "out", Settings(format="json", rnp_m=555.6), resume=True)) as resumed:
        assert resumed.against() == {"gps_lat": 20, "valid": 20}
    assert statements.against({"b": 2, "a": 2, "c": 30}) == "what speaks against positions: 30 c, 2 a, 2 b"
    assert statements.against(dict.fromkeys("abcdefg", 1)) == "what speaks against positions: 1 a, 1 b, 1 c, 1 d, 1 e and 2 more"


@pytest.mark.parametrize("odd", ["1e999", "9" * 400, '"\\ud800"', "[" * 200 + "]" * 200])
@pytest.mark.parametrize("place", ["before", "behind"])
def test_a_line_that_cannot_be_read_to_its_end_is_not_believed(tmp_path: Path, odd: str, place: str) -> None:
    """It says that it is invalid, before or behind what cannot be read."""
    keys, more = (b'"valid":false,"n":%s', b'"n":%s,"valid":false')[place == "behind"], odd.encode()
    session = live.Session(tmp_path / "out", Settings(format="json", rnp_m=555.6))
    session.take(chunk([line.replace(b"{", b"{" + keys % more + b",", 1) for line in lines(20)]))
    session.finish()
    assert set(tables.epochs(tmp_path / "out")["status"]) == {"invalid_input"}


@pytest.mark.parametrize(
    "key", ["epv", "vAcc", "acc", "error", "std", "rms", "vel_acc", "range_std", "heading_accuracy", "integrity_level"]
)
def test_what_bounds_no_position_for_certain_is_counted_and_not_heard(tmp_path: Path, key: str) -> None:
    epochs, unread = lived(tmp_path / "out", **{key: 0.1})
    assert (set(epochs["status"]), unread) == ({"ok"}, {key: 20})


def test_every_bare_length_is_one_of_tables_and_no_other_statement() -> None:
    for name in BARE_LENGTHS - {"anp"}:
        assert speaks_of_accuracy(name) or speaks_of_level(name), name
    assert speaks_of_integrity("anp")
    assert not [name for name in BARE_LENGTHS if kind_of(name) is not None]


def test_a_key_that_nothing_reads_is_reported_while_the_session_runs(tmp_path: Path) -> None:
    plain, sentences = lines(24), list[str]()
    more = [
        json.dumps(json.loads(line) | {"epv": 9.0, key: 7}).encode() + b"\n"
        for line, key in zip(plain[20:], ("a", "a", "b", "b"), strict=True)
    ]
    session = live.Session(tmp_path / "out", Settings(format="json", rnp_m=555.6), say=sentences.append)
    session.take(chunk(plain[:20]))
    assert sentences == []
    for line in more:
        session.take(chunk([line]))
    assert sentences == [statements.unread(["epv", "a"]), statements.unread(["b"])]
    session.finish()
    # Four times epv, twice each other key.
    assert "\nnavbound_unread_keys_total 8\n" in metrics.of(tmp_path / "out")
    # Who goes on hears of them again.
    again = list[str]()
    with closing(live.Session(tmp_path / "out", Settings(format="json", rnp_m=555.6), resume=True, say=again.append)) as session:
        session.take(chunk(lines(25)[24:]))
    assert again == [statements.unread(["a", "b", "epv"])]


def test_the_sentence_names_apart_what_may_speak_of_accuracy() -> None:
    assert statements.unread(["squawk", "comment"]) == "keys that nothing reads: comment, squawk"
    apart = "; by their names these may speak of accuracy or integrity, and nothing is judged by them: epv"
    assert statements.unread(["squawk", "epv"]) == f"keys that nothing reads: epv, squawk{apart}"
