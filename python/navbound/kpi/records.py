"""From the core's counts to the records of a performance evaluation: names and words, no arithmetic beyond ratios of counts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import polars as pl

from navbound import _core
from navbound.records.performance import (
    Axis,
    AxisResult,
    DayResult,
    KpiEvent,
    KpiSeries,
    Level,
    LevelResult,
    Spread,
    StanfordBins,
    StanfordCounts,
)
from navbound.table.columns import LEVEL_EVENTS
from navbound.table.declare import schema

if TYPE_CHECKING:
    from collections.abc import Sequence

AXES: tuple[Axis, Axis] = ("h", "v")
_QUANTITIES = ("error_m", "level_m", "safety_index")
_PERCENTILES = ("p50", "p95", "p99", "p999")
_DAY_NS = 86_400_000_000_000
_PER = 100_000
_MARITIME_S = 900.0

EVENT_SCHEMA = schema(LEVEL_EVENTS)
"""Columns of a performance run's events.parquet: the fields of `KpiEvent`."""


def table_of_levels() -> list[Level]:
    """The core's table of service levels."""
    return [_listed(row) for row in _core.service_levels()]


def _listed(row: dict[str, Any]) -> Level:
    limits, rest = row.pop("limits"), row.pop("rest")
    sources = (row.pop("limits_source"), row.pop("rest_source"))
    provenance = {name: limits if name in {"hal_m", "val_m"} else rest for name in row if name.endswith(("_m", "_s", "_risk"))}
    return Level(source=f"alert limits: {sources[0]}; the rest: {sources[1]}", provenance=provenance, **row)


def axes(counts: list[dict[str, Any]], percentiles: list[list[float]]) -> list[AxisResult]:
    """Both axes; `percentiles` holds a row for each quantity of each axis."""
    results = []
    for index, axis in enumerate(counts):
        rows = percentiles[3 * index : 3 * index + 3]
        spreads = {
            name: None if axis[name] is None else Spread(**axis[name], **dict(zip(_PERCENTILES, row, strict=True)))
            for name, row in zip(_QUANTITIES, rows, strict=True)
        }
        results.append(AxisResult(axis=AXES[index], n_potential_mi=axis["n_potential_mi"], n_mi=axis["n_mi"], **spreads))
    return results


def level_result(
    level: Level, outcome: dict[str, Any], *, whole: dict[str, Any], all_axes: list[AxisResult], percentiles: list[list[float]], grid: Any
) -> LevelResult:
    """One level; `whole` holds the counts of all levels, `all_axes` what every solution had."""
    n_available, n_solution, n_expected = outcome["n_available"], whole["n_solution"], whole["n_expected"]
    n_events = outcome["n_continuity_events"]
    _, hazards, misleading = outcome["runs"]
    rate = _PER / n_available if n_available else None
    low, high = outcome["continuity_event_limits"]
    limits = [level.hal_m] if level.val_m is None else [level.hal_m, level.val_m]
    counts = [
        StanfordCounts(axis=axis, alert_limit_m=limit, **regions)
        for axis, limit, regions in zip(AXES, limits, outcome["regions"], strict=False)
    ]
    return LevelResult(
        level=level,
        accuracy_met=_accuracy_met(level, all_axes),
        n_expected=n_expected,
        n_solution=n_solution,
        n_available=n_available,
        availability_expected=outcome["availability_expected"],
        availability_low=outcome["availability_limits"][0],
        availability_high=outcome["availability_limits"][1],
        n_effective=outcome["n_effective"],
        availability_solution=n_available / n_solution if n_solution else None,
        n_continuity_events=n_events,
        window_s=grid.window_s,
        n_window_epochs=grid.n_window_epochs,
        window_meaningful=grid.period_s <= grid.window_s,
        n_at_risk=outcome["n_at_risk"],
        continuity_risk=outcome["n_at_risk"] / n_available if n_available else None,
        events_per_1e5=None if rate is None else rate * n_events,
        events_per_1e5_low=None if rate is None else rate * low,
        events_per_1e5_high=None if rate is None else rate * high,
        continuity_risk_maritime=_MARITIME_S * n_events / (n_expected * grid.period_s) if n_available else None,
        truth_known=all_axes[0].error_m is not None,
        n_hazard_epochs=outcome["n_hazard_epochs"],
        n_hazard_events=hazards[0],
        n_hazard_over_tta=hazards[1],
        longest_hazard_s=hazards[2],
        n_mi_epochs=outcome["n_mi_epochs"],
        n_mi_events=misleading[0],
        n_mi_over_tta=misleading[1],
        longest_mi_s=misleading[2],
        stanford=counts,
        available=axes(outcome["available"], percentiles),
    )


