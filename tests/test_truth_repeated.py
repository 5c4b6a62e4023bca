"""Two true positions of one time: nobody knows which is right, whichever stands first."""

from __future__ import annotations

from pathlib import Path

import polars as pl
import pytest

import navbound
from test_verdict import M_PER_RAD, table, white

N = 100


def repeated(path: Path, *, off_m: float, column: str, first: bool) -> Path:
    """A recording whose every row stands twice; the second time with another truth."""
    rows = pl.read_csv(table(path, N, error_en_m=0.5 * white(N)))
    off = rows.with_columns(pl.col(column) + off_m / (1.0 if column == "truth_h_m" else M_PER_RAD))
    pl.concat([off, rows] if first else [rows, off]).sort("time_ns", maintain_order=True).write_csv(path)
    return path


@pytest.mark.parametrize("first", [True, False])
@pytest.mark.parametrize("piece_rows", [None, 30])
@pytest.mark.parametrize("column", ["truth_lat_rad", "truth_lon_rad", "truth_h_m"])
def test_two_true_positions_of_one_time_are_counted_in_any_order(tmp_path: Path, column: str, piece_rows: int | None, first: bool) -> None:
    path = repeated(tmp_path / "a.csv", off_m=50.0, column=column, first=first)
    summary = navbound.analyze(path, piece_rows=piece_rows).summary
    assert (summary.verdict.id, summary.verdict.n_reason) == ("nothing_judged", {"invalid_number": N})
    (left_out,) = summary.rejected
    assert (left_out.count, "with another position, bound or status" in left_out.reason) == (N, True)


@pytest.mark.parametrize("first", [True, False])
def test_a_truth_in_other_digits_is_the_same(tmp_path: Path, first: bool) -> None:
    path = repeated(tmp_path / "a.csv", off_m=0.5, column="truth_lat_rad", first=first)
    assert navbound.analyze(path).summary.verdict.n_reason == {}
