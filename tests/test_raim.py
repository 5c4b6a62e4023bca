"""RAIM by the slope method: against independent laws, against the errors it bounds, on the recorded day, and what is refused."""

from __future__ import annotations

import json
import math
import sys
from datetime import datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl
import pytest
from scipy import stats

import navbound
from navbound import araim, gnss, raim
from navbound.errors import InputError

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT / "oracle"))

import raim_scipy  # noqa: E402

if TYPE_CHECKING:
    from numpy.typing import NDArray

GPS, GALILEO = 0, 2
sky = raim_scipy.sky


@pytest.mark.parametrize("dof", [1, 2, 5, 12])
def test_thresholds_and_missed_biases_give_their_risks_back_by_another_form_of_the_law(dof: int) -> None:
    needs = raim.Requirement(false_alarm=1e-4, missed_detection=0.02, fault_free=1e-5)
    threshold, bias = raim.factors(dof, needs)
    # SciPy's own tail, and a quadrature of some 1e-10 absolute.
    assert abs(stats.chi2.sf(float(threshold) ** 2, dof) / 1e-4 - 1) <= 1e-10
    assert abs(raim_scipy.chi_square_of_normals(dof, float(bias), float(threshold) ** 2) - 0.02) <= 1e-8


def test_factors_take_any_shape_and_refuse_what_is_no_redundancy() -> None:
    threshold, bias = raim.factors([[1, 2], [3, 4]])
    assert threshold.shape == bias.shape == (2, 2)
    assert (np.diff(bias.ravel()) > 0).all()
    for wrong in (0, -1, 61, 1.5, "two"):
        with pytest.raises(InputError, match="n_redundant"):
            raim.factors(wrong)


def at_least(count: int, n: int) -> float:
    """Lower end of the one-sided 99.9 % interval of a share."""
    return float(stats.beta.ppf(1e-3, count, n - count + 1)) if count else 0.0


def test_the_guaranteed_level_bounds_a_missed_fault_of_any_size_and_the_published_one_does_not() -> None:
    """Seeded ranges at a risk that can be counted; the fault on the satellite with the steepest slope, sizes up to beyond detection."""
    n, n_sv, needs = 20_000, 30, raim.Requirement(false_alarm=1e-3, missed_detection=0.05, fault_free=1e-3)
    unit, of, sigma = sky(n_sv, 4), [GPS] * n_sv, np.linspace(1.0, 2.0, n_sv)
    levels = raim.protection_levels(unit, of, sigma, requirement=needs)
    rng = np.random.default_rng(20_200_625)
    steepest, worst = 0, 0.0
    for i in range(n_sv):
        moved = raim.monitor(unit, of, np.eye(n_sv)[i] * 1e-3, sigma, requirement=needs)
        slope = float(np.abs(moved.step_enu_m[2]) / moved.ratio)
        steepest, worst = (i, slope) if slope > worst else (steepest, worst)
    published, guaranteed = [], []
    for size in np.linspace(0.0, 14.0, 8):
        noise = rng.normal(size=(n, n_sv)) * sigma
        noise[:, steepest] += size
        tested = raim.monitor(unit, of, noise, sigma, requirement=needs)
        error, missed = np.abs(tested.step_enu_m[:, 2]), tested.decision == "none"
        guaranteed.append(at_least(int((missed & (error > levels.vpl_m)).sum()), n))
        published.append(at_least(int((missed & (error > levels.vpl_slope_m)).sum()), n))
    assert max(guaranteed) <= 0.05
    assert max(published) > 0.05, "the geometry no longer shows what the page says"


@pytest.mark.parametrize(("slope", "published", "risk"), [(0.3, 0.094, 1e-5), (1.0, 0.0035, 1e-6), (2.0, 7.5e-4, 3e-6)])
def test_the_risks_of_the_page_come_out(slope: float, published: float, risk: float) -> None:
    """docs/methods/raim.md: five redundant ranges, sigma of the position one metre."""
    _, bias = raim.factors(5)
    noise = float(stats.norm.isf(raim.RAIM.missed_detection / 2))
    # Two digits are printed.
    assert abs(raim_scipy.worst_joint(5, slope * float(bias), slope, 1.0) / published - 1) <= 0.05
    assert raim_scipy.worst_joint(5, slope * float(bias) + noise, slope, 1.0) <= risk


def test_the_published_level_holds_where_the_slope_is_steep() -> None:
    """docs/methods/raim.md: from some 1.7 sigma on."""
    _, bias = raim.factors(5)
    risk = {slope: raim_scipy.worst_joint(5, slope * float(bias), slope, 1.0) for slope in (1.5, 1.7, 5.0)}
    assert risk[1.5] > raim.RAIM.missed_detection >= max(risk[1.7], risk[5.0])


