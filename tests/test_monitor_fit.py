"""Detections of healthy receivers against their allocation, residuals against the error model, injected faults."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import polars as pl
import pytest
from scipy import stats

import navbound
import rinex_fixture
from navbound import araim, gnss, raim
from navbound.gnss.monitor_fit import DISBELIEF, exact_interval, fit_of
from test_gnss_ionosphere import EXAMPLES, with_biased_ranges

LIGHT = 299792458.0
DAY = "ESBC00DNK_R_20201770000_01D"
WAVELENGTH_M = {"1": LIGHT / 1575.42e6, "2": LIGHT / 1227.60e6, "5": LIGHT / 1176.45e6, "7": LIGHT / 1207.14e6}


@pytest.fixture(scope="module")
def day(shared_data: Path) -> tuple[gnss.Observations, gnss.Navigation, list[float]]:
    folder = shared_data / "gnss" / "ESBC_2020_177"
    truth = json.loads((shared_data / "baselines.json").read_text(encoding="utf-8"))["ESBC_2020_177"]["reference_ecef_m"]
    return gnss.read_observations(folder / f"{DAY}_30S_MO.crx.gz"), gnss.read_navigation(folder / f"{DAY}_MN.rnx.gz"), truth


@pytest.mark.parametrize(("k", "n"), [(0, 10), (1, 10), (3, 2880), (17, 40), (40, 40)])
def test_the_exact_interval_is_that_of_the_beta_law(k: int, n: int) -> None:
    low, high = exact_interval(k, n)
    # Bisection of sums of exponentials of logarithms near 1e4: 1e-16 * 1e4.
    assert low == pytest.approx(stats.beta.ppf(0.025, k, n - k + 1) if k else 0.0, rel=1e-9)
    assert high == pytest.approx(stats.beta.isf(0.025, k + 1, n - k) if k < n else 1.0, rel=1e-9)


def epochs(scale: float, seed: int, n: int = 4000) -> tuple[np.ndarray, np.ndarray]:
    """Chi-squares of eight redundancies, half of each of two constellations."""
    rng = np.random.default_rng(seed)
    statistic = np.zeros((n, 5))
    statistic[:, [0, 2]] = scale * rng.chisquare(4, (n, 2))
    redundancy = np.zeros((n, 5))
    redundancy[:, [0, 2]] = 4.0
    return statistic, redundancy


def test_the_interval_of_the_ratio_holds_the_truth_as_often_as_it_says() -> None:
    covered = 0
    for seed in range(200):
        fit = fit_of(*epochs(1.3, seed, 400), np.full(400, "none"), 1e-5)
        covered += fit.ratio_low <= 1.3 <= fit.ratio_high
    # 95 % of 200 is 190 with a deviation of 3.1; the number of effective epochs is estimated, which costs some.
    assert 178 <= covered <= 200


def test_a_model_that_is_too_small_is_not_believed() -> None:
    right = fit_of(*epochs(1.0, 1), np.full(4000, "none"), 1e-5)
    assert right.residuals_fit
    assert right.believable
    assert DISBELIEF not in right.words
    small = fit_of(*epochs(1.5, 1), np.full(4000, "none"), 1e-5)
    assert not small.believable
    assert DISBELIEF in small.words
    assert small.ratio_of_system.keys() == {"gps", "galileo"}
    # Detections alone contradict the allocation too.
    detected = np.full(4000, "none", dtype="<U12")
    detected[100::400] = "excluded"
    often = fit_of(*epochs(1.0, 1), detected, 1e-5)
    assert often.residuals_fit
    assert not often.detections_fit
    assert DISBELIEF in often.words
    assert often.n_events == 10


def test_nothing_to_compare_is_not_believed() -> None:
    none = fit_of(np.full((3, 5), np.nan), np.full((3, 5), np.nan), np.array(["", "", ""]), 1e-5)
    assert not none.believable
    assert DISBELIEF in none.words


def test_detections_that_follow_each_other_are_one_event() -> None:
    rng = np.random.default_rng(3)
    statistic, redundancy = epochs(1.0, 3)
    # A statistic that keeps its value for 100 epochs: 40 independent ones.
    slow = np.repeat(rng.chisquare(4, (40, 2)), 100, axis=0)
    statistic[:, [0, 2]] = slow
    decision = np.full(4000, "none", dtype="<U12")
    decision[1000:1040] = "excluded"
    fit = fit_of(statistic, redundancy, decision, 1e-5)
    assert 20 < fit.n_effective < 90
    assert (fit.n_detected, fit.n_events) == (40, 1)
    assert fit.detections_fit
    # One satellite after the other is no single fault, however close they follow.
    decision[1000:1040] = np.resize(["G05", "G07"], 40)
    many = fit_of(statistic, redundancy, decision, 1e-5)
    assert many.n_events == min(40, round(many.n_effective))
    assert not many.detections_fit


@pytest.mark.parametrize("systems", ["G", "GE", "GEC"])
def test_a_healthy_day_is_within_the_allocation(day: tuple[gnss.Observations, gnss.Navigation, list[float]], systems: str) -> None:
    observations, navigation, truth = day
    watched = araim.watch(observations, navigation, systems=systems, truth_ecef_m=truth)
    assert watched.fit.n_epochs == 2880
    assert 5 < watched.fit.n_effective < 2880
    assert watched.fit.believable, watched.fit.words
    epochs = watched.epochs.drop_nulls(["hpl_m", "nse_e_m"])
    assert epochs.height > 0.99 * 2880
    assert (np.hypot(epochs["nse_e_m"], epochs["nse_n_m"]) < epochs["hpl_m"]).all()
    assert (epochs["nse_u_m"].abs() < epochs["vpl_m"]).all()


def test_codes_as_measured_have_a_sigma_that_fits_too(day: tuple[gnss.Observations, gnss.Navigation, list[float]]) -> None:
    observations, navigation, _ = day
    smoothed, measured = (araim.watch(observations, navigation, smoothing_s=s) for s in (100.0, None))
    assert measured.fit.residuals_fit, measured.fit.words
    assert measured.epochs["hpl_m"].median() > smoothed.epochs["hpl_m"].median()  # type: ignore[operator]
    assert measured.models["smoothing"] == "none"


def test_a_receiver_that_set_no_number_is_within_the_allocation(shared_data: Path) -> None:
    folder = shared_data / "gnss" / "ARLM_2015_200"
    watched = araim.watch(gnss.read_observations(folder / "arlm200x.15o"), gnss.read_navigation(folder / "arlm2000.15n"), systems="G")
    assert watched.fit.n_epochs == 120
    assert watched.fit.believable, watched.fit.words


def test_a_model_that_does_not_fit_the_ranges_is_marked(day: tuple[gnss.Observations, gnss.Navigation, list[float]]) -> None:
    observations, navigation, _ = day
    model = replace(araim.ERROR_MODELS["dual-frequency"], noise=(0.02, 0.02, 0.2), source="a tenth")
    support = replace(araim.SUPPORT, sigma_ura_m=(0.1,) * 5, sigma_ure_m=(0.1,) * 5)
    watched = araim.watch(observations, navigation, model=model, support=support)
    assert not watched.fit.believable
    assert DISBELIEF in watched.models["fit of the error model"]


PAIRS = {"G": ["C1C", "C1W", "C2W", "L1C", "L2W"], "E": ["C1C", "C5Q", "L1C", "L5Q"]}


def test_the_verdict_of_a_run_says_where_the_model_does_not_fit(
    day: tuple[gnss.Observations, gnss.Navigation, list[float]], shared_data: Path, tmp_path: Path
) -> None:
    """Two hours of codes without phases: as they are, and with a metre of noise that no model knows of."""
    navigation = shared_data / "gnss" / "ESBC_2020_177" / f"{DAY}_MN.rnx.gz"
    rng = np.random.default_rng(5)

    def noisy(column: pl.DataFrame, _code: str) -> pl.DataFrame:
        return column.with_columns(value=pl.col("value") + pl.Series(rng.normal(0.0, 1.0, column.height)))

    codes = {"G": ["C1C", "C1W", "C2W"], "E": ["C1C", "C5Q"]}
    runs = {}
    for name, change in (("quiet", None), ("noisy", noisy)):
        path = tmp_path / f"{name}.rnx"
        rinex_fixture.write(day[0], path, codes, until_s=7200.0, change=change)
        runs[name] = navbound.evaluate([path, navigation], levels="LPV-200", protection="araim").summary
    assert DISBELIEF not in runs["quiet"].verdict.words
    assert runs["noisy"].verdict.words.startswith(f"The protection levels {DISBELIEF}")
    for summary in runs.values():
        words = " ".join(summary.assumptions)
        assert "Galileo E1-E5a with FNAV" in words
        assert "below the elevation mask at" in words
        assert "Squared residuals are" in words


def faulty(observations: gnss.Observations, path: Path, satellite: str, fault_m: np.ndarray) -> gnss.Observations:
    """The beginning of the day with a fault of the satellite's clock: the same metres on every code and phase, one number an epoch."""
    fault = pl.DataFrame({"time_ns": observations.time_ns[: fault_m.size], "fault_m": fault_m})

    def change(column: pl.DataFrame, code: str) -> pl.DataFrame:
        unit_m = 1.0 if code[0] == "C" else WAVELENGTH_M[code[1]]
        shift = pl.when(pl.col("satellite") == satellite).then(pl.col("fault_m") / unit_m).otherwise(0.0)
        joined = column.join(fault, on="time_ns", maintain_order="left")
        return joined.with_columns(value=pl.col("value") + shift).drop("fault_m")

    return rinex_fixture.write(observations, path, PAIRS, until_s=30.0 * fault_m.size, change=change)


