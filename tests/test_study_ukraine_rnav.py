"""The flight from Kyiv to Kharkiv: what the tables say follows from the stations, and the drawn errors keep to the covariances."""

from __future__ import annotations

import io
import itertools
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
import polars as pl
import pytest
from rich.console import Console
from scipy import stats

import navbound
from navbound import InputError, evaluation, rnp
from navbound.run import directory
from navbound.studies.ukraine_rnav import flight as scene
from navbound.studies.ukraine_rnav import study

if TYPE_CHECKING:
    from pathlib import Path

    from navbound.run.directory import Run

NM = 1852.0


@cache
def result() -> study.Study:
    return study.run()


@cache
def flown() -> Run:
    return study.fly()


def test_the_route_is_as_long_as_the_sum_of_its_legs() -> None:
    """Great-circle sum by the haversine on a sphere: within 0.3 % of the ellipsoid, and turns cut corners by less than that."""
    points = np.radians(list(scene.POINTS_DEG.values()))
    lat = np.concatenate(([np.radians(50.36)], points[:, 0], [np.radians(49.925)]))
    lon = np.concatenate(([np.radians(30.908)], points[:, 1], [np.radians(36.274)]))
    half = np.sin(np.diff(lat) / 2) ** 2 + np.cos(lat[1:]) * np.cos(lat[:-1]) * np.sin(np.diff(lon) / 2) ** 2
    length_nm = float(2 * 6371.0 * np.arcsin(np.sqrt(half)).sum() / 1.852)
    assert result().length_nm == pytest.approx(length_nm, rel=5e-3)


def test_drawn_errors_keep_to_the_stated_covariance() -> None:
    """Errors are drawn anew at every epoch, so epochs are independent: exact binomial and chi-square limits at 1e-4."""
    for track in (scene.PAIR, scene.ALL, scene.VOR):
        rows = flown().epochs.filter(pl.col("track") == track, pl.col("nse_cross_m").is_not_null(), pl.col("anp_cross_m").is_not_null())
        n_inside = int((rows["nse_cross_m"].abs() <= rows["anp_cross_m"]).sum())
        assert stats.binomtest(n_inside, rows.height, 0.95).pvalue > 1e-4, (track, n_inside / rows.height)
        if track == scene.VOR:
            # A bearing's arc bends: at 60 NM two deviations of it are 350 m short along the radial, more than the range's own error.
            continue
        covariance = np.array([[rows[f"cov_{a}_m2"] for a in ("ee", "en")], [rows[f"cov_{a}_m2"] for a in ("en", "nn")]]).transpose(2, 0, 1)
        error = rows.select("nse_e_m", "nse_n_m").to_numpy()
        statistics = evaluation.nees(error, covariance)
        low, high = stats.chi2.ppf([5e-5, 1 - 5e-5], 2 * rows.height) / rows.height
        assert low < statistics.nees_mean < high, (track, statistics.nees_mean)


def test_the_pair_is_available_where_two_stations_are_and_better_than_a_bearing() -> None:
    by_name = {m.track: m for m in result().means}
    pair, every, vor = (by_name[name] for name in (scene.PAIR, scene.ALL, scene.VOR))
    assert 0.7 < pair.share_available <= every.share_available < vor.share_available
    assert pair.nse95_median_m is not None
    assert every.nse95_median_m is not None
    assert vor.nse95_median_m is not None
    assert every.nse95_median_m < pair.nse95_median_m < 0.2 * vor.nse95_median_m
    # Every epoch that has a pair has a position: no mirror is taken for it, and none is lost.
    for m in result().means:
        solved = flown().epochs.filter(pl.col("track") == m.track, pl.col("status") != "not_available").height
        assert solved == round(m.share_available * result().n_epochs)
    # Two ranges of 182.6 m at right angles: 1.96 times that across any course, the least a pair can have.
    assert pair.nse95_median_m > 1.96 * 182.6


def test_the_pairs_follow_each_other_without_a_gap_or_a_twin() -> None:
    pairs = result().pairs
    assert len(pairs) > 3
    for before, after in itertools.pairwise(pairs):
        assert after.from_nm - before.to_nm == pytest.approx(scene.STEP_S * scene.SPEED_MPS / NM, abs=1e-9)
        assert before.stations != after.stations
    assert len(pairs) - 1 <= result().n_switches_without_waiting
    assert {name for p in pairs for name in p.stations.split("-")} <= set(result().stations)


def test_posteriors_are_those_of_the_classifier_for_the_error_shown() -> None:
    classifier = rnp.StateClassifier((0.3, 1.0, 2.0, 5.0), fte_nm=(0.15, 0.5, 1.0, 2.5))
    # Table of section 5.3, flight technical error of half of each level.
    assert result().boundary_m == pytest.approx([NM * b for b in (0.259807621, 0.866025404, 1.732050808, 4.330127019)], rel=1e-8)
    shown = [p for p in result().points if p.posterior is not None]
    assert len(shown) > 8
    for p in shown:
        assert p.nse95_pair_m is not None
        assert p.posterior == pytest.approx(classifier.posterior(p.nse95_pair_m), rel=1e-9, abs=1e-300)
        limits = [*result().boundary_m, np.inf]
        assert p.state == result().states[int(np.argmax(p.nse95_pair_m <= np.array(limits)))]
        sigma = p.nse95_pair_m / stats.norm.ppf(0.975)
        inside = 1 - 2 * stats.norm.sf(np.array(limits) / sigma)
        assert p.probability == pytest.approx(np.diff(inside, prepend=0.0), abs=1e-9)
    assert result().agreement == 1.0


def test_the_report_track_of_the_authors_differs_only_in_its_states() -> None:
    epochs = flown().epochs
    pair, authors = (epochs.filter(pl.col("track") == name) for name in (scene.PAIR, study.AUTHORS))
    states = [f"p_state_{k}" for k in range(1, 6)]
    assert pair.drop("track", "state", *states).equals(authors.drop("track", "state", *states))
    # The twin shows states only: the verdict counts each epoch once.
    assert flown().summary.verdict.n_epochs == 3 * pair.height
    total = authors.select(pl.sum_horizontal(states)).drop_nulls().to_series()
    usable = authors["sigma_cross_m"].is_not_null().sum()
    assert usable > 200
    assert np.allclose(total.to_numpy()[authors["sigma_cross_m"].is_not_null().to_numpy()], 1.0, atol=1e-12)
    assert not pair["p_state_1"].equals(authors["p_state_1"])


def test_a_seed_changes_the_draws_and_nothing_else() -> None:
    other = study.run(seed=7)
    assert [p.model_dump() for p in other.points] == [p.model_dump() for p in result().points]
    assert other.means != result().means
    with pytest.raises(InputError, match="seed"):
        study.run(seed=-1)


def test_it_renders_survives_json_and_writes_its_report(tmp_path: Path) -> None:
    console = Console(width=140, record=True, file=io.StringIO())
    console.print(result().table())
    text = console.export_text()
    assert "Optimal DME pair" in text
    assert "not known" in text
    assert study.Study.model_validate_json(result().model_dump_json()) == result()
    navbound.study("ukraine-rnav", out=tmp_path / "run")
    run = directory.load(tmp_path / "run")
    assert {t.track for t in run.summary.tracks} == {scene.PAIR, scene.ALL, scene.VOR, study.AUTHORS}
    assert (tmp_path / "run" / "report.html").stat().st_size > 100_000
    with pytest.raises(InputError, match="out"):
        navbound.study("tse-coverage", out=tmp_path / "other")
    with pytest.raises(InputError, match="files"):
        navbound.study("ukraine-rnav", ["a.csv"])
