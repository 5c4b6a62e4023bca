"""The satellites of an evaluation's solutions, for the pictures of the sky and the table of who was used."""

from __future__ import annotations

from typing import TYPE_CHECKING

import polars as pl

from navbound.gnss.receivers import USED
from navbound.table.columns import HEARD
from navbound.table.declare import schema
from navbound.words.plurals import agreeing

if TYPE_CHECKING:
    from collections.abc import Iterable

    from navbound.sbas.positions import CorrectedPositions

MOST_HEARD = 2_000_000
"""Satellite-epochs that are kept: a day at one a second, or a month at one every 30 s; 160 MB."""

OF_SOLUTIONS = "The satellites listed are those of the solutions; the others that were heard are not listed one by one."
"""Of positions with a service's corrections."""


def of_service(positions: CorrectedPositions) -> pl.DataFrame:
    """The satellites of each solution with a service's corrections, as columns of `HEARD`."""
    epochs, each = positions.epochs, positions.satellites
    return each.select(
        track=epochs["track"].gather(each["epoch"]),
        time_ns=epochs["time_ns"].gather(each["epoch"]),
        sv=pl.format("G{}", pl.col("prn").cast(pl.String).str.zfill(2)),
        fate=pl.lit(USED),
        az_rad="az_rad",
        el_rad="el_rad",
        cn0_dbhz=pl.lit(None, pl.Float64),
        residual_m="residual_m",
        sigma_m="sigma_m",
    )


def together(of_parts: Iterable[pl.DataFrame | None]) -> tuple[pl.DataFrame | None, list[str]]:
    """The satellites of the first parts, as many as are kept, and words on that."""
    kept, n_parts, n_more = list[pl.DataFrame](), 0, 0
    for part in of_parts:
        if part is None or part.is_empty():
            continue
        if kept and sum(each.height for each in kept) + part.height > MOST_HEARD:
            n_more += 1
            continue
        n_parts += 1
        kept.append(part.select(schema(HEARD).names()))
    if not kept:
        return None, []
    words = [f"The satellites are those of {n_parts} files; {n_more} more {agreeing(n_more, 'is', 'are')} not shown."] if n_more else []
    return pl.concat(kept).cast(schema(HEARD)), words
