"""Any table to columns of text or numbers, with the line each row stands on."""

from __future__ import annotations

import io
import re
from collections import Counter
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import polars as pl

from navbound.errors import FormatError
from navbound.read.checks.rejections import Rejections
from navbound.read.columns.naming import declare
from navbound.read.quantities import GARMIN, GARMIN_UNITS
from navbound.read.statements.texts import alarms

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path


LINE = "__line"

MOST_COLUMNS = 5_000
"""Columns of a table that is read: some steps take time for each, and no recording has so many. Provenance: ours."""


def require_few(path: Path, n_columns: int) -> None:
    """Refuse a table of very many columns before it is taken apart.

    Raises
    ------
    FormatError
        With how many there are and how many may be.
    """
    if n_columns > MOST_COLUMNS:
        raise FormatError(path, f"a table of {n_columns} columns; at most {MOST_COLUMNS} are read: leave out those that are not needed")


@dataclass(frozen=True)
class Table:
    """Rows as they stand in the file.

    Attributes
    ----------
    frame : DataFrame
        The columns of the file, text where the file is text, and `LINE`.
    rejections : Rejections
        Rows that could not be taken apart.
    n_rows : int
        Rows in the file, used or not.
    """

    frame: pl.DataFrame
    rejections: Rejections
    n_rows: int

    @property
    def columns(self) -> list[str]:
        """Names in the file."""
        return [c for c in self.frame.columns if c != LINE]


def counted(frame: pl.DataFrame) -> pl.DataFrame:
    """With the number of each row."""
    return frame.with_columns(pl.int_range(1, pl.len() + 1).alias(LINE))


_SENTENCE = r"[$!][A-Z0-9]{3,10},.*\*[0-9A-Fa-f]{2}\s*$"
"""A line of NMEA 0183 or one like it: no names of columns."""
_SEPARATORS, _SEPARATOR_WORDS = ",;\t", "comma, semicolon or tab"


@dataclass(frozen=True)
class Layout:
    """What the first line of a text table says of the others.

    Attributes
    ----------
    header, separator : str
        The line, and what stands between its names.
    names : list of str
        In the file.
    pair : str
        The one of them whose fields hold latitude and longitude together; empty where none does.
    """

    header: str
    separator: str
    names: list[str]
    pair: str = ""

    @property
    def columns(self) -> list[str]:
        """Names of the columns that are made of the fields."""
        named = [(name,) if name != self.pair else _HALVES for name in self.names if name]
        return [name for each in named for name in each]


@dataclass(frozen=True)
class Rows:
    """Some rows of a text table: those of as many fields as the header.

    Of the others, and of remarks between them, it has reason, count, line and text of the first.
    """

    frame: pl.DataFrame
    n_rows: int
    bad: tuple[str, int, int, str] | None
    remarks: tuple[str, int, int, str] | None = None


def lines_of(text: str, first_line: int) -> pl.DataFrame:
    """Lines that are not empty, with their numbers, from the first that is no remark on; `first_line` is that of the first."""
    lines = pl.DataFrame({"text": text.split("\n")}, schema={"text": pl.String}).with_columns(pl.col("text").str.strip_chars_end("\r"))
    lines = lines.with_columns(pl.int_range(first_line, first_line + pl.len()).alias(LINE))
    lines = lines.filter(pl.col("text").str.strip_chars() != "")
    remark = lines["text"].str.starts_with("#")
    if first_line > 1:
        return lines
    rest = lines[int((~remark).arg_max() or 0) :] if not remark.all() else lines.clear()
    if rest.is_empty():
        return rest
    before = lines.filter(pl.col(LINE) < rest[LINE][0]).tail(1).with_columns(pl.col("text").str.strip_chars_start("# \t"))
    if not before.is_empty():
        rest[0, "text"] = _with_units(rest["text"][0], before["text"][0])
    return pl.concat([before, rest]) if not before.is_empty() and _names_of(before["text"][0], rest["text"][0]) else rest


def _with_units(header: str, units: str) -> str:
    """A header of a flight deck with the unit of the line above behind each name of which it is not the usual one."""
    names, written = ([each.strip() for each in line.split(",")] for line in (header, units))
    if len(names) != len(written) or not set(names) >= GARMIN:
        return header
    return ",".join(name if unit == GARMIN_UNITS.get(name, unit) else f"{name} [{unit}]" for name, unit in zip(names, written, strict=True))


def _names_of(remark: str, row: str) -> bool:
    """Whether a remark holds the names of the columns: as many fields as the numbers below it, and no number."""
    separator = max(_SEPARATORS, key=row.count)
    names, numbers = (line.split(separator) for line in (remark, row))
    return separator in row and len(names) == len(numbers) and _is_number(numbers[0]) and not any(map(_is_number, names))