def test_no_faultless_epoch_alarms_more_often_than_promised() -> None:
    needs = raim.Requirement(false_alarm=0.01, missed_detection=0.05, fault_free=1e-3)
    unit, of, sigma = sky(9, 12), [GPS] * 5 + [GALILEO] * 4, np.linspace(1.0, 2.0, 9)
    n = 40_000
    noise = np.random.default_rng(5).normal(size=(n, 9)) * sigma + np.where(np.array(of) == GPS, 1e5, -3e4)
    alarms = int((raim.monitor(unit, of, noise, sigma, requirement=needs).decision != "none").sum())
    # The two-sided 99.9 % interval around the promised share.
    low, high = stats.binom.ppf([5e-4, 1 - 5e-4], n, 0.01)
    assert low <= alarms <= high


def test_levels_turn_with_north_scale_with_noise_and_ignore_the_order() -> None:
    unit, of, sigma = sky(10, 6), [GPS] * 6 + [GALILEO] * 4, np.linspace(1.0, 2.5, 10)
    base = raim.protection_levels(unit, of, sigma)
    c, s = math.cos(0.7), math.sin(0.7)
    turned = raim.protection_levels(unit @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]), of, sigma)
    twice = raim.protection_levels(unit, of, 2 * sigma)
    mixed = raim.protection_levels(unit[::-1], of[::-1], sigma[::-1])
    for name in ("hpl_m", "vpl_m", "hel_m", "vel_m", "hpl_slope_m"):
        level = float(getattr(base, name))
        # Sums in another order, of condition below 1e3.
        assert abs(getattr(turned, name) - level) <= 1e-11 * level
        assert abs(getattr(twice, name) - 2 * level) <= 1e-11 * level
        assert abs(getattr(mixed, name) - level) <= 1e-11 * level


def test_solution_separation_and_slopes_see_the_same_satellite_and_differ_by_their_tests() -> None:
    """Both have sigma_ss,i = slope_i; the slope method's one test of all residuals needs a larger bias than one test a satellite."""
    orbits = gnss.constellation("gps")
    lat, time = np.radians(np.arange(-80, 81, 20.0)), np.arange(0, 86_400, 3600.0)
    slopes = raim.predict(orbits, lat, 0.3, 0.0, time)
    separated = araim.predict(orbits, lat, 0.3, 0.0, time, service="raim", model="single-frequency")
    both = (slopes.status == "ok") & (separated.status == "ok")
    assert np.array_equal(slopes.status == "ok", separated.status == "ok")
    ratio = slopes.hpl_m[both] / separated.hpl_m[both]
    # docs/methods/raim.md prints 1.17, 1.27, 1.30.
    np.testing.assert_allclose([ratio.min(), np.median(ratio), ratio.max()], [1.17, 1.27, 1.30], atol=0.005)


def test_a_prediction_is_that_of_its_geometry() -> None:
    orbits = gnss.constellation("gps") + gnss.constellation("galileo")
    lat, lon, time = np.radians([-60.0, 5.0, 47.0]), np.radians([10.0, 100.0, -120.0]), np.array([0.0, 9000.0])
    levels = raim.predict(orbits, lat, lon, 0.0, time, model="dual-frequency")
    assert levels.hpl_m.shape == (2, 3)
    az, el = gnss.directions(orbits, lat, lon, 0.0, time[:, None])
    unit = np.stack([np.cos(el) * np.sin(az), np.cos(el) * np.cos(az), np.sin(el)], axis=-1)
    unit[el < math.radians(5)] = np.nan
    a, b, scale = raim.ERROR_MODELS["dual-frequency"].noise
    local = (a + b * np.exp(-el / scale)) ** 2 + (0.12 * 1.001) ** 2 / (0.002001 + np.sin(el) ** 2)
    sigma = np.sqrt(np.array(raim.SUPPORT.sigma_ura_m)[orbits.constellation] ** 2 + local)
    computed = raim.protection_levels(unit, orbits.constellation, sigma)
    for name in ("hpl_m", "vpl_m", "hel_m", "vel_m"):
        # Angles and back cost a few units in the last place of vectors of 1, and gains up to 10.
        np.testing.assert_allclose(getattr(levels, name), getattr(computed, name), rtol=1e-9)
    assert np.array_equal(levels.n_sv, computed.n_sv)
    assert (levels.hel_m >= levels.hpl_m).all()


