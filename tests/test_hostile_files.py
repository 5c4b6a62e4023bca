"""Files that were made to do harm: bombs, and headers that take the readers long."""

from __future__ import annotations

import gzip
import re
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import polars as pl
import pytest

from navbound import FormatError, InputError, dme, gnss, sbas
from navbound.exit_status import UNREADABLE
from navbound.read import read
from navbound.read.columns.naming import plain_form
from navbound.storage import packed

MB = 1 << 20


def bomb(path: Path, plain_mb: int, head: bytes = b"") -> Path:
    """A gzip file of one repeated digit; of members of one megabyte, so that making it needs no memory."""
    with path.open("wb") as file:
        file.write(gzip.compress(head))
        file.write(gzip.compress(b"0" * MB) * plain_mb)
    return path


READERS: dict[str, Callable[[Path], object]] = {
    "tracks": read,
    "observations": gnss.read_observations,
    "navigation": gnss.read_navigation,
    "orbits": gnss.read_orbits,
    "constellation": gnss.constellation,
    "messages": sbas.read,
    "stations": dme.read_stations,
}


@pytest.mark.parametrize("reader", READERS)
def test_a_bomb_is_refused_by_every_reader(tmp_path: Path, reader: str) -> None:
    path = bomb(tmp_path / "bomb.gz", 80)
    with pytest.raises(FormatError, match=r"bomb\.gz: its 0\.1 MB unpack to more than the 67 MB that are allowed"):
        READERS[reader](path)


def test_a_bomb_of_three_gigabytes_needs_no_memory(tmp_path: Path) -> None:
    path = bomb(tmp_path / "bomb.csv.gz", 3000)
    assert path.stat().st_size < 4 * MB
    run = subprocess.run(
        [sys.executable, "-m", "navbound", "analyze", str(path), "--out", str(tmp_path / "run")],
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30)),
    )
    assert run.returncode == UNREADABLE
    assert "that are allowed" in run.stderr


def test_the_limit_is_a_setting(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = bomb(tmp_path / "bomb.gz", 80)
    monkeypatch.setenv("NAVBOUND_UNPACKED_RATIO", "2000")
    assert len(packed.read(path)) == 80 * MB
    monkeypatch.setenv("NAVBOUND_UNPACKED_BYTES", str(80 * MB - 1))
    with pytest.raises(FormatError, match="84 MB that are allowed"):
        packed.read(path)
    monkeypatch.setenv("NAVBOUND_UNPACKED_BYTES", "plenty")
    with pytest.raises(InputError, match="NAVBOUND_UNPACKED_BYTES"):
        packed.read(path)


def test_a_parquet_file_that_unpacks_to_more_than_the_limit_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "one value.parquet"
    pl.select(time_ns=pl.repeat(0, 9_000_000), est_lat_rad=pl.repeat(0.5, 9_000_000)).write_parquet(path)
    assert path.stat().st_size < MB
    with pytest.raises(FormatError, match="144 MB, more than the 67 MB"):
        read(path)


def pattern(name: str) -> tuple[str, str | None]:
    """A column's name and unit by the pattern that says it shortest, and takes quadratic time."""
    match = re.fullmatch(r"\s*(.*?)\s*[(\[]\s*([^)\]]*?)\s*[)\]]\s*", name)
    stem, unit = (match[1], match[2].lower()) if match else (name, None)
    return re.sub(r"[\s\-.]+", "_", stem.strip().lower()), unit


@pytest.mark.parametrize(
    "name",
    [
        "lat",
        "Latitude (deg)",
        "a [b] (c)",
        "a (b) c",
        "a ((b)",
        "a (b))",
        "(x)",
        "()",
        ")",
        "(",
        "",
        "a (b]",
        "a [ m/s ] ",
        "a (b (c)",
        "x)y(z)",
    ],
)
def test_names_and_units_are_what_the_pattern_says(name: str) -> None:
    assert plain_form(name) == pattern(name)


BUDGET_S_PER_BYTE = 2e-6
"""A megabyte in two seconds, on a machine that does other work too."""

HEADERS: dict[str, Callable[[int], str]] = {
    "blanks": lambda n: " " * n,
    "blanks in brackets": lambda n: "lat (" + " " * n + "x",
    "brackets": lambda n: "(" * n,
    "pairs": lambda n: "()" * (n // 2) + ")",
    "blanks and brackets": lambda n: " (" * (n // 2),
    "one long name": lambda n: "latitude" * (n // 8),
    "many names": lambda n: ",".join(f"lat{k}" for k in range(n // 8)),
    "quotation marks": lambda n: '"' * n,
    "points": lambda n: ".-" * (n // 2),
}


@pytest.mark.parametrize("kind", HEADERS)
def test_a_header_takes_time_in_proportion_to_its_length(tmp_path: Path, kind: str) -> None:
    header = HEADERS[kind](1_000_000)
    path = tmp_path / "table.csv"
    path.write_text(f"time,{header}\n1,2\n")
    begin = time.process_time()
    with pytest.raises(FormatError) as refusal:
        read(path)
    assert time.process_time() - begin < BUDGET_S_PER_BYTE * len(header) + 1.0
    assert len(str(refusal.value)) < 2000


@pytest.mark.parametrize("kind", sorted(HEADERS.keys() - {"many names", "quotation marks"}))
def test_a_long_name_beside_a_position_takes_time_in_proportion_to_its_length(tmp_path: Path, kind: str) -> None:
    """A table that is read to its end: names that nothing reads are looked at for other places, letters and accuracies."""
    header = f"gps_lat_lon{HEADERS[kind](1_000_000)}b"
    path = tmp_path / "table.csv"
    path.write_text(f"time_s,lat,lon,{header}\n" + "".join(f"{1_700_000_000 + k},48.{k:02d},2.5,S\n" for k in range(20)))
    begin = time.process_time()
    assert read(path).epochs.height == 20
    assert time.process_time() - begin < BUDGET_S_PER_BYTE * len(header) + 1.0
