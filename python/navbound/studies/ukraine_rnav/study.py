"""A flight from Kyiv to Kharkiv on DME and VOR: navigation error of the optimal pair along the route, and the RNP states it supports.

Ostroumov and Kuzmenko 2018 show such a flight as figures, without numbers, route, profile or error model; so nothing here is compared
with theirs. Shown are the optimal pair with all DMEs in view and the best VOR/DME beside it, the posteriors of the authors' classifier
(in its safe form) for the 95 % navigation error across the route, and the probabilities that the law of the error itself gives.
"""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import anp, rnp, tse
from navbound.errors import InputError
from navbound.records.base import Record
from navbound.run.judge import STATE_LEVELS_NM, judge
from navbound.studies.ukraine_rnav import flight as scene
from navbound.units import METRES_PER_NM

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from rich.console import RenderableType

    from navbound.run.directory import Run

    Floats = NDArray[np.float64]

RISK = 0.05
FTE_SHARE = 0.5
"""Flight technical error (95 %) as a share of each level, for the boundaries of the authors' classifier; their values are not known."""
AUTHORS = "pair-authors-states"
EVERY_NM = 15.0
SEED = 2018


class Means(Record):
    """One way to navigate, over the whole flight; None where it never gave a position."""

    track: str
    label: str
    share_available: float
    nse95_median_m: float | None
    """Median of the 95 % navigation error across the route."""
    nse95_max_m: float | None
    circle_median_m: float | None
    """Median of the radius that holds the horizontal error with 95 %."""
    share_rnp_1: float
    """Share of the flight whose 95 % error across leaves room within 1 NM for a flight technical error of half of it."""
    coverage: float | None
    """Share of drawn errors across the route within their 95 % bound."""


class PairUse(Record):
    """A pair from taking to leaving."""

    stations: str
    from_nm: float
    to_nm: float
    drms_min_m: float
    drms_max_m: float


class Point(Record):
    """One point of the route."""

    along_nm: float
    h_m: float
    n_stations: int
    pair: str
    nse95_pair_m: float | None
    nse95_all_m: float | None
    nse95_vor_m: float | None
    posterior: list[float] | None
    """The authors' classifier, for `nse95_pair_m`."""
    probability: list[float] | None
    """From the law of the error, same boundaries."""
    state: str


class Study(Record):
    """The whole flight."""

    length_nm: float
    n_epochs: int
    stations: list[str]
    states: list[str]
    boundary_m: list[float]
    means: list[Means]
    pairs: list[PairUse]
    n_switches_without_waiting: int
    """Changes of the optimal pair if each better one were taken at once."""
    points: list[Point]
    agreement: float
    """Share of epochs where the most likely state is the one that comparison with the boundaries gives."""
    words: list[str]

    def table(self) -> RenderableType:
        """Lay the study out as tables for a terminal."""
        return _render(self)


def run(*, seed: int = SEED) -> Study:
    """Do the study.

    Parameters
    ----------
    seed : int
        Of the drawn errors of ranges and bearings; the tables of deviations and states do not depend on it.

    Raises
    ------
    InputError
        A negative seed.
    """
    flown, judged, classifier = _judged(seed)
    across = {name: _across(flown, matrix) for name, matrix in _matrices(flown).items()}
    nse95 = {name: tse.exact(0.0, np.where(np.isfinite(sigma), sigma, 0.0), RISK) for name, sigma in across.items()}
    nse95 = {name: np.where(np.isfinite(across[name]), values, np.nan) for name, values in nse95.items()}
    pair95 = nse95[scene.PAIR]
    known = np.isfinite(pair95)
    posterior, probability = (np.full((len(pair95), len(classifier.names)), np.nan) for _ in range(2))
    posterior[known] = classifier.posterior(pair95[known])
    probability[known] = classifier.probabilities(0.0, across[scene.PAIR][known])
    decided = np.where(known, classifier.classify(np.where(known, pair95, 0.0)), -1)
    agreement = float(np.mean(decided[known] == classifier.threshold_class(pair95[known])))
    pairs = _pairs(flown)
    at_once = int(np.count_nonzero((np.diff(flown.selection.best, axis=0) != 0).any(axis=1)))
    means = [_means(flown, judged, name, nse95[name]) for name in scene.LABELS]
    every = np.unique(np.searchsorted(flown.along_m, np.arange(0.0, flown.along_m[-1], EVERY_NM * METRES_PER_NM)))
    return Study(
        length_nm=float(flown.along_m[-1] / METRES_PER_NM),
        n_epochs=len(flown.along_m),
        stations=list(flown.stations.ident),
        states=classifier.names,
        boundary_m=classifier.boundary_m.tolist(),
        means=means,
        pairs=pairs,
        n_switches_without_waiting=at_once,
        points=[
            Point(
                along_nm=float(flown.along_m[k] / METRES_PER_NM),
                h_m=float(flown.h_m[k]),
                n_stations=int(flown.selection.n_stations[k]),
                pair=_pair_name(flown, k),
                nse95_pair_m=_some(pair95[k]),
                nse95_all_m=_some(nse95[scene.ALL][k]),
                nse95_vor_m=_some(nse95[scene.VOR][k]),
                posterior=posterior[k].tolist() if known[k] else None,
                probability=probability[k].tolist() if known[k] else None,
                state=classifier.names[decided[k]] if known[k] else "not available",
            )
            for k in every.tolist()
        ],
        agreement=agreement,
        words=_words(pairs, at_once, agreement),
    )