def test_what_cannot_be_meant_is_refused_by_name() -> None:
    unit, of = sky(8, 1), [GPS] * 8
    good: dict[str, Any] = {"unit_enu": unit, "constellation": of, "sigma_m": 1.0}
    changes: list[tuple[dict[str, Any], str]] = [
        ({"sigma_m": 0.0}, "sigma_m"),
        ({"sigma_m": -1.0}, "sigma_m"),
        ({"sigma_m": math.nan}, "sigma_m"),
        ({"unit_enu": 2 * unit}, "unit_enu"),
        ({"unit_enu": unit[:, :2]}, "unit_enu"),
        ({"constellation": [9] * 8}, "constellation"),
        ({"constellation": [0] * 7}, "constellation"),
        ({"requirement": raim.Requirement(0.0, 1e-3, 1e-7)}, "false_alarm"),
        ({"requirement": raim.Requirement(1e-7, 1.0, 1e-7)}, "missed_detection"),
        ({"requirement": "raim"}, "requirement"),
    ]
    for change, name in changes:
        with pytest.raises(InputError) as refusal:
            raim.protection_levels(**{**good, **change})
        assert refusal.value.argument == name
    with pytest.raises(InputError, match="residual_m"):
        raim.monitor(unit, of, [math.nan] * 8, 1.0)
    with pytest.raises(InputError, match="residual_m"):
        raim.monitor(unit, of, np.zeros(8), np.ones((3, 8)))
    many = raim.protection_levels(sky(70, 1), [GPS] * 70, 1.0)
    assert many.status == "too_many"


def test_what_the_sky_cannot_give_is_a_status() -> None:
    unit = np.full((4, 8, 3), np.nan)
    unit[0, :3], unit[1, :4], unit[2] = sky(3, 1), sky(4, 1), sky(8, 1)
    cone = np.linspace(0, 2 * math.pi, 8, endpoint=False)
    unit[3] = np.stack([np.cos(cone) * 0.8, np.sin(cone) * 0.8, np.full(8, 0.6)], axis=-1)
    levels = raim.protection_levels(unit, [GPS] * 8, 1.0)
    assert levels.status.tolist() == ["too_few_satellites", "not_monitored", "ok", "singular"]
    assert np.isnan(levels.hpl_m[[0, 3]]).all()
    assert np.isposinf(levels.hpl_m[1])
    assert levels.n_sv.tolist() == [3, 4, 8, 8]
    tested = raim.monitor(unit, [GPS] * 8, np.zeros((4, 8)), 1.0)
    assert tested.decision.tolist() == ["", "none", "none", ""]


def day(shared_data: Path) -> tuple[Path, Path, list[float]]:
    folder = shared_data / "gnss" / "ESBC_2020_177"
    truth = json.loads((shared_data / "baselines.json").read_text(encoding="utf-8"))["ESBC_2020_177"]["reference_ecef_m"]
    return folder / "ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz", folder / "ESBC00DNK_R_20201770000_01D_MN.rnx.gz", truth


def test_the_recorded_day_stays_inside_its_levels(shared_data: Path, tmp_path: Path) -> None:
    """Errors against levels, epoch by epoch, and what the run says of detection and exclusion."""
    observations, navigation, truth = day(shared_data)
    run = navbound.evaluate(
        [observations, navigation], levels=["NPA", "APV-I"], truth=",".join(map(str, truth)), protection="raim", out=tmp_path / "run"
    )
    epochs = run.summary.performance
    assert epochs is not None
    assert epochs.n_expected == 2880
    assert epochs.n_mi_epochs == 0
    assert all(level.n_hazard_epochs == 0 for level in epochs.levels)
    npa, apv = epochs.levels
    assert npa.availability_expected > 0.999
    assert apv.availability_expected < npa.availability_expected
    words = " ".join(run.summary.assumptions)
    for phrase in ("a fault detected at", "detection and exclusion (HEL) 100 %, 100 %, 100 %", "inferred", "slope"):
        assert phrase in words
    assert (tmp_path / "run" / "report.html").is_file()


