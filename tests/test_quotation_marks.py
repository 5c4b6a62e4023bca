"""Text tables by RFC 4180: fields in quotation marks, and marks within them."""

from __future__ import annotations

from pathlib import Path

import pytest

from navbound.errors import FormatError
from navbound.read.pieces import read_pieces
from navbound.read.tables.epochs import read

N = 40


def table(tmp_path: Path, note: str, header: str = "time,note,callsign,lat,lon", callsign: str = "AFR1") -> Path:
    rows = [f"{1_700_000_000 + k},{note},{callsign},48.{k:03d},2.0" for k in range(N)]
    (tmp_path / "table.csv").write_text("\n".join([header, *rows]) + "\n")
    return tmp_path / "table.csv"


@pytest.mark.parametrize(
    "note",
    [
        '"a ""b"" c"',
        '"a, ""b"" c"',
        '"a,""b"" c"',
        '"""b"""',
        '"b"""',
        '""',
        '""""',
        '","","',
        '"{""a"": 1,""b"": {""c"": ""x, y""}}"',
        "a",
        "",
        'a "b" c',
    ],
)
def test_a_mark_that_is_doubled_is_one_mark_of_its_field(tmp_path: Path, note: str) -> None:
    path = table(tmp_path, note)
    for epochs in (read(path).epochs, next(read_pieces(path).epochs())):
        assert epochs.height == N
        assert set(epochs["callsign"]) == {"AFR1"}


def test_the_marks_of_a_field_are_no_part_of_it(tmp_path: Path) -> None:
    assert set(read(table(tmp_path, "x", callsign='"A ""1"""')).epochs["callsign"]) == {'A "1"'}


def test_a_name_is_a_field_too(tmp_path: Path) -> None:
    reading = read(table(tmp_path, "x", header='time,"a ""b"", c","callsign",lat,lon'))
    assert (reading.epochs.height, reading.unused) == (N, ['a "b", c'])


@pytest.mark.parametrize("note", ['"a"b', '"a"" b" c', '"a,""b"" c"d'])
def test_nothing_stands_behind_a_field_in_quotation_marks(tmp_path: Path, note: str) -> None:
    with pytest.raises(FormatError, match="a quotation mark that does not enclose a field"):
        read(table(tmp_path, note))


@pytest.mark.parametrize("note", ['"a', '"a\nb"', '"a ""b""'])
def test_a_field_that_does_not_end_on_its_line_is_refused_with_the_reason(tmp_path: Path, note: str) -> None:
    with pytest.raises(FormatError, match="a field with a line break is not read"):
        read(table(tmp_path, note))
