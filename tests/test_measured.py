"""A position that nothing measured (typed in, carried forward, simulated) is none, whatever deviation stands beside it."""

from __future__ import annotations

import struct
import zlib
from contextlib import closing
from functools import reduce
from operator import xor
from pathlib import Path

import polars as pl
import pytest

import navbound
from navbound import live
from navbound.errors import FormatError
from navbound.live.sinks import tables
from navbound.live.source import File
from navbound.read import read

N, BAD = 40, 12


def sentence(text: str) -> str:
    return f"${text}*{reduce(xor, text.encode()):02X}\r\n"


def nmea(quality: int, path: Path) -> Path:
    """Of 40 seconds, twelve with this quality."""
    text = sentence("GPZDA,120000.00,22,11,2026,00,00")
    for k in range(N):
        of_row = quality if 10 <= k < 10 + BAD else 1
        text += sentence(f"GPGGA,1200{k:02d}.00,49{k * 0.02:08.5f},N,00230.0000,E,{of_row},08,1.0,100.0,M,47.0,M,,")
        text += sentence(f"GPGST,1200{k:02d}.00,1.0,,,,2.0,2.0,4.0")
    path.write_text(text)
    return path


def rtklib(quality: int, path: Path) -> Path:
    head = "latitude(deg) longitude(deg) height(m) Q ns sdn(m) sde(m) sdu(m) sdne(m) sdeu(m) sdun(m) age(s) ratio"
    rows = [f"%  GPST  {head}"]
    for k in range(N):
        of_row = quality if 10 <= k < 10 + BAD else 5
        rows.append(f"2026/11/22 12:00:{k:02d}.000 {49 + k * 0.0003:.9f} 2.5 150.0 {of_row} 10 1.0 1.0 2.0 0.0 0.0 0.0 0.0 0.0")
    path.write_text("\n".join(rows) + "\n")
    return path


def novatel(kind: str, path: Path) -> Path:
    lines = []
    for k in range(N):
        of_row = kind if 10 <= k < 10 + BAD else "SINGLE"
        head = f"BESTPOSA,COM1,0,50.0,FINESTEERING,2445,{100 + k}.000,00000000,0000,1000"
        body = f'SOL_COMPUTED,{of_row},{49 + k * 0.0003:.9f},2.5,100.0,47.0,WGS84,1.0,1.0,2.0,"",0.0,0.0,10,10,10,10,0,0,0,0'
        text = f"{head};{body}"
        lines.append(f"#{text}*{zlib.crc32(text.encode(), 0xFFFFFFFF) ^ 0xFFFFFFFF:08x}\r\n")
    path.write_text("".join(lines))
    return path


def novatel_binary(kind: int, path: Path) -> Path:
    frames = []
    for k in range(N):
        of_row = kind if 10 <= k < 10 + BAD else 16
        body = struct.pack("<II3dfI3f12xBB6x", 0, of_row, 49 + k * 0.0003, 2.5, 100.0, 47.0, 61, 1.0, 1.0, 2.0, 10, 10)
        head = struct.pack("<3sBHBBHHBBHiIHH", b"\xaa\x44\x12", 28, 42, 0, 0, len(body), 0, 0, 180, 2445, 100_000 + 1000 * k, 0, 0, 0)
        frames.append(head + body + struct.pack("<I", zlib.crc32(head + body, 0xFFFFFFFF) ^ 0xFFFFFFFF))
    path.write_bytes(b"".join(frames))
    return path


NOT_MEASURED = [
    *((nmea, quality) for quality in (0, 6, 7, 8)),
    *((rtklib, quality) for quality in (0, 7, 8)),
    *((novatel, word) for word in ("FIXEDPOS", "FIXEDHEIGHT", "PROPAGATED", "WARNING", "NOT_A_WORD")),
    *((novatel_binary, number) for number in (1, 2, 8, 19, 71, 200)),
]


@pytest.mark.parametrize(("write", "kind"), NOT_MEASURED)
def test_a_position_that_was_not_measured_is_left_out_and_counted(tmp_path: Path, write, kind: int | str) -> None:  # type: ignore[no-untyped-def]
    reading = read(write(kind, tmp_path / "recorded.bin"))
    assert reading.epochs.height == N - BAD
    assert sum(r.count for r in reading.rejected) == BAD


@pytest.mark.parametrize(
    ("write", "kind"),
    [*((nmea, q) for q in (1, 2, 4, 5, 9)), *((rtklib, q) for q in range(1, 7)), (novatel, "NARROW_INT"), (novatel_binary, 50)],
)
def test_a_measured_position_of_every_kind_is_kept(tmp_path: Path, write, kind: int | str) -> None:  # type: ignore[no-untyped-def]
    assert read(write(kind, tmp_path / "recorded.bin")).epochs.height == N


@pytest.mark.parametrize("quality", [6, 7, 8])
def test_a_sentence_of_a_simulator_is_no_position_live_either(tmp_path: Path, quality: int) -> None:
    session = live.Session(tmp_path / "out", live.Settings(format="nmea", rnp_m=555.6))
    with closing(File(nmea(quality, tmp_path / "log.nmea"))) as source:
        session.run(source)
    epochs = tables.epochs(tmp_path / "out")
    assert epochs.filter(pl.col("status") == "ok").height == N - BAD
    assert epochs.filter(pl.col("status") == "not_available").height == BAD


@pytest.mark.parametrize(("quality", "ok"), [(1, N), (3, N), (9, N), (6, N - BAD), (7, N - BAD), (8, N - BAD)])
def test_the_column_of_a_table_says_the_same(tmp_path: Path, quality: int, ok: int) -> None:
    rows = ["time,lat,lon,h_m,cov_ee_m2,cov_en_m2,cov_nn_m2,gga_quality"]
    for k in range(N):
        of_row = quality if 10 <= k < 10 + BAD else 1
        rows.append(f"2026-11-22T12:00:{k:02d}Z,{49 + k * 0.0003:.9f},2.5,100.0,2.0,0.0,2.0,{of_row}")
    path = tmp_path / "table.csv"
    path.write_text("\n".join(rows) + "\n")
    epochs = navbound.analyze([path], spec="RNP 0.3").epochs
    assert epochs.filter(pl.col("status") == "ok").height == ok


def test_where_no_position_was_measured_the_refusal_says_what_the_rows_were(tmp_path: Path) -> None:
    text = "".join(sentence(f"GPGGA,1200{k:02d}.00,4900.0,N,00230.0,E,8,08,1.0,100.0,M,47.0,M,,") for k in range(5))
    path = tmp_path / "simulated.nmea"
    path.write_text(sentence("GPZDA,120000.00,22,11,2026,00,00") + text)
    with pytest.raises(FormatError, match=r"no row that may be used: 5 rows left out, no fix \(record 2: quality 8"):
        read(path)