def _is_number(text: str) -> bool:
    try:
        float(text.strip().strip('"').replace(":", "").replace("-", "").replace("T", "").rstrip("Z"))
    except ValueError:
        return False
    return True


def layout_of(path: Path, lines: pl.DataFrame, declared: Iterable[str] = ()) -> Layout:
    """Separator and names of the first of these lines; `declared` as for :func:`table`.

    Raises
    ------
    FormatError
        A name that stands twice; fields that blanks separate.
    """
    header = str(lines["text"][0])
    _require_line_ends(path, lines.head(1), pl.col("text"))
    if re.match(_SENTENCE, header):
        what = f"sentences such as “{header[:40]}”, and none of a position that is read here (GGA or RMC, dated by RMC or ZDA)"
        raise FormatError(path, what, int(lines[LINE][0]))
    separator = max(_SEPARATORS, key=header.count)
    if separator not in header and len(header.split()) > 2:
        what = f"no {_SEPARATOR_WORDS} in “{header[:60]}”: blanks separate no fields"
        raise FormatError(path, what + _lacking(header), int(lines[LINE][0]), "header")
    header = _without_end(header, separator, lines[1 : 1 + _SAMPLE])
    layout = Layout(header, separator, _names(path, header, separator, declared))
    pairs = [name for name in layout.names if name.strip().lower() in _PAIRS]
    if len(pairs) != 1:
        return layout
    fields = rows_of(path, layout, lines[1 : 1 + _SAMPLE]).frame[pairs[0]].str.strip_chars()
    return replace(layout, pair=pairs[0]) if (fields.is_null() | (fields == "") | fields.str.contains(_PAIR)).all() else layout


def _without_end(header: str, separator: str, rows: pl.DataFrame) -> str:
    """A header that ends in a separator, without that where no row has one there: loggers write such headers."""
    fields = rows["text"].str.replace_all(r'"[^"]*"', "").str.count_matches(separator, literal=True) + 1
    ends = header.rstrip(" ").endswith(separator) and not rows.is_empty() and (fields == len(header.split(separator)) - 1).all()
    return header.rstrip(" ").removesuffix(separator) if ends else header


_PAIRS = ("position", "latlon", "lat_lon", "latlng", "lat_lng")
"""Columns of latitude and longitude in one field, in this order: the export of Flightradar24 has `Position`."""
_PAIR = r"^[-+]?\d{1,2}(\.\d+)?\s*,\s*[-+]?\d{1,3}(\.\d+)?$"
_HALVES = ("position latitude", "position longitude")
_SAMPLE = 20
"""Rows whose fields show whether they are such. [1]"""


def _split(frame: pl.DataFrame, pair: str) -> pl.DataFrame:
    """A field at its first comma; what is no pair of numbers is refused with its row, as any other position."""
    if not pair:
        return frame
    both = pl.col(pair).str.splitn(",", 2).struct.rename_fields(list(_HALVES)).alias(pair)
    return frame.with_columns(both).unnest(pair)


SOLUTION_HEADER = (
    "%  GPST  latitude(deg)  longitude(deg)  height(m)  Q  ns  sdn(m)  sde(m)  sdu(m)  sdne(m)  sdeu(m)  sdun(m)  age(s)  ratio"
)
"""Columns of an RTKLIB solution file with angles in degrees, as RTKLIB names them."""
_SOLUTION_WORDS = (14, 15)
"""Words of such a row: the instant is one or two, the ratio is not always there."""


def _lacking(header: str) -> str:
    """What is to be added above rows of blanks; numbers alone name no columns, and nothing is guessed from them."""
    words = header.split()
    if not all(_is_number(word.replace("/", "")) for word in words):
        return "; write commas between the names and between the fields"
    named = ". The rows have no header: add a line of names, with commas between all fields"
    if len(words) not in _SOLUTION_WORDS:
        return named
    return (
        f". The rows have no header. Of an RTKLIB solution in degrees and GPS time add as the first line “{SOLUTION_HEADER}” "
        "(out-outhead=on writes it; UTC in place of GPST where the times are UTC); of another table a line of names, with commas "
        "between all fields"
    )


