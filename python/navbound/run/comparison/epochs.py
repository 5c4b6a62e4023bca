"""The epoch tables of two runs, by track and time."""

from __future__ import annotations

from typing import get_args

import polars as pl

from navbound.errors import InputError
from navbound.records.comparison import ChangedCount, ChangedWords, MovedColumn
from navbound.table.declare import UNITS, unit_of

KEY = ["track", "time_ns"]
WORDS: tuple[str, ...] = get_args(ChangedWords.model_fields["column"].annotation)
"""Columns of words whose changes are reported."""
_OF_B = "_of_b"


def joined(a: pl.DataFrame, b: pl.DataFrame) -> pl.DataFrame:
    """Epochs of both, in the order of tracks and times; columns of B have an ending of their own.

    Raises
    ------
    InputError
        A run that holds an epoch twice.
    """
    for name, epochs in (("a", a), ("b", b)):
        if epochs.select(KEY).is_duplicated().any():
            raise InputError(name, "an epoch twice", domain="runs that hold each time of a track once")
    return a.join(b, on=KEY, how="inner", suffix=_OF_B).sort(KEY)


def columns(both: pl.DataFrame, a: pl.DataFrame, b: pl.DataFrame) -> tuple[list[MovedColumn], int]:
    """Columns of numbers that moved, the most epochs first; how many did not."""
    shared = [
        name for name in a.columns if name in b.columns and name not in KEY and a[name].dtype.is_numeric() and b[name].dtype.is_numeric()
    ]
    moved = [column for name in shared if (column := _column(both, name)) is not None]
    return sorted(moved, key=lambda column: (-column.n_moved - column.n_only_a - column.n_only_b, column.column)), len(shared) - len(moved)


def _column(both: pl.DataFrame, name: str) -> MovedColumn | None:
    pair = both.select(*KEY, a=pl.col(name).cast(pl.Float64).fill_nan(None), b=pl.col(f"{name}{_OF_B}").cast(pl.Float64).fill_nan(None))
    # Two infinities are the same number, and have no difference.
    differ = pair.filter(pl.col("a").ne_missing(pl.col("b")))
    if differ.is_empty():
        return None
    compared = differ.drop_nulls().with_columns(difference=pl.col("b") - pl.col("a"))
    furthest = compared.row(int(compared["difference"].abs().arg_max() or 0), named=True) if compared.height else None
    return MovedColumn(
        column=name,
        unit=UNITS[unit_of(name)],
        n_moved=compared.height,
        n_only_a=differ["b"].null_count(),
        n_only_b=differ["a"].null_count(),
        largest=None if furthest is None else furthest["difference"],
        track=None if furthest is None else furthest["track"],
        time_ns=None if furthest is None else furthest["time_ns"],
    )


def changes(both: pl.DataFrame) -> tuple[list[ChangedWords], list[ChangedCount]]:
    """Epochs whose words changed, as runs; and how many there are of each change."""
    spans: list[ChangedWords] = []
    counts: list[ChangedCount] = []
    for name in WORDS:
        if f"{name}{_OF_B}" not in both.columns:
            continue
        pair = both.select(*KEY, a=name, b=f"{name}{_OF_B}").with_row_index("row").filter(pl.col("a").ne_missing(pl.col("b")))
        # Runs of epochs that follow each other in both tables.
        begins = pl.any_horizontal(pl.col(c).ne_missing(pl.col(c).shift()) for c in ("track", "a", "b")) | (pl.col("row").diff() != 1)
        runs = pair.with_columns(run=begins.fill_null(value=True).cum_sum()).group_by("run", maintain_order=True)
        of_runs = runs.agg(
            *(pl.col(c).first() for c in ("track", "a", "b")),
            start_ns=pl.col("time_ns").first(),
            end_ns=pl.col("time_ns").last(),
            n_epochs=pl.len(),
        ).drop("run")
        spans += [ChangedWords(column=name, **row) for row in of_runs.iter_rows(named=True)]
        every = pair.group_by("a", "b").agg(n_epochs=pl.len()).sort("n_epochs", "a", "b", descending=[True, False, False])
        counts += [ChangedCount(column=name, **row) for row in every.iter_rows(named=True)]
    return spans, counts
