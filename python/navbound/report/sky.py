"""The satellites that were heard, as the page is given them: sorted by satellite, thinned evenly where there are too many."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import polars as pl

from navbound.report import packing
from navbound.rnp.usual import breaks

if TYPE_CHECKING:
    from navbound.report.packing import Packed

MOST_ROWS = 40_000
"""Satellite-epochs of a run that are embedded, about 0.4 MB; a day of twenty satellites every 30 s has 58 000. [1]"""
_NUMBERS = ("az_rad", "el_rad", "residual_m", "cn0_dbhz")
_WORDS = ("sv", "fate")


@dataclass(frozen=True)
class Sky:
    """Heads and text blocks, one a receiver, and a sentence on what they leave out."""

    heads: list[dict[str, object]]
    blocks: list[str]
    words: list[str]


def pack(heard: pl.DataFrame | None) -> Sky:
    """Every receiver's satellites, at every epoch or at every second, third, ... one."""
    if heard is None or heard.is_empty():
        return Sky([], [], [])
    every = -(-heard.height // MOST_ROWS)
    heads, blocks = [], []
    for (track,), of in heard.group_by("track", maintain_order=True):
        kept = of.filter(pl.col("time_ns").rank("dense").cast(pl.Int64) % every == 1 % every).sort("sv", "time_ns")
        start_ns = int(kept["time_ns"].min())  # type: ignore[arg-type]
        packed: list[Packed] = [packing.pack("elapsed_s", ((kept["time_ns"] - start_ns).cast(pl.Float64) * 1e-9).to_numpy())]
        packed += [packing.pack(name, kept[name].cast(pl.Float64).fill_null(float("nan")).to_numpy()) for name in _NUMBERS]
        heads.append(
            {
                "track": track,
                "n": kept.height,
                "start_ns": str(start_ns),
                # Of the epochs, at each of which several satellites are heard.
                "breaks": breaks(kept["time_ns"].unique().sort().to_numpy()).tolist(),
                "columns": [p.head() for p in packed],
                "words": {name: packing.run_lengths(kept[name]) for name in _WORDS},
            }
        )
        blocks.append(packing.deflate(packed))
    words = [] if every == 1 else [f"The charts of satellites show one epoch in {every}; their table counts all."]
    return Sky(heads, blocks, words)
