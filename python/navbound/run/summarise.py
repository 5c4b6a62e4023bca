"""Judged epochs to the records that a person reads first."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
import polars as pl

from navbound import anp, evaluation, rnp
from navbound.methods import column_of, method
from navbound.records.run import (
    Belief,
    EventSummary,
    Held,
    Honesty,
    MethodResult,
    PhaseSummary,
    ProtectionSummary,
    Summary,
    TrackSummary,
    Verdict,
    Worst,
)
from navbound.rnp.exposure import LONGEST_STEP_S
from navbound.run.inputs.doubts import Doubts, tracks_with_levels
from navbound.run.verdict import rule
from navbound.run.verdict.belief import of_epochs
from navbound.run.verdict.results import honesty_words, protection_words, verdict_words
from navbound.status import USABLE
from navbound.table.columns import COVARIANCE

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.methods import Method
    from navbound.records.material import Material

LISTED_EVENTS = 500
"""Events in summary.json; all of them are in events.parquet, and the report says how many are not listed."""

TRACKS_TO_DRAW = 10
"""Fewer tracks drawn again say little of how tracks differ."""

REGION_RISK = 0.05


def summarise(
    material: Material,
    epochs: pl.DataFrame,
    events: pl.DataFrame,
    *,
    ids: list[str],
    judging: str,
    states: list[str],
    risks: tuple[float, float],
) -> Summary:
    """Every record of summary.json.

    Parameters
    ----------
    material : Material
        Where the epochs came from.
    epochs, events : DataFrame
        After judging.
    ids : list of str
        Methods evaluated, the judging one first.
    judging : str
        The method whose bound is compared with RNP.
    states : list of str
        Names behind ``p_state_1``, ...
    risks : (float, float)
        Of accuracy and of integrity. [1]
    """
    risk_accuracy, risk_integrity = risks
    judged = method(judging)
    margins = with_margins(epochs, judged)
    coverage_kind = evaluation.CLOSED_LOOP if material.kind == "fly" else evaluation.REPEATED
    accuracy = [_method_result(epochs, i, risk_accuracy, coverage_kind, integrity=False) for i in ids]
    protection = _protection(epochs, material.limits_held)
    verdict = verdict_of(material, _facts(material, margins, accuracy, risks), accuracy, risks, protection)
    return Summary(
        kind=material.kind,
        title=material.title,
        verdict=verdict,
        coverage_kind=coverage_kind,
        assumptions=material.assumptions,
        covariance=material.covariance,
        phases=_phases(margins, judged.column, material.sample_period_s, events),
        protection=protection,
        tracks=_tracks(margins, material.labels, events),
        accuracy=accuracy,
        integrity=[_method_result(epochs, i, risk_integrity, coverage_kind, integrity=True) for i in ids],
        honesty=honesty_of(epochs),
        states=states,
        events=listed(events),
        cross_track=material.cross_track,
        rejected=material.rejected,
        n_status=by_status(epochs),
    )


def with_margins(epochs: pl.DataFrame, judged: Method) -> pl.DataFrame:
    """Judged epochs with what the bounds of the judging method leave of the limits."""
    # What the monitor compared: the larger of the bound and |FTE| + protection level, where there are levels.
    integrity = judged.integrity_column if "integrity_compared_m" not in epochs.columns else "integrity_compared_m"
    # By numbers: the engine divides by a column that is one value by its reciprocal, which is not the same in the last bit.
    ratio = column_of(epochs, judged.column) / column_of(epochs, "rnp_m")
    margins = epochs.with_columns(
        pl.Series("_ratio", ratio, nan_to_null=True),
        # A NaN is greater than every number here: it must not pass for a margin.
        (pl.col("rnp_m") - pl.col(judged.column)).fill_nan(None).alias("_margin"),
        (2 * pl.col("rnp_m") - pl.col(integrity)).fill_nan(None).alias("_margin_integrity"),
        pl.col(integrity).alias("_integrity"),
    )
    # Degraded epochs may show outside; a share inside speaks of ok epochs alone.
    return margins.with_columns(pl.when(pl.col("status") == "ok").then((pl.col("_margin") >= 0).cast(pl.Float64)).alias("_inside"))


def listed(events: pl.DataFrame) -> list[EventSummary]:
    """The events of summary.json."""
    return [EventSummary(**row) for row in events.head(LISTED_EVENTS).iter_rows(named=True)]


@dataclass(frozen=True)
class VerdictFacts:
    """What the verdict says and rests on, of every epoch.

    Attributes
    ----------
    n_recorded, n_missing : int
        Epochs that are there, and that should have been.
    n_judged, n_inside, n_contained : int
        With status ok and both margins; of these within RNP, and within twice RNP.
    n_status : dict
        Epochs by status.
    worst : (Worst or None, Worst or None)
        Epochs of the least margin, of accuracy and of integrity.
    doubts : Doubts
        What the recording says against itself.
    """

    n_recorded: int
    n_missing: int
    n_judged: int
    n_inside: int
    n_contained: int
    n_outside: int
    n_status: dict[str, int]
    worst: tuple[Worst | None, Worst | None]
    doubts: Doubts
    belief: Belief | None = None
    n_known_beyond: int = 0
    n_truth: int = 0


def _facts(material: Material, margins: pl.DataFrame, stated: list[MethodResult], risks: tuple[float, float]) -> VerdictFacts:
    judge = stated[0]
    judged = judged_margins(margins)
    truth = "nse_h_m" in margins.columns
    doubts = Doubts(tracks_with_levels(margins), recorded=material.kind == "analyze")
    doubts.see(margins)
    return VerdictFacts(
        n_recorded=margins.height,
        n_missing=_missing(margins, material.left_out, material.sample_period_s),
        n_judged=judged.height,
        n_inside=int((judged["_margin"] >= 0).sum()),
        n_contained=int((judged["_margin_integrity"] >= 0).sum()),
        n_outside=margins.select(OUTSIDE.sum()).item(),
        n_status=by_status(margins),
        worst=worst_of(margins, judge.id),
        doubts=doubts,
        belief=of_epochs(margins, judge.id, risks, [each.id for each in stated]),
        n_known_beyond=margins.select(_KNOWN_BEYOND.sum()).item() if truth else 0,
        n_truth=int(np.isfinite(column_of(margins, "nse_h_m")).sum()) if truth else 0,
    )


def judged_margins(margins: pl.DataFrame) -> pl.DataFrame:
    """Both margins of the epochs that are judged."""
    return margins.filter(pl.col("status") == "ok").select("_margin", "_margin_integrity").drop_nulls()


def by_status(epochs: pl.DataFrame) -> dict[str, int]:
    """Epochs by status."""
    return dict(epochs.get_column("status").value_counts().sort("status").iter_rows())


def worst_of(margins: pl.DataFrame, judging: str) -> tuple[Worst | None, Worst | None]:
    """Epochs of the least margin, of accuracy and of integrity."""
    return _worst(margins, "_margin", method(judging).column, 1.0), _worst(margins, "_margin_integrity", "_integrity", 2.0)


def verdict_of(
    material: Material, found: VerdictFacts, stated: list[MethodResult], risks: tuple[float, float], protection: list[ProtectionSummary]
) -> Verdict:
    """The verdict and its words."""
    judge, belief = stated[0], found.belief
    n_epochs, n_degraded = found.n_recorded + found.n_missing, found.n_status.get("degraded", 0)
    facts = rule.TrackFacts(
        n_epochs=n_epochs,
        n_judged=found.n_judged,
        n_outside=found.n_outside,
        n_beyond_alert_limit=sum(p.n_epochs - round(p.share_available * p.n_epochs) for p in protection),
        n_implausible=found.n_status.get("invalid_input", 0),
        n_misleading=sum(check.n_above for check in belief.levels if check.level == "hpl_m") if belief is not None else 0,
        belief="unchecked" if belief is None else belief.state,
        n_known_beyond=found.n_known_beyond,
        n_stated_against=found.doubts.n_stated_against,
        n_without_level=found.doubts.n_without_level,
        n_apart=0 if found.doubts.neighbours is None else found.doubts.neighbours.n,
        truth_lost=material.truth_doubts.n > 0 and found.n_truth == 0,
    )
    decided = rule.of_tracks(facts)
    verdict = Verdict(
        id=decided,
        inside=rule.MEANS_INSIDE[decided],
        words="",
        requirement=material.requirement,
        method=judge.id,
        share_inside=found.n_inside / found.n_judged if found.n_judged else None,
        share_contained=found.n_contained / found.n_judged if found.n_judged else None,
        n_epochs=n_epochs,
        n_judged=found.n_judged,
        n_degraded=n_degraded,
        n_unjudged=n_epochs - found.n_judged - n_degraded,
        n_missing=found.n_missing,
        n_outside=facts.n_outside,
        n_known_beyond=facts.n_known_beyond,
        n_stated_beyond=found.doubts.n_stated_beyond,
        n_stated_alert=found.doubts.n_stated_alert,
        n_stated_worse=found.doubts.n_stated_worse,
        n_stated_uncontained=found.doubts.n_stated_uncontained,
        unread=material.unread,
        n_apart=facts.n_apart,
        largest_apart_m=found.doubts.neighbours.largest_m if found.doubts.neighbours is not None and facts.n_apart else None,
        n_without_level=found.doubts.n_without_level,
        n_long_steps=found.doubts.n_long_steps,
        longest_step_s=found.doubts.longest_step_s,
        assumed=_assumed(material, judge.id),
        belief=belief,
        n_implausible=facts.n_implausible,
        worst_accuracy=found.worst[0],
        worst_integrity=found.worst[1],
        truth_known=found.n_truth > 0,
        n_truth=found.n_truth,
        n_truth_doubted=material.truth_doubts.n,
        truth_doubts=material.truth_doubts.words,
    )
    words = verdict_words(verdict, judge, risks, material.covariance)
    return verdict.model_copy(update={"words": f"{words}{protection_words(protection)}"})


OUTSIDE = (pl.min_horizontal("_margin", "_margin_integrity") < 0).fill_null(value=False) | (
    (pl.col("status") == "ok") & pl.col("_margin").is_not_null() & pl.col("_margin_integrity").is_null()
)
"""Outside a limit, or an ok epoch whose protection level is missing: what the monitor compares is then within no limit."""


_KNOWN_BEYOND = (
    (pl.col("status") == "ok") & (pl.col("_margin") >= 0) & (pl.col("nse_h_m") > 2.0 * pl.col("rnp_m")) & pl.col("nse_h_m").is_finite()
).fill_null(value=False)
"""An ok epoch within its limit whose known navigation error alone is beyond twice RNP: no share of epochs makes that good."""


def _assumed(material: Material, judging: str) -> list[Literal["sigma_typed", "sigma_coded", "no_path"]]:
    """What no data says and the first sentence must."""
    assumed: list[Literal["sigma_typed", "sigma_coded", "no_path"]] = []
    if material.covariance.id == "typed":
        assumed.append("sigma_typed")
    elif material.covariance.id in {"nac_p", "containment_radius"}:
        assumed.append("sigma_coded")
    return [*assumed, "no_path"] if method(judging).error_column == "nse_h_m" else assumed


def _missing(epochs: pl.DataFrame, left_out: pl.DataFrame, period_s: float) -> int:
    gaps = Gaps(left_out, period_s)
    gaps.see(epochs)
    return gaps.n_missing()


class Gaps:
    """Epochs that should have been there: recorded rows that are no epochs, and what the gaps beside them should have held.

    A gap counts where it is longer than the monitor waits before it says that there is nothing. A left out row in it counts once. Epochs
    come in the order of track and time, in pieces of any length.
    """

    def __init__(self, left_out: pl.DataFrame, period_s: float) -> None:
        self._n_left_out, self._period_s, self._n = left_out.height, period_s, 0
        self._rest = left_out.drop_nulls("time_ns").unique().sort("track", "time_ns")
        self._last = self._rest.clear()
        self._longest_s = rnp.Monitor(sample_period_s=min(period_s, LONGEST_STEP_S), time_to_alert_s=math.inf).stale_after_s

    def see(self, epochs: pl.DataFrame) -> None:
        """The next epochs."""
        track, time_ns = epochs["track"][-1], epochs["time_ns"][-1]
        due = (pl.col("track") < track) | ((pl.col("track") == track) & (pl.col("time_ns") <= time_ns))
        before = self._rest.filter(due)
        self._rest = self._rest.filter(~due)
        self._count(pl.concat([epochs.select("track", "time_ns"), before]))

    def _count(self, rows: pl.DataFrame) -> None:
        rows = pl.concat([self._last, rows.unique().sort("track", "time_ns")])
        step = pl.col("time_ns").diff().over("track").cast(pl.Float64) * 1e-9
        gaps = rows.select(step=step).filter(pl.col("step") > self._longest_s)
        self._n += int(gaps.select(((pl.col("step") / self._period_s).round() - 1).sum()).item() or 0)
        self._last = rows.tail(1)

    def n_missing(self) -> int:
        """Of all epochs, once."""
        if not self._rest.is_empty():
            self._count(self._rest)
            self._rest = self._rest.clear()
        return self._n_left_out + self._n


def _worst(margins: pl.DataFrame, margin: str, bound: str, factor: float) -> Worst | None:
    # The table may be large: the row is looked up, nothing is copied.
    place = margins.get_column(margin).arg_min()
    if place is None:
        return None
    row = margins.row(place, named=True)
    return Worst(
        track=row["track"],
        time_ns=row["time_ns"],
        margin_m=row[margin],
        bound_m=row[bound],
        limit_m=factor * row["rnp_m"],
        phase=row.get("phase"),
        along_m=row.get("along_m"),
        lat_rad=row["est_lat_rad"],
        lon_rad=row["est_lon_rad"],
    )


def _phases(margins: pl.DataFrame, bound: str, sample_period_s: float, events: pl.DataFrame) -> list[PhaseSummary]:
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


def _protection(epochs: pl.DataFrame, held: dict[str, str]) -> list[ProtectionSummary]:
    """Protection levels against the alert limit of each phase whose limit says how it is held."""
    if not (held and {"phase", "hpl_m", "hal_m"} <= set(epochs.columns)):
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
    return [ProtectionSummary(**row, hal_held=held[row["phase"]]) for row in grouped.iter_rows(named=True)]


def _tracks(margins: pl.DataFrame, labels: dict[str, str], events: pl.DataFrame) -> list[TrackSummary]:
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


def _codes(epochs: pl.DataFrame) -> NDArray[np.int64]:
    """Tracks as integers in order of appearance."""
    return epochs.get_column("track").rle_id().cast(pl.Int64).to_numpy()


def method_result(method_id: str, risk: float, known: NDArray[np.float64], scored: dict[str, float | None] | None = None) -> MethodResult:
    """A method at one risk: what it is, and its bounds where there are any."""
    m = method(method_id)
    described = {
        "id": m.id,
        "title": m.title,
        "source": m.source,
        "provenance": m.provenance,
        "assumes": m.assumes,
        "error_column": m.error_column,
        "may_alert": m.may_alert,
        "risk": risk,
        "n": len(known),
        "mean_m": float(known.mean()) if len(known) else None,
        "max_m": float(known.max()) if len(known) else None,
    }
    return MethodResult.model_validate(described | (scored or dict.fromkeys(_SCORES)))


_SCORES = ("coverage", "coverage_low", "coverage_high", "n_effective", "winkler_m", "pinball_m")


def _method_result(epochs: pl.DataFrame, method_id: str, risk: float, coverage_kind: str, *, integrity: bool) -> MethodResult:
    m = method(method_id)
    bound = column_of(epochs, m.integrity_column if integrity else m.column)
    known = np.isfinite(bound)
    scored: dict[str, float | None] = dict.fromkeys(_SCORES)
    if m.error_column in epochs.columns:
        error = np.abs(column_of(epochs, m.error_column))
        both = known & np.isfinite(error)
        if both.any():
            score = evaluation.bound(error[both], bound[both], risk, track=_codes(epochs)[both], coverage_kind=coverage_kind)
            scored = {
                "coverage": score.coverage,
                "coverage_low": score.coverage_low,
                "coverage_high": score.coverage_high,
                "n_effective": score.n_effective,
                "winkler_m": score.winkler_m,
                "pinball_m": score.pinball_m,
            }
    return method_result(method_id, risk, bound[known], scored)


def honesty_of(epochs: pl.DataFrame) -> Honesty | None:
    """NEES and PIT in three dimensions where the vertical is known, otherwise in two."""
    vertical = {"nse_u_m", "cov_uu_m2"} <= set(epochs.columns)
    errors = ("nse_e_m", "nse_n_m", "nse_u_m") if vertical else ("nse_e_m", "nse_n_m")
    if not set(errors) <= set(epochs.columns) or "cov_ee_m2" not in epochs.columns:
        return None
    error = np.column_stack([column_of(epochs, name) for name in errors])
    upper = np.column_stack([column_of(epochs, name) for name in COVARIANCE[: 6 if vertical else 3]])
    usable = epochs.get_column("status").is_in(USABLE).to_numpy()
    known = usable & np.isfinite(error).all(axis=1) & np.isfinite(upper).all(axis=1)
    if not known.any():
        return None
    ee, en, nn, *rest = upper[known].T
    rows = [[ee, en], [en, nn]]
    if vertical:
        eu, nu, uu = rest
        rows = [[ee, en, eu], [en, nn, nu], [eu, nu, uu]]
    covariance = np.moveaxis(np.array(rows), 2, 0)
    track = _codes(epochs)[known]
    nees = evaluation.nees(error[known], covariance, track=track)
    pit = evaluation.pit(error[known], covariance, track=track)
    regions = _regions(error[known], covariance, track)
    return Honesty(
        n=nees.n,
        n_effective=nees.n_effective,
        dimension=nees.dimension,
        nees_mean=nees.nees_mean,
        nees_low=nees.nees_low,
        nees_high=nees.nees_high,
        pit_counts=pit.counts,
        pit_low=pit.low,
        pit_high=pit.high,
        regions=regions,
        words=honesty_words(nees, pit, regions),
    )


def _regions(error: NDArray[np.float64], covariance: NDArray[np.float64], track: NDArray[np.int64]) -> list[Held]:
    """The 95 % circle and sphere against the error, where there are tracks enough to draw again."""
    if len(np.unique(track)) < TRACKS_TO_DRAW:
        return []
    sizes = {"circle": (np.hypot(error[:, 0], error[:, 1]), anp.circle(np.ascontiguousarray(covariance[:, :2, :2]), REGION_RISK))}
    if error.shape[1] == 3:
        sizes["sphere"] = (np.linalg.norm(error, axis=1), anp.sphere(covariance, REGION_RISK))
    found = []
    for region, (size, radius) in sizes.items():
        low, high = evaluation.bootstrap_coverage(size, radius, track)
        found.append(Held.model_validate({"region": region, "share": float((size <= radius).mean()), "low": low, "high": high}))
    return found
