"""Approaches to one runway beside each other, and by operator: what the page overlays."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound.records.groups import DeviationBand, DeviationGroup
from navbound.run.summary.margins import with_margins
from navbound.storage.tables import pieces
from navbound.units import METRES_PER_NM

if TYPE_CHECKING:
    from navbound.methods import Method
    from navbound.storage.tables import Table

BIN_M = 0.5 * METRES_PER_NM
"""Width of a bin of the distance to the threshold. Provenance: ours."""
LEAST_FOR_BAND = 40
"""Epochs of a bin whose outer 2.5 % on either side hold one. [1]"""
HISTOGRAM_BINS = 41
"""Odd, so that the middle bin lies about zero."""
_OPERATOR = re.compile(r"^([A-Z]{3})[0-9]")
"""An ICAO flight identification: the operator's three letters, then a number."""


def approaches_of(epochs: Table, judged: Method) -> pl.DataFrame:
    """Epochs before a threshold with their margins, in memory; no rows where nothing is an approach to a runway."""
    names = ["track", "leg", "along_m", "fte_m", "fte_v_m", "est_h_m", "status", "rnp_m", "integrity_compared_m"]
    parts = [_approaches(with_margins(piece, judged)) for piece in pieces(epochs, [*names, judged.column, judged.integrity_column])]
    return pl.concat(parts, rechunk=True) if parts else pl.DataFrame()


def deviation_groups(margins: pl.DataFrame, labels: dict[str, str]) -> list[DeviationGroup]:
    """By runway, and by operator where callsigns name one; nothing where nothing is an approach to a runway."""
    approaches = _approaches(margins)
    if approaches.is_empty():
        return []
    prefixes = {track: code[1] for track, label in labels.items() if (code := _OPERATOR.match(label))}
    named = approaches.with_columns(operator=pl.col("track").replace_strict(prefixes, default=None, return_dtype=pl.String))
    return [*_grouped(named, "leg", "runway"), *_grouped(named.drop_nulls("operator"), "operator", "operator")]


def _approaches(epochs: pl.DataFrame) -> pl.DataFrame:
    """Epochs before a threshold: their distance along the path is counted to it, negative before it."""
    if not {"leg", "along_m", "fte_m"} <= set(epochs.columns):
        return epochs.clear()
    return epochs.filter(pl.col("leg").is_not_null() & (pl.col("along_m") < 0) & pl.col("fte_m").is_finite())


def _grouped(epochs: pl.DataFrame, column: str, by: str) -> list[DeviationGroup]:
    fte = pl.col("fte_m")
    furthest = fte.abs().arg_max()
    grouped = epochs.group_by(pl.col(column).alias("name"), maintain_order=True).agg(
        pl.col("track").n_unique().alias("n_tracks"),
        pl.len().alias("n_epochs"),
        fte.mean().alias("mean_m"),
        fte.std(ddof=0).alias("std_m"),
        fte.abs().quantile(0.95, interpolation="nearest").alias("abs95_m"),
        fte.get(furthest).alias("most_m"),
        pl.col("track").get(furthest).alias("most_track"),
        pl.col("_inside").mean().alias("share_inside"),
        pl.col("_ratio").max().alias("worst_ratio"),
    )
    return [DeviationGroup(by=by, **row) for row in grouped.sort("name").iter_rows(named=True)]


def deviation_bands(epochs: pl.DataFrame) -> list[DeviationBand]:
    """Envelope, 95 % band and histogram of the approaches to each runway, lateral and vertical."""
    approaches = _approaches(epochs)
    if approaches.is_empty():
        return []
    bands: list[DeviationBand] = []
    for (runway,), of in approaches.group_by("leg", maintain_order=True):
        above = next((name for name in ("fte_v_m", "est_h_m") if name in of.columns and of[name].is_finite().any()), None)
        bands += [_band(of.filter(pl.col(name).is_finite()), str(runway), name) for name in ("fte_m", above) if name is not None]
    return sorted(bands, key=lambda band: band.runway)


def _band(of: pl.DataFrame, runway: str, column: str) -> DeviationBand:
    place = (-pl.col("along_m") / BIN_M).floor().cast(pl.Int64).alias("bin")
    value, enough = pl.col(column), pl.len() >= LEAST_FOR_BAND
    bins = (
        of.group_by(place)
        .agg(
            n=pl.len(),
            least_m=value.min(),
            low_m=pl.when(enough).then(value.quantile(0.025, interpolation="nearest")),
            median_m=value.median(),
            high_m=pl.when(enough).then(value.quantile(0.975, interpolation="nearest")),
            most_m=value.max(),
        )
        .sort("bin")
    )
    edges, counts = _histogram(of[column].to_numpy()) if column != "est_h_m" else ([], [])
    return DeviationBand(
        runway=runway,
        column=column,
        n_tracks=of["track"].n_unique(),
        before_m=[(k + 0.5) * BIN_M for k in bins["bin"]],
        edges_m=edges,
        counts=counts,
        **{name: bins[name].to_list() for name in ("n", "least_m", "low_m", "median_m", "high_m", "most_m")},
    )


def _histogram(values: np.ndarray[tuple[int], np.dtype[np.float64]]) -> tuple[list[float], list[int]]:
    """Equal bins about zero, of a round width, up to the 99.5 % of the sizes; beyond is counted in the outer bins."""
    reach = float(np.quantile(np.abs(values), 0.995, method="higher"))
    width = 2 * reach / HISTOGRAM_BINS or 1.0
    decade = 10.0 ** math.floor(math.log10(width))
    width = next(factor * decade for factor in (1, 2, 5, 10) if factor * decade >= width)
    edges = (np.arange(HISTOGRAM_BINS + 1) - HISTOGRAM_BINS / 2) * width
    counts = np.histogram(np.clip(values, edges[0], edges[-1]), edges)[0]
    return edges.tolist(), counts.tolist()
