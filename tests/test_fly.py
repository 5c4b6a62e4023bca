"""The simulated flight with drawn errors as the rest of navbound sees it; its physics is proven in crates/simulate/tests."""

from __future__ import annotations

import hashlib
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from navbound import InputError, path, scenario
from navbound.errors import NotFoundError
from navbound.records.material import Material
from navbound.run.fly import material
from navbound.run.judge import judge
from navbound.run.settings import Settings

DRAWN = "beijing-shanghai-drawn"
NOTATION = Path(__file__).parents[1] / "docs" / "notation.md"


@pytest.fixture(scope="module")
def flown() -> Material:
    return material(DRAWN)


def test_one_epoch_for_every_second(flown: Material) -> None:
    times = flown.epochs["time_ns"]
    assert times.len() == 7081
    assert (times.diff().drop_nulls() == 10**9).all()
    assert times[0] == scenario.load(DRAWN).start_ns


def test_columns_are_those_of_the_glossary(flown: Material) -> None:
    section = NOTATION.read_text(encoding="utf-8").split("## The epoch table")[1].split("\n## ")[0]
    first_cells = [line.split("|")[1] for line in section.splitlines() if line.startswith("|")]
    declared = {name for cell in first_cells for name in re.findall(r"`([a-z0-9_]+)`", cell)}
    assert set(flown.epochs.columns) <= declared
    needed = {"track", "time_ns", "est_lat_rad", "course_rad", "fte_m", "rnp_m", "cov_ee_m2", "cov_en_m2", "cov_nn_m2", "status", "nse_e_m"}
    assert needed <= set(flown.epochs.columns)


def test_nothing_is_missing_where_satellites_are_in_view(flown: Material) -> None:
    assert set(flown.epochs["status"]) == {"ok"}
    assert flown.epochs.drop("reason", "reason_id").null_count().sum_horizontal().item() == 0
    assert flown.epochs["reason"].null_count() == 7081


def test_cruise_is_as_long_and_as_fast_as_the_sums_say(flown: Material) -> None:
    # Our specification 6.1 solves 174.5 m/s with other speed laws near the ends; within 1 %. Top of climb 1098 s needs no solving.
    assert abs(flown.settings["cruise_speed_mps"] / 174.5 - 1) < 0.01  # type: ignore[operator]
    assert abs(flown.settings["top_of_climb_s"] - 1098) < 1  # type: ignore[operator]
    e = flown.epochs
    at = e["time_ns"] - e["time_ns"][0]
    cruise = e.filter((at > 1_110 * 10**9) & (at < 5_600 * 10**9))
    assert (cruise["path_h_m"] == 8900.0).all()
    assert abs(e["along_m"][-1] - flown.settings["length_m"]) < 100


def test_technical_error_is_the_distance_from_the_corners_route(flown: Material) -> None:
    # Away from turns the flown path is the leg itself, which navbound.path knows without the simulator.
    waypoints = scenario.load(DRAWN).waypoints
    e = flown.epochs
    leg = e.filter(pl.col("leg") == "ABTUB-UDINO")
    line = path.line(waypoints[8].lat_rad, waypoints[8].lon_rad, waypoints[9].lat_rad, waypoints[9].lon_rad)
    inside = leg[100:-100]
    feet = line.project(inside["est_lat_rad"].to_numpy(), inside["est_lon_rad"].to_numpy())
    # Both find the same foot to the micrometre.
    np.testing.assert_allclose(feet.cross_m, inside["fte_m"].to_numpy(), rtol=0, atol=1e-5)
    assert inside.height > 500


def test_technical_error_is_of_the_size_of_real_ones(flown: Material) -> None:
    # Recorded airliners on final: 95 % within 12 to 22 m of the centreline; en route some tens of metres. Turns are wider.
    cruise = flown.epochs.filter(pl.col("phase") == "en route")["fte_m"].abs()
    p95 = cruise.quantile(0.95)
    assert p95 is not None
    assert 10 < p95 < 60
    assert flown.epochs["fte_m"].abs().max() < 150  # type: ignore[operator]


def test_phases_carry_their_rnp_in_order(flown: Material) -> None:
    phases = flown.epochs.group_by("phase", maintain_order=True).agg(pl.col("rnp_m").unique())
    assert phases["phase"].to_list() == ["departure", "en route", "arrival", "approach"]
    assert phases["rnp_m"].to_list() == [[1852.0], [3704.0], [1852.0], [555.6]]


