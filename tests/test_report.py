"""What the report page is given: packing, selection, escaping, clipping."""

from __future__ import annotations

import base64
import json
import math
import re
import zlib
from pathlib import Path

import numpy as np
import polars as pl
import pytest

import report_fixture
from navbound import write
from navbound.errors import InputError
from navbound.report import coast, packing, payload, render
from navbound.report.render import script_safe
from navbound.time import utc_text

_NULL, _ZERO = -(2**31), -(2**31) + 1


def _unpack(packed: packing.Packed) -> np.ndarray:
    """The page's decoder, written again from the format's description, a value at a time."""
    n = len(packed.planes) // 4
    values = []
    for i in range(n):
        word = sum(packed.planes[k * n + i] << (8 * k) for k in range(4))
        values.append(word // 2 if word % 2 == 0 else -(word + 1) // 2)
    for _ in range(packed.order):
        for i in range(1, n):
            values[i] = (values[i] + values[i - 1] + 2**31) % 2**32 - 2**31

    def value(q: int) -> float:
        if q in (_NULL, _ZERO):
            return math.nan if q == _NULL else 0.0
        linear = packed.offset + q * packed.resolution
        return 10**linear if packed.kind == "log10" else linear

    return np.array([value(q) for q in values])


@pytest.mark.parametrize(
    "values",
    [
        [0.0, 0.001, -5.4321, 12345.678],
        [math.nan, 1.0, math.nan, math.nan, 2.0],
        [math.nan, math.nan],
        [7.0],
        list(np.cumsum(np.random.default_rng(1).normal(size=500))),
        list(np.arange(500) ** 2 * 0.25),
        [1e6, -1e6, 1e6, -1e6],
    ],
)
def test_lengths_come_back_within_half_a_millimetre(values: list[float]) -> None:
    packed = packing.pack("fte_m", np.array(values))
    assert packed.resolution == 1e-3
    # Half a resolution is the rounding; the rest is room for the sum offset + q * resolution in doubles.
    np.testing.assert_allclose(_unpack(packed), values, rtol=0, atol=0.5001e-3, equal_nan=True)


def test_a_range_too_wide_for_32_bits_is_kept_more_coarsely_and_says_so() -> None:
    values = np.array([0.0, 5e6, 2e7])
    packed = packing.pack("along_m", values)
    assert packed.resolution == pytest.approx(1e-2)
    np.testing.assert_allclose(_unpack(packed), values, rtol=0, atol=0.501e-2)


def test_risks_keep_their_relative_size_and_zero_is_zero() -> None:
    values = np.array([1e-300, 3.3e-9, 0.0, 1.0, math.nan])
    back = _unpack(packing.pack("p_exceed_2rnp", values))
    assert back[2] == 0.0
    # Half of 1e-4 in log10 is 0.0115 %; at 1e-300 the double of the logarithm itself costs far less.
    np.testing.assert_allclose(back, values, rtol=1.2e-4, atol=0, equal_nan=True)


def test_infinite_values_are_shown_as_missing_not_as_numbers() -> None:
    back = _unpack(packing.pack("hdop", np.array([1.0, math.inf, -math.inf])))
    assert np.isnan(back).tolist() == [False, True, True]


def test_text_runs_give_back_the_words() -> None:
    words: list[str | None] = ["ok", "ok", None, "bad", "ok"]
    packed = packing.run_lengths(pl.Series(words, dtype=pl.String))
    assert packed == {"words": ["ok", "bad"], "runs": [[0, 2], [-1, 1], [1, 1], [0, 1]]}


def test_text_in_the_records_cannot_end_the_script() -> None:
    nasty = {"words": "</script><!--<script>alert(1)</script> & \u2028\u2029"}
    text = script_safe(nasty)
    assert not set(text) & set("<>&\u2028\u2029")
    assert json.loads(text) == nasty


def test_nan_in_a_record_becomes_null() -> None:
    fixture = report_fixture.flight(n=20)
    summary = fixture.summary.model_copy(update={"tracks": [fixture.summary.tracks[0].model_copy(update={"fte_mean_m": math.nan})]})
    page = payload.build(summary, fixture.record, fixture.epochs, fixture.events, fixture.waypoints)
    assert page.data["summary"]["tracks"][0]["fte_mean_m"] is None
    script_safe(page.data)


@pytest.mark.parametrize(("utc", "offset_s"), [("2016-12-31T12:00:00", 17), ("2017-01-01T12:00:00", 18)])
def test_the_page_has_the_leap_seconds_of_the_flight(utc: str, offset_s: int) -> None:
    fixture = report_fixture.flight(n=20)
    gps_ns = (int(np.datetime64(utc, "s").astype(np.int64)) - 315_964_800 + offset_s) * 1_000_000_000
    moved = fixture.epochs.with_columns(pl.lit(gps_ns, dtype=pl.Int64).alias("time_ns") + pl.int_range(20) * 1_000_000_000)
    page = payload.build(fixture.summary, fixture.record, moved, fixture.events, [])
    assert page.data["utc_offset_s"] == offset_s
    assert page.data["tracks"][0]["start_ns"] == str(gps_ns)


def _points(line: list[int]) -> np.ndarray:
    return np.cumsum(np.array(line).reshape(-1, 2), axis=0) / 1000.0


def test_the_coast_is_cut_to_the_region() -> None:
    lines = [_points(line) for line in coast.clip_coastline(35.0, 117.0, 39.0, 123.0)]
    points = np.concatenate(lines)
    # The tip of Shandong, 37.4 N 122.7 E, is there; Florida is not. One vertex outside each cut stays, so that lines reach the edge.
    assert np.min(np.hypot(points[:, 0] - 122.7, points[:, 1] - 37.4)) < 0.1
    assert points[:, 0].min() > 115
    assert points[:, 0].max() < 126
    assert sum(map(len, lines)) < 1000


def test_the_coast_continues_over_the_antimeridian() -> None:
    points = np.concatenate([_points(line) for line in coast.clip_coastline(-20.0, 176.0, -15.0, 184.0)])
    # Fiji lies on both sides of 180 degrees.
    assert points[:, 0].min() < 179
    assert 180 < points[:, 0].max() < 186


def test_the_worst_tracks_are_embedded_first_until_the_budget_is_spent() -> None:
    fixture = report_fixture.flight(5, n=300)
    whole = payload.build(fixture.summary, fixture.record, fixture.epochs, fixture.events, [])
    assert len(whole.tracks) == 5
    ratios = {t.track: (-t.n_warnings, -(t.worst_ratio or 0)) for t in fixture.summary.tracks}
    assert [t["track"] for t in whole.data["tracks"]] == sorted(ratios, key=lambda t: ratios[t])
    size = len(json.dumps(whole.data)) + sum(map(len, whole.tracks))
    some = payload.build(fixture.summary, fixture.record, fixture.epochs, fixture.events, [], budget_bytes=size - len(whole.tracks[-1]))
    assert 1 <= len(some.tracks) < 5
    assert [t["track"] for t in some.data["tracks"]] == [t["track"] for t in whole.data["tracks"][: len(some.tracks)]]
    one = payload.build(fixture.summary, fixture.record, fixture.epochs, fixture.events, [], budget_bytes=0)
    assert len(one.tracks) == 1


def test_a_track_holds_the_columns_of_the_table(tmp_path: Path) -> None:
    fixture = report_fixture.flight(n=50)
    page = payload.build(fixture.summary, fixture.record, fixture.epochs, fixture.events, [])
    head = page.data["tracks"][0]
    raw = zlib.decompress(base64.b64decode(page.tracks[0]))
    assert len(raw) == 4 * 50 * len(head["columns"])
    names = [c["name"] for c in head["columns"]]
    assert {"elapsed_s", "fte_m", "tse_exact_m", "tse_exact_integrity_m", "p_exceed_2rnp", "p_state_4", "anp_circle_m"} <= set(names)
    i = names.index("fte_m")
    column = head["columns"][i]
    packed = packing.Packed("fte_m", column["kind"], column["resolution"], column["offset"], column["order"], raw[200 * i : 200 * (i + 1)])
    np.testing.assert_allclose(_unpack(packed), fixture.epochs["fte_m"].to_numpy(), rtol=0, atol=0.5001e-3)


def test_the_page_cuts_its_lines_where_the_exports_cut_them() -> None:
    fixture = report_fixture.flight(n=50)
    epochs = (
        fixture.epochs.sort("time_ns").with_row_index().filter(~pl.col("index").is_between(10, 19) & (pl.col("index") != 40)).drop("index")
    )
    page = payload.build(fixture.summary, fixture.record, epochs, fixture.events, [])
    starts = [each.properties["from_utc"] for each in write.shapes(epochs)]
    after = [utc_text(epochs["time_ns"][k + 1]) for k in page.data["tracks"][0]["breaks"]]
    assert len(after) == 1
    assert set(after) <= set(starts)


def test_a_two_hour_flight_stays_below_two_megabytes(tmp_path: Path) -> None:
    fixture = report_fixture.flight()
    assert fixture.epochs.height == 7081
    out = render(fixture.summary, fixture.record, fixture.epochs, fixture.events, fixture.waypoints, tmp_path / "report.html")
    assert 300_000 < out.stat().st_size < 2_000_000


def test_many_tracks_stay_below_two_megabytes_too(tmp_path: Path) -> None:
    fixture = report_fixture.flight(60, n=1500)
    out = render(fixture.summary, fixture.record, fixture.epochs, fixture.events, fixture.waypoints, tmp_path / "report.html")
    assert 1_500_000 < out.stat().st_size < 2_000_000


def test_the_page_names_nothing_outside_itself(tmp_path: Path) -> None:
    fixture = report_fixture.flight(n=50)
    out = render(fixture.summary, fixture.record, fixture.epochs, fixture.events, fixture.waypoints, tmp_path)
    assert out == tmp_path / "report.html"
    text = out.read_text(encoding="utf-8")
    assert text.startswith("<!doctype html>")
    assert not re.search(r"<(?:script|link|img|iframe)[^>]+(?:src|href)=", text)
    assert "default-src 'none'" in text
    assert text.count("</script>") == text.count("<script")
    assert not list(tmp_path.glob("*.partial"))


def test_the_same_records_give_the_same_bytes(tmp_path: Path) -> None:
    fixture = report_fixture.flight(n=50)
    a, b = (
        render(fixture.summary, fixture.record, fixture.epochs, fixture.events, fixture.waypoints, tmp_path / name)
        for name in ("a.html", "b.html")
    )
    assert a.read_bytes() == b.read_bytes()


def test_a_table_without_time_is_refused_by_name(tmp_path: Path) -> None:
    fixture = report_fixture.flight(n=50)
    with pytest.raises(InputError, match="time_ns"):
        render(fixture.summary, fixture.record, fixture.epochs.drop("time_ns"), fixture.events, [], tmp_path / "report.html")
    assert not (tmp_path / "report.html").exists()


def test_an_empty_run_still_has_its_verdict(tmp_path: Path) -> None:
    fixture = report_fixture.flight(n=50)
    out = render(fixture.summary, fixture.record, fixture.epochs.head(0), pl.DataFrame(), [], tmp_path / "report.html")
    assert fixture.summary.verdict.words in out.read_text(encoding="utf-8")
