"""A made-up flight for tests of the report: shapes and sizes of a real run, numbers that mean nothing.

Nothing here is a result of navbound; every text in it says so.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Literal

import numpy as np
import polars as pl

from navbound.records.run import (
    CovarianceConsistency,
    CrossTrack,
    EventSummary,
    InputFile,
    MethodResult,
    PhaseSummary,
    Rejection,
    RunRecord,
    Summary,
    TrackSummary,
    Verdict,
    Waypoint,
    Worst,
)

Provenance = Literal["printed", "re-derived", "standard", "ours", "inferred"]

N = 7081
START_NS = 1_316_000_000_000_000_000
NM = 1852.0
STATES = ["RNP 0.3", "RNP 1", "RNP 2", "out of RNP"]
SPIKE = 5200
"""Epoch whose flight technical error alone jumps: a spike that no drawing may lose."""
GAP = (3000, 3120)
"""Epochs without a bound."""
ALONE = 3060
"""The one epoch within the gap that has one."""

_POINTS = [
    ("ZBAA", 40.07, 116.60),
    ("WPT-A", 38.60, 116.70),
    ("WPT-B", 36.90, 117.60),
    ("WPT-C", 34.80, 118.90),
    ("WPT-D", 32.90, 120.10),
    ("ZSSS", 31.20, 121.33),
]


@dataclass
class Fixture:
    """The arguments of report.render."""

    summary: Summary
    record: RunRecord
    epochs: pl.DataFrame
    events: pl.DataFrame
    waypoints: list[Waypoint] = field(default_factory=list)


def _route(share: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    lat = np.radians([p[1] for p in _POINTS])
    lon = np.radians([p[2] for p in _POINTS])
    knots = np.linspace(0, 1, len(_POINTS))
    kernel = np.hanning(241) / np.hanning(241).sum()
    smooth = [np.convolve(np.pad(np.interp(share, knots, v), 120, "reflect", reflect_type="odd"), kernel, "valid") for v in (lat, lon)]
    east = np.gradient(smooth[1]) * np.cos(smooth[0])
    return smooth[0], smooth[1], np.arctan2(east, np.gradient(smooth[0])) % (2 * math.pi)


def _wander(rng: np.random.Generator, n: int, sigma: float, tau: float) -> np.ndarray:
    a = math.exp(-1 / tau)
    out = np.empty(n)
    out[0] = rng.normal() * sigma
    noise = rng.normal(size=n) * sigma * math.sqrt(1 - a * a)
    for i in range(1, n):
        out[i] = a * out[i - 1] + noise[i]
    return out


def epochs(track: str = "flight-000", n: int = N, seed: int = 7, truth: bool = True) -> pl.DataFrame:
    """One made-up track."""
    rng = np.random.default_rng(seed)
    t = np.arange(n)
    lat, lon, course = _route(t / (n - 1))
    sigma_e, sigma_n, sigma_u = (s * (1 + 0.25 * np.sin(t / 700 + k)) for k, s in enumerate((1.4, 1.2, 2.6)))
    rho = 0.3 * np.sin(t / 900)
    fte = _wander(rng, n, 18, 60) * np.where(t < 700, 1.6, 1.0)
    if n == N:
        fte[SPIKE] += 420.0
        fte[6300:6420] += 260.0 * np.hanning(120)
    fte_v = _wander(rng, n, 9, 40)
    nse_e, nse_n, nse_u = (_wander(rng, n, 1, 300) * s for s in (sigma_e, sigma_n, sigma_u))
    cross = nse_e * np.cos(course) - nse_n * np.sin(course)
    along_error = nse_e * np.sin(course) + nse_n * np.cos(course)
    sigma_cross = np.sqrt((sigma_e * np.cos(course)) ** 2 + (sigma_n * np.sin(course)) ** 2)
    edges = (np.array([0.09, 0.85, 0.95]) * n).astype(int)
    rnp = np.select([t < edges[0], t < edges[1], t < edges[2]], [NM, 2 * NM, NM], 0.3 * NM)
    phase = np.select([t < edges[0], t < edges[1], t < edges[2]], ["departure", "en route", "arrival"], "approach")
    tse_exact = np.hypot(np.abs(fte) + 1.64 * sigma_cross, 0.8 * sigma_cross)
    tse_integrity = np.abs(fte) + 4.3 * sigma_cross
    circle = 2.4 * np.maximum(sigma_e, sigma_n)
    warning = np.abs(fte) > 2 * rnp * 0.2
    alert = np.where(warning & (t > n * 0.85), "caution", "normal").astype(object)
    alert[np.abs(t - 6360) < 12] = "warning" if n == N else "normal"
    status = np.full(n, "ok", dtype=object)
    reason: list[str | None] = [None] * n
    bound_gap = np.zeros(n, dtype=bool)
    if n == N:
        bound_gap[GAP[0] : GAP[1]] = True
        bound_gap[ALONE] = False
        status[bound_gap], alert[bound_gap] = "not_available", "unavailable"
        reason = ["fixture: three satellites, four needed" if g else None for g in bound_gap]
    logits = np.stack([-np.abs(tse_exact[:, None] - c).ravel() / 40 for c in (25, 70, 200, 500)], axis=1)
    posterior = np.exp(logits - logits.max(axis=1, keepdims=True))
    posterior /= posterior.sum(axis=1, keepdims=True)
    step_m = 160.0

    def hole(values: np.ndarray) -> np.ndarray:
        return np.where(bound_gap, np.nan, values)

    frame = pl.DataFrame(
        {
            "track": [track] * n,
            "time_ns": START_NS + t.astype(np.int64) * 1_000_000_000,
            "est_lat_rad": lat - fte * np.sin(course) / 6.37e6,
            "est_lon_rad": lon + fte * np.cos(course) / (6.37e6 * np.cos(lat)),
            "est_h_m": 10000 * np.minimum(1, np.minimum(t, n - 1 - t) / 1100) + fte_v,
            "cov_ee_m2": sigma_e**2,
            "cov_en_m2": rho * sigma_e * sigma_n,
            "cov_nn_m2": sigma_n**2,
            "cov_uu_m2": sigma_u**2,
            "path_lat_rad": lat,
            "path_lon_rad": lon,
            "path_h_m": 10000 * np.minimum(1, np.minimum(t, n - 1 - t) / 1100),
            "course_rad": course,
            "along_m": t * step_m,
            "leg": np.array([f"{a[0]}-{b[0]}" for a, b in pairwise(_POINTS)])[np.minimum(t * 5 // n, 4)],
            "phase": phase,
            "ground_speed_mps": np.full(n, step_m) + rng.normal(size=n),
            "rnp_m": rnp,
            "fte_m": fte,
            "fte_v_m": fte_v,
            "nse_e_m": nse_e,
            "nse_n_m": nse_n,
            "nse_u_m": nse_u,
            "nse_along_m": along_error,
            "nse_cross_m": cross,
            "nse_h_m": np.hypot(nse_e, nse_n),
            "nse_3d_m": np.sqrt(nse_e**2 + nse_n**2 + nse_u**2),
            "tse_m": fte + cross,
            "tse_v_m": fte_v + nse_u,
            "sigma_cross_m": hole(sigma_cross),
            "tse_exact_m": hole(tse_exact),
            "tse_ltem_m": hole(tse_exact * 1.03),
            "tse_exact_integrity_m": hole(tse_integrity),
            "tse_vertical_m": hole(np.abs(fte_v) + 1.7 * sigma_u),
            "anp_circle_m": hole(circle),
            "anp_sphere_m": hole(2.7 * sigma_u),
            "anp_along_m": hole(1.96 * sigma_n),
            "anp_cross_m": hole(1.96 * sigma_cross),
            "anp_vertical_m": hole(1.96 * sigma_u),
            "p_exceed_rnp": hole(10 ** -np.minimum(300, 3 + 40 * (rnp / (np.abs(fte) + 500)) ** 2)),
            "p_exceed_2rnp": hole(10 ** -np.minimum(300, 2.2 + (2 * rnp / (np.abs(fte) + 350)) ** 2)),
            "status": status,
            "reason": reason,
            "alert": alert,
            "state": np.array(STATES)[posterior.argmax(axis=1)],
            **{f"p_state_{i + 1}": posterior[:, i] for i in range(len(STATES))},
            "n_sv": rng.integers(17, 22, n),
            "hdop": 0.65 + 0.05 * np.sin(t / 400),
            "vdop": 0.96 + 0.08 * np.sin(t / 500),
        },
        strict=False,
    ).with_columns(pl.col(pl.Float64).fill_nan(None))
    return frame if truth else frame.drop([c for c in frame.columns if c.startswith(("nse_", "tse_m", "tse_v_m"))])


def _method(name: str, title: str, error: str, frame: pl.DataFrame, *, risk: float = 0.05, provenance: Provenance = "ours") -> MethodResult:
    column = frame[name.replace("-", "_") + ("_m" if risk > 1e-3 else "_integrity_m")]
    numbers = column.cast(pl.Float64).to_numpy()
    mean = float(np.nanmean(numbers))
    known = error in frame.columns
    within = frame.select((pl.col(error).abs() <= column).mean()).item() if known else None
    return MethodResult(
        id=name,
        title=title,
        source="test fixture, no document",
        provenance=provenance,
        assumes="fixture: nothing",
        error_column=error,
        may_alert=name.startswith("tse"),
        risk=risk,
        n=column.drop_nulls().len(),
        mean_m=mean,
        max_m=float(np.nanmax(numbers)),
        coverage=within,
        coverage_low=within - 0.01 if within is not None else None,
        coverage_high=min(1.0, within + 0.01) if within is not None else None,
        n_effective=240.5 if known else None,
        winkler_m=mean * 2.2 if known else None,
        pinball_m=mean / 15 if known else None,
    )


def flight(n_tracks: int = 1, truth: bool = True, n: int = N) -> Fixture:
    """Records and tables of a made-up run."""
    names = [f"flight-{i:03d}" for i in range(n_tracks)]
    frame = pl.concat([epochs(name, n, 7 + i, truth) for i, name in enumerate(names)])
    first = frame.filter(pl.col("track") == names[0])
    margin = first["rnp_m"] - first["tse_exact_m"]
    at = int(margin.arg_min() or 0)
    row = first.row(at, named=True)
    worst = Worst(
        track=names[0],
        time_ns=row["time_ns"],
        margin_m=margin[at],
        bound_m=row["tse_exact_m"],
        limit_m=row["rnp_m"],
        phase=row["phase"],
        along_m=row["along_m"],
        lat_rad=row["est_lat_rad"],
        lon_rad=row["est_lon_rad"],
    )
    accuracy = [
        _method("tse-exact", "TSE, exact folded normal", "tse_m", frame, provenance="re-derived"),
        _method("tse-ltem", "TSE, linear estimation", "tse_m", frame, provenance="printed"),
        _method("tse-vertical", "TSE, vertical", "tse_v_m", frame),
        _method("anp-circle", "ANP, circle", "nse_h_m", frame),
        _method("anp-sphere", "ANP, sphere", "nse_3d_m", frame),
        _method("anp-along", "ANP, along track", "nse_along_m", frame),
        _method("anp-cross", "ANP, across track", "nse_cross_m", frame),
        _method("anp-vertical", "ANP, vertical", "nse_u_m", frame),
    ]
    events = [
        EventSummary(
            track=names[0],
            kind="warning",
            onset_ns=START_NS + 6348 * 10**9,
            annunciation_ns=START_NS + 6348 * 10**9,
            clear_ns=START_NS + 6372 * 10**9,
            peak_m=300.0,
            limit_m=2 * NM,
            min_margin_m=-12.5,
            words="Fixture: integrity bound beyond 2 RNP </script><b>not markup</b>",
        ),
        EventSummary(
            track=names[0],
            kind="unavailable",
            onset_ns=START_NS + GAP[0] * 10**9,
            annunciation_ns=None,
            clear_ns=START_NS + GAP[1] * 10**9,
            peak_m=None,
            limit_m=None,
            min_margin_m=None,
            words="Fixture: three satellites, four needed",
        ),
        EventSummary(
            track=names[0],
            kind="waypoint",
            onset_ns=START_NS + 1416 * 10**9,
            annunciation_ns=None,
            clear_ns=None,
            peak_m=None,
            limit_m=None,
            min_margin_m=None,
            words="Fixture: passing WPT-A",
        ),
    ]
    summary = Summary(
        kind="fly",
        title="Fixture flight, not a result",
        verdict=Verdict(
            id="nothing_judged" if n < 10 else "inside",
            inside=None if n < 10 else True,
            words=(
                "Inside RNP for 99.8 % of the flight (fixture numbers). Worst margin 246 m in the approach. "
                "Assumed: nothing, the numbers are made up. Truth known."
            ),
            requirement="RNP by phase of flight",
            method="tse-exact",
            share_inside=0.998,
            share_contained=1.0,
            n_epochs=frame.height,
            n_judged=frame["tse_exact_m"].drop_nulls().len(),
            n_implausible=0,
            worst_accuracy=worst,
            worst_integrity=worst.model_copy(update={"margin_m": worst.margin_m * 2, "limit_m": worst.limit_m * 2}),
            truth_known=truth,
        ),
        coverage_kind="Fixture: coverage over the epochs of one flight, not over repeated flights.",
        assumptions=["Fixture: made-up Gaussian error.", "Fixture: covariance from nowhere."],
        phases=[
            PhaseSummary(
                phase=p,
                rnp_m=r * NM,
                n_epochs=1000,
                duration_s=1000,
                share_inside=0.99,
                worst_ratio=0.4,
                p_exceed_2rnp_max=2e-6,
                p_exceed_2rnp_mean=3e-9,
                coverage=0.95 if truth else None,
                n_cautions=0,
                n_warnings=0,
            )
            for p, r in (("departure", 1), ("en route", 2), ("arrival", 1), ("approach", 0.3))
        ],
        tracks=[
            TrackSummary(
                track=name,
                label=f"Fixture {i}",
                n_epochs=n,
                start_ns=START_NS,
                duration_s=float(n - 1),
                fte_mean_m=0.5 * i,
                fte_std_m=20 + (i * 7) % 5,
                fte_abs95_m=41.0 + (i * 5) % 7,
                share_inside=1 - 0.001 * i,
                worst_ratio=0.4 + 0.01 * ((i * 3) % n_tracks),
                worst_margin_m=300.0 - i,
                n_cautions=0,
                n_warnings=1 if i == 0 else 0,
                n_unavailable=GAP[1] - GAP[0] if n == N else 0,
            )
            for i, name in enumerate(names)
        ],
        accuracy=accuracy,
        integrity=[_method("tse-exact", "TSE, exact folded normal", "tse_m", frame, risk=1e-5, provenance="re-derived")],
        honesty=CovarianceConsistency(
            n=frame.height,
            n_effective=240.5,
            dimension=2,
            nees_mean=2.11,
            nees_low=1.76,
            nees_high=2.26,
            pit_low=480,
            pit_high=936,
            pit_counts=[700, 690, 742, 655, 718, 731, 699, 706, 610, 830],
            words="Fixture: the claimed covariance agrees with the errors.",
        )
        if truth
        else None,
        states=STATES,
        events=events,
        cross_track=[
            CrossTrack(path="LFPG 08R (fixture)", n_tracks=9, n_points=990, mean_m=1.2, std_m=14.3, abs95_m=29.8, between_tracks_std_m=8.8)
        ],
        rejected=[Rejection(file="fixture.csv", reason="latitude missing", count=3, first_line=17, example="2020-01-01,,12.0")],
        n_status={"ok": frame.height - 120, "not_available": 120},
    )
    record = RunRecord(
        navbound_version="0.0.0-fixture",
        command="navbound fly fixture",
        created_utc="2026-01-01T00:00:00Z",
        kind="fly",
        scenario={"name": "fixture"},
        seed=7,
        inputs=[InputFile(path="fixture.csv", sha256="0" * 64, n_bytes=1234, n_rows=frame.height)],
        methods=["tse-exact", "tse-ltem", "anp-circle"],
        risk_accuracy=0.05,
        risk_integrity=1e-5,
        settings={"correlation_time_s": 60.0},
        platform="fixture",
    )
    waypoints = [
        Waypoint(name=p[0], lat_rad=math.radians(p[1]), lon_rad=math.radians(p[2]), kind="runway" if p[0].startswith("Z") else "waypoint")
        for p in _POINTS
    ]
    table = pl.DataFrame([e.model_dump() for e in events], infer_schema_length=None)
    return Fixture(summary, record, frame, table, waypoints)
