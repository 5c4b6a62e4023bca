"""A Parquet file in batches of rows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import polars as pl

from navbound.errors import FormatError
from navbound.read.objects.structures import apart
from navbound.read.tables.load import words_of
from navbound.read.tables.table import require_few

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_SIGN = b"PAR1"


def is_parquet(path: Path) -> bool:
    """Whether a file begins as a Parquet file."""
    try:
        with path.open("rb") as file:
            return file.read(len(_SIGN)) == _SIGN
    except OSError:
        # Whoever reads it says what is wrong.
        return False


def shape(path: Path) -> tuple[int, list[str]]:
    """Rows, and names of the columns, as the end of the file states them.

    Raises
    ------
    FormatError
        A damaged file, or one of very many columns.
    """
    try:
        stated = pl.scan_parquet(path)
        require_few(path, len(stated.collect_schema()))
        names = apart(path, stated.head(0).collect()).columns
        return int(stated.select(pl.len()).collect().item()), names
    except (pl.exceptions.PolarsError, OSError) as e:
        raise FormatError(path, f"damaged Parquet file: {words_of(e)}") from e


def batches(path: Path, n_rows: int) -> Iterator[pl.DataFrame]:
    """The rows in order, in batches of at most so many. What is unpacked at a time are a few groups of rows as the file has them.

    Raises
    ------
    FormatError
        A damaged file.
    """
    total, _ = shape(path)
    seen = 0
    try:
        for batch in pl.scan_parquet(path).collect_batches(chunk_size=n_rows, maintain_order=True):
            seen += batch.height
            for begin in range(0, batch.height, n_rows):
                yield apart(path, batch.slice(begin, n_rows))
    except (pl.exceptions.PolarsError, OSError) as e:
        raise FormatError(path, f"damaged Parquet file: {words_of(e)}") from e
    if seen != total:
        raise FormatError(path, f"damaged Parquet file: its end states {total} rows, and {seen} are in it")
