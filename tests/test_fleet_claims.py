"""ADS-B states become bounds by what the aircraft claims; the RNP in force is that of its area, its track, or the specification."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import polars as pl
import pytest

from live_fixture import recorded
from navbound import _core, live
from navbound.errors import FormatError
from navbound.live import journal, zones
from navbound.live.sinks import tables
from navbound.read.statements.kinds import kind_of
from navbound.read.statements.texts import stated_in

UNIX_S = 1_731_000_000.0
LINE: dict[str, Any] = {
    "now": UNIX_S,
    "hex": "4ca123",
    "type": "adsb_icao",
    "flight": "<script>alert(1)</script>",
    "lat": 48.9,
    "lon": 2.5,
    "seen_pos": 0.0,
    "gs": 0.0,
    "nic": 8,
    "nac_p": 9,
    "sil": 3,
}
NM = 1852.0


def session(tmp_path: Path, lines: list[dict[str, Any]], **settings: Any) -> Path:
    content = "".join(json.dumps(LINE | line) + "\n" for line in lines).encode()
    how = live.Settings(format="readsb", rnp_m=0.3 * NM, standing=True, **settings)
    frames = _core.live_input("chunk", None, content) + _core.live_input("end", None, b"")
    source = recorded(tmp_path / "in", frames, how)
    live.judge(source, tmp_path / "out")
    return tmp_path / "out"


def table(tmp_path: Path, text: str) -> str:
    path = tmp_path / "rnp.toml"
    path.write_text(text)
    return str(path)


def test_accuracy_is_that_of_nacp_and_integrity_the_radius_of_nic(tmp_path: Path) -> None:
    epochs = tables.epochs(session(tmp_path, [{}, {"hex": "4ca124", "nac_p": 10, "nic": 6, "sil": 2}]))
    # NACp 9 is an EPU of 30 m, NACp 10 one of 10 m; NIC 8 a radius of 0.1 NM, NIC 6 one of at most 0.6 NM (the standard's tables).
    assert epochs["accuracy_bound_m"].to_list() == pytest.approx([30.0, 10.0], rel=1e-9)
    assert epochs["integrity_compared_m"].to_list() == pytest.approx([0.1 * NM, 0.6 * NM], rel=1e-12)
    assert epochs.select("nic", "nac_p", "sil").rows() == [(8.0, 9.0, 3.0), (6.0, 10.0, 2.0)]


def test_what_an_aircraft_does_not_claim_makes_it_unavailable_with_its_reason(tmp_path: Path) -> None:
    lines: list[dict[str, Any]] = [
        {"hex": "a00001", "nac_p": None},
        {"hex": "a00002", "sil": 1},
        {"hex": "a00003", "nic": 0},
        {"hex": "a00004", "type": "tisb_icao"},
    ]
    out = session(tmp_path, lines)
    epochs = tables.epochs(out)
    expected = ["no_accuracy_category", "no_integrity_claim", "no_integrity_claim", "foreign_position"]
    assert epochs["reason_id"].to_list() == expected
    assert set(epochs["status"]) == {"not_available"}
    assert [t["kind"] for t in map(json.loads, (out / journal.EVENTS).read_text().splitlines())] == ["unavailable"] * 4


def test_a_radius_wider_than_twice_the_rnp_of_the_area_is_a_warning(tmp_path: Path) -> None:
    rnp = table(tmp_path, '[[area]]\nname = "Paris"\nrnp_nm = 1.0\ncorners_deg = [[48, 2], [48, 3], [50, 3], [50, 2]]\n')
    lines = [{"hex": "a00001", "nic": 5, "now": UNIX_S + k} for k in range(3)] + [
        {"hex": "a00002", "nic": 5, "lon": 5.0, "now": UNIX_S + k} for k in range(3)
    ]
    out = session(tmp_path, lines, rnp_table=rnp)
    # NIC 5 is 1 NM: within twice RNP 1, and beyond twice RNP 0.3.
    raised = [(t["track"], t["kind"]) for t in map(json.loads, (out / journal.EVENTS).read_text().splitlines())]
    assert raised == [("a00002", "warning")]
    assert sorted(set(tables.epochs(out).select("track", "rnp_m").rows())) == [("a00001", NM), ("a00002", 0.3 * NM)]


def test_a_track_with_a_path_is_judged_by_its_total_error(tmp_path: Path, shared_data: Path) -> None:
    del shared_data
    rnp = table(tmp_path, '[[track]]\ntrack = "4ca123"\npath = "LFPG/08R"\nrnp_nm = 1.0\n')
    epochs = tables.epochs(session(tmp_path, [{}, {"hex": "4ca124"}], rnp_table=rnp))
    (deviation_m, none), (bound_m, plain_m) = epochs["fte_m"].to_list(), epochs["accuracy_bound_m"].to_list()
    assert none is None
    assert plain_m == pytest.approx(30.0, rel=1e-9)
    # Far from the path the bound is the deviation and the one-sided 95 % quantile of the navigation error across it.
    sigma_m = 30.0 / math.sqrt(-2.0 * math.log(0.05))
    assert abs(deviation_m) > 1000.0
    assert bound_m == pytest.approx(abs(deviation_m) + 1.6448536269514722 * sigma_m, rel=1e-9)
    assert epochs["rnp_m"].to_list() == [NM, 0.3 * NM]


def test_a_changed_table_is_another_session(tmp_path: Path) -> None:
    rnp = table(tmp_path, "[[area]]\nrnp_nm = 1.0\ncorners_deg = [[48, 2], [48, 3], [50, 3]]\n")
    out = session(tmp_path, [{}], rnp_table=rnp)
    table(tmp_path, "[[area]]\nrnp_nm = 2.0\ncorners_deg = [[48, 2], [48, 3], [50, 3]]\n")
    with pytest.raises(FormatError, match="its content has changed"):
        live.judge(out, tmp_path / "again")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("rnp = 1", "neither \\[\\[area\\]\\] nor"),
        ("[[area]]\nrnp_nm = 1.0\ncorners_deg = [[48, 2], [48, 3]]", "area 1: corners_deg"),
        ("[[area]]\nrnp_nm = 1.0\ncorners_deg = [[48, 2], [48, 3], [95, 3]]", "outside latitude"),
        ("[[area]]\nrnp_nm = 1.0\ncorners_deg = [[48, -179], [48, 179], [50, 3]]", "180 degrees apart"),
        ("[[area]]\nrnp_nm = 0\ncorners_deg = [[48, 2], [48, 3], [50, 3]]", "rnp_nm = 0 \\[NM\\] is outside"),
        ("[[area]]\nrnp_m = 1.0\ncorners_deg = [[48, 2], [48, 3], [50, 3]]", "rnp_m is none of"),
        ('[[track]]\ntrack = "a b"\nrnp_nm = 1', "is no name"),
        ('[[track]]\ntrack = "a"', "neither path nor rnp_nm"),
        ('[[track]]\ntrack = "a"\nrnp_nm = 1\n[[track]]\ntrack = "a"\nrnp_nm = 1', "stands twice"),
        ("area = 3", "is no list"),
        ("[[", "not a table of RNP values"),
    ],
)
def test_a_table_that_is_none_says_where(tmp_path: Path, text: str, sentence: str) -> None:
    with pytest.raises(FormatError, match=sentence):
        zones.load(table(tmp_path, text))


@pytest.mark.parametrize(
    "source",
    [
        "adsb_icao",
        "adsb_icao_nt",
        "adsb_other",
        "adsr_icao",
        "adsr_other",
        "tisb_icao",
        "tisb_trackfile",
        "tisb_other",
        "mlat",
        "mode_s",
        "adsc",
    ],
)
def test_whose_a_position_is_says_a_table_as_a_live_source_does(tmp_path: Path, source: str) -> None:
    epochs = tables.epochs(session(tmp_path, [{"type": source}]))
    kind = kind_of("type")
    assert kind is not None
    stated = stated_in(kind, pl.Series([source]))
    assert (stated.against[0] is not None) == (epochs["reason_id"][0] == "foreign_position")
    assert stated.unknown == []


@pytest.mark.parametrize(
    ("age", "reason"),
    [
        ({"seen_pos": 0.9}, None),
        ({"seen_pos": 1.5}, "position_held"),
        ({"seen_pos": 40.0}, "position_stale"),
        ({"seen_pos": 0.1, "seen": 40.0}, "position_stale"),
        ({"seen": 40.0}, "position_stale"),
        ({"seen": 0.5}, None),
    ],
    ids=str,
)
def test_a_position_is_as_old_as_its_line_says(tmp_path: Path, age: dict[str, float], reason: str | None) -> None:
    """As in a recording of the same lines (tests/test_read_readsb.py)."""
    lines = [LINE | {"now": UNIX_S + k, "gs": 155.5, "lat": 48.9 + k * 80.0 / 111_195} | {"seen_pos": None} | age for k in range(30)]
    epochs = tables.epochs(session(tmp_path, lines))
    assert set(epochs["reason_id"]) == {reason}


def test_a_radius_counts_before_its_category(tmp_path: Path) -> None:
    epochs = tables.epochs(session(tmp_path, [{"rc": 900}, {"hex": "4ca124", "rc": 0}]))
    assert epochs["integrity_compared_m"][0] == pytest.approx(900.0)
    assert epochs["reason_id"].to_list() == [None, "no_integrity_claim"]


def test_a_line_that_says_that_gps_was_lost_is_not_believed(tmp_path: Path) -> None:
    assert tables.epochs(session(tmp_path, [{"gpsOkBefore": UNIX_S - 10.0}]))["status"].to_list() == ["invalid_input"]