def fly(*, seed: int = SEED) -> Run:
    """The flight as a judged run, for the report; a fourth track shows the pair with the posteriors of the authors' classifier."""
    return _judged(seed)[1]


def _classifier() -> rnp.StateClassifier:
    return rnp.StateClassifier(STATE_LEVELS_NM, fte_nm=[FTE_SHARE * level for level in STATE_LEVELS_NM])


def _judged(seed: int) -> tuple[scene.Flight, Run, rnp.StateClassifier]:
    if not seed >= 0:
        raise InputError("seed", seed, domain="[0, inf)")
    flown = scene.flight(scene.network())
    material = scene.material(flown, seed)
    words = (
        f"On the track {AUTHORS} the states are posteriors of the authors' classifier (safe form) for the 95 % navigation error across the "
        "route, with a flight technical error of half of each level (theirs is not known); elsewhere they come from the law of the error."
    )
    judged, classifier = judge(replace(material, assumptions=[*material.assumptions, words])), _classifier()
    pair = material.epochs.filter(pl.col("track") == scene.PAIR).with_columns(pl.lit(AUTHORS).alias("track"))
    label = "Optimal DME pair, states by the authors' classifier"
    # Judged apart: the same flight must not count twice in the verdict.
    twin = judge(replace(material, epochs=pair, labels={AUTHORS: label}))
    epochs = pl.concat([judged.epochs, _with_posteriors(twin.epochs, classifier)])
    tracks = [*judged.summary.tracks, *twin.summary.tracks]
    return flown, replace(judged, table=epochs, summary=judged.summary.model_copy(update={"tracks": tracks})), classifier


def _with_posteriors(epochs: pl.DataFrame, classifier: rnp.StateClassifier) -> pl.DataFrame:
    """The authors' posteriors in place of the probabilities."""
    sigma = epochs["sigma_cross_m"].to_numpy()
    mine = np.isfinite(sigma)
    nse95 = tse.exact(0.0, sigma[mine], RISK)
    posterior, decided = classifier.posterior(nse95), classifier.classify(nse95)
    state = epochs["state"].to_list()
    for place, k in zip(np.flatnonzero(mine).tolist(), decided.tolist(), strict=True):
        state[place] = classifier.names[k]
    columns = [pl.Series("state", state, dtype=pl.String)]
    for k in range(len(classifier.names)):
        values = epochs[f"p_state_{k + 1}"].to_numpy().copy()
        values[mine] = posterior[:, k]
        columns.append(pl.Series(f"p_state_{k + 1}", values, nan_to_null=True))
    return epochs.with_columns(columns)


def _matrices(flown: scene.Flight) -> dict[str, Floats]:
    selection = flown.selection
    return {scene.PAIR: selection.used_en_m2, scene.ALL: selection.all_en_m2, scene.VOR: selection.vor_en_m2}


def _across(flown: scene.Flight, matrix: Floats) -> Floats:
    """Standard deviation across the course, NaN without a position."""
    known = np.isfinite(matrix[:, 0, 0])
    sigma = np.full(len(matrix), np.nan)
    sigma[known] = tse.project(np.zeros(2), matrix[known], flown.course_rad[known]).sigma_m
    return sigma


def _means(flown: scene.Flight, judged: Run, name: str, nse95: Floats) -> Means:
    known = np.isfinite(nse95)
    matrix = _matrices(flown)[name][known]
    limit = float(rnp.nse_boundary(scene.RNP_M, FTE_SHARE * scene.RNP_M))
    track = judged.epochs.filter(pl.col("track") == name, pl.col("nse_cross_m").is_not_null(), pl.col("anp_cross_m").is_not_null())
    share = track.select((pl.col("nse_cross_m").abs() <= pl.col("anp_cross_m")).mean()).item()
    return Means(
        track=name,
        label=scene.LABELS[name],
        share_available=float(known.mean()),
        nse95_median_m=_some(np.median(nse95[known])) if known.any() else None,
        nse95_max_m=_some(nse95[known].max()) if known.any() else None,
        circle_median_m=_some(np.median(anp.circle(matrix, RISK))) if known.any() else None,
        # Where there is no position nothing is supported.
        share_rnp_1=float(np.mean(nse95 <= limit)),
        coverage=None if share is None else float(share),
    )


