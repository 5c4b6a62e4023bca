"""A file of a table to its columns: text with separators, JSON, or Parquet."""

from __future__ import annotations

import io
import re
from typing import TYPE_CHECKING

import polars as pl

from navbound.errors import FormatError
from navbound.read.checks.rejections import Rejections
from navbound.read.objects import of_json
from navbound.read.objects.structures import apart
from navbound.read.tables.memory import require_free
from navbound.read.tables.table import Table, counted, layout_of, lines_of, require_few, rows_of
from navbound.storage import packed

if TYPE_CHECKING:
    from collections.abc import Iterable

    from navbound.read.source import Source


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
    content = _csv(source, declared) if source.kind == "csv" else {"json": of_json.table, "parquet": _parquet}[source.kind](source)
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
    return Table(counted(frame), Rejections(source.path, "record"), frame.height)


def words_of(error: Exception) -> str:
    """The first sentence of the table library, without what it advises its own users."""
    return re.split(r"\n|\. |, (?:try|consider)|You might", str(error), maxsplit=1)[0].strip()[:160]
