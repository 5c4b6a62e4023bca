"""Rows of one track and one time: the same position again, or another one, of which none can be believed."""

from __future__ import annotations

from dataclasses import dataclass

import polars as pl

from navbound import status

SAME_PLACE_M = 1.0
"""Distance up to which two positions of one time are one, written with other digits. [m] Provenance: ours; five decimals of a degree."""

EARTH_RADIUS_M = 6_371_000.0

LEFT_OUT = {"track": pl.String, "time_ns": pl.Int64}
"""Rows of a recording that cannot be judged: which track, and when (null where not even the time is known)."""

_SENTENCE = "another position has the same time"


@dataclass(frozen=True)
class Repeats:
    """What became of rows that share a time.

    Attributes
    ----------
    epochs : DataFrame
        One row a time; a contradicted one has status ``invalid_input``.
    identical, contradicting : DataFrame
        Rows left out: those that repeat the first row of their time, and those of another position.
    """

    epochs: pl.DataFrame
    identical: pl.DataFrame
    contradicting: pl.DataFrame


def separate(epochs: pl.DataFrame) -> Repeats:
    """One row a time out of rows sorted by track and time.

    Two positions of one time that lie further apart than `SAME_PLACE_M` contradict each other. Nobody knows which of them is right, so the
    epoch is not believed (``position_jump``: no vehicle is in two places).
    """
    key = ["track", "time_ns"]
    again = (pl.all_horizontal(pl.col(k) == pl.col(k).shift(1) for k in key)).fill_null(value=False)
    if not epochs.select(again.any()).item():
        return Repeats(epochs, epochs.clear(), epochs.clear())
    lat, lon = pl.col("est_lat_rad"), pl.col("est_lon_rad")
    north = EARTH_RADIUS_M * (lat - lat.first().over(key))
    # A meridian and the same one a turn further are one.
    east = EARTH_RADIUS_M * lat.cos() * ((lon - lon.first().over(key)) / 2).sin() * 2
    here = {"est_lat_rad", "est_lon_rad"} <= set(epochs.columns)
    # A NaN is no small distance.
    same = (north**2 + east**2 <= SAME_PLACE_M**2).fill_null(value=False) if here else pl.lit(value=True)
    marked = epochs.with_columns(again.alias("__again"), (~same).alias("__other"))
    marked = marked.with_columns(pl.col("__other").any().over(key).alias("__doubted"))
    first = marked.filter(~pl.col("__again"))
    doubted = first["__doubted"]
    kept = first.drop("__again", "__other", "__doubted")
    if doubted.any():
        if "status" not in kept.columns:
            kept = kept.with_columns(pl.lit("ok").alias("status"))
        mark = pl.DataFrame({"doubted": doubted}).select(
            reason_id=pl.when("doubted").then(pl.lit("position_jump")), sentence=pl.when("doubted").then(pl.lit(_SENTENCE))
        )
        kept = status.overridden(kept, mark["reason_id"], mark["sentence"])
    repeated = marked.filter("__again")
    plain = repeated.drop("__again", "__other", "__doubted")
    return Repeats(kept, plain.filter(~repeated["__other"]), plain.filter(repeated["__other"]))


def left_out(rows: pl.DataFrame) -> pl.DataFrame:
    """Track and time of rows that cannot be judged."""
    return rows.select(pl.col(name).cast(dtype) for name, dtype in LEFT_OUT.items())
