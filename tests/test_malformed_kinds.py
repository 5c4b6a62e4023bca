"""Every kind of file, damaged in every way: the right part with each loss counted, or a sentence that names the file at fault."""

from __future__ import annotations

import gzip
import io
import subprocess
import sys
from dataclasses import dataclass
from functools import cache
from json import loads
from pathlib import Path
from typing import TYPE_CHECKING

import polars as pl
import pytest

from conftest import SHARED
from navbound.errors import FormatError, InputError
from navbound.run.analyze import material
from navbound.run.evaluate.performance import Options, evaluate_files

if TYPE_CHECKING:
    from collections.abc import Callable

DATA = SHARED / "data"
SBAS = DATA / "sbas"
ROWS = 120
"""Rows or epochs of each file: enough that one damaged row is less than a tenth."""
START_S = 1_700_000_000


def track() -> pl.DataFrame:
    """Northwards at 50 m/s."""
    rows = [[START_S + k, round(50 + 50 * k / 111_200, 7), 10.0 + k * 1e-7, 97.2] for k in range(ROWS)]
    return pl.DataFrame(rows, schema=["timestamp", "latitude", "longitude", "groundspeed"], orient="row")


def csv() -> bytes:
    return track().write_csv().encode()


def json() -> bytes:
    return track().write_json().replace("},", "},\n").replace("[", "[\n").encode()


def parquet() -> bytes:
    track().write_parquet(made := io.BytesIO())
    return made.getvalue()


def solutions() -> bytes:
    text = (DATA / "gnss_imu" / "taroz_kinematic" / "rover_1Hz_spp.pos").read_text()
    lines = text.splitlines(keepends=True)
    head = [line for line in lines if line.startswith("%")]
    return "".join(head + [line for line in lines if not line.startswith("%")][:ROWS]).encode()


def nmea() -> bytes:
    def sentence(body: str) -> str:
        check = 0
        for c in body:
            check ^= ord(c)
        return f"${body}*{check:02X}\r\n"

    made = ""
    for k in range(ROWS):
        clock, lat = f"12{k // 60:02d}{k % 60:02d}.00", f"50{k * 0.027:07.4f}"
        made += sentence(f"GPRMC,{clock},A,{lat},N,01000.0000,E,97.2,0.0,150224,,,A")
        made += sentence(f"GPGGA,{clock},{lat},N,01000.0000,E,1,09,0.9,300.0,M,47.0,M,,")
    return made.encode()


def ubx() -> bytes:
    return (DATA / "rxlogs" / "gpsd" / "ublox-neo-m8l.log").read_bytes()


def sbf() -> bytes:
    return (DATA / "rxlogs" / "pysbf2" / "pygpsdata_x5pvt.log").read_bytes()


@cache
def observations() -> bytes:
    text = gzip.decompress((SBAS / "virtual_user_2025046_17h.25O.gz").read_bytes()).decode()
    head, body = text.split("END OF HEADER", 1)
    first, *epochs = body.split("\n>")
    return (head + "END OF HEADER" + first + "".join("\n>" + e for e in epochs[300 : 300 + ROWS]) + "\n").encode()


def navigation() -> bytes:
    return (SBAS / "gps_2025046_17h_rinex3.nav").read_bytes()


def ems() -> bytes:
    return gzip.decompress((SBAS / "more" / "prn137_2025046_17h.ems.gz").read_bytes())


def sbs() -> bytes:
    made = []
    for line in ems().decode().splitlines():
        prn, *date, kind, block = line.split()
        tow = 579_600 + 60 * int(date[4]) + int(date[5])
        made.append(f"2353 {tow} {prn} {kind:>2} : {block[:56] + f'{int(block[56:58], 16) & 0xC0:02X}'}\n")
    return "".join(made).encode()


@dataclass(frozen=True)
class Kind:
    """A kind of file, with those that it needs beside it, and where one of its rows begins and what separates its numbers."""

    make: Callable[[], bytes]
    name: str
    beside: tuple[str, ...] = ()
    binary: bool = False


KINDS = {
    "CSV": Kind(csv, "a.csv"),
    "JSON": Kind(json, "a.json"),
    "Parquet": Kind(parquet, "a.parquet", binary=True),
    "RTKLIB solutions": Kind(solutions, "a.pos"),
    "NMEA": Kind(nmea, "a.nmea"),
    "u-blox": Kind(ubx, "a.ubx", binary=True),
    "Septentrio": Kind(sbf, "a.sbf", binary=True),
    "RINEX observations": Kind(observations, "a.rnx", ("RINEX navigation",)),
    "RINEX navigation": Kind(navigation, "a.nav", ("RINEX observations",)),
    "EMS": Kind(ems, "a.ems", ("RINEX observations", "RINEX navigation")),
    "RTKLIB sbs": Kind(sbs, "a.sbs", ("RINEX observations", "RINEX navigation")),
}


def row(content: bytes, share: float = 0.5) -> tuple[int, int]:
    """Beginning and end of a row in the middle."""
    first = content.index(b"\n", int(len(content) * share)) + 1
    return first, content.index(b"\n", first) + 1


