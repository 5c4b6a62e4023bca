"""Positions from real receivers' files, against surveyed truth; skipped, aloud, where the files are not at hand."""

from __future__ import annotations

import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

from navbound import FormatError, InputError, evaluation, gnss
from navbound.methods import bounds

Floats = np.ndarray[Any, np.dtype[np.float64]]
Day = tuple[gnss.Observations, gnss.Navigation, dict[str, Any]]


@pytest.fixture(scope="module")
def day(shared_data: Path) -> Day:
    baselines = json.loads((shared_data / "baselines.json").read_text(encoding="utf-8"))
    folder = shared_data / "gnss" / "ESBC_2020_177"
    observations = gnss.read_observations(folder / "ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz")
    return observations, gnss.read_navigation(folder / "ESBC00DNK_R_20201770000_01D_MN.rnx.gz"), baselines["ESBC_2020_177"]


def errors(epochs: pl.DataFrame) -> np.ndarray[Any, np.dtype[np.float64]]:
    return epochs.select("nse_e_m", "nse_n_m", "nse_u_m").to_numpy()


def covariances(epochs: pl.DataFrame) -> np.ndarray[Any, np.dtype[np.float64]]:
    c = {k: epochs[f"cov_{k}_m2"].to_numpy() for k in ("ee", "en", "nn", "eu", "nu", "uu")}
    rows = [[c["ee"], c["en"], c["eu"]], [c["en"], c["nn"], c["nu"]], [c["eu"], c["nu"], c["uu"]]]
    return np.moveaxis(np.array(rows), -1, 0)


def ecef(lat: Floats, lon: Floats, h: Floats) -> Floats:
    e2 = (2 - 1 / 298.257223563) / 298.257223563
    n = 6_378_137.0 / np.sqrt(1 - e2 * np.sin(lat) ** 2)
    return np.stack([(n + h) * np.cos(lat) * np.cos(lon), (n + h) * np.cos(lat) * np.sin(lon), (n * (1 - e2) + h) * np.sin(lat)], axis=-1)


# The stored peer's 95 % horizontal error, and a covariance that covers: three would be exact; of a day, some ten ionospheres, 1 to 4.
@pytest.mark.parametrize("systems", ["G", "GE", "GEC"])
def test_a_station_day_is_as_accurate_as_the_peer_and_says_how_wrong_it_is(day: Day, systems: str) -> None:
    observations, navigation, baseline = day
    positions = gnss.solve(observations, navigation, systems=systems, truth_ecef_m=baseline["reference_ecef_m"])
    epochs = positions.epochs
    assert epochs["status"].to_list() == ["ok"] * 2880
    error = errors(epochs)
    h95 = float(np.quantile(np.hypot(error[:, 0], error[:, 1]), 0.95))
    assert h95 <= baseline[systems]["h95_m"]
    assert float(np.quantile(np.abs(error[:, 2]), 0.95)) <= baseline[systems]["v95_m"]
    nees = evaluation.nees(error, covariances(epochs))
    assert 1.0 < nees.nees_mean < 4.0
    # Satellites above the peer's mask as it counts them; it drops a few for reasons of its own.
    above = gnss.solve(observations, navigation, systems=systems, mask_rad=np.radians(10.0)).epochs
    assert abs(float(above["n_sv"].to_numpy().mean()) - baseline[systems]["mean_sats"]) < 0.15


# gLAB 6.0.0, GPS, mask 5 degrees, on the same files against the same truth: 1.90 m at 95 %.
def test_gps_alone_is_as_accurate_as_the_second_peer(day: Day) -> None:
    observations, navigation, baseline = day
    error = errors(gnss.solve(observations, navigation, systems="G", truth_ecef_m=baseline["reference_ecef_m"]).epochs)
    assert float(np.quantile(np.hypot(error[:, 0], error[:, 1]), 0.95)) <= 1.90


