"""JSON to a table: records, columns, an object a line, and what decoders of aircraft write."""

from __future__ import annotations

import json
import re
from collections import Counter
from typing import TYPE_CHECKING, Any

import polars as pl

from navbound.errors import FormatError
from navbound.read.checks.rejections import Rejections
from navbound.read.objects import readsb
from navbound.read.objects.structures import columns_of
from navbound.read.tables.cells import leaves, series
from navbound.read.tables.memory import require_free
from navbound.read.tables.table import Table, counted, require_few

if TYPE_CHECKING:
    from navbound.read.source import Source


def table(source: Source) -> Table:
    """Take a file of JSON apart.

    Raises
    ------
    FormatError
        It is no JSON or no table, or ends too early.
    """
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
    return Table(counted(frame), rejections, frame.height)


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
    names = columns_of(source.path, (keys for record in records for keys in record))
    return {name: [record.get(keys) for record in records] for keys, name in names.items()}