def _accuracy_met(level: Level, both: list[AxisResult]) -> bool | None:
    demands = [(level.accuracy_h_m, both[0].error_m), (level.accuracy_v_m, both[1].error_m)]
    required = [(limit, error) for limit, error in demands if limit is not None]
    if not required or any(error is None for _, error in required):
        return None
    return all(error is not None and error.p95 <= limit for limit, error in required)


def stanford_bins(
    cells_of_axes: list[dict[str, Any]], bin_m: float, limit_m: float, variant: Literal["stanford", "stanford-esa"] = "stanford"
) -> list[StanfordBins]:
    """Histograms of both axes; an axis without a point is left out."""
    return [
        StanfordBins(axis=axis, variant=variant, bin_m=bin_m, limit_m=limit_m, n=sum(bins["count"]), **bins)
        for axis, bins in zip(AXES, cells_of_axes, strict=True)
        if bins["count"]
    ]


def series(cells: dict[str, Any], levels: Sequence[Level]) -> KpiSeries:
    """Errors and levels against time."""
    ids = [level.id for level in levels]
    by_level = {name: dict(zip(ids, cells.pop(name), strict=True)) for name in ("n_available", "cause")}
    return KpiSeries(**cells, **by_level)


def days(counts: list[tuple[int, int, int, list[int]]], levels: Sequence[Level]) -> list[DayResult]:
    """A record for each GPS day."""
    return [
        DayResult(
            start_ns=day * _DAY_NS,
            n_expected=expected,
            n_solution=solution,
            n_available={level.id: n for level, n in zip(levels, available, strict=True)},
        )
        for day, expected, solution, available in counts
    ]


def events(table: dict[str, Any], levels: Sequence[Level], modes: dict[str, int], reasons: dict[str, int]) -> pl.DataFrame:
    """Events as a table, with what the table said about their onset."""
    words = {code: text for text, code in modes.items()} | {0: None}
    why = {code: text for text, code in reasons.items()} | {0: ""}
    before, onset = ([words[code] for code in table[f"mode_{at}"]] for at in ("before", "onset"))
    causes = [why[code] for code in table["reason_onset"]]
    sentences = [
        _words(kind, text, pair_sv, pair_mode)
        for kind, text, pair_sv, pair_mode in zip(
            table["kind"],
            causes,
            zip(table["n_sv_before"], table["n_sv_onset"], strict=True),
            zip(before, onset, strict=True),
            strict=True,
        )
    ]
    columns = {name: values for name, values in table.items() if name in EVENT_SCHEMA}
    columns["level"] = [levels[index].id for index in table["level"]]
    columns |= {"reason": sentences, "mode_before": before, "mode_onset": onset}
    columns["over_tta"] = [
        None if kind == "loss" else duration > levels[index].tta_s
        for kind, duration, index in zip(table["kind"], table["duration_s"], table["level"], strict=True)
    ]
    return pl.DataFrame({name: columns[name] for name in EVENT_SCHEMA}, schema=EVENT_SCHEMA)


def _words(kind: str, reason: str, n_sv: tuple[int | None, int | None], mode: tuple[str | None, str | None]) -> str:
    if kind != "loss":
        return ""
    words = [reason] if reason else []
    if None not in n_sv and n_sv[0] != n_sv[1]:
        words.append(f"satellites {n_sv[0]} to {n_sv[1]}")
    if None not in mode and mode[0] != mode[1]:
        words.append(f"mode {mode[0]} to {mode[1]}")
    return "; ".join(words)


def gravest(table: pl.DataFrame, most: int) -> pl.DataFrame:
    """Hazards, then misleading information, then losses, the longest first."""
    order = pl.col("kind").replace_strict({"hazard": 0, "mi": 1, "loss": 2}, return_dtype=pl.Int64)
    return table.sort(order, -pl.col("n_epochs"), "onset_ns", "level", maintain_order=True).head(most)


def event_records(table: pl.DataFrame) -> list[KpiEvent]:
    """Rows as records."""
    return [KpiEvent(**row) for row in table.iter_rows(named=True)]
