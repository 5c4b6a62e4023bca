"""Tables that are read and judged in pieces: what the whole gives at once, in memory that does not grow with the file."""

from __future__ import annotations

import json
import os
import random
import subprocess
import sys
from pathlib import Path
from typing import Any

import polars as pl
import pytest

import navbound
from navbound import FormatError, NavboundError
from navbound.report import payload
from navbound.run.directory import Run
from navbound.run.pieces import material

PIECES = (1, 7, 1000)
OF_LONG = (7, 1000)
"""Of the longest table a row a piece would be half a minute; the others have every border that it has."""
START_S = 1_483_228_700
"""100 s before 2017-01-01, which a leap second preceded."""


def row(k: int, track: str, **more: object) -> dict[str, Any]:
    """An aircraft flies north at 70 m/s."""
    return {"timestamp": START_S + k, "icao24": track, "latitude": f"{48 + 70 * k / 6.371e6 * 57.29578:.7f}", "longitude": 2.5} | more


def as_text(rows: list[dict[str, Any]]) -> str:
    return "\n".join([",".join(rows[0]), *(",".join(map(str, r.values())) for r in rows)]) + "\n"


def damaged() -> str:
    """Aircraft mixed in time with quality indicators now and then, steps back, repeats, contradictions, jumps, gaps and bad fields."""
    rows = []
    for k in range(0, 440, 4):
        for n, track in enumerate(("b2", "a1", "c3")):
            if (track == "c3" and 100 <= k < 160) or (track == "a1" and k > 400):
                continue
            nac_p = (8, 9, 5)[n] if k % (40 if track == "a1" else 360) == 0 else ""
            speed = "" if track == "b2" and k < 300 else 136.1
            level = 300 + k % 50 if track == "a1" and k % 3 else ""
            sign = f"AF{n}{k // 300}" if k % 5 else ""
            rows.append(row(k, track, groundspeed=speed, nac_p=nac_p, hpl=level, callsign=sign))
    changes: dict[int, dict[str, Any]] = {
        30: {"latitude": 55.0},
        90: {"latitude": "x"},
        100: {"groundspeed": "fast"},
        110: {"longitude": ""},
    }
    for k, change in changes.items():
        rows[k] |= change
    for k in (140, 141):
        rows[k] |= {"timestamp": ""}
    rows[150] |= {"timestamp": "yesterday"}
    rows.insert(210, dict(rows[200]))
    rows.insert(261, rows[250] | {"latitude": 48.5})
    rows[20], rows[50] = rows[50], rows[20]
    lines = as_text(rows).split("\n")
    lines.insert(45, "# a remark")
    lines.insert(133, "1,2,3")
    lines.insert(144, "")
    lines.insert(155, '1483228900,"a1,2.5,1,2,3,4')
    return "\r\n".join(lines)


def silent() -> str:
    """One aircraft that reports no speed and jumps, then another; standard deviations, words of status that the list does not know."""
    rows = [row(k, "s", sde=2 + k % 3, sdn=3, sdu=5, status="ok" if k % 51 else "fine") for k in range(0, 300, 3)]
    for k in range(50, 52):
        rows[k] |= {"latitude": 48.2}
    rows += [row(k, "t", sde=2, sdn="nan" if k == 5 else 1, sdu=5, status="ok") for k in range(20)]
    return as_text(rows)


def leap() -> str:
    """Written times over a leap second, without a zone."""
    times = [f"2016-12-31 23:59:{s:02d}" for s in range(20, 61)] + [f"2017-01-01T00:00:{s:02d}" for s in range(40)]
    return as_text([row(k, "l", epu=40) | {"timestamp": t} for k, t in enumerate(times)])


def dated() -> str:
    """State vectors as the OpenSky Network stores them; some positions were valid later than their row, or never."""
    rows = []
    for k in range(80):
        more = {"velocity": 70.0, "heading": 0.0, "vertrate": 0.0, "baroaltitude": 900.0, "geoaltitude": 950.0, "nic": 8}
        rows.append(row(k, "o", **more, lastposupdate={50: START_S + 99, 60: "never"}.get(k, START_S + k - 0.3)))
    rows[20] |= {"latitude": rows[19]["latitude"]}
    return as_text(rows)


