"""Flights that navigate by their sensors: whether the filter is as good as it says, what faults do, and what is stated of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from scipy import integrate, stats

from navbound import FormatError, anp, evaluation, scenario
from navbound.records.faults import FaultSummary
from navbound.records.material import Material
from navbound.run import fly
from navbound.run.directory import Run
from navbound.run.judge import judge
from navbound.run.settings import Settings
from navbound.run.verdict import faults
from navbound.run.verdict.faults import fault_summaries
from navbound.scenario import Scenario
from navbound.studies.anp_comparison import study as anp_comparison

RATE_HZ = 10
"""The path is smooth: ten samples a second lose millimetres and save nineteen parts of twenty of the time."""


def quick(name: str, faults: list[dict[str, Any]] | None = None, constellations: list[str] | None = None) -> Scenario:
    loaded = scenario.load(name)
    data = loaded.model_dump()
    data["sensors"]["rate_hz"] = RATE_HZ
    if constellations is not None:
        data["sensors"]["gnss"]["constellations"] = constellations
    if faults is not None:
        data["sensors"]["faults"] = faults
    return Scenario.model_validate(data)


def errors(epochs: pl.DataFrame, skip_s: float = 120.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    late = epochs.filter(pl.col("time_ns") - pl.col("time_ns").min() >= skip_s * 1e9)
    error = late.select("nse_e_m", "nse_n_m", "nse_u_m").to_numpy()
    ee, en, nn, eu, nu, uu = late.select("cov_ee_m2", "cov_en_m2", "cov_nn_m2", "cov_eu_m2", "cov_nu_m2", "cov_uu_m2").to_numpy().T
    covariance = np.moveaxis(np.array([[ee, en, eu], [en, nn, nu], [eu, nu, uu]]), 2, 0)
    return error, covariance, late["track"].rle_id().to_numpy()


@pytest.fixture(scope="module")
def real() -> Material:
    return fly.material(quick("beijing-shanghai-real"), flights=4)


@pytest.fixture(scope="module")
def white() -> Run:
    return judge(fly.material(quick("beijing-shanghai-white")), Settings(methods=()))


def test_the_filter_is_as_good_as_it_says_where_errors_stay(real: Material) -> None:
    error, covariance, track = errors(real.epochs)
    nees = evaluation.nees(error, covariance, track)
    assert nees.nees_low <= nees.nees_mean <= nees.nees_high
    # Four flights of few independent epochs: the share is uncertain by its own bootstrap; fifty are in docs/methods/fused-flight.md.
    circle, sphere = anp.circle(covariance[:, :2, :2], 0.05), anp.sphere(covariance, 0.05)
    for size, bound in ((np.hypot(error[:, 0], error[:, 1]), circle), (np.linalg.norm(error, axis=1), sphere)):
        low, high = evaluation.bootstrap_coverage(size, bound, track)
        assert low <= 0.98
        assert high >= 0.93


def test_a_filter_that_takes_all_errors_for_white_is_caught_by_nees_and_pit_but_not_by_its_innovations(white: Run) -> None:
    consistency = white.summary.honesty
    assert consistency is not None
    # Claimed 0.7 m where the errors are 4 m and more (specification 7, case C): 100 times in the mean; ten is far beyond chance.
    assert consistency.nees_mean > 10 * consistency.nees_high
    assert consistency.pit_counts[-1] > 5 * consistency.pit_high
    assert "claims smaller errors" in consistency.words
    reported = white.record.settings["filter"]
    assert isinstance(reported, dict)
    # The mean squared innovation looks healthy. What gives the filter away is that each innovation knows the one before.
    assert reported["range"]["mean_square"] < 1.2
    assert reported["range"]["lag_one"] > 0.3


def test_flights_do_not_depend_on_the_company_they_keep(real: Material) -> None:
    alone = fly.material(quick("beijing-shanghai-real"), flights=1).epochs
    assert alone.equals(real.epochs.filter(pl.col("track") == "flight-000"))


def test_the_mode_falls_back_without_satellites_and_returns() -> None:
    epochs = fly.material(quick("beijing-shanghai-jammed", constellations=["gps"])).epochs
    mode = epochs["nav_mode"].to_list()
    # Five seconds of patience and one and a half in which a measurement counts as there; ten seconds before the return counts.
    assert mode[2400] == mode[2404] == "gnss"
    assert set(mode[2408:3600]) <= {"dme_dme", "vor_dme", "coasting"}
    assert mode[3615] == "gnss"
    lost = epochs[2500:3600]
    assert lost["n_sv"].max() == 0
    assert lost["hdop"].null_count() == lost.height
    assert lost["status"].unique().to_list() == ["degraded"]
    # The covariance knows: the error stays within three of its deviations.
    ratio = lost["nse_e_m"].abs() / lost["cov_ee_m2"].sqrt()
    assert ratio.max() < 3.5  # type: ignore[operator]


def summary(name: str, faults: list[dict[str, Any]] | None = None) -> tuple[Run, list[FaultSummary]]:
    # Fewer satellites are faster, and enough where none of them is at fault.
    result = quick(name, faults, ["gps", "beidou"] if "satellite" in name or "approach" in name else ["gps"])
    run = judge(fly.material(result), Settings(methods=()))
    return run, fault_summaries(result, run.epochs, run.events)


@pytest.mark.parametrize(
    ("name", "kinds"),
    [
        ("beijing-shanghai-jammed", ["interference"]),
        ("beijing-shanghai-spoofed", ["spoofing"]),
        ("beijing-shanghai-spoofed-approach", ["spoofing"]),
        ("beijing-shanghai-satellite-wrong", ["satellite-step", "satellite-ramp"]),
        ("beijing-shanghai-dme-wrong", ["interference", "dme-bias"]),
        ("beijing-shanghai-imu-jump", ["interference", "imu-bias-jump"]),
        ("beijing-shanghai-baro-blocked", ["baro-blockage"]),
    ],
)
def test_every_shipped_fault_is_flown_and_summed_up(name: str, kinds: list[str]) -> None:
    run, summaries = summary(name)
    assert [f.kind for f in summaries] == kinds
    # Loss of monitoring, and any alert, ends in normal only at an epoch inside.
    shown, outside = run.epochs["alert"], (run.epochs["tse_exact_m"] > run.epochs["rnp_m"]).fill_null(value=False)
    assert run.epochs["track"].n_unique() == 1
    assert not ((shown == "normal") & (shown.shift(1) != "normal") & outside).any()
    for fault in summaries:
        assert fault.nse_h_max_m is not None
        assert fault.words.endswith(".")
        assert ";" not in fault.words
    by_kind = {f.kind: f for f in summaries}
    if "satellite-step" in by_kind:
        # A hundred metres against a deviation of some metres: gated from the first second, said after three.
        assert by_kind["satellite-step"].gate_after_s == pytest.approx(2.0, abs=1.0)
        assert by_kind["satellite-step"].nse_h_max_m < 20.0  # type: ignore[operator]
    if name == "beijing-shanghai-spoofed-approach":
        # The crew knows in the second in which the filters are found to disagree.
        assert by_kind["spoofing"].alert_after_s == by_kind["spoofing"].disagree_after_s
        assert by_kind["spoofing"].alert == "unavailable"
        assert by_kind["spoofing"].outcome == "before"
    if name == "beijing-shanghai-spoofed":
        # Half a metre a second: found before the 300 m are reached, though each gate lets it pass.
        assert by_kind["spoofing"].disagree_after_s < 600.0  # type: ignore[operator]
    if name == "beijing-shanghai-imu-jump":
        # Both filters share the unit; that they fall out without satellites is said, or that several stations contradict them.
        assert by_kind["imu-bias-jump"].alert == "unavailable"
        assert by_kind["imu-bias-jump"].alert_after_s < 400.0  # type: ignore[operator]
    if name == "beijing-shanghai-jammed":
        assert by_kind["interference"].disagree_after_s is None
    if "interference" in by_kind:
        assert by_kind["interference"].mode_after_s == pytest.approx(6.0, abs=2.0)


def test_a_wrong_unit_without_a_second_filter_is_reported_by_the_stations_that_contradict_it() -> None:
    result = quick("beijing-shanghai-imu-jump", constellations=["gps"])
    assert result.filter is not None
    alone = result.model_copy(update={"filter": result.filter.model_copy(update={"reversion": False})})
    epochs = fly.material(alone).epochs
    contradicted = epochs.filter(pl.col("reason").str.starts_with("several stations contradict"))
    assert contradicted["status"].unique().to_list() == ["not_available"]
    # The jump is at 2700 s, the satellites come back at 3600 s.
    second = (contradicted["time_ns"] - epochs["time_ns"].min()) / 1e9
    assert 2700.0 < second.min() < 3600.0  # type: ignore[operator]


def fault(kind: str, **more: object) -> list[dict[str, Any]]:
    return [{"kind": kind, "start_s": 3000.0, **more}]


WITHOUT_SATELLITES = {"kind": "interference", "start_s": 0.0, "duration_s": 8000.0}
"""Ranges take most of the time, and nothing is required of them here."""


@pytest.mark.parametrize("what", ["silent", "not-a-number", "late"])
def test_a_short_trouble_of_the_inertial_unit_is_bridged_and_counted(what: str) -> None:
    run, _ = summary("beijing-shanghai", [WITHOUT_SATELLITES, *fault("imu-trouble", duration_s=0.5, what=what)])
    reported = run.record.settings["filter"]
    assert isinstance(reported, dict)
    assert reported["samples"]["bridged"] == 1
    # At the very second of the trouble there is no state of that instant.
    assert run.epochs.with_row_index().filter(pl.col("status") == "not_available")["index"].to_list() == [3000]
    assert run.epochs["reason"][3000] == "the navigation filter needs inertial samples up to it, which this epoch lacks"


@pytest.mark.parametrize(("what", "duration_s"), [("silent", 5.0), ("not-a-number", 5.0), ("silent", 60.0)])
def test_an_inertial_unit_that_was_lost_is_aligned_in_flight(what: str, duration_s: float) -> None:
    run, summaries = summary("beijing-shanghai", fault("imu-trouble", duration_s=duration_s, what=what))
    end = 3000 + round(duration_s)
    lost = run.epochs[3000:end]
    # The ranges of each instant alone, with less behind them for ten seconds, which is longer than most holes.
    assert lost["nav_source"].unique().to_list() == ["snapshot"]
    assert set(lost["status"][:10]) == {"degraded"}
    assert set(lost["status"][10:]) <= {"ok"}
    assert lost["nav_mode"].unique().to_list() == ["stopped"]
    assert lost["nse_h_m"].max() < 15.0  # type: ignore[operator]
    assert summaries[0].alert is None
    # The satellites of the first second after it give a position; the attitude takes some minutes at the most.
    after = run.epochs[end + 1 :]
    assert "not_available" not in after["status"].to_list()
    mode = after["nav_mode"].to_list()
    settled = len(mode) - mode[::-1].index("aligning")
    assert set(mode[:settled]) == {"aligning"}
    assert set(after["status"][:settled].to_list()) == {"degraded"}
    assert set(mode[settled:]) == {"gnss"}
    assert 10 < settled < 600
    reported = run.record.settings["filter"]
    assert isinstance(reported, dict)
    assert reported["samples"]["adrift"] > 0
    assert reported["samples"]["stopped"] == 0


@pytest.mark.parametrize("duration_s", [5.0, 60.0])
def test_after_a_lost_unit_the_filter_is_as_good_as_it_says(duration_s: float) -> None:
    faults = [{"kind": "imu-trouble", "start_s": 3000.0, "duration_s": duration_s, "what": "silent"}]
    flights = fly.material(quick("beijing-shanghai-seed", faults, ["gps"]), flights=6).epochs
    since = pl.col("time_ns") - pl.col("time_ns").min()
    again = flights.filter(pl.col("status") != "not_available", since >= round((3000 + duration_s) * 1e9))
    error, covariance, track = errors(again, skip_s=0.0)
    aligning = (again["nav_mode"] == "aligning").to_numpy()
    for part in (aligning, ~aligning):
        assert np.count_nonzero(part) > 60
        nees = evaluation.nees(error[part], covariance[part], track[part])
        # Not more than its limits; less while it aligns, because 3 m/s² are more than this flight has.
        assert nees.nees_mean <= nees.nees_high


def test_a_lost_unit_is_aligned_by_stations_alone() -> None:
    run, _ = summary("beijing-shanghai", [WITHOUT_SATELLITES, *fault("imu-trouble", duration_s=30.0, what="silent")])
    after = run.epochs[3031:]
    assert "not_available" not in after["status"].to_list()
    assert after["nav_mode"][0] == "aligning"
    assert "dme_dme" in after["nav_mode"].to_list()
    ratio = after["nse_h_m"] / (after["cov_ee_m2"] + after["cov_nn_m2"]).sqrt()
    # Three drms, of a flight.
    assert ratio.max() < 3.0  # type: ignore[operator]


def test_a_wrong_station_without_satellites_is_left_out_before_it_takes_the_height_along() -> None:
    flights = fly.material(quick("beijing-shanghai-dme-wrong", constellations=["gps"]), flights=4).epochs
    second = (pl.col("time_ns") - pl.col("time_ns").min()) / 1e9
    lost = flights.filter(second >= 2400, second < 4200)
    for axis, cov in (("nse_e_m", "cov_ee_m2"), ("nse_n_m", "cov_nn_m2"), ("nse_u_m", "cov_uu_m2")):
        # Before, up to 18 deviations: one measurement in six passed the gate. Four flights of half an hour: 4.5 is beyond chance.
        assert (lost[axis].abs() / lost[cov].sqrt()).max() < 4.5  # type: ignore[operator]
    assert lost["nse_u_m"].abs().max() < 150.0  # type: ignore[operator]


def test_samples_whose_times_run_a_second_behind_give_no_position_until_they_are_right_again() -> None:
    run, summaries = summary("beijing-shanghai", [WITHOUT_SATELLITES, *fault("imu-trouble", duration_s=30.0, what="late")])
    status = run.epochs["status"].to_list()
    assert set(status[3000:3030]) == {"not_available"}
    assert "not_available" not in status[3031:]
    assert summaries[1].alert == "unavailable"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('base = "beijing-shanghai-drawn"\n[filter]\nmode = "white"\n', "filter"),
        ('base = "beijing-shanghai"\n[navigation]\nclaimed_sigma_scale = 0.5\n', "navigation.claimed_sigma_scale"),
        ('base = "beijing-shanghai-real"\n[filter]\ngate_risk = 0.0\n', "gate_risk"),
        ('base = "beijing-shanghai-real"\n[filter]\nmode = "grey"\n', "mode"),
        ('base = "beijing-shanghai-real"\n[filter]\nform = "ultra-tight"\n', "form"),
        ('base = "beijing-shanghai-real"\n[filter]\nseparation_risk = 0.0\n', "separation_risk"),
        ('base = "beijing-shanghai-real"\n[[faults]]\nkind = "lateral-ramp"\nstart_s = 1.0\nduration_s = 2.0\nrate_mps = 1.0\n', "faults"),
        (
            'base = "beijing-shanghai-real"\n[[sensors.faults]]\nkind = "imu-trouble"\nstart_s = 1.0\nduration_s = 2.0\nwhat = "odd"\n',
            "what",
        ),
    ],
)
def test_a_filter_that_cannot_be_is_refused_by_name(tmp_path: Path, text: str, words: str) -> None:
    file = tmp_path / "wrong.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(FormatError, match=words):
        scenario.load(file)


def test_the_ranked_probability_score_is_its_integral() -> None:
    for error, sigma in ((0.0, 1.0), (1.3, 0.7), (-4.0, 2.0)):
        whole, _ = integrate.quad(
            lambda x, s=sigma, e=error: (stats.norm.cdf(x, scale=s) - (x >= e)) ** 2, -40, 40, points=[error], limit=200
        )
        # The quadrature's own estimate is below 1e-8.
        assert evaluation.crps([error], [sigma])[0] == pytest.approx(whole, abs=1e-7)


def test_the_comparison_says_of_every_published_number_what_became_of_it(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    file = tmp_path / "quick.toml"
    file.write_text(f'base = "beijing-shanghai-seed"\n[sensors]\nrate_hz = {RATE_HZ}\n', encoding="utf-8")
    monkeypatch.setattr(anp_comparison, "CASES", (("seed", str(file), 1),))
    study = anp_comparison.run(flights=2)
    (case,) = study.cases
    assert len(case.bounds) == 8
    assert {b.evaluation for b in case.bounds} == {"circle", "sphere", "ellipsoid"}
    entries = {e.quantity: e for e in study.entries}
    assert len(entries) == len(study.entries) == 17
    # White ranges of 10.5 m: our specification's prototype has 0.681 ± 0.048 m and 0.730 ± 0.052 m on the same route; four deviations.
    assert entries["RMSE of the error, longitude [m]"].computed == pytest.approx(0.681, abs=0.2)
    assert entries["RMSE of the error, latitude [m]"].computed == pytest.approx(0.730, abs=0.2)
    assert entries["RMS of the circle, longitude [m]"].verdict == "impossible"
    ratio = {(b.evaluation, b.axis): b.rms_m for b in case.bounds}
    # The ellipsoid's support is 2.79548 deviations of each axis.
    assert ratio["ellipsoid", "altitude"] / case.axes[2].sigma_m == pytest.approx(2.79548, abs=1e-5)
    assert case.nees_low_over_3 < case.nees_over_3 < case.nees_high_over_3


def test_an_innovation_beyond_its_gate_is_a_measurement_that_was_rejected(real: Material) -> None:
    kinds = [f"innovation_{of}" for of in ("range", "station", "baro")]
    largest = real.epochs.select(pl.max_horizontal(kinds)).to_series()
    assert real.epochs["innovation_range"].null_count() < 0.1 * real.epochs.height
    assert (largest.drop_nulls() >= 0.0).all()
    # Range rates and bearings are rejected as well, and have no column.
    beyond = largest > 1.0
    assert beyond.any()
    assert (real.epochs["n_gated"].filter(beyond) > 0).all()


def test_biases_of_the_unit_become_better_known(real: Material) -> None:
    for of in ("gyro_x_radps", "gyro_y_radps", "gyro_z_radps", "accel_x_mps2", "accel_y_mps2", "accel_z_mps2"):
        bias, sigma = (real.epochs[f"{kind}_{of}"] for kind in ("bias", "sigma_bias"))
        assert bias.is_finite().all(), of
        assert (sigma > 0.0).all(), of
        # Two hours of satellites say more of a bias than the grade of the unit.
        assert sigma[-1] < sigma[0], of


def test_what_became_of_a_fault_is_one_statement_a_sentence() -> None:
    never = dict.fromkeys(("gate_after_s", "memory_after_s", "disagree_after_s", "mode_after_s", "mode", "alert_after_s", "alert"))
    quiet = never | {"outcome_words": "the true error stayed inside RNP"}
    assert faults._words(quiet, compared=True).split(". ") == [
        "The filter's gate rejected no run of measurements",
        "The filters with and without satellites agreed",
        "The mode did not fall",
        "There was no alert",
        "The true error stayed inside RNP.",
    ]
    spoke = {
        "gate_after_s": 2.0,
        "disagree_after_s": 9.0,
        "mode_after_s": 9.0,
        "mode": "dme_dme",
        "alert_after_s": 10.0,
        "alert": "caution",
    }
    assert faults._words(quiet | spoke, compared=True).split(". ")[:4] == [
        "The filter's gate rejected measurements after 2 s",
        "The filters with and without satellites disagreed after 9 s",
        "The mode fell to dme_dme after 9 s",
        "The first alert (caution) came after 10 s",
    ]
