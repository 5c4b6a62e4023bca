"""Any table to columns of text or numbers, with the line each row stands on."""

from __future__ import annotations

import io
import json
import re
from collections import Counter
from dataclasses import dataclass, replace
from functools import reduce
from typing import TYPE_CHECKING, Any, cast

import polars as pl

from navbound.errors import FormatError
from navbound.read.checks.rejections import Rejections
from navbound.read.columns.naming import declare
from navbound.read.statements.texts import alarms
from navbound.read.tables import readsb
from navbound.read.tables.cells import DEEPEST, leaves, series
from navbound.read.tables.memory import require_free
from navbound.storage import packed

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from navbound.read.source import Source

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


def table(source: Source, declared: Iterable[str] = ()) -> Table:
    """Take a CSV, JSON or Parquet file apart.

    Parameters
    ----------
    source : Source
        The file.
    declared : iterable of str
        ``column`` or ``column:unit`` as a caller declares them; ``column#2`` is the second column of a name that stands twice.

    Raises
    ------
    FormatError
        The file is none of these, has no rows, or its columns differ in length.
    """
    content = _csv(source, declared) if source.kind == "csv" else {"json": _json, "parquet": _parquet}[source.kind](source)
    if content.n_rows == 0:
        raise FormatError(source.path, "no rows below the header")
    content.rejections.refuse_if_too_many(content.n_rows)
    return content


def _csv(source: Source, declared: Iterable[str]) -> Table:
    """Text lines with a separator; lines with another number of fields than the header are left out and counted."""
    require_free(source, source.content.count(b"\n"))
    lines = lines_of(source.text(), 1)
    if lines.is_empty():
        raise FormatError(source.path, "nothing but comments")
    layout = layout_of(source.path, lines, declared)
    rows = rows_of(source.path, layout, lines[1:])
    rejections = Rejections(source.path)
    if rows.bad is not None:
        rejections.add(*rows.bad)
    if rows.remarks is not None:
        rejections.add(*rows.remarks, malformed=False)
    return Table(rows.frame, rejections, rows.n_rows)


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
    return pl.concat([before, rest]) if not before.is_empty() and _names_of(before["text"][0], rest["text"][0]) else rest


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
    layout = Layout(header, separator, _names(path, header, separator, declared))
    pairs = [name for name in layout.names if name.strip().lower() in _PAIRS]
    if len(pairs) != 1:
        return layout
    fields = rows_of(path, layout, lines[1 : 1 + _SAMPLE]).frame[pairs[0]].str.strip_chars()
    return replace(layout, pair=pairs[0]) if (fields.is_null() | (fields == "") | fields.str.contains(_PAIR)).all() else layout


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


def _parquet(source: Source) -> Table:
    try:
        stated = pl.scan_parquet(io.BytesIO(source.content))
        n_columns = len(stated.collect_schema())
        require_few(source.path, n_columns)
        n_rows = stated.select(pl.len()).collect().item()
        # Eight bytes a field: a column of one value packs to nothing.
        packed.require_room(source.path, len(source.content), 8 * n_rows * n_columns)
        require_free(source, n_rows)
        frame = apart(source.path, pl.read_parquet(io.BytesIO(source.content)))
    except (pl.exceptions.PolarsError, OSError) as e:
        raise FormatError(source.path, f"damaged Parquet file: {words_of(e)}") from e
    return Table(_counted(frame), Rejections(source.path, "record"), frame.height)


def _columns_of(path: Path, keys: Iterable[tuple[str, ...]]) -> dict[tuple[str, ...], str]:
    """What a value in objects is called, by the keys that lead to it: by the last of them, unless another value has that name."""
    keys = list(dict.fromkeys(keys))
    n_of = Counter(each[-1] for each in keys)
    names = {each: each[-1] if len(each) == 1 or n_of[each[-1]] == 1 else ".".join(each) for each in keys}
    repeated = next((name for name, n in Counter(names.values()).items() if n > 1), None)
    if repeated is not None:
        raise FormatError(path, f"the key “{repeated}” is that of two columns", field=repeated)
    return names


def apart(path: Path, frame: pl.DataFrame) -> pl.DataFrame:
    """What columns of structures hold, as columns of their own; words of a list of categories and bytes of a text are texts."""
    leaves = [each for name, dtype in frame.schema.items() for each in _leaves((name,), dtype)]
    if len(leaves) == frame.width and all(len(each) == 1 for each in leaves):
        return _in_texts(frame)
    names = _columns_of(path, leaves)
    within = {each: reduce(lambda of, key: of.struct.field(key), each[1:], pl.col(each[0])) for each in leaves}
    return _in_texts(frame.select(column.alias(names[each]) for each, column in within.items()))


def _in_texts(frame: pl.DataFrame) -> pl.DataFrame:
    of_texts = pl.selectors.categorical() | pl.selectors.enum() | pl.selectors.binary()
    return frame.with_columns(of_texts.cast(pl.String, strict=False))


def _leaves(keys: tuple[str, ...], dtype: pl.DataType) -> Iterator[tuple[str, ...]]:
    if isinstance(dtype, pl.Struct) and len(keys) <= DEEPEST:
        for part in dtype.fields:
            yield from _leaves((*keys, part.name), cast("pl.DataType", part.dtype))
    else:
        yield keys


def words_of(error: Exception) -> str:
    """The first sentence of the table library, without what it advises its own users."""
    return re.split(r"\n|\. |, (?:try|consider)|You might", str(error), maxsplit=1)[0].strip()[:160]