TABLES = {"damaged": damaged, "silent": silent, "leap": leap, "dated": dated}


def in_pieces(file: Path, out: Path, piece_rows: int | None) -> Run:
    more: dict[str, Any] = {} if piece_rows is None else {"piece_rows": piece_rows}
    return navbound.analyze(file, spec="RNP 0.1" if "silent" not in file.name else "RNP AR 0.1", out=out, **more)


def page(run: Run) -> payload.Page:
    return payload.build(run.summary, run.record, run.table, run.events, run.waypoints)


@pytest.mark.parametrize("kind", TABLES)
def test_pieces_of_any_length_give_the_bits_of_the_whole(tmp_path: Path, kind: str) -> None:
    file = tmp_path / f"{kind}.csv"
    file.write_bytes(TABLES[kind]().encode())
    whole = in_pieces(file, tmp_path / "whole", None)
    assert isinstance(whole.table, pl.DataFrame)
    one = page(whole)
    for piece_rows in OF_LONG if kind == "damaged" else PIECES:
        run = in_pieces(file, tmp_path / "pieces", piece_rows)
        assert not isinstance(run.table, pl.DataFrame), "it must have been read in pieces"
        assert run.summary.model_dump_json() == whole.summary.model_dump_json(), piece_rows
        assert run.epochs.equals(whole.epochs), piece_rows
        assert run.epochs.schema == whole.epochs.schema
        assert run.events.equals(whole.events), piece_rows
        assert run.record.settings == whole.record.settings
        assert run.record.inputs == whole.record.inputs
        written = [pl.read_parquet(tmp_path / folder / "epochs.parquet") for folder in ("whole", "pieces")]
        assert written[0].equals(written[1])
        other = page(run)
        assert one.tracks == other.tracks
        assert one.data["coastline"] == other.data["coastline"]


@pytest.mark.parametrize("kind", TABLES)
def test_pieces_of_a_parquet_file_give_the_bits_of_the_whole(tmp_path: Path, kind: str) -> None:
    text = tmp_path / "sound.csv"
    lines = [line for line in TABLES[kind]().replace("\r", "").split("\n") if line and not line.startswith("#") and '"' not in line]
    text.write_text("\n".join(line for line in lines if line.count(",") == lines[0].count(",")) + "\n")
    file = tmp_path / f"{kind}.parquet"
    pl.read_csv(text, infer_schema_length=None).write_parquet(file, row_group_size=50)
    whole = in_pieces(file, tmp_path / "whole", None)
    assert isinstance(whole.table, pl.DataFrame)
    # Row by row is the text's test: what a table holds is cut after it was read, whatever it was read from.
    for piece_rows in PIECES[1:]:
        run = in_pieces(file, tmp_path / "pieces", piece_rows)
        assert not isinstance(run.table, pl.DataFrame), "it must have been read in pieces"
        assert run.summary.model_dump_json() == whole.summary.model_dump_json(), piece_rows
        assert run.epochs.equals(whole.epochs), piece_rows
        assert run.epochs.schema == whole.epochs.schema
        assert run.events.equals(whole.events), piece_rows
        assert run.record.inputs == whole.record.inputs


