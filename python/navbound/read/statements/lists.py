"""Lists of values that others computed, in columns of tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

import polars as pl

from navbound.read.own_positions import CLAIMS, OF_PLACE

if TYPE_CHECKING:
    from collections.abc import Iterable


def without_lists(frame: pl.DataFrame, names: Iterable[str]) -> pl.DataFrame:
    """The named columns with whether a list of each row has the position; what is no list stays as it is.

    An accuracy or an integrity that a list has is none of the aircraft's: the row does not state it.
    """
    replaced, of_others = list[pl.Expr](), {name: list[pl.Expr]() for name in CLAIMS if name in frame.columns}
    for name in names:
        dtype = frame.schema[name]
        if isinstance(dtype, pl.List) and not dtype.inner.is_nested():
            listed = pl.col(name).cast(pl.List(pl.String))
            has = pl.any_horizontal(listed.list.contains(pl.lit(each)) for each in OF_PLACE)
            # A row without a list names nothing.
            replaced.append(has.fill_null(value=False).alias(name))
            for claim, listing in of_others.items():
                listing.append(listed.list.contains(pl.lit(claim)).fill_null(value=False))
        elif dtype == pl.String:
            text, is_list = pl.col(name), pl.col(name).str.strip_chars().str.starts_with("[").fill_null(value=False)
            has = text.str.contains(_listing("|".join(OF_PLACE))).cast(pl.String)
            replaced.append(pl.when(is_list).then(has).otherwise(text).alias(name))
            for claim, listing in of_others.items():
                listing.append(is_list & text.str.contains(_listing(claim)).fill_null(value=False))
    own = [pl.when(~pl.any_horizontal(listing)).then(pl.col(claim)).alias(claim) for claim, listing in of_others.items() if listing]
    return frame.with_columns(*replaced, *own)


def _listing(words: str) -> str:
    return rf"""["'\s\[,]({words})["'\s\],]"""