@pytest.mark.parametrize("kind", ["step", "ramp"])
def test_an_injected_fault_of_one_satellite_is_excluded(
    day: tuple[gnss.Observations, gnss.Navigation, list[float]], tmp_path: Path, kind: str
) -> None:
    _, navigation, truth = day
    # 0.1 m/s from half past midnight on, or 30 m at once.
    after = np.clip(30.0 * (np.arange(240) - 60), 0.0, None)
    fault_m = np.where(after > 0, 30.0, 0.0) if kind == "step" else 0.1 * after
    observations = faulty(day[0], tmp_path / "faulty.rnx", "G30", fault_m)
    watched = araim.watch(observations, navigation, truth_ecef_m=truth)
    table = watched.epochs.with_columns(fault_m=pl.Series(fault_m))
    assert (table.filter(pl.col("fault_m") == 0)["n_excluded"] == 0).all()
    large = table.filter(pl.col("fault_m") >= 25)
    assert large.height > 100
    assert set(large["reason"]) == {"excluded G30"}
    known = table.drop_nulls("hpl_m")
    assert (np.hypot(known["nse_e_m"], known["nse_n_m"]) < known["hpl_m"]).all()
    assert (known["nse_u_m"].abs() < known["vpl_m"]).all()
    # One satellite in fault says nothing against the error model of the others.
    assert watched.fit.n_detected >= large.height
    assert watched.fit.n_events == 1
    assert watched.fit.believable, watched.fit.words


def test_raim_compares_its_residuals_too(day: tuple[gnss.Observations, gnss.Navigation, list[float]]) -> None:
    observations, navigation, _ = day
    watched = raim.watch(observations, navigation)
    assert watched.fit.residuals_fit, watched.fit.words
    assert "fit of the error model" in watched.models


def test_levels_whose_model_the_residuals_contradict_show_nothing(tmp_path: Path) -> None:
    """An error of 8 m (one sigma) in all ranges of each satellite: no error is above its level, and the levels promise nothing."""
    biased = with_biased_ranges(tmp_path, "G", 8.0)
    run = navbound.evaluate(
        [biased, EXAMPLES / "broadcast.rnx"], protection="raim", levels="RNP 0.3", truth="4189135.1896,188029.6189,4789919.6247"
    )
    assert run.summary.performance is not None
    assert run.summary.performance.levels[0].n_mi_events == 0
    assert run.summary.verdict.id == "not_shown"
