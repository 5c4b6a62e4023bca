"""What one pass over the judged epochs counts: of a table in memory one piece, of a large one many, with the same results."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound.methods import column_of, method
from navbound.read.checks.neighbours import COLUMNS as NEIGHBOURS
from navbound.read.checks.stated import ALERT, CONTAINMENT, ERROR, WORSE
from navbound.run.inputs.doubts import Doubts
from navbound.run.summary.margins import KNOWN_BEYOND, OUTSIDE, by_reason, by_status, judged_margins, with_margins, worst_of
from navbound.run.summary.missing import Gaps
from navbound.storage.tables import pieces

if TYPE_CHECKING:
    from collections.abc import Iterator

    from polars.dataframe.group_by import GroupBy

    from navbound.records.material import Material
    from navbound.records.run import Worst
    from navbound.storage.tables import Table


@dataclass
class Group:
    """What is counted of the epochs of a phase or a track."""

    n: int = 0
    n_ok: int = 0
    n_inside: int = 0
    worst_ratio: float | None = None
    worst_margin_m: float | None = None
    start_ns: int = 2**63 - 1
    end_ns: int = -(2**63)
    risk_max: float | None = None
    n_bounded: int = 0
    n_covered: int = 0

    def add(self, other: Group) -> None:
        """Epochs of the next piece."""
        for name in ("n", "n_ok", "n_inside", "n_bounded", "n_covered"):
            setattr(self, name, getattr(self, name) + getattr(other, name))
        self.worst_ratio = _largest(self.worst_ratio, other.worst_ratio)
        self.risk_max = _largest(self.risk_max, other.risk_max)
        self.worst_margin_m = min((m for m in (self.worst_margin_m, other.worst_margin_m) if m is not None), default=None)
        self.start_ns, self.end_ns = min(self.start_ns, other.start_ns), max(self.end_ns, other.end_ns)

    @property
    def share_inside(self) -> float | None:
        """Of the epochs with a margin."""
        return self.n_inside / self.n_ok if self.n_ok else None

    @property
    def coverage(self) -> float | None:
        """Share of the epochs with error and bound whose error is within."""
        return self.n_covered / self.n_bounded if self.n_bounded else None


def _largest(one: float | None, other: float | None) -> float | None:
    return max((value for value in (one, other) if value is not None), default=None)


@dataclass(frozen=True)
class Deviation:
    """Flight technical error of a track; None where none is known. [m]."""

    mean_m: float | None = None
    std_m: float | None = None
    abs95_m: float | None = None


class Sums:
    """Counts of every epoch, and by phase and track."""

    def __init__(self, material: Material, judging: str, events: pl.DataFrame, with_levels: frozenset[str]) -> None:
        self.doubts = Doubts(with_levels, recorded=material.kind == "analyze")
        self.gaps = Gaps(material.left_out, material.sample_period_s)
        self.n = self.n_judged = self.n_inside = self.n_contained = self.n_outside = self.n_known_beyond = self.n_truth = 0
        self.largest_height_error_m: float | None = None
        self.n_status: Counter[str] = Counter()
        self.n_reason: Counter[str] = Counter()
        self.worst: list[Worst | None] = [None, None]
        self.phases: dict[tuple[str, float], Group] = {}
        self.tracks: dict[str, Group] = {}
        self.deviations: dict[str, Deviation] = {}
        self.alerts: Counter[tuple[str, float, str]] = Counter()
        self._judging = judging
        self._fte = _Fte(self.deviations)
        self._risks: dict[tuple[str, float], list[pl.Series]] = {}
        alerting = events.filter(pl.col("kind").is_in(["caution", "warning"]))
        self._onsets = alerting.select("track", "kind", time_ns="onset_ns")

    def see_all(self, epochs: Table) -> None:
        """Every epoch, of the columns that are read here."""
        read = (
            "phase",
            "rnp_m",
            "along_m",
            "integrity_compared_m",
            "reason_id",
            "nse_h_m",
            "nse_u_m",
            "fte_m",
            "tse_m",
            "p_exceed_2rnp",
            *NEIGHBOURS,
        )
        doubted = ("hpl_m", ERROR, ALERT, WORSE, CONTAINMENT)
        judged = method(self._judging)
        for piece in pieces(epochs, ["track", "time_ns", "status", *read, *doubted, judged.column, judged.integrity_column]):
            self._see(piece)
        self._fte.end()

    def _see(self, epochs: pl.DataFrame) -> None:
        margins = with_margins(epochs, method(self._judging))
        judged = judged_margins(margins)
        self.gaps.see(epochs)
        self.doubts.see(margins)
        self.n += epochs.height
        self.n_judged += judged.height
        self.n_inside += int((judged["_margin"] >= 0).sum())
        self.n_contained += int((judged["_margin_integrity"] >= 0).sum())
        self.n_outside += int(margins.select(OUTSIDE.sum()).item())
        if "nse_h_m" in margins.columns:
            self.n_known_beyond += int(margins.select(KNOWN_BEYOND.sum()).item())
            self.n_truth += int(np.isfinite(column_of(margins, "nse_h_m")).sum())
        if "nse_u_m" in margins.columns:
            heights = column_of(margins.filter(status="ok"), "nse_u_m")
            known = np.abs(heights[np.isfinite(heights)])
            self.largest_height_error_m = _largest(self.largest_height_error_m, float(known.max()) if known.size else None)
        self.n_status.update(by_status(margins))
        self.n_reason.update(by_reason(margins))
        for k, worst in enumerate(worst_of(margins, self._judging)):
            before = self.worst[k]
            if worst is not None and (before is None or worst.margin_m < before.margin_m):
                self.worst[k] = worst
        for (track,), group in self._groups(margins, ["track"]):
            self.tracks.setdefault(track, Group()).add(group)
        if "fte_m" in margins.columns:
            self._fte.see(margins)
        if "phase" in margins.columns:
            self._see_phases(margins)

    def _see_phases(self, margins: pl.DataFrame) -> None:
        for (phase, limit), group in self._groups(margins, ["phase", "rnp_m"]):
            self.phases.setdefault((phase, limit), Group()).add(group)
        if "p_exceed_2rnp" in margins.columns:
            for (phase, limit), rows in margins.select("phase", "rnp_m", "p_exceed_2rnp").group_by("phase", "rnp_m", maintain_order=True):
                self._risks.setdefault((phase, limit), []).append(rows["p_exceed_2rnp"])
        at = self._onsets.join(margins.select("track", "time_ns", "phase", "rnp_m"), on=["track", "time_ns"])
        self.alerts.update({(p, limit, kind): n for p, limit, kind, n in at.group_by("phase", "rnp_m", "kind").len().iter_rows()})

    def mean_risk(self, phase: str, limit: float) -> float | None:
        """Mean risk beyond twice RNP of a phase; its epochs are given away."""
        parts = self._risks.pop((phase, limit), None)
        return None if parts is None else _mean(pl.concat(parts, rechunk=True))

    def _groups(self, margins: pl.DataFrame, by: list[str]) -> Iterator[tuple[tuple[Any, ...], Group]]:
        inside, bound = pl.col("_inside"), method(self._judging).column
        within = pl.lit(None, pl.Boolean)
        if "tse_m" in margins.columns and bound.startswith("tse"):
            within = pl.col("tse_m").abs() <= pl.col(bound)
        risk = pl.col("p_exceed_2rnp") if "p_exceed_2rnp" in margins.columns else pl.lit(None, pl.Float64)
        grouped = margins.group_by(by, maintain_order=True).agg(
            pl.len().alias("n"),
            inside.count().alias("n_ok"),
            inside.sum().cast(pl.Int64).alias("n_inside"),
            pl.col("_ratio").max().alias("worst_ratio"),
            pl.col("_margin").min().alias("worst_margin_m"),
            pl.col("time_ns").min().alias("start_ns"),
            pl.col("time_ns").max().alias("end_ns"),
            risk.max().alias("risk_max"),
            (within.is_not_null()).sum().cast(pl.Int64).alias("n_bounded"),
            within.fill_null(value=False).sum().cast(pl.Int64).alias("n_covered"),
        )
        for row in grouped.iter_rows(named=True):
            yield tuple(row.pop(name) for name in by), Group(**row)


class _Fte:
    """The flight technical error of one track after the other: one number an epoch of the track at hand is kept."""

    def __init__(self, done: dict[str, Deviation]) -> None:
        self._done = done
        self._track: str | None = None
        self._parts = list[pl.Series]()

    def see(self, epochs: pl.DataFrame) -> None:
        for (track,), rows in epochs.select("track", "fte_m").group_by("track", maintain_order=True):
            if track != self._track:
                self.end()
            self._track = str(track)
            self._parts.append(rows["fte_m"])

    def end(self) -> None:
        """The last epoch of a track has been seen."""
        if self._track is None:
            return
        fte = pl.col("value")
        of = _as_group(pl.concat(self._parts, rechunk=True)).agg(
            fte.mean().alias("mean"), fte.std(ddof=0).alias("std"), fte.abs().quantile(0.95, interpolation="nearest").alias("abs95")
        )
        self._done[self._track] = Deviation(*of.select("mean", "std", "abs95").row(0))
        self._track, self._parts = None, []


def _mean(values: pl.Series) -> float | None:
    mean = _as_group(values).agg(pl.col("value").mean())["value"][0]
    return None if mean is None else float(mean)


def _as_group(values: pl.Series) -> GroupBy:
    """All values as one group: the engine adds the numbers of a group in another order than those of a column."""
    return pl.DataFrame({"key": np.zeros(len(values), dtype=np.uint8), "value": values}).group_by("key", maintain_order=True)
