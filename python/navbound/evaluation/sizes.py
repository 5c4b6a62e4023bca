"""Sizes of errors from their components, of arrays and of columns of a table."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import polars as pl

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


def horizontal(error_m: Floats) -> Floats:
    """Horizontal sizes of errors whose first two components are east and north, shape (n, 2) or (n, 3); shape (n,). [m]."""
    size: Floats = np.hypot(error_m[:, 0], error_m[:, 1])
    return size


def spatial(error_m: Floats) -> Floats:
    """Sizes of errors of all their components, shape (n, k); shape (n,). [m]."""
    size: Floats = np.linalg.norm(error_m, axis=1)
    return size


def root_mean_square(values: Floats) -> float:
    """Root of the mean of the squares."""
    return float(np.sqrt(np.mean(np.square(values))))


def horizontal_of_columns() -> pl.Expr:
    """The horizontal size of the error of each row of an epoch table. [m]."""
    return (pl.col("nse_e_m").pow(2) + pl.col("nse_n_m").pow(2)).sqrt()


def root_mean_square_of(column: pl.Expr) -> pl.Expr:
    """The root of the mean of the squares of a column, or of each group."""
    return column.pow(2).mean().sqrt()