def _pairs(flown: scene.Flight) -> list[PairUse]:
    used, nm = flown.selection.used, flown.along_m / METRES_PER_NM
    drms = np.sqrt(np.trace(flown.selection.used_en_m2, axis1=1, axis2=2))
    edges = [0, *(np.flatnonzero((np.diff(used, axis=0) != 0).any(axis=1)) + 1).tolist(), len(used)]
    return [
        PairUse(
            stations=_pair_name(flown, a),
            from_nm=float(nm[a]),
            to_nm=float(nm[b - 1]),
            drms_min_m=float(drms[a:b].min()),
            drms_max_m=float(drms[a:b].max()),
        )
        for a, b in itertools.pairwise(edges)
        if used[a, 0] >= 0
    ]


def _pair_name(flown: scene.Flight, k: int) -> str:
    names = [flown.stations.ident[i] for i in flown.selection.used[k].tolist() if i >= 0]
    return "-".join(names) or "none"


def _some(value: float | np.floating) -> float | None:
    return float(value) if np.isfinite(value) else None


def _words(pairs: list[PairUse], at_once: int, agreement: float) -> list[str]:
    return [
        "Not compared with the source: the slides show figures only; route, profile, error model and flight technical error are not known.",
        f"The pair changes {max(len(pairs) - 1, 0)} times when another must be 5 % better for 10 s, {at_once} times if each better one "
        "were taken at once.",
        f"With equal priors the most likely state is the one that comparison with the boundaries gives, at {agreement:.0%} of the epochs: "
        "the gain of the classifier is the graded posterior. That is no probability of the state; the law of the error gives one.",
        "The figure printed for a pair, 2 sqrt(sigma_1² + sigma_2²) / sin, is twice the drms and not an error across the route.",
    ]


def _metres(value: float | None) -> str:
    return "-" if value is None else f"{value:.0f}"


def _percent(values: list[float] | None) -> str:
    return "-" if values is None else " ".join(f"{100 * v:5.1f}" for v in values)


def _render(study: Study) -> RenderableType:
    from rich.console import Group  # noqa: PLC0415
    from rich.table import Table  # noqa: PLC0415

    title = f"UKBB to UKHH, {study.length_nm:.0f} NM, {study.n_epochs} epochs, {len(study.stations)} stations"
    means = Table(title=title)
    for heading in (
        "navigation",
        "available [%]",
        "95 % across, median [m]",
        "max [m]",
        "95 % circle, median [m]",
        "room for RNP 1 [%]",
        "drawn errors held [%]",
    ):
        means.add_column(heading, justify="left" if heading == "navigation" else "right")
    for m in study.means:
        numbers = [_metres(v) for v in (m.nse95_median_m, m.nse95_max_m, m.circle_median_m)]
        coverage = "-" if m.coverage is None else f"{100 * m.coverage:.1f}"
        means.add_row(m.label, f"{100 * m.share_available:.1f}", *numbers, f"{100 * m.share_rnp_1:.1f}", coverage)
    pairs = Table(title="The pair in use")
    for heading in ("stations", "from [NM]", "to [NM]", "drms least [m]", "most [m]"):
        pairs.add_column(heading)
    for p in study.pairs:
        pairs.add_row(p.stations, f"{p.from_nm:.1f}", f"{p.to_nm:.1f}", f"{p.drms_min_m:.0f}", f"{p.drms_max_m:.0f}")
    points = Table(title="Along the route: navigation error across it (95 %)")
    for heading in ("NM", "height [m]", "stations", "pair", "pair [m]", "all in view [m]", "VOR/DME [m]"):
        points.add_column(heading, justify="left" if heading == "pair" else "right")
    states = Table(title=f"Along the route with the pair: {', '.join(study.states)} [%]")
    for heading in ("NM", "pair [m]", "authors' posterior", "law of the error", "state"):
        states.add_column(heading, justify="left" if heading == "state" else "right")
    for q in study.points:
        errors = [_metres(v) for v in (q.nse95_pair_m, q.nse95_all_m, q.nse95_vor_m)]
        points.add_row(f"{q.along_nm:.0f}", f"{q.h_m:.0f}", str(q.n_stations), q.pair, *errors)
        states.add_row(f"{q.along_nm:.0f}", errors[0], _percent(q.posterior), _percent(q.probability), q.state)
    return Group(means, pairs, points, states, *study.words)