def cut(content: bytes, kind: Kind) -> bytes:
    # Not between two frames: such a file is whole.
    first, end = (len(content) // 2 + 10, len(content) // 2 + 11) if kind.binary else row(content, 0.6)
    return content[: (first + end) // 2]


def bad_field(content: bytes, kind: Kind) -> bytes:
    if kind.binary:
        middle = len(content) // 2
        return content[:middle] + b"x#x" + content[middle + 3 :]
    first, end = row(content)
    digit = next(k for k in range(first + (end - first) // 3, end) if content[k - 1 : k + 1].isdigit())
    return content[: digit - 1] + b"x#" + content[digit + 1 :]


def one_bit(content: bytes, kind: Kind) -> bytes:
    """One bit of a digit or of a frame."""
    if kind.binary:
        at = len(content) // 2
    else:
        first, end = row(content)
        at = next(k for k in range(first + 20, end) if content[k : k + 1].isdigit())
    return content[:at] + bytes([content[at] ^ 0x40]) + content[at + 1 :]


def wrong_kind(_: bytes, __: Kind) -> bytes:
    return b"\x89PNG\r\n\x1a\n" + bytes((37 * k) % 256 for k in range(4000))


def empty(_: bytes, __: Kind) -> bytes:
    return b""


def zero_bytes(content: bytes, kind: Kind) -> bytes:
    at = len(content) // 2 if kind.binary else row(content)[0] + 10
    return content[:at] + bytes(30) + content[at + 30 :]


def other_line_ends(content: bytes, _: Kind) -> bytes:
    return content.replace(b"\r\n", b"\n").replace(b"\n", b"\r\n")


def old_line_ends(content: bytes, _: Kind) -> bytes:
    return content.replace(b"\r\n", b"\n").replace(b"\n", b"\r")


def blocks(content: bytes, kind: Kind) -> tuple[bytes, list[bytes], str]:
    """Head and whole records of a text."""
    text = content.decode()
    if kind.name == "a.rnx":
        head, *epochs = text.split("\n>")
        return head.encode(), [("\n>" + e).encode() for e in epochs], ""
    if kind.name == "a.nav":
        head, body = text.split("END OF HEADER")
        lines = body.splitlines(keepends=True)
        return (head + "END OF HEADER" + lines[0]).encode(), ["".join(lines[k : k + 8]).encode() for k in range(1, len(lines) - 7, 8)], ""
    lines = text.splitlines(keepends=True)
    n = next(k for k, line in enumerate(lines) if line[:1] in "0123456789{$" and k >= int(kind.name in {"a.csv", "a.json"}))
    step = 2 if kind.name == "a.nmea" else 1
    return "".join(lines[:n]).encode(), ["".join(lines[k : k + step]).encode() for k in range(n, len(lines), step)], ""


def twice(content: bytes, kind: Kind) -> bytes:
    if kind.binary:
        return content
    head, records, _ = blocks(content, kind)
    middle = len(records) // 2
    return head + b"".join([*records[: middle + 1], records[middle], *records[middle + 1 :]])


def backwards(content: bytes, kind: Kind) -> bytes:
    """One record behind its place."""
    if kind.binary:
        return content
    head, records, _ = blocks(content, kind)
    k = len(records) // 3
    return head + b"".join([*records[:k], *records[k + 1 : 2 * k], records[k], *records[2 * k :]])


DAMAGES = (cut, bad_field, one_bit, wrong_kind, empty, zero_bytes, other_line_ends, old_line_ends, twice, backwards)
BENIGN = {"other_line_ends", "twice", "backwards"}
"""Damages that may leave the result as it was."""


@dataclass(frozen=True)
class Outcome:
    """What became of a run: its refusal, or its epochs with what it says."""

    refusal: str
    words: tuple[str, ...]
    epochs: pl.DataFrame | None


def outcome(kind: Kind, content: bytes, folder: Path) -> Outcome:
    folder.mkdir(exist_ok=True)
    (own := folder / kind.name).write_bytes(content)
    files = [own]
    for other in kind.beside:
        (beside := folder / f"sound-{KINDS[other].name}").write_bytes(KINDS[other].make())
        files.append(beside)
    try:
        if len(files) == 3:
            run = evaluate_files(files, Options(levels=["LPV-200"]))
            return Outcome("", stated(own, run.summary.rejected, run.summary.assumptions), run.epochs)
        judged_material = material(files, requirement="RNP 2", rnp_m=3704, sigma_m=10)
    except (FormatError, InputError) as e:
        return Outcome(str(e), (), None)
    return Outcome("", stated(own, judged_material.rejected, judged_material.assumptions), judged_material.epochs)


def stated(own: Path, rejected: list, notes: list[str]) -> tuple[str, ...]:  # type: ignore[type-arg]
    of_own = [f"{r.count} x {r.reason} (line {r.first_line})" for r in rejected if Path(r.file) == own]
    words = ("after a later one", "belong to no message", "has no end")
    return (*of_own, *(note for note in notes if own.name in note and any(w in note for w in words)))


@cache
def sound(name: str, folder: Path) -> Outcome:
    return outcome(KINDS[name], KINDS[name].make(), folder)


def verdict(name: str, damage: Callable[[bytes, Kind], bytes], tmp: Path) -> tuple[str, str]:
    """``refused``, ``counted``, ``same`` or ``SILENT``, and the words."""
    kind = KINDS[name]
    whole, result = sound(name, tmp / "sound"), outcome(kind, damage(kind.make(), kind), tmp / "damaged")
    assert whole.epochs is not None, whole.refusal
    if result.epochs is None:
        return ("refused" if kind.name in result.refusal and "sound-" not in result.refusal else "WRONG FILE"), result.refusal
    if new := [one for one in result.words if one not in whole.words]:
        return "counted", "; ".join(new)
    numbers = [c for c in ("time_ns", "est_lat_rad", "est_lon_rad", "est_h_m", "hpl_m", "vpl_m") if c in whole.epochs.columns]
    same = result.epochs.height == whole.epochs.height and result.epochs.select(numbers).equals(whole.epochs.select(numbers))
    return ("same" if same else "SILENT"), ""


@pytest.mark.parametrize("damage", DAMAGES, ids=lambda d: d.__name__)
@pytest.mark.parametrize("name", KINDS)
def test_damage_is_refused_or_counted(name: str, damage: Callable[[bytes, Kind], bytes], tmp_path: Path) -> None:
    if not DATA.is_dir():
        pytest.skip(f"SKIPPED ALOUD: no real data at {DATA}")
    kind = KINDS[name]
    if damage(kind.make(), kind) == kind.make():
        pytest.skip("frames of a binary log are not taken apart here")
    verdict_id, words = verdict(name, damage, tmp_path)
    if kind.name == "a.parquet" and damage in (bad_field, one_bit, zero_bytes):
        # The file as it is written has no checksum: another number is a number.
        assert verdict_id in {"refused", "counted", "SILENT"}
        pytest.skip("SKIPPED ALOUD: a number changed inside a Parquet page cannot be seen")
    assert verdict_id in {"refused", "counted", "same"}, words
    if verdict_id == "same":
        # To JSON every line end is a blank.
        assert damage.__name__ in BENIGN | ({"old_line_ends"} if kind.name == "a.json" else set())


@pytest.fixture(scope="module")
def damaged_run(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """Observations, navigation data and messages, each damaged; from the command line to its folder."""
    if not DATA.is_dir():
        pytest.skip(f"SKIPPED ALOUD: no real data at {DATA}")
    folder = tmp_path_factory.mktemp("damaged")
    ranges, records, log = observations().decode(), navigation().decode(), ems().decode()
    head, *epochs = ranges.split("\n>")
    sv, values = epochs[20].splitlines()[1][:3], epochs[20].splitlines()[1][3:]
    epochs[20] = epochs[20].replace(sv + values, sv + "9999999999.999" + values[14:])
    epochs[40], epochs[60] = epochs[60], epochs[40]
    (folder / "a.rnx").write_text("\n>".join([head, *epochs]))
    first = records.index("\nG") + 1
    (folder / "a.nav").write_text(records[:first] + "G99" + records[first + 3 :])
    flipped = log.splitlines()
    flipped[500] = flipped[500][:60] + ("0" if flipped[500][60] != "0" else "1") + flipped[500][61:]
    (folder / "a.ems").write_text("\n".join(flipped) + "\n")
    arguments = [str(folder / name) for name in ("a.rnx", "a.nav", "a.ems")] + ["--levels", "APV-I", "--out", str(folder / "run")]
    done = subprocess.run([sys.executable, "-m", "navbound", "analyze", *arguments], capture_output=True, text=True, check=False)
    assert done.returncode in {0, 4}, done.stderr
    return folder / "run", done.stdout


LOSSES = {
    "no pseudorange of a receiver: beyond 1e9 m": ("a.rnx", 1),
    "the time runs backwards against the epochs around it": ("a.rnx", 2),
    "not a satellite number": ("a.nav", 1),
    "parity": ("a.ems", 1),
}


@pytest.mark.parametrize("loss", LOSSES)
def test_every_loss_reaches_summary_terminal_and_report(damaged_run: tuple[Path, str], loss: str) -> None:
    folder, terminal = damaged_run
    name, count = LOSSES[loss]
    rejected = loads((folder / "summary.json").read_text())["rejected"]
    own = [r for r in rejected if loss in r["reason"]]
    assert [(Path(r["file"]).name, r["count"]) for r in own] == [(name, count)], rejected
    assert own[0]["first_line"] > 0
    line_of_loss = next(line for line in terminal.replace("\n    ", " ").splitlines() if loss in line)
    assert line_of_loss.strip().startswith(f"{count} x ")
    assert name in terminal
    assert loss in (folder / "report.html").read_text()
