"""The example tables of tracks, levels and an inertial unit hold what their page says, against figures that come from elsewhere."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

import navbound
from navbound import ins, kpi

ROOT = Path(__file__).parents[1]
DATA = ROOT / "examples" / "data"
NS = 1_000_000_000


def table(name: str) -> pl.DataFrame:
    return pl.read_csv(DATA / name)


def apart_enu_m(place: pl.DataFrame, other: pl.DataFrame) -> np.ndarray[Any, Any]:
    """Differences of two places along east, north and up; radii of curvature of WGS-84, written down here. [m]"""
    lat, lon, h = (place[name].to_numpy() for name in ("lat_rad", "lon_rad", "h_m"))
    a, e2 = 6378137.0, 0.00669437999014
    w = 1.0 - e2 * np.sin(lat) ** 2
    east = (other["lon_rad"].to_numpy() - lon) * (a / np.sqrt(w) + h) * np.cos(lat)
    north = (other["lat_rad"].to_numpy() - lat) * (a * (1 - e2) / w**1.5 + h)
    return np.stack([east, north, other["h_m"].to_numpy() - h], 1)


def in_si(tracks: pl.DataFrame) -> pl.DataFrame:
    return tracks.select(lat_rad=pl.col("lat_deg").radians(), lon_rad=pl.col("lon_deg").radians(), h_m="height_m")


def covariance(fixes: pl.DataFrame) -> np.ndarray[Any, Any]:
    full = [f"cov_{axes}_m2" for axes in ("ee", "en", "eu", "en", "nn", "nu", "eu", "nu", "uu")]
    return np.stack([fixes[name].to_numpy() for name in full], 1).reshape(-1, 3, 3)


def test_the_tracks_are_two_dozen_landings_on_two_runways() -> None:
    run = navbound.analyze(DATA / "tracks.csv", path="LFPG/08R,LFPG/09L", sigma_m=2.5, truth=DATA / "tracks-truth.csv")
    assert [(c.path, c.n_tracks) for c in run.summary.cross_track] == [("LFPG/08R", 12), ("LFPG/09L", 12)]
    assert run.summary.verdict.id == "inside"
    belief = run.summary.verdict.belief
    assert belief is not None
    assert belief.state == "supported"


def test_the_tracks_end_at_their_thresholds() -> None:
    last = table("tracks-truth.csv").group_by("icao24", maintain_order=True).last()
    # Thresholds to four decimals, written down here (inferred: the publication was not read); rows are 2 s and 140 m apart.
    thresholds = {0: (48.9931, 2.5656), 1: (49.0247, 2.5248)}
    for k, row in enumerate(last.iter_rows(named=True)):
        lat, lon = thresholds[k % 2]
        east, north = (row["lon_deg"] - lon) * 111_320 * np.cos(np.radians(lat)), (row["lat_deg"] - lat) * 111_200
        assert -200.0 < east < 50.0, row
        assert abs(north) < 100.0, row


def test_positions_of_the_tracks_are_wrong_by_what_the_page_says() -> None:
    reported, truth = table("tracks.csv"), table("tracks-truth.csv")
    assert reported.select("time", "icao24", "callsign").equals(truth.select("time", "icao24", "callsign"))
    error = apart_enu_m(in_si(reported), in_si(truth))
    assert len(set(reported["icao24"])) == 24
    # 24 flights of about one independent error each; a share of the chi-square law of 24 degrees of 1e-4 either way: 0.31 to 2.25.
    by_flight = np.stack([np.sqrt((error[reported["icao24"].to_numpy() == name] ** 2).mean(0)) for name in reported["icao24"].unique()])
    for axis in range(2):
        assert 0.31 < np.mean(by_flight[:, axis] ** 2) / 2.5**2 < 2.25


def test_the_day_of_levels_has_its_outage_and_no_misleading_level() -> None:
    levels = table("levels.csv")
    since_s = (levels["time_ns"] - levels["time_ns"][0]).to_numpy() / NS
    assert since_s.tolist() == [s for s in 30.0 * np.arange(2880) if not 30_000 <= s < 30_600]
    assert (np.hypot(levels["nse_e_m"].to_numpy(), levels["nse_n_m"].to_numpy()) < levels["hpl_m"].to_numpy()).all()
    assert (levels["nse_u_m"].abs() < levels["vpl_m"]).all()
    indicators = kpi.evaluate(levels, ["LPV-200"], period_s=30.0).levels[0]
    # Of 2880 expected; the vertical limit is 35 m.
    assert indicators.n_available == levels.filter((pl.col("vpl_m") <= 35.0) & (pl.col("hpl_m") <= 40.0)).height < 2860


def test_the_inertial_samples_lead_along_the_true_motion() -> None:
    imu, motion = table("imu.csv"), table("motion.csv")
    track = ins.mechanize(ins.Imu.of_table(imu), ins.Start.of_table(motion))
    seconds = np.isin(track.time_ns, motion["time_ns"].to_numpy())
    alone = pl.DataFrame(dict(zip(("lat_rad", "lon_rad", "h_m"), track.position[seconds].T, strict=True)))
    drift = np.hypot(*apart_enu_m(motion[1:], alone)[:, :2].T)
    # The unit's accelerometers are wrong by 1e-4 g: a Gaussian of t^2/2 times that, 1.8 m after a minute and 28 m after four; five of them.
    assert drift[59] < 5 * 1.8
    assert 0.1 < drift[-1] < 5 * 28


def test_the_fixes_are_wrong_by_what_their_covariance_says_and_stop_for_a_minute() -> None:
    fixes, motion = table("fixes.csv"), table("motion.csv")
    since_s = (fixes["time_ns"] - motion["time_ns"][0]).to_numpy() / NS
    assert since_s.tolist() == [float(s) for s in range(241) if not 120 <= s < 180]
    truth = fixes.select("time_ns").join(motion, on="time_ns")
    error = apart_enu_m(truth, fixes)
    square = np.einsum("ni,nij,nj->n", error, np.linalg.inv(covariance(fixes)), error)
    # Three numbers that hardly change within the log: between the 1e-4 quantiles of the chi-square law of three degrees.
    assert 0.0052 < square.mean() < 21.1


def fused(correlation_time_s: float) -> tuple[ins.Fused, pl.DataFrame]:
    imu, fixes, motion = (table(f"{name}.csv") for name in ("imu", "fixes", "motion"))
    aiding = ins.Aiding(fixes=ins.Fixes.of_table(fixes, correlation_time_s=correlation_time_s))
    return ins.fuse(ins.Imu.of_table(imu), aiding, ins.Start.of_table(motion)), motion


@pytest.mark.parametrize(("correlation_time_s", "consistent"), [(100.0, True), (0.0, False)])
def test_a_filter_that_knows_how_long_errors_last_is_consistent(correlation_time_s: float, consistent: bool) -> None:
    result, motion = fused(correlation_time_s)
    truth = pl.DataFrame({"time_ns": result.time_ns}).join(motion, on="time_ns")
    estimate = pl.DataFrame(dict(zip(("lat_rad", "lon_rad", "h_m"), result.position.T, strict=True)))
    error = apart_enu_m(truth, estimate)
    square = np.einsum("ni,nij,nj->n", error, np.linalg.inv(result.covariance_enu_m2), error) / 3
    # One for a consistent covariance; about one independent error in the log, so that twice it is no contradiction yet.
    assert bool(square.mean() < 2.0) == consistent
    coasting = [int((t - motion["time_ns"][0]) / NS) for t, mode in zip(result.time_ns, result.mode, strict=True) if mode == "coasting"]
    assert (coasting[0], coasting[-1]) == (126, 189)


def test_what_fixes_say_of_each_other_is_in_their_covariance() -> None:
    fixes = table("fixes.csv")
    plain, lasting = (ins.Fixes.of_table(fixes, correlation_time_s=s) for s in (0.0, 50.0))
    np.testing.assert_array_equal(np.asarray(plain.covariance_enu_m2), covariance(fixes))
    # A fix a second: 2 x 50 s / 1 s.
    np.testing.assert_allclose(np.asarray(lasting.covariance_enu_m2), 100.0 * covariance(fixes), rtol=1e-15)


def test_the_lines_of_the_page_run(monkeypatch: pytest.MonkeyPatch) -> None:
    page = (DATA / "README.md").read_text(encoding="utf-8")
    code = re.search(r"```python\n(.*?)```", page, re.DOTALL)
    assert code
    monkeypatch.chdir(ROOT)
    names: dict[str, Any] = {}
    exec(code.group(1), names)
    assert names["fused"].mode.count("coasting") == 64
