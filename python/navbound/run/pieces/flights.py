"""Flights of one vehicle: where its callsign changes in a long gap, the next flight begins."""

from __future__ import annotations

import polars as pl

from navbound.words.plurals import counted

LONGEST_GAP_S = 1800.0
"""A gap in which another flight may have begun is longer. [s] Provenance: ours."""
_MOST = 999
"""Flights of one track: their names are in order as texts. [1]"""


class Flights:
    """Divides tracks, in the order of track and time and in pieces of any length, at gaps in which the callsign changes."""

    def __init__(self, *, dividing: bool = True) -> None:
        self._dividing = dividing
        self._last: pl.DataFrame | None = None
        self._n = 0
        self._starts = list[pl.DataFrame]()

    def divide(self, epochs: pl.DataFrame) -> pl.DataFrame:
        """The next epochs; from its second flight on a track has the number of the flight in its name."""
        if not self._dividing or "callsign" not in epochs.columns:
            return epochs
        own = epochs.select("track", "time_ns", pl.col("callsign").str.strip_chars().replace("", None))
        rows = own if self._last is None else pl.concat([self._last, own])
        before = pl.col("callsign").forward_fill().over("track").shift(1).over("track")
        gap_s = pl.col("time_ns").diff().over("track").cast(pl.Float64) * 1e-9
        begins = ((gap_s > LONGEST_GAP_S) & (pl.col("callsign") != before)).fill_null(value=False)
        goes_on = pl.col("track") == rows["track"][0]
        carried = pl.when(goes_on).then(self._n if self._last is not None else 0).otherwise(0)
        n = (begins.cast(pl.Int64).cum_sum().over("track") + carried).clip(upper_bound=_MOST - 1)
        known = pl.col("callsign").forward_fill().over("track")
        marked = rows.with_columns(begins.alias("begins"), n.alias("n"), known.alias("known"))
        name = pl.when(pl.col("n") > 0).then(pl.format("{} #{}", "track", (pl.col("n") + 1).cast(pl.String).str.zfill(3)))
        marked = marked.with_columns(name.otherwise("track").alias("flight"))
        self._last = marked.tail(1).select("track", "time_ns", callsign="known")
        self._n = int(marked["n"][-1])
        self._starts.append(marked.filter("begins").select("track", "time_ns", "flight"))
        return epochs.with_columns(marked["flight"].tail(epochs.height).alias("track"))

    def divide_left_out(self, left_out: pl.DataFrame) -> pl.DataFrame:
        """Rows that cannot be judged, those after the start of a flight with its name; an unknown time is of the first."""
        starts = self._begun()
        if starts.is_empty() or left_out.is_empty():
            return left_out
        timed = left_out.drop_nulls("time_ns").sort("time_ns")
        joined = timed.join_asof(starts.sort("time_ns"), on="time_ns", by="track", check_sortedness=False)
        named = joined.select(pl.coalesce("flight", "track").alias("track"), "time_ns")
        return pl.concat([named, left_out.filter(pl.col("time_ns").is_null())])

    def words(self) -> list[str]:
        """How many tracks were divided; nothing where none was."""
        starts = self._begun()
        if starts.is_empty():
            return []
        n = starts["track"].n_unique()
        which = f"{counted(n, 'track was', 'tracks were')} divided into {n + starts.height} flights"
        return [
            f"Flights: {which}, where the callsign changes in a gap of more than {LONGEST_GAP_S / 60:.0f} min; such a gap holds no missing "
            "epochs."
        ]

    def _begun(self) -> pl.DataFrame:
        empty = pl.DataFrame(schema={"track": pl.String, "time_ns": pl.Int64, "flight": pl.String})
        return pl.concat([empty, *self._starts])
