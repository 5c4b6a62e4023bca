"""Directions to satellites in columns of a table."""

from __future__ import annotations

import polars as pl


def towards(east: str, north: str, up: str) -> pl.Expr:
    """The part of a vector that points to the satellite of each row, at its `az_rad` and `el_rad`; in the unit of the vector."""
    level = pl.col("az_rad").sin() * pl.col(east) + pl.col("az_rad").cos() * pl.col(north)
    return pl.col("el_rad").cos() * level + pl.col("el_rad").sin() * pl.col(up)