def test_the_mask_is_five_degrees_unless_another_is_named(day: Day) -> None:
    observations, navigation, _ = day
    lowest: list[float] = []
    for named in ({}, {"mask_rad": np.radians(5.0)}, {"mask_rad": np.radians(10.0)}):
        positions = gnss.solve(observations, navigation, systems="G", keep_ranges=True, **named)
        assert positions.ranges is not None
        lowest.append(float(np.degrees(positions.ranges["el_rad"].min())))  # type: ignore[arg-type]
        assert positions.models["mask"] == f"elevation {10 if lowest[-1] > 9 else 5} deg and more"
    assert 5.0 <= lowest[0] == lowest[1] < 5.1
    assert 10.0 <= lowest[2] < 10.1


def test_methods_take_the_table_unchanged(day: Day) -> None:
    observations, navigation, _ = day
    epochs = gnss.solve(observations, navigation).epochs
    radius = bounds(epochs, "anp-circle", 0.05).bound_m
    assert np.isfinite(radius).all()
    # A 95 % circle lies between those of a line and of a round ellipse with the same larger axis.
    larger = np.sqrt(np.linalg.eigvalsh(covariances(epochs)[:, :2, :2])[:, 1])
    assert ((radius >= 1.959 * larger) & (radius <= 2.4478 * larger)).all()


def test_a_receiver_at_rest_stands_still_by_doppler(day: Day) -> None:
    observations, navigation, _ = day
    speed = gnss.solve(observations, navigation).epochs["ground_speed_mps"].to_numpy()
    # Doppler of a geodetic receiver: some millimetres a second a satellite, and the broadcast clock rates.
    assert float(np.quantile(speed, 0.95)) < 0.05


def test_the_ionosphere_free_pair_needs_no_ionosphere(day: Day) -> None:
    observations, navigation, baseline = day
    error = errors(gnss.solve(observations, navigation, systems="GE", signals="dual", truth_ecef_m=baseline["reference_ecef_m"]).epochs)
    # The mean north error that the broadcast ionosphere leaves (0.3 to 0.5 m here, in the peer too) is gone.
    assert abs(error[:, 1].mean()) < 0.1


def test_wrong_arguments_are_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="nowhere"):
        gnss.read_observations(tmp_path / "nowhere.rnx")
    (tmp_path / "empty").write_bytes(b"")
    with pytest.raises(FormatError, match="empty"):
        gnss.read_navigation(tmp_path / "empty")
    with pytest.raises(InputError, match="paths"):
        gnss.read_navigation([])
    packed = tmp_path / "cut.gz"
    packed.write_bytes(gzip.compress(b"x" * 1000)[:-10])
    with pytest.raises(FormatError, match="gzip"):
        gnss.read_observations(packed)


def test_settings_outside_their_domain_are_refused(day: Day) -> None:
    observations, navigation, _ = day
    for wrong in (
        {"systems": "GX"},
        {"systems": ""},
        {"mask_rad": float("nan")},
        {"mask_rad": 2.0},
        {"false_alarm": 0.0},
        {"range_factor": 0.0},
        {"shared_factor": float("nan")},
        {"signals": "triple"},
    ):
        with pytest.raises(InputError, match=next(iter(wrong))):
            gnss.solve(observations, navigation, **wrong)
    with pytest.raises(InputError, match="code"):
        observations.column("G", "C9Z")


def test_another_station_is_solved_without_having_been_calibrated_on(shared_data: Path) -> None:
    folder = shared_data / "gnss" / "ARLM_2015_200"
    observations = gnss.read_observations(folder / "arlm200x.15o")
    # Truth is the header here (catalogue: surveyed monitor station).
    positions = gnss.solve(
        observations, gnss.read_navigation(folder / "arlm2000.15n"), systems="G", truth_ecef_m=observations.approximate_ecef_m
    )
    assert positions.epochs["status"].is_in(["ok", "degraded"]).all()
    nees = evaluation.nees(errors(positions.epochs), covariances(positions.epochs))
    # One hour: a share of the errors that last longer than it.
    assert 1.0 < nees.nees_mean < 4.0