def _json(source: Source) -> Table:
    # A record is an object; a row of a table of columns, or of a trace, is some twenty fields between commas.
    require_free(source, max(source.content.count(b"{"), source.content.count(b",") // 20))
    try:
        data = _json_of(source)
    except RecursionError as e:
        raise FormatError(source.path, "not a table: JSON nested too deeply") from e
    rejections = Rejections(source.path, "record")
    if isinstance(data, dict) and isinstance(data.get("trace"), list):
        columns = readsb.columns_of(source, data)
    elif readsb.is_snapshot(data):
        columns = _records(source, readsb.records_of(source.path, [data]))
    elif isinstance(data, dict):
        rows = {tuple(values) for values in data.values() if isinstance(values, dict)}
        if len(rows) > 1:
            raise FormatError(source.path, "not a table: its columns name different rows")
        columns = {name: _column(source, name, values) for name, values in data.items()}
    else:
        joined = isinstance(data, list) and bool(data) and readsb.is_snapshot(data[0])
        columns = _records(source, readsb.records_of(source.path, data) if joined else data)
    require_few(source.path, len(columns))
    lengths = {len(values) for values in columns.values()}
    if len(lengths) != 1:
        raise FormatError(
            source.path, f"not a table: columns of {' and '.join(map(str, sorted(lengths)))} items" if lengths else "no columns"
        )
    frame = pl.DataFrame({name: series(name, values) for name, values in columns.items()})
    return Table(_counted(frame), rejections, frame.height)


def _json_of(source: Source) -> Any:
    """One value, or an object a line."""
    decoder = json.JSONDecoder(object_pairs_hook=lambda pairs: _unrepeated(source, pairs), parse_int=_whole_number)
    text = source.text()
    try:
        return _whole_characters(source, text, decoder.decode(text))
    except json.JSONDecodeError as e:
        if e.msg != "Extra data" or not text.lstrip().startswith("{"):
            raise _refused(source, "not JSON", e, e.lineno, text[e.pos :]) from e
    records, lines = list[Any](), text.rstrip().splitlines()
    for number, line in enumerate(lines, 1):
        if line.strip():
            try:
                records.append(decoder.decode(line))
            except json.JSONDecodeError as e:
                rest = line[e.pos :] if number == len(lines) else None
                raise _refused(source, "not an object of JSON on each line", e, number, rest) from e
    return _whole_characters(source, text, records)


_CUT = r'\s*("([^"\\]|\\.)*\\?|-?[\d.eE+-]*|t(ru?)?|f(a(ls?)?)?|n(ul?)?|u\w*)\s*'
"""What is left of a text that ends within a value, from where a parser refuses it."""


def _refused(source: Source, what: str, error: json.JSONDecodeError, line: int, rest: str | None) -> FormatError:
    """A text that ends too early is named as one, by its `rest` from the error on; anything else is what the parser says."""
    if rest is None or error.msg == "Extra data" or not re.fullmatch(_CUT, rest):
        return FormatError(source.path, f"{what}: {error.msg}", line)
    where = f"the text ends in line {line}, after byte {len(source.content.rstrip())}, within an object, a list or a value"
    return FormatError(source.path, f"{what}: {where}; the file looks cut: get it whole, or take the unfinished record out", line)


_MOST_DIGITS = 20
"""Those of an integer of 64 bits with its sign. [1]"""


def _whole_number(text: str) -> int | float:
    """An integer; one that no column of integers holds is a number as large, or infinite."""
    return int(text) if len(text) <= _MOST_DIGITS else float(text)


def _whole_characters(source: Source, text: str, content: Any) -> Any:
    """Refuse half of a character (U+D800 to U+DFFF alone): it can be decoded, and not written anywhere."""
    if re.search(r"\\u[dD][89a-fA-F]", text):
        try:
            json.dumps(content, ensure_ascii=False).encode()
        except UnicodeEncodeError as e:
            half = f"\\u{ord(e.object[e.start]):04x}"
            raise FormatError(source.path, f"half of a character: {half} without the other half of its pair") from e
    return content


def _unrepeated(source: Source, pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Refuse an object that states a key twice: only one of the two would be read."""
    content = dict(pairs)
    if len(content) < len(pairs):
        repeated = next(name for name, n in Counter(name for name, _ in pairs).items() if n > 1)
        raise FormatError(source.path, f"an object has the key “{repeated}” twice", field=repeated)
    return content


def _counted(frame: pl.DataFrame) -> pl.DataFrame:
    return frame.with_columns(pl.int_range(1, pl.len() + 1).alias(LINE))


def _column(source: Source, name: str, values: Any) -> list[Any]:
    """Take a column of the form {"0": v, "1": v} or [v, v]."""
    if isinstance(values, dict):
        return list(values.values())
    if isinstance(values, list):
        return values
    raise FormatError(source.path, f"not a table: “{name}” is neither a column {{row: value}} nor a list", field=name)


def _records(source: Source, data: list[Any]) -> dict[str, list[Any]]:
    """Turn a list of objects into columns; a key that a record lacks is empty there."""
    if not data or not all(isinstance(record, dict) for record in data):
        raise FormatError(source.path, "not a table: a list of records {column: value} is needed")
    records = [dict(leaves(record)) for record in data]
    names = _columns_of(source.path, (keys for record in records for keys in record))
    return {name: [record.get(keys) for record in records] for keys, name in names.items()}