def test_a_large_parquet_file_is_read_in_pieces(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("navbound.run.pieces.material.LARGE_ROWS", 60)
    file, damaged, with_truth = (tmp_path / f"{name}.parquet" for name in ("large", "damaged", "truth"))
    table = pl.DataFrame([row(k, "g", sde=1.0, sdn=1.0) for k in range(60)])
    table.write_parquet(file)
    assert not isinstance(navbound.analyze(file).table, pl.DataFrame)
    assert not isinstance(navbound.analyze(file, truth="4200000,170000,4780000").table, pl.DataFrame)
    table.with_columns(truth_lat=pl.col("latitude"), truth_lon=pl.col("longitude")).write_parquet(with_truth)
    assert not isinstance(navbound.analyze(with_truth).table, pl.DataFrame)
    table.head(59).write_parquet(file)
    assert isinstance(navbound.analyze(file).table, pl.DataFrame)
    damaged.write_bytes(file.read_bytes()[:-200])
    with pytest.raises(FormatError, match="damaged Parquet file"):
        navbound.analyze(damaged, piece_rows=7)


def test_the_tables_have_what_they_are_to_show(tmp_path: Path) -> None:
    """Otherwise their pieces would agree on nothing."""
    words, statuses, kinds = "", set[str](), set[str]()
    for kind, text in TABLES.items():
        file = tmp_path / f"{kind}.csv"
        file.write_bytes(text().encode())
        # Its pieces state the same, which is the test above.
        run = in_pieces(file, tmp_path / kind, None)
        words += run.summary.model_dump_json()
        statuses |= set(run.summary.n_status)
        kinds |= set(run.events["kind"])
    for each in (
        "time repeated within a track with another position",
        "another number of fields",
        "not a number; row used without it",
        "rows stood after a later one",
        "later than its row",
        "a status that is none of",
        "no time zone",
        "longitude: empty",
        "timestamp: empty",
        "timestamp: not a time",
    ):
        assert each in words, each
    assert statuses == {"ok", "degraded", "not_available", "invalid_input"}
    assert kinds == {"caution", "warning", "unavailable"}


def refused(file: Path, piece_rows: int | None) -> str:
    more: dict[str, Any] = {} if piece_rows is None else {"piece_rows": piece_rows}
    with pytest.raises(NavboundError) as error:
        navbound.analyze(file, **more)
    return str(error.value)


GOOD = [row(k, "g", sde=1, sdn=1) for k in range(60)]
REFUSED = {
    "fields": as_text(GOOD) + "1,2\n" * 20,
    "values": as_text([r | ({"latitude": "north"} if k % 3 else {}) for k, r in enumerate(GOOD)]),
    "optional": as_text([r | ({"sde": "small", "sdn": "large"} if k % 6 == 0 else {}) for k, r in enumerate(GOOD)]),
    "column": as_text([{("lat." if n == "latitude" else n): v for n, v in r.items()} for r in GOOD]),
    "times": as_text([r | {"timestamp": 7 + k} for k, r in enumerate(GOOD)]),
    "twice": as_text(GOOD).replace("sdn", "sde"),
    "header": "timestamp,latitude,longitude\n",
    "remarks": "# nothing\n# here\n",
    "nothing": as_text([r | {"latitude": ""} for r in GOOD]),
    "zero": as_text(GOOD).replace("2.5,", "2.5\0,", 30),
}


@pytest.mark.parametrize("kind", REFUSED)
def test_a_refusal_names_the_same_line_and_text(tmp_path: Path, kind: str) -> None:
    file = tmp_path / "refused.csv"
    file.write_text(REFUSED[kind])
    expected = refused(file, None)
    assert {refused(file, n) for n in PIECES} == {expected}


def test_bytes_that_are_no_text_are_named_by_line_and_offset(tmp_path: Path) -> None:
    file = tmp_path / "refused.csv"
    content = as_text(GOOD).encode()
    at = content.index(b"g", len(content) // 2)
    file.write_bytes(content[:at] + b"\xff" + content[at + 1 :])
    line = content.count(b"\n", 0, at) + 1
    for piece_rows in PIECES:
        message = refused(file, piece_rows)
        assert f":{line}" in message
        assert f"at offset {at}" in message


def test_a_line_without_an_end_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("navbound.read.pieces.chunks.MOST_LINE_BYTES", 1 << 10)
    file = tmp_path / "long.csv"
    file.write_text(as_text(GOOD) + "1" * 100_000)
    with pytest.raises(FormatError, match=r":62.*a line is longer than"):
        navbound.analyze(file, piece_rows=7)


def test_a_table_beyond_the_memory_is_refused_before_it_is_taken_apart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = tmp_path / "large.csv"
    text.write_text(as_text(GOOD))
    table = pl.read_csv(text)
    parquet, records = tmp_path / "large.parquet", tmp_path / "large.json"
    table.write_parquet(parquet)
    table.write_json(records)
    # One row of text more than the table has: the line of names.
    for file, n_rows in ((text, table.height + 1), (parquet, table.height), (records, table.height)):
        needed = 900 * n_rows + 2 * file.stat().st_size
        monkeypatch.setattr("navbound.read.tables.memory.free_bytes", lambda needed=needed: needed)
        navbound.analyze(file)
        monkeypatch.setattr("navbound.read.tables.memory.free_bytes", lambda needed=needed: needed - 1)
        with pytest.raises(FormatError, match=rf"{file.name}: its {n_rows} rows take about .* read in pieces"):
            navbound.analyze(file, truth="4200000,170000,4780000")
    navbound.analyze(text, piece_rows=7)


def test_a_full_disk_for_the_pieces_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tempfile.TemporaryFile", lambda **_: Path("/dev/full").open("w+b", buffering=0))  # noqa: SIM115 - the spool closes it
    file = tmp_path / "full.csv"
    file.write_text(as_text(GOOD))
    with pytest.raises(FormatError, match=r"cannot hold the pieces of a large table: No space left"):
        navbound.analyze(file, piece_rows=7, out=tmp_path / "out")
    assert list((tmp_path / "out").iterdir()) == []


def test_a_track_too_long_for_the_page_is_shown_around_its_worst(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(payload, "MOST_ROWS", 20)
    file = tmp_path / "long.csv"
    rows = [row(k, "w", epu=900 if k == 130 else 100) for k in range(200)]
    file.write_text(as_text(rows))
    pages = [page(in_pieces(file, tmp_path / "out", n)) for n in (None, 7)]
    assert pages[0].tracks == pages[1].tracks
    assert pages[0].data["summary"] == pages[1].data["summary"]
    (head,) = pages[0].data["tracks"]
    worst = pages[0].data["summary"]["verdict"]["worst_accuracy"]["time_ns"]
    assert head["n"] == 20
    assert int(head["start_ns"]) == worst - 10 * 10**9
    assert "The charts show 20 of the 200 epochs of track w" in json.dumps(pages[0].data["summary"]["assumptions"])


def large(file: Path, n_bytes: int) -> None:
    """Aircraft one after the other, two hours each."""
    rng, n = random.Random(5), 0
    with file.open("w") as out:
        out.write("timestamp,icao24,callsign,latitude,longitude,geoaltitude,groundspeed,track,nac_p\n")
        while out.tell() < n_bytes:
            south, n = rng.uniform(30, 50), n + 1
            place = f"{4 + rng.random():.7f}"
            out.writelines(
                f"{START_S + k},{n:06x},TST{n:04d},{south + 1.2e-3 * k:.6f},{place},{31000 + k % 70}.0,259.18,0.00,{8 + k % 3}\n"
                for k in range(7200)
            )


@pytest.mark.parametrize(("n_bytes", "is_large"), [((64 << 20) - 1, False), (64 << 20, True)])
def test_a_text_of_64_mib_is_read_in_pieces(tmp_path: Path, n_bytes: int, is_large: bool) -> None:
    """The limit is that of docs/methods/recorded-tracks.md. Behind its first megabyte the file is a hole."""
    file = tmp_path / "large.csv"
    file.write_text(as_text(GOOD * 800))
    assert file.stat().st_size > 1 << 20
    os.truncate(file, n_bytes)
    assert material.is_large(file, None) is is_large


COMMAND = """
import sys
from navbound.cli import main
from navbound.run.pieces import material
material.LARGE_BYTES = 1
main.main()
"""
RUN = """
import resource, subprocess, sys
done = subprocess.run([sys.executable, "-c", *sys.argv[1:]], capture_output=True, text=True)
print(done.returncode, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss // 1024)
"""


def test_memory_does_not_grow_with_the_table(tmp_path: Path) -> None:
    """At once a table of 40 MB takes about 570 MB, in pieces 350."""
    large(tmp_path / "large.csv", 40_000_000)
    command = [COMMAND, "analyze", str(tmp_path / "large.csv"), "--out", str(tmp_path / "run")]
    done = subprocess.run([sys.executable, "-c", RUN, *command], capture_output=True, text=True, check=True)
    status, peak_mb = map(int, done.stdout.split())
    assert status == 0
    assert peak_mb < 450
    assert pl.scan_parquet(tmp_path / "run" / "epochs.parquet").select(pl.len()).collect().item() > 450_000