def test_flights_are_tracks_and_seeds_matter() -> None:
    done: list[tuple[int, int]] = []
    many = material(DRAWN, flights=17, progress=lambda n, total: done.append((n, total)))
    assert done == [(0, 17), (16, 17), (17, 17)]
    assert many.epochs["track"].unique(maintain_order=True).to_list() == [f"flight-{i:03d}" for i in range(17)]
    assert many.labels["flight-008"] == "Flight 9"
    alone = material(DRAWN).epochs
    assert many.epochs[:7081].equals(alone)
    assert not material(DRAWN, seed=1).epochs.equals(alone)


def test_circle_and_sphere_of_many_flights_come_with_their_uncertainty() -> None:
    run = judge(material(DRAWN, flights=12), Settings(methods=("anp-circle", "anp-sphere")))
    consistency = run.summary.honesty
    assert consistency is not None
    scored = {m.id: m.coverage for m in run.summary.accuracy}
    for region in consistency.regions:
        assert region.share == pytest.approx(scored[f"anp-{region.region}"], abs=1e-12)
        # Errors are drawn from the covariance: some 400 independent epochs, a deviation of a point.
        assert region.low < 0.95 < region.high
        assert region.high - region.low < 0.1
        assert f"the 95 % {region.region} held" in consistency.words
    assert [region.region for region in consistency.regions] == ["circle", "sphere"]
    few = judge(material(DRAWN, flights=9), Settings(methods=())).summary.honesty
    assert few is not None
    assert few.regions == []


def test_context_says_what_was_assumed_and_read(flown: Material) -> None:
    assert flown.seed == 20220801
    assert flown.scenario is not None
    assert flown.scenario["title"] == flown.title == "Beijing to Shanghai, errors drawn"
    file = Path(flown.inputs[0].path)
    assert flown.inputs[0].sha256 == hashlib.sha256(file.read_bytes()).hexdigest()
    assert [w.name for w in flown.waypoints][::20] == ["ZBAA", "ZSSS"]
    assert any("nominal" in sentence for sentence in flown.assumptions)
    led = material("beijing-shanghai-misled")
    assert "lateral-ramp from 6700 s" in led.assumptions[-1]


def test_interference_is_admitted_and_a_ramp_is_not() -> None:
    plain, poor, led = (material(name).epochs for name in (DRAWN, "beijing-shanghai-degraded", "beijing-shanghai-misled"))
    at = 6_900
    assert poor["cov_ee_m2"][at] == pytest.approx(250**2 * plain["cov_ee_m2"][at], rel=1e-12)
    assert led["cov_ee_m2"][at] == plain["cov_ee_m2"][at]
    nse = led.select(pl.col("nse_e_m") - plain["nse_e_m"], pl.col("nse_n_m") - plain["nse_n_m"])[at].row(0)
    assert np.hypot(*nse) == pytest.approx(2.5 * 200, rel=1e-9)


def test_no_satellites_is_a_status_with_a_reason(tmp_path: Path) -> None:
    file = tmp_path / "blind.toml"
    file.write_text('base = "beijing-shanghai-drawn"\n[navigation]\nmask_deg = 85.0\n', encoding="utf-8")
    e = material(file).epochs
    lost = e.filter(pl.col("status") == "not_available")
    assert lost.height == e.height
    assert lost["reason"].null_count() == 0
    assert lost["reason"].str.contains("satellites are needed").all()
    assert lost["fte_m"].null_count() == lost["cov_ee_m2"].null_count() == lost["est_lat_rad"].null_count() == lost.height
    assert lost["truth_lat_rad"].null_count() == lost["course_rad"].null_count() == 0


def test_results_do_not_depend_on_the_number_of_threads() -> None:
    program = (
        "import hashlib; from navbound.run.fly import material; e = material('beijing-shanghai-drawn', flights=3).epochs;"
        "print(hashlib.sha256(e.drop('reason', 'reason_id').hash_rows(seed=1).to_numpy().tobytes()).hexdigest())"
    )
    digests = {
        subprocess.run(
            [sys.executable, "-c", program], env=os.environ | {"RAYON_NUM_THREADS": n}, check=True, capture_output=True, text=True
        ).stdout
        for n in ("1", "2")
    }
    assert len(digests) == 1
    assert len(digests.pop().strip()) == 64


@pytest.mark.parametrize("flights", [0, -1, 1.5, 1001])
def test_no_flight_is_refused(flights: int) -> None:
    with pytest.raises(InputError, match="flights"):
        material(DRAWN, flights=flights)


@pytest.mark.parametrize("seed", [-1, 2**64])
def test_a_seed_outside_its_range_is_refused(seed: int) -> None:
    with pytest.raises(InputError, match="seed"):
        material(DRAWN, seed=seed)


def test_a_method_that_does_not_exist_is_refused_before_a_flight_is_flown() -> None:
    with pytest.raises(NotFoundError, match="tse-exakt"):
        Settings(methods=("tse-exact", "tse-exakt"))
