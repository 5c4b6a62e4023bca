"""Epochs by phase, by track, and by phase against the alert limit."""

from __future__ import annotations

import polars as pl

from navbound.records.run import PhaseSummary, ProtectionSummary, TrackSummary
from navbound.status import USABLE


def phases(margins: pl.DataFrame, bound: str, sample_period_s: float, events: pl.DataFrame) -> list[PhaseSummary]:
    """Every phase with one RNP value."""
    if "phase" not in margins.columns:
        return []
    covered = pl.lit(None, dtype=pl.Float64)
    if "tse_m" in margins.columns and bound.startswith("tse"):
        covered = (pl.col("tse_m").abs() <= pl.col(bound)).cast(pl.Float64).mean()
    risk = pl.col("p_exceed_2rnp") if "p_exceed_2rnp" in margins.columns else pl.lit(None, dtype=pl.Float64)
    grouped = margins.group_by("phase", "rnp_m", maintain_order=True).agg(
        pl.len().alias("n_epochs"),
        pl.col("_inside").mean().alias("share_inside"),
        pl.col("_ratio").max().alias("worst_ratio"),
        risk.max().alias("p_exceed_2rnp_max"),
        risk.mean().alias("p_exceed_2rnp_mean"),
        covered.alias("coverage"),
    )
    phase_of = margins.select("track", pl.col("time_ns").alias("onset_ns"), "phase", "rnp_m")
    alerts = events.filter(pl.col("kind").is_in(["caution", "warning"])).join(phase_of, on=["track", "onset_ns"])
    counts = {(phase, limit, kind): n for phase, limit, kind, n in alerts.group_by("phase", "rnp_m", "kind").len().iter_rows()}
    return [
        PhaseSummary(
            **row,
            duration_s=row["n_epochs"] * sample_period_s,
            n_cautions=counts.get((row["phase"], row["rnp_m"], "caution"), 0),
            n_warnings=counts.get((row["phase"], row["rnp_m"], "warning"), 0),
        )
        for row in grouped.iter_rows(named=True)
    ]


def protection_of(epochs: pl.DataFrame, provenance: dict[str, str]) -> list[ProtectionSummary]:
    """Protection levels against the alert limit of each phase whose limit says how it is held."""
    if not (provenance and {"phase", "hpl_m", "hal_m"} <= set(epochs.columns)):
        return []

    def most(name: str) -> pl.Expr:
        return pl.col(name).max() if name in epochs.columns else pl.lit(None, dtype=pl.Float64)

    truth = "nse_h_m" in epochs.columns
    usable = pl.col("status").is_in(USABLE)
    misleading = (usable & (pl.col("nse_h_m") > pl.col("hpl_m"))).sum() if truth else pl.lit(0)
    grouped = epochs.group_by("phase", "hal_m", maintain_order=True).agg(
        pl.len().alias("n_epochs"),
        most("hpl_m").alias("hpl_max_m"),
        most("hpl_multi_m").alias("hpl_multi_max_m"),
        most("nse_h_m").alias("hpe_max_m"),
        most("accuracy_m").alias("accuracy_max_m"),
        most("accuracy_limit_m").alias("accuracy_limit_m"),
        (pl.col("hpl_m") <= pl.col("hal_m")).fill_null(value=False).mean().alias("share_available"),
        misleading.alias("n_misleading"),
    )
    return [ProtectionSummary(**row, hal_held=provenance[row["phase"]]) for row in grouped.iter_rows(named=True)]


def tracks(margins: pl.DataFrame, labels: dict[str, str], events: pl.DataFrame) -> list[TrackSummary]:
    """Every track."""
    fte = pl.col("fte_m") if "fte_m" in margins.columns else pl.lit(None, dtype=pl.Float64)
    grouped = margins.group_by("track", maintain_order=True).agg(
        pl.len().alias("n_epochs"),
        pl.col("time_ns").min().alias("start_ns"),
        ((pl.col("time_ns").max() - pl.col("time_ns").min()).cast(pl.Float64) * 1e-9).alias("duration_s"),
        fte.mean().alias("fte_mean_m"),
        fte.std(ddof=0).alias("fte_std_m"),
        fte.abs().quantile(0.95, interpolation="nearest").alias("fte_abs95_m"),
        pl.col("_inside").mean().alias("share_inside"),
        pl.col("_ratio").max().alias("worst_ratio"),
        pl.col("_margin").min().alias("worst_margin_m"),
    )
    counts = {(track, kind): n for track, kind, n in events.group_by("track", "kind").len().iter_rows()}
    return [
        TrackSummary(
            **row,
            label=labels.get(row["track"], row["track"]),
            n_cautions=counts.get((row["track"], "caution"), 0),
            n_warnings=counts.get((row["track"], "warning"), 0),
            n_unavailable=counts.get((row["track"], "unavailable"), 0),
        )
        for row in grouped.iter_rows(named=True)
    ]