def first_hour(read: gnss.Observations, out: Path, steps_m: dict[str, float]) -> gnss.Observations:
    """GPS C/A codes and strengths of the first hour as a file of their own, with a step on some satellites from its middle on."""
    strengths = read.column("G", "S1C").select("time_ns", "satellite", cn0_dbhz="value")
    codes = read.column("G", "C1C").filter(pl.col("time_ns") < read.time_ns[120])
    codes = codes.join(strengths, on=["time_ns", "satellite"], how="left", maintain_order="left")
    lines = [
        f"{'     3.04           OBSERVATION DATA    M':60}RINEX VERSION / TYPE",
        f"{'G    2 C1C S1C':60}SYS / # / OBS TYPES",
        f"{'':60}END OF HEADER",
    ]
    for (time_ns,), epoch in codes.group_by("time_ns", maintain_order=True):
        when = datetime(1980, 1, 6) + timedelta(microseconds=int(str(time_ns)) // 1000)
        lines.append(f"> {when:%Y %m %d %H %M %S}.0000000  0 {epoch.height:2d}")
        for satellite, value, cn0_dbhz in epoch.select("satellite", "value", "cn0_dbhz").iter_rows():
            step = steps_m.get(satellite, 0.0) if time_ns >= read.time_ns[60] else 0.0
            lines.append(f"{satellite}{value + step:14.3f}  {cn0_dbhz:14.3f}")
    out.write_text("\n".join(lines) + "\n", encoding="ascii")
    return gnss.read_observations(out)


def test_a_step_in_one_satellite_is_detected_excluded_and_the_levels_are_those_of_the_rest(shared_data: Path, tmp_path: Path) -> None:
    observations, navigation, truth = day(shared_data)
    read, records = gnss.read_observations(observations), gnss.read_navigation(navigation)
    quiet = first_hour(read, tmp_path / "quiet.rnx", {})
    seen = raim.watch(quiet, records, truth_ecef_m=truth, track="a").epochs
    assert seen.height == 120
    assert set(seen["decision"]) == {"none"}
    # The same levels as from the packed day without its phases: lines of sight from places some metres apart turn by 1e-7.
    whole = raim.watch(read, records, truth_ecef_m=truth, track="a", smoothing_s=None).epochs[:120]
    np.testing.assert_allclose(seen["hpl_m"], whole["hpl_m"], rtol=1e-6)
    ranges = gnss.solve(quiet, records, systems="G", keep_ranges=True).ranges
    assert ranges is not None
    # Three that are above the horizon all the hour, the second of them highest.
    lasting = ranges.group_by("sv").agg(pl.len(), pl.col("el_rad").mean()).filter(pl.col("len") == 120).sort("el_rad", descending=True)
    wrong, also = lasting["sv"][1], lasting["sv"][2]
    faulty = first_hour(read, tmp_path / "faulty.rnx", {wrong: 300.0})
    levels = raim.watch(faulty, records, truth_ecef_m=truth, track="a").epochs
    before, after = levels[:60], levels[60:]
    assert before.equals(seen[:60])
    assert set(after["decision"]) == {"excluded"}
    assert set(after["reason"]) == {f"excluded {wrong}"}
    assert set(after["status"]) == {"degraded"}
    assert set(after["n_excluded"]) == {1}
    # Fewer satellites, larger levels; the error stays inside them, and the level promised beforehand held.
    assert (after["hpl_m"] > seen[60:]["hpl_m"]).all()
    assert (after["hpl_m"] <= after["hel_m"] * (1 + 1e-9)).all()
    assert (np.hypot(after["nse_e_m"], after["nse_n_m"]) < after["hpl_m"].to_numpy()).all()
    # What the run says of it.
    text = ",".join(map(str, truth))
    run = navbound.evaluate([tmp_path / "faulty.rnx", navigation], levels="NPA", truth=text, protection="raim")
    words = " ".join(run.summary.assumptions)
    assert f"120 epochs: a fault detected at 60, excluded at 60 ({wrong} at 60), not to be excluded at 0" in words
    assert run.summary.performance is not None
    assert run.summary.performance.n_mi_epochs == 0
    # Two satellites at once are not one: the position is not to be used.
    both = raim.watch(first_hour(read, tmp_path / "both.rnx", {wrong: 300.0, also: -400.0}), records).epochs[60:]
    lost = both.filter(pl.col("decision") == "not_excluded")
    assert lost.height > 0
    assert set(lost["status"]) == {"not_available"}
    assert lost["hpl_m"].null_count() == lost.height


def test_watching_refuses_what_it_cannot_do(shared_data: Path) -> None:
    observations, navigation, _ = day(shared_data)
    read, records = gnss.read_observations(observations), gnss.read_navigation(navigation)
    for change in ({"systems": "X"}, {"signals": "triple"}, {"mask_rad": 2.0}, {"model": "none"}):
        with pytest.raises(InputError, match=next(iter(change))):
            raim.watch(read, records, **change)


def sigma_of(levels: raim.Levels) -> NDArray[np.float64]:
    return np.hypot(levels.sigma_e_m, levels.sigma_n_m)


def test_without_a_fault_the_level_is_never_below_the_fault_free_one() -> None:
    """Thirty satellites have slopes so small that the noise decides."""
    levels = raim.protection_levels(sky(30, 9), [GPS] * 30, 1.0)
    floor = float(stats.norm.isf(raim.RAIM.fault_free / 2)) * sigma_of(levels)
    assert levels.hpl_m >= floor
    assert levels.hpl_slope_m < floor
