"""Columns of structures, objects within records, to columns of their own."""

from __future__ import annotations

from collections import Counter
from functools import reduce
from typing import TYPE_CHECKING, cast

import polars as pl

from navbound.errors import FormatError
from navbound.read.tables.cells import DEEPEST

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path


def columns_of(path: Path, keys: Iterable[tuple[str, ...]]) -> dict[tuple[str, ...], str]:
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
    names = columns_of(path, leaves)
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
