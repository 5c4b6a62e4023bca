"""Epochs by phase, by track, and by phase against the alert limit."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import polars as pl

from navbound.records.run import PhaseSummary, ProtectionSummary, TrackSummary
from navbound.run.summary.sums import Deviation
from navbound.status import USABLE
from navbound.storage.tables import pieces

if TYPE_CHECKING:
    from navbound.run.summary.sums import Sums
    from navbound.storage.tables import Table


def phases(sums: Sums, sample_period_s: float) -> list[PhaseSummary]:
    """Every phase with one RNP value."""
    return [
        PhaseSummary(
            phase=phase,
            rnp_m=limit,
            n_epochs=group.n,
            duration_s=group.n * sample_period_s,
            share_inside=group.share_inside,
            worst_ratio=group.worst_ratio,
            p_exceed_2rnp_max=group.risk_max,
            p_exceed_2rnp_mean=sums.mean_risk(phase, limit),
            coverage=group.coverage,
            n_cautions=sums.alerts[phase, limit, "caution"],
            n_warnings=sums.alerts[phase, limit, "warning"],
        )
        for (phase, limit), group in sums.phases.items()
    ]


_MOST = ("hpl_m", "hpl_multi_m", "nse_h_m", "accuracy_m", "accuracy_limit_m")


def protection_of(epochs: Table, provenance: dict[str, str]) -> list[ProtectionSummary]:
    """Protection levels against the alert limit of each phase whose limit says how it is held."""
    if not (provenance and {"phase", "hpl_m", "hal_m"} <= set(epochs.columns)):
        return []
    parts = [_protection(piece) for piece in pieces(epochs, ["phase", "hal_m", "status", *_MOST])]
    together = pl.concat(parts).group_by("phase", "hal_m", maintain_order=True)
    grouped = together.agg(pl.col("n", "n_available", "n_misleading").sum(), pl.col(_MOST).max())
    return [_protection_summary(row, provenance) for row in grouped.iter_rows(named=True)]


def _protection(epochs: pl.DataFrame) -> pl.DataFrame:
    """Counts and largest values of a piece."""

    def most(name: str) -> pl.Expr:
        return (pl.col(name).max() if name in epochs.columns else pl.lit(None, dtype=pl.Float64)).alias(name)

    usable = pl.col("status").is_in(USABLE)
    misleading = (usable & (pl.col("nse_h_m") > pl.col("hpl_m"))).sum() if "nse_h_m" in epochs.columns else pl.lit(0)
    return epochs.group_by("phase", "hal_m", maintain_order=True).agg(
        pl.len().cast(pl.Int64).alias("n"),
        (pl.col("hpl_m") <= pl.col("hal_m")).fill_null(value=False).sum().cast(pl.Int64).alias("n_available"),
        misleading.cast(pl.Int64).alias("n_misleading"),
        *(most(name) for name in _MOST),
    )


def _protection_summary(row: dict[str, Any], provenance: dict[str, str]) -> ProtectionSummary:
    return ProtectionSummary(
        phase=row["phase"],
        hal_m=row["hal_m"],
        n_epochs=row["n"],
        hpl_max_m=row["hpl_m"],
        hpl_multi_max_m=row["hpl_multi_m"],
        hpe_max_m=row["nse_h_m"],
        accuracy_max_m=row["accuracy_m"],
        accuracy_limit_m=row["accuracy_limit_m"],
        share_available=row["n_available"] / row["n"],
        n_misleading=row["n_misleading"],
        hal_held=provenance[row["phase"]],
    )


def tracks(sums: Sums, labels: dict[str, str], events: pl.DataFrame) -> list[TrackSummary]:
    """Every track."""
    counts = {(track, kind): n for track, kind, n in events.group_by("track", "kind").len().iter_rows()}
    summaries = []
    for track, group in sums.tracks.items():
        fte = sums.deviations.get(track, Deviation())
        summaries.append(
            TrackSummary(
                track=track,
                label=labels.get(track, track),
                n_epochs=group.n,
                start_ns=group.start_ns,
                duration_s=float(group.end_ns - group.start_ns) * 1e-9,
                fte_mean_m=fte.mean_m,
                fte_std_m=fte.std_m,
                fte_abs95_m=fte.abs95_m,
                share_inside=group.share_inside,
                worst_ratio=group.worst_ratio,
                worst_margin_m=group.worst_margin_m,
                n_cautions=counts.get((track, "caution"), 0),
                n_warnings=counts.get((track, "warning"), 0),
                n_unavailable=counts.get((track, "unavailable"), 0),
            )
        )
    return summaries