# Used for no number of the weights: a receiver in the open, another hour of the sun's cycle (catalogue: surveyed).
def test_a_surveyed_receiver_is_no_further_off_than_the_peer(shared_data: Path) -> None:
    folder = shared_data / "gnss" / "taroz_static"
    baseline = json.loads((shared_data / "baselines.json").read_text(encoding="utf-8"))["taroz_static"]["rover_GEC"]
    lat, lon, h = (float(v) for v in (folder / "rover_position.txt").read_text().split())
    truth = ecef(np.radians([lat]), np.radians([lon]), np.array([h]))[0]
    positions = gnss.solve(gnss.read_observations(folder / "rover.obs.gz"), gnss.read_navigation(folder / "base.nav"), truth_ecef_m=truth)
    error = errors(positions.epochs)
    assert float(np.quantile(np.hypot(error[:, 0], error[:, 1]), 0.95)) <= baseline["h95_m"]
    # Five minutes are one ionosphere, whose errors are covered.
    assert 0.3 < evaluation.nees(error, covariances(positions.epochs)).nees_mean < 4.0


# Nothing was set by this drive. Without the memory of surroundings, 268 epochs were "ok" with a mean of 777.
@pytest.mark.parametrize("systems", ["G", "GC"])
def test_a_street_is_degraded_and_its_covariance_can_be_believed(shared_data: Path, systems: str) -> None:
    folder = shared_data / "gnss" / "HK_TST_2019_118"
    observations = gnss.read_observations(folder / "COM3_190428_124409.obs")
    week, second, lat, lon, h = np.loadtxt(folder / "groundTruth_TST.csv", delimiter=",").T
    known = ecef(np.radians(lat), np.radians(lon), h)
    time_s = observations.time_ns * 1e-9 - week[0] * 604_800
    truth = np.column_stack([np.interp(time_s, second, known[:, k], np.nan, np.nan) for k in range(3)])
    navigation = gnss.read_navigation([folder / "hksc1180.19n", folder / "hksc1180.19b"])
    epochs = gnss.solve(observations, navigation, systems=systems, truth_ecef_m=truth).epochs
    street = epochs.filter(pl.col("nse_e_m").is_not_null())
    assert street.height > 400
    assert street["status"].to_list().count("ok") < 0.05 * street.height
    reasons = street["reason"].drop_nulls().str.contains("contradict|to spare|cannot confirm|wider than 185.2 m")
    assert reasons.all()
    # Wide rather than narrow: the covariance holds every reading of the ranges, and errors are at most what it says.
    error = errors(street)
    assert 0.3 < evaluation.nees(error, covariances(street)).nees_mean <= 3.0
    miss = np.hypot(error[:, 0], error[:, 1])
    assert (miss <= bounds(street, "anp-circle", 0.05).bound_m).mean() >= 0.95
    assert (miss <= bounds(street, "anp-circle", 1e-5).bound_m).mean() >= 0.999


def test_a_calibration_of_ones_own_scales_the_covariance(day: Day) -> None:
    observations, navigation, _ = day
    plain, doubled = (gnss.solve(observations, navigation, systems="G", range_factor=f, shared_factor=f) for f in (1.0, 2.0))
    assert "times 2" in doubled.models["weights"]
    assert "times" not in plain.models["weights"]
    both = plain.epochs["cov_uu_m2"].to_numpy(), doubled.epochs["cov_uu_m2"].to_numpy()
    # A power of two goes through the whole solution without rounding.
    assert np.median(both[1] / both[0]) == pytest.approx(4.0, rel=1e-12)


def test_every_column_is_in_the_glossary(day: Day) -> None:
    observations, navigation, baseline = day
    glossary = (Path(__file__).parents[1] / "docs" / "notation.md").read_text(encoding="utf-8")
    columns = gnss.solve(observations, navigation, truth_ecef_m=baseline["reference_ecef_m"]).epochs.columns
    assert [c for c in columns if f"`{c}`" not in glossary] == []
