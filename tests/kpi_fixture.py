"""A made-up performance evaluation for tests of the report: shapes of a real one, numbers that mean nothing.

Nothing here is a result of navbound; the counts come from the made-up epochs by plain NumPy, so that the parts agree with one another.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from navbound.records.performance import (
    AxisResult,
    DayResult,
    KpiEvent,
    KpiSeries,
    Level,
    LevelResult,
    ListedSubset,
    Performance,
    Spread,
    StanfordBins,
    StanfordCounts,
    Subsets,
)

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

START_NS = 1_316_000_000_000_000_000
N = 86_400
BIN_M = 0.1
LIMIT_M = 50.0
WIDTH_S = 60

_LIMITS: dict[str, tuple[float, float | None]] = {
    "NPA": (556.0, None),
    "APV-I": (40.0, 50.0),
    "LPV-200": (40.0, 35.0),
    "APV-II": (40.0, 20.0),
}


def _epochs(hazard: bool) -> dict[str, Floats]:
    rng = np.random.default_rng(11)
    t = np.arange(N, dtype=np.float64)
    hpe = np.hypot(0.4 * rng.normal(size=N), 0.5 * rng.normal(size=N))
    vpe = np.abs(0.9 * rng.normal(size=N) + 0.8 * np.sin(2 * np.pi * t / 3000))
    hpl = 12 + 3 * np.sin(2 * np.pi * t / 18000) + 1.5 * np.abs(rng.normal(size=N))
    vpl = 17 + 5 * np.sin(2 * np.pi * t / 24000) + 2 * np.abs(rng.normal(size=N))
    vpl[30_000:30_900] += 22
    hpl[60_000:60_020] += 45
    if hazard:
        vpe[70_000:70_012] = 41.0
        vpe[75_000:75_004] = 27.0
        hpe[71_000:71_003] = 75.0
    hpl[50_000:50_600] = vpl[50_000:50_600] = np.nan
    return {"hpe": hpe, "vpe": vpe, "hpl": hpl, "vpl": vpl}


def _spread(values: Floats) -> Spread:
    good = values[np.isfinite(values)]
    rank = np.sort(good)

    def at(q: float) -> float:
        return float(rank[int(np.ceil(q * len(rank))) - 1])

    return Spread(
        n=len(good),
        mean=float(good.mean()),
        rms=float(np.sqrt((good**2).mean())),
        p50=at(0.5),
        p95=at(0.95),
        p99=at(0.99),
        p999=at(0.999),
        max=float(good.max()),
        max_time_ns=START_NS + int(np.nanargmax(values)) * 10**9,
    )


def _axis(axis: Literal["h", "v"], error: Floats, level: Floats) -> AxisResult:
    index = error / level
    return AxisResult(
        axis=axis,
        error_m=_spread(np.where(np.isfinite(level), error, np.nan)),
        level_m=_spread(level),
        safety_index=_spread(index),
        n_potential_mi=int(((index > 0.75) & (index <= 1)).sum()),
        n_mi=int((index > 1).sum()),
    )


def _without_truth(axis: AxisResult) -> AxisResult:
    return axis.model_copy(update={"error_m": None, "safety_index": None, "n_mi": 0, "n_potential_mi": 0})


def _counts(axis: Literal["h", "v"], error: Floats, level: Floats, limit: float) -> StanfordCounts:
    known = np.isfinite(level)
    e, p = error[known], level[known]
    below = p < limit
    return StanfordCounts(
        axis=axis,
        alert_limit_m=limit,
        n=len(e),
        n_nominal=int((below & (e <= p)).sum()),
        n_mi=int((below & (e > p) & (e <= limit)).sum()),
        n_hmi=int((below & (e > limit)).sum()),
        n_unavailable=int((~below & (e <= p)).sum()),
        n_unavailable_mi=int((~below & (e > p)).sum()),
    )


def _bins(axis: Literal["h", "v"], error: Floats, level: Floats, variant: Literal["stanford", "stanford-esa"] = "stanford") -> StanfordBins:
    known = np.isfinite(level)
    last = round(LIMIT_M / BIN_M)
    pairs = np.minimum(np.floor(np.stack([error[known], level[known]]) / BIN_M).astype(int), last)
    result, count = np.unique(pairs, axis=1, return_counts=True)
    return StanfordBins(
        axis=axis,
        variant=variant,
        bin_m=BIN_M,
        limit_m=LIMIT_M,
        n=int(known.sum()),
        error_bin=result[0].tolist(),
        level_bin=result[1].tolist(),
        count=count.tolist(),
    )


def _available(e: dict[str, Floats], name: str) -> Bools:
    hal, val = _LIMITS[name]
    return (e["hpl"] < hal) & (e["vpl"] < val if val is not None else True)


def _runs(condition: Bools) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate(([0], condition.astype(np.int8), [0]))))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def _level(name: str, e: dict[str, Floats], truth: bool) -> LevelResult:
    hal, val = _LIMITS[name]
    available = _available(e, name)
    hazard = available & ((e["hpe"] > hal) | (e["vpe"] > val if val is not None else False))
    mi = available & ((e["hpe"] > e["hpl"]) | ((e["vpe"] > e["vpl"]) if val is not None else False))
    hazards, mis = _runs(hazard), _runs(mi)
    level = Level(
        id=name,
        title=f"{name} (fixture)",
        hal_m=hal,
        val_m=val,
        accuracy_h_m=16.0 if val is not None else 220.0,
        accuracy_v_m={"APV-I": 20.0, "LPV-200": 4.0, "APV-II": 8.0}.get(name),
        tta_s=6.0 if name != "NPA" else 10.0,
        integrity_risk=2e-7,
        integrity_per="approach",
        continuity_risk=8e-6,
        continuity_per="15 s",
        source="test fixture, no document",
        provenance={"hal_m": "standard", "val_m": "standard", "tta_s": "inferred", "accuracy_h_m": "printed"},
    )
    losses = len(_runs(~available))
    stanford = [_counts("h", e["hpe"], e["hpl"], hal)] + ([_counts("v", e["vpe"], e["vpl"], val)] if val is not None else [])
    keep = np.where(available, 1.0, np.nan)
    axes = [_axis("h", e["hpe"], e["hpl"] * keep), _axis("v", e["vpe"], e["vpl"] * keep)]
    share = float(available.mean())
    return LevelResult(
        level=level,
        accuracy_met=True if truth else None,
        n_expected=N,
        n_solution=N - 600,
        n_available=int(available.sum()),
        availability_expected=share,
        availability_low=share - 0.004,
        availability_high=min(1.0, share + 0.002),
        n_effective=812.4,
        availability_solution=int(available.sum()) / (N - 600),
        n_continuity_events=losses,
        window_s=15.0,
        n_window_epochs=15,
        window_meaningful=True,
        n_at_risk=15 * losses,
        continuity_risk=15 * losses / int(available.sum()),
        events_per_1e5=1e5 * losses / int(available.sum()),
        events_per_1e5_low=0.3,
        events_per_1e5_high=9.1,
        continuity_risk_maritime=900 * losses / N,
        truth_known=truth,
        n_hazard_epochs=int(hazard.sum()) if truth else 0,
        n_hazard_events=len(hazards) if truth else 0,
        n_hazard_over_tta=sum(b - a > level.tta_s for a, b in hazards) if truth else 0,
        longest_hazard_s=float(max((b - a for a, b in hazards), default=0)) if truth else 0.0,
        n_mi_epochs=int(mi.sum()) if truth else 0,
        n_mi_events=len(mis) if truth else 0,
        n_mi_over_tta=sum(b - a > level.tta_s for a, b in mis) if truth else 0,
        longest_mi_s=float(max((b - a for a, b in mis), default=0)) if truth else 0.0,
        stanford=stanford if truth else [],
        available=axes,
    )


def _cause(name: str, e: dict[str, Floats]) -> list[str]:
    """Cause of each epoch, empty where the level was available."""
    hal, val = _LIMITS[name]
    h = e["hpl"] >= hal
    v = e["vpl"] >= val if val is not None else np.zeros(N, dtype=bool)
    out = np.where(h & v, "hpl and vpl", np.where(h, "hpl", np.where(v, "vpl", "")))
    return np.where(np.isnan(e["hpl"]), "no solution", out).tolist()  # type: ignore[no-any-return]


def _series(e: dict[str, Floats]) -> KpiSeries:
    n = N // WIDTH_S

    def most(values: Floats, pick: Literal["max", "min"]) -> list[float | None]:
        fill = -np.inf if pick == "max" else np.inf
        result = getattr(np.where(np.isnan(values), fill, values).reshape(n, WIDTH_S), pick)(axis=1)
        return [float(v) if np.isfinite(v) else None for v in result]

    def frequent(causes: list[str]) -> list[str]:
        out = []
        for k in range(n):
            present = [c for c in causes[k * WIDTH_S : (k + 1) * WIDTH_S] if c]
            out.append(max(set(present), key=present.count) if present else "")
        return out

    known = np.where(np.isnan(e["hpl"]), np.nan, 1.0)
    return KpiSeries(
        width_ns=WIDTH_S * 10**9,
        start_ns=[START_NS + k * WIDTH_S * 10**9 for k in range(n)],
        n_expected=[WIDTH_S] * n,
        n_solution=np.isfinite(e["hpl"]).reshape(n, WIDTH_S).sum(axis=1).tolist(),
        hpe_max_m=most(e["hpe"] * known, "max"),
        vpe_max_m=most(e["vpe"] * known, "max"),
        hpl_min_m=most(e["hpl"], "min"),
        hpl_max_m=most(e["hpl"], "max"),
        vpl_min_m=most(e["vpl"], "min"),
        vpl_max_m=most(e["vpl"], "max"),
        n_available={name: _available(e, name).reshape(n, WIDTH_S).sum(axis=1).tolist() for name in _LIMITS},
        cause={name: frequent(_cause(name, e)) for name in _LIMITS},
    )


def _events(e: dict[str, Floats], truth: bool) -> list[KpiEvent]:
    listed: list[KpiEvent] = []
    for name, (hal, val) in _LIMITS.items():
        available, causes = _available(e, name), _cause(name, e)
        hazard = available & ((e["hpe"] > hal) | (e["vpe"] > val if val is not None else False))
        for kind, condition in (("hazard", hazard), ("loss", ~available)):
            if kind == "hazard" and not truth:
                continue
            for a, b in _runs(condition)[:40]:

                def largest(values: Floats, a: int = a, b: int = b) -> float | None:
                    part = values[a:b]
                    return float(np.nanmax(part)) if np.isfinite(part).any() else None

                listed.append(
                    KpiEvent(
                        level=name,
                        kind=kind,
                        onset_ns=START_NS + a * 10**9,
                        clear_ns=START_NS + b * 10**9,
                        n_epochs=b - a,
                        duration_s=float(b - a),
                        over_tta=b - a > 6 if kind == "hazard" else None,
                        cause=causes[a] if kind == "loss" else "",
                        reason="fixture: a satellite set </script>",
                        hpe_max_m=largest(e["hpe"]),
                        vpe_max_m=largest(e["vpe"]),
                        hpl_max_m=largest(e["hpl"]),
                        vpl_max_m=largest(e["vpl"]),
                        n_sv_before=9,
                        n_sv_onset=7,
                        mode_before="PA",
                        mode_onset="PA",
                    )
                )
    return sorted(listed, key=lambda event: (event.kind != "hazard", -event.duration_s))


def _subsets(levels: list[LevelResult]) -> Subsets:
    """Counts that differ from those of the epochs, so that the page cannot show one for the other."""
    one = ListedSubset(
        time_ns=START_NS + 60 * 10**9,
        satellites=["G01", "G02", "G03", "G05"],
        left_out=["G07"],
        hpe_m=9.0,
        hpl_m=10.0,
        vpe_m=30.0,
        vpl_m=24.0,
        safety_index=1.25,
    )
    double = {"n", "n_nominal", "n_mi", "n_hmi", "n_unavailable", "n_unavailable_mi"}
    return Subsets(
        n_epochs=N - 600,
        n_unsolved=3,
        n_cut=2,
        n_subsets=2 * (N - 600),
        n_singular=5,
        n_mi=1,
        min_satellites=4,
        max_satellites=12,
        safety_index_h_max=0.9,
        safety_index_v_max=1.25,
        listed_from=0.7,
        n_listed=7,
        listed=[one, one.model_copy(update={"time_ns": START_NS, "vpl_m": None, "safety_index": 0.9})],
        stanford={r.level.id: [c.model_copy(update={name: 2 * getattr(c, name) for name in double}) for c in r.stanford] for r in levels},
    )


def performance(*, hazard: bool = True, truth: bool = True, experimental: str = "", esa: bool = True) -> Performance:
    """One made-up day."""
    e = _epochs(hazard)
    bins = [_bins("h", e["hpe"], e["hpl"]), _bins("v", e["vpe"], e["vpl"])] if truth else []
    if esa and truth:
        bins += [_bins("h", e["hpe"] * 1.6, e["hpl"] * 1.3, "stanford-esa"), _bins("v", e["vpe"] * 1.6, e["vpl"] * 1.3, "stanford-esa")]
    levels = [_level(name, e, truth) for name in _LIMITS]
    events = _events(e, truth)
    series = _series(e)
    if not truth:
        series = series.model_copy(update={"hpe_max_m": [None] * len(series.start_ns), "vpe_max_m": [None] * len(series.start_ns)})
    axes = [_axis("h", e["hpe"], e["hpl"]), _axis("v", e["vpe"], e["vpl"])]
    if not truth:
        axes = [_without_truth(a) for a in axes]
        levels = [r.model_copy(update={"available": [_without_truth(a) for a in r.available]}) for r in levels]
    return Performance(
        title="fixture receiver, not a result",
        truth_known=truth,
        period_s=1.0,
        first_ns=START_NS,
        last_ns=START_NS + (N - 1) * 10**9,
        exclude_missing=False,
        n_expected=N,
        n_missing=0,
        n_no_solution=600,
        n_solution=N - 600,
        n_repeated=0,
        n_mi_epochs=int(((e["hpe"] > e["hpl"]) | (e["vpe"] > e["vpl"])).sum()) if truth else 0,
        axes=axes,
        levels=levels,
        stanford=bins,
        series=series,
        n_events={kind: sum(event.kind == kind for event in events) + (900 if kind == "loss" else 0) for kind in ("loss", "hazard")},
        events=events,
        days=[
            DayResult(
                start_ns=START_NS + k * 86_400 * 10**9,
                n_expected=N,
                n_solution=N - 600,
                n_available={r.level.id: r.n_available for r in levels},
            )
            for k in range(2)
        ],
        subsets=_subsets(levels) if esa and truth else None,
        experimental=experimental,
        notes=["Fixture: numbers that mean nothing."],
    )
