"""Protection levels of a recording: a bound of nothing or less bounds nothing, so it is none."""

from __future__ import annotations

from typing import TYPE_CHECKING

import polars as pl

if TYPE_CHECKING:
    from collections.abc import Iterator

LEVELS = ("hpl_m", "vpl_m")

REASON = "0 or less is no protection level; row used without it"


def without_bound(out: pl.DataFrame) -> tuple[pl.DataFrame, dict[str, pl.Series]]:
    """Levels of 0 or less made null; and which rows of each column they were in, where there are any. [m]."""
    wrong = dict(_wrong(out))
    return out.with_columns(pl.select(pl.when(~at).then(out[name]).alias(name)).to_series() for name, at in wrong.items()), wrong


def _wrong(out: pl.DataFrame) -> Iterator[tuple[str, pl.Series]]:
    for name in LEVELS:
        if name in out.columns and out[name].dtype.is_numeric():
            at = (out[name] <= 0.0).fill_null(value=False)
            if at.any():
                yield name, at