def rows_of(path: Path, layout: Layout, lines: pl.DataFrame) -> Rows:
    """Take lines below the header apart.

    Raises
    ------
    FormatError
        Lines that do not make as many rows.
    """
    remarks, lines = lines.filter(pl.col("text").str.starts_with("#")), lines.filter(~pl.col("text").str.starts_with("#"))
    # Separators within quotation marks do not count; a quotation mark that is left over opens a field that does not end.
    bare = pl.col("text").str.replace_all(r'"[^"]*"', "")
    _require_line_ends(path, lines, bare)
    counted = lines.with_columns(n=bare.str.count_matches(layout.separator, literal=True) + 1, open=bare.str.contains('"', literal=True))
    n_fields = len(layout.names)
    # Of a field in quotation marks nothing stands behind the last of them. Fields are taken from the begin of the line on: a separator
    # and a doubled mark within a field begin no other one.
    sep = re.escape(layout.separator)
    behind = pl.col("text").str.contains(rf'^(?:(?:"(?:[^"]|"")*"|[^"{sep}][^{sep}]*)?{sep})*"(?:[^"]|"")*"[^"{sep}]')
    counted = counted.with_columns(unended="open", open=pl.col("open") | behind)
    good = counted.filter(pl.col("n") == n_fields, ~pl.col("open"))
    bad = counted.filter((pl.col("n") != n_fields) | pl.col("open"))
    refused = None
    if not bad.is_empty():
        text, line, n, unended = bad.select("text", LINE, "n", "unended").row(0)
        fields = f"first: {n}" if n != n_fields else "first: a quotation mark that does not enclose a field"
        what = "first: a quotation mark that opens a field and ends none; a field with a line break is not read" if unended else fields
        refused = (f"a row with another number of fields than the header's {n_fields} ({what})", bad.height, line, text)
    body = "\n".join([layout.header, *good["text"].to_list()]).encode()
    schema = dict.fromkeys(map(str, range(n_fields)), pl.String)
    try:
        frame = pl.read_csv(io.BytesIO(body), separator=layout.separator, has_header=False, skip_rows=1, schema=schema)
    except pl.exceptions.PolarsError as e:
        first = good.filter(pl.col("text").str.contains('"', literal=True))
        line = int(first[LINE][0]) if first.height else int(good[LINE][0])
        raise FormatError(path, "not a table: quotation marks that do not enclose whole fields", line) from e
    if frame.height != good.height:
        raise FormatError(path, f"not a table: {good.height} lines make {frame.height} rows")
    named = {str(i): name for i, name in enumerate(layout.names) if name}
    frame = _split(frame.select(named.keys()).rename(named), layout.pair)
    of_remarks = None
    if not remarks.is_empty():
        # One that states an alarm is shown before others.
        stated = remarks.filter(alarms(remarks["text"]).against.is_not_null())
        text, line = (stated if stated.height else remarks).select("text", LINE).row(0)
        of_remarks = (_REMARK, remarks.height, int(line), str(text))
    return Rows(frame.with_columns(good[LINE]), counted.height, refused, of_remarks)


_REMARK = "a line that begins with #, which is a remark"
"""What is counted of a line between rows that may say something of them."""


def _require_line_ends(path: Path, lines: pl.DataFrame, text: pl.Expr) -> None:
    """Refuse lines that end in CR alone: two rows and more would be one, with too many fields."""
    joined = lines.filter(text.str.contains("\r", literal=True))
    if not joined.is_empty():
        raise FormatError(path, "lines end in CR alone (\\r); write LF (\\n) or CR LF at their ends", int(joined[LINE][0]))


def _cells(line: str, separator: str) -> list[str]:
    """The fields of a line as they are written; a separator between quotation marks ends none."""
    fields = [list[str]()]
    for part in re.findall(rf'"[^"]*"|[^"{re.escape(separator)}]+|"|{re.escape(separator)}', line):
        if part == separator:
            fields.append([])
        else:
            fields[-1].append(part)
    return ["".join(parts) for parts in fields]


def _names(path: Path, header: str, separator: str, declared: Iterable[str]) -> list[str]:
    names = [n.strip().removeprefix('"').removesuffix('"').replace('""', '"') for n in _cells(header, separator)]
    require_few(path, len(names))
    repeated = [name for name, n in Counter(names).items() if n > 1 and name]
    # Which of them counts is a person's choice; without one nothing is guessed.
    selected = {value.rpartition("#")[0] for value in declared if re.search(r"#\d+(:\w+)?$", value)}
    if refused := [name for name in repeated if name not in selected]:
        n, name = names.count(refused[0]), refused[0]
        often = "twice" if n == 2 else f"{n} times"
        how = f"give one of them another name, or choose by place (#1 is the first); {declare(f'QUANTITY={name}#1')}"
        raise FormatError(path, f"the column “{name}” is named {often}; {how}", 1)
    for name in repeated:
        for place, at in enumerate([k for k, each in enumerate(names) if each == name], 1):
            names[at] = f"{name}#{place}"
    # Columns without a name (a data frame's index, what a person wrote beside, the separator at the end of a line) are seen by their place.
    return [name or ("" if f"column {k}" in names else f"column {k}") for k, name in enumerate(names, 1)]
