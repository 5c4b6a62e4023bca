"""Recorded tracks with falsified positions, with truth, with quality indicators, along routes."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

import navbound
from navbound import FormatError, InputError, anp, path
from navbound.read.categories import NACP_EPU_M, NIC_RC_M, circular_sigma, nacp_sigma_m
from navbound.read.checks.plausible import check
from navbound.read.covariance import claim
from navbound.read.tables.epochs import read
from navbound.records.material import Material
from navbound.run.analyze import material
from navbound.run.judge import judge

SHARED = Path(__file__).parents[2] / "shared" / "data"
SPOOFED = SHARED / "aircraft" / "other" / "noisy_spoofing.json.gz"
TRACE = SHARED / "aircraft" / "other" / "trace_full_ac671b.json.gz"
DRIVE = SHARED / "gnss_imu" / "taroz_kinematic"
ESBC = SHARED / "gnss" / "ESBC_2020_177" / "baseline"

needs_data = pytest.mark.skipif(not SHARED.exists(), reason="the recorded data are not at hand")


def nees(m: Material) -> float:
    """Mean of e' V^-1 e over the epochs with truth and covariance."""
    names = [f"cov_{a}_m2" for a in ("ee", "en", "eu", "en", "nn", "nu", "eu", "nu", "uu")]
    known = m.epochs.drop_nulls(["nse_e_m", "nse_n_m", "nse_u_m", *set(names)])
    v = np.stack([known[n].to_numpy() for n in names], axis=1).reshape(-1, 3, 3)
    e = known.select("nse_e_m", "nse_n_m", "nse_u_m").to_numpy()
    return float(np.mean(np.einsum("ni,nij,nj->n", e, np.linalg.inv(v), e)))


@needs_data
def test_every_large_step_of_a_falsified_track_is_covered_by_a_status() -> None:
    """README of the data: 15 steps above 5 km. Its 554 km is a flat figure; the chord of the largest is 563.9 km."""
    m = material(SPOOFED, requirement="RNP 2", rnp_m=3704, sigma_m=50)
    words = next(a for a in m.assumptions if a.startswith("Plausibility"))
    assert "15 steps of more than 5 km" in words
    assert "563.9 km" in words
    r = 6.371e6
    lat, lon = m.epochs["est_lat_rad"].to_numpy(), m.epochs["est_lon_rad"].to_numpy()
    north, east = np.diff(lat) * r, np.diff(lon) * r * np.cos(lat[1:])
    far = np.flatnonzero(np.hypot(north, east) > 5000)
    assert len(far) == 15
    assert abs(np.hypot(north, east).max() - 554e3) < 1e3
    refused = m.epochs["status"].is_in(["not_available", "invalid_input"]).to_numpy()
    # Either the position before the step had been held too long, or the step itself cannot be flown.
    assert all(refused[i] or refused[i + 1] for i in far)
    assert m.epochs.filter(pl.Series(refused))["cov_ee_m2"].null_count() == refused.sum()
    assert any(r.count == 11 and r.reason == "latitude: empty" for r in m.rejected)


@needs_data
def test_the_monitor_raises_at_every_large_step() -> None:
    run = judge(material(SPOOFED, requirement="RNP 2", rnp_m=3704, sigma_m=50))
    lat, lon = run.epochs["est_lat_rad"].to_numpy(), run.epochs["est_lon_rad"].to_numpy()
    far = np.flatnonzero(np.hypot(np.diff(lat), np.diff(lon) * np.cos(lat[1:])) * 6.371e6 > 5000)
    alert = run.epochs["alert"].to_list()
    assert len(far) == 15
    assert {(alert[i], alert[i + 1])[alert[i] == "normal"] for i in far} == {"unavailable"}
    # An alarm that never ends would pass as well: more than half of the track is judged and normal.
    assert alert.count("normal") > len(alert) / 2


@needs_data
@pytest.mark.parametrize("flight", ["ajaccio", "brussels_ils", "kiruna", "munich", "nice", "vienna"])
def test_a_sound_flight_has_no_jumps(flight: str) -> None:
    """Navaid inspection flights: arcs, holds and steep turns at 5 s or 10 s, with the delays of a network of receivers."""
    m = material(SHARED / "aircraft" / "calibration" / f"{flight}.json.gz", requirement="RNP 1", rnp_m=1852, sigma_m=10)
    assert any(a.startswith("Plausibility: 0 position jumps") for a in m.assumptions)
    # What came 14 s and more late is ahead of the position before it, which is the wrong one: no more than one row in a hundred.
    invalid = m.epochs.filter(pl.col("status") == "invalid_input")
    assert set(invalid["reason_id"]) <= {"position_ahead"}
    assert invalid.height < (0.01 * m.epochs.height if flight in {"brussels_ils", "munich", "vienna"} else 1)


@needs_data
@pytest.mark.parametrize(("solution", "epochs", "expected", "tolerance"), [("spp", 550, 4.21, 0.005), ("rtk", 531, 6955.0, 0.5)])
def test_the_drive_has_the_error_statistics_of_the_catalogue(solution: str, epochs: int, expected: float, tolerance: float) -> None:
    """README of the data: mean NEES 4.21 and 6955, to the digits printed; a consistent covariance has 3."""
    m = material(DRIVE / f"rover_1Hz_{solution}.pos", truth=DRIVE / "reference_1Hz.pos", requirement="RNP 0.3", rnp_m=555.6)
    assert m.epochs.height == epochs
    assert abs(nees(m) - expected) <= tolerance
    assert any(f"{epochs} of {epochs} epochs have one" in a for a in m.assumptions)


@needs_data
def test_the_same_truth_in_another_file_gives_the_same_error() -> None:
    """The reference as CSV, weeks and time of week at 5 Hz, and as RTKLIB file at 1 Hz."""
    both = [
        material(DRIVE / "rover_1Hz_spp.pos", truth=DRIVE / name, requirement="RNP 0.3", rnp_m=555.6).epochs.select(
            "nse_e_m", "nse_n_m", "nse_u_m"
        )
        for name in ("reference_1Hz.pos", "reference.csv")
    ]
    # Both files print 1e-8 deg or more (1 mm) and 1 mm of height.
    assert np.abs(both[0].to_numpy() - both[1].to_numpy()).max() < 2e-3


@needs_data
@pytest.mark.parametrize(("systems", "expected"), [("G", 0.34), ("GE", 0.43), ("GEC", 0.47)])
def test_cartesian_solutions_have_the_error_statistics_of_the_catalogue(tmp_path: Path, systems: str, expected: float) -> None:
    """README of the data: a static day against its precise position; the covariance is given in Earth-centred axes."""
    header = "%  GPST x-ecef(m) y-ecef(m) z-ecef(m) Q ns\n"
    times = [2111 * 604_800 + 345_600 + 30 * i for i in range(2880)]
    rows = [f"{t // 604_800} {t % 604_800}.000 3582104.9212 532590.1856 5232755.3599 6 9\n" for t in times]
    (tmp_path / "truth.pos").write_text(header + "".join(rows), encoding="utf-8")
    m = material(ESBC / f"esbc_spp_{systems}.pos.gz", truth=tmp_path / "truth.pos", requirement="RNP 0.3", rnp_m=555.6)
    assert m.epochs.height == 2880
    assert abs(nees(m) - expected) <= 0.005


@needs_data
def test_a_truth_eighteen_seconds_off_is_no_truth(tmp_path: Path) -> None:
    """A file in GPS time whose header says UTC: no epoch fits at 0.01 s where the times are not whole seconds, else the error shows it."""
    text = (DRIVE / "reference_1Hz.pos").read_text(encoding="utf-8").replace("%  GPST", "%  UTC ")
    (tmp_path / "utc.pos").write_text(text, encoding="utf-8")
    right = material(DRIVE / "rover_1Hz_spp.pos", truth=DRIVE / "reference_1Hz.pos", requirement="RNP 0.3", rnp_m=555.6)
    wrong = material(DRIVE / "rover_1Hz_spp.pos", truth=tmp_path / "utc.pos", requirement="RNP 0.3", rnp_m=555.6)
    assert nees(wrong) > 10 * nees(right)
    early = text.replace("2023/07/11", "2023/07/10")
    (tmp_path / "early.pos").write_text(early, encoding="utf-8")
    with pytest.raises(InputError, match=r"no epoch of early\.pos is within 0\.01 s of one"):
        material(DRIVE / "rover_1Hz_spp.pos", truth=tmp_path / "early.pos", requirement="RNP 0.3", rnp_m=555.6)


@needs_data
def test_a_quality_indicator_becomes_a_covariance_and_expires() -> None:
    m = material(TRACE, requirement="RNP 2", rnp_m=3704)
    words = m.assumptions[0]
    assert "NACp" in words
    assert "which was not read" in words
    # NACp 10: EPU below 10 m; of a circular error 95 % lie within 2.4477 sigma (spec of the total system error, 1.5).
    usual = m.epochs["cov_ee_m2"].drop_nulls().mode()[0]
    assert abs(math.sqrt(usual) * 2.4477468306808165 / 10 - 1) < 2e-11
    # One time of the recording stands twice, with positions 127 m apart.
    contradicted = m.epochs.filter(pl.col("status") == "invalid_input")
    assert (contradicted["reason_id"].to_list(), m.left_out.height) == (["position_jump"], 1)
    before = m.epochs.filter(pl.col("cov_ee_m2").is_null(), pl.col("status") != "invalid_input")
    assert set(before["reason"]) == {"no covariance"}


def test_the_radius_factors_are_those_of_the_specification() -> None:
    """Two-dimensional radius factors, spec of the total system error, section 1.5."""
    assert abs(1 / circular_sigma(0.05) - 2.4477468306808165) < 1e-15
    assert abs(1 / circular_sigma(1e-5) - 4.7985259121880812) < 2e-15


def test_a_category_whose_limit_is_the_rnp_is_inside_it() -> None:
    """NACp 6 is an EPU of less than 555.6 m (0.3 NM), 7 of less than 185.2 m (0.1 NM)."""
    for category, rnp_nm in ((6, 0.3), (7, 0.1), (5, 0.5), (4, 1.0), (3, 2.0), (2, 4.0), (1, 10.0)):
        radius_m = nacp_sigma_m()[category] / circular_sigma(0.05)
        assert NACP_EPU_M[category] == pytest.approx(rnp_nm * 1852.0, abs=1e-9)
        assert 0.0 < rnp_nm * 1852.0 - radius_m < 1e-6
        assert anp.circle(np.diag([nacp_sigma_m()[category] ** 2] * 2), 0.05) < rnp_nm * 1852.0


def test_a_better_category_never_has_a_larger_radius() -> None:
    for table in (NACP_EPU_M, NIC_RC_M):
        assert [table[k] for k in sorted(table, reverse=True)] == sorted(table.values())
        assert min(table) == 1


def epoch_table(**columns: list[float | None]) -> pl.DataFrame:
    n = len(next(iter(columns.values())))
    return pl.DataFrame({"track": ["a"] * n, "time_ns": [10**9 * 60 * i for i in range(n)]} | columns)


def test_the_callers_sigma_goes_before_the_file_and_the_covariance_before_the_category() -> None:
    full = epoch_table(cov_ee_m2=[4.0], cov_en_m2=[1.0], cov_nn_m2=[9.0], nac_p=[10.0])
    assert claim(full).epochs.select("cov_ee_m2", "cov_en_m2", "cov_nn_m2").row(0) == (4.0, 1.0, 9.0)
    assert claim(full, 3.0).epochs.select("cov_ee_m2", "cov_en_m2", "cov_nn_m2").row(0) == (9.0, 0.0, 9.0)
    axes = claim(epoch_table(sigma_e_m=[2.0], sigma_n_m=[3.0], sigma_u_m=[5.0])).epochs
    assert axes.select("cov_ee_m2", "cov_en_m2", "cov_nn_m2", "cov_uu_m2").row(0) == (4.0, 0.0, 9.0, 25.0)
    for wrong in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(InputError, match="sigma_m"):
            claim(full, wrong)


def test_a_category_counts_for_five_minutes_and_zero_means_unknown() -> None:
    in_force = claim(epoch_table(nac_p=[9.0, None, None, None, None, None, None, 0.0, None])).epochs["cov_ee_m2"]
    assert in_force.is_not_null().to_list() == [True] * 6 + [False] * 3


def make_track(folder: Path, line: path.Path, offsets_m: list[float], step_m: float, start_m: float) -> Path:
    """A track at stated distances right of a path, 1 s apart: each position on the geodesic that leaves the path at a right angle."""
    rows = ["gps_time_s,lat_rad,lon_rad,sde,sdn"]
    for i, offset in enumerate(offsets_m):
        foot = line.at(start_m + step_m * i)
        side = path.from_azimuth(foot.lat_rad.item(), foot.lon_rad.item(), foot.course_rad.item() + math.pi / 2).at(offset)
        rows.append(f"{1.3e9 + i},{side.lat_rad.item()!r},{side.lon_rad.item()!r},3,4")
    file = folder / "track.csv"
    file.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return file


ROUTE = """
[[waypoint]]
name = "ALPHA"
lat_deg = 40.0
lon_deg = 116.0

[[waypoint]]
name = "BRAVO"
lat_deg = 39.0
lon_deg = 116.5

[[waypoint]]
name = "CHARLIE"
lat_deg = 39.0
lon_deg = 118.0
"""


def test_a_track_on_a_route_has_the_offset_it_was_made_with(tmp_path: Path) -> None:
    (tmp_path / "route.toml").write_text(ROUTE, encoding="utf-8")
    first = path.line(*np.radians([40.0, 116.0, 39.0, 116.5]).tolist())
    offsets = [100.0 * math.sin(i / 7) for i in range(60)]
    track = make_track(tmp_path, first, offsets, 100.0, -950.0)
    m = material(track, path=tmp_path / "route.toml", requirement="RNP 1", rnp_m=1852)
    # Ten epochs lie before the first waypoint; they are counted, not judged.
    assert m.epochs.height == 50
    assert any("before the start" in r.reason and r.count == 10 for r in m.rejected)
    # The projection is good to a micrometre; the coordinates have 16 digits, 1e-9 m on the ground.
    assert np.abs(m.epochs["fte_m"].to_numpy() - np.array(offsets[10:])).max() < 1e-5
    assert np.abs(m.epochs["along_m"].to_numpy() - (50.0 + 100.0 * np.arange(50))).max() < 1e-5
    assert set(m.epochs["leg"]) == {"ALPHA-BRAVO"}
    assert [w.name for w in m.waypoints] == ["ALPHA", "BRAVO", "CHARLIE"]
    assert set(m.epochs["status"]) == {"ok"}


def test_a_route_without_sense_is_refused_by_name(tmp_path: Path) -> None:
    track = make_track(tmp_path, path.line(0.7, 2.0, 0.71, 2.0), [0.0] * 3, 100.0, 0.0)
    file = tmp_path / "route.toml"
    for content, says in [
        (ROUTE.replace("40.0", "95.0"), r"lat_deg: waypoint 1: found “95.0”, allowed \[-90, 90\]"),
        (ROUTE.replace("lon_deg = 118.0", ""), "lon_deg: waypoint 3: found “None”"),
        ("[[waypoint]\n", "not TOML"),
        ("a = 1\n", "needs .*waypoint"),
        (ROUTE.partition('[[waypoint]]\nname = "BRAVO"')[0], "no route"),
    ]:
        file.write_text(content, encoding="utf-8")
        with pytest.raises(FormatError, match=says):
            material(track, path=file, requirement="RNP 1", rnp_m=1852)


def test_without_a_path_only_the_navigation_system_is_judged(tmp_path: Path) -> None:
    track = make_track(tmp_path, path.line(0.7, 2.0, 0.71, 2.0), [0.0] * 5, 100.0, 0.0)
    m = material(track, requirement="RNP 1", rnp_m=1852)
    assert m.epochs["fte_m"].null_count() == 5
    assert m.epochs["cov_ee_m2"].to_list() == [9.0] * 5
    assert any("only the navigation system is judged" in a for a in m.assumptions)
    assert any("uncorrelated" in a for a in m.assumptions)


def test_a_covariance_that_is_none_is_not_believed(tmp_path: Path) -> None:
    rows = ["gps_time_s,lat_deg,lon_deg,cov_ee_m2,cov_en_m2,cov_nn_m2"]
    rows += [f"{1.3e9 + i},{48 + 5e-4 * i},2,{cov}" for i, cov in enumerate(["4,1,9", "4,7,9", "0,0,0", ",,"])]
    (tmp_path / "cov.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    epochs = material(tmp_path / "cov.csv", requirement="RNP 1", rnp_m=1852).epochs
    assert epochs["status"].to_list() == ["ok", "invalid_input", "degraded", "not_available"]
    assert epochs["reason"].to_list() == [None, "not a covariance", "the covariance is zero along an axis", "no covariance"]
    assert epochs["cov_ee_m2"].to_list() == [4.0, None, 0.0, None]


def test_a_variance_below_a_tenth_of_a_millimetre_squared_is_one_of_zero(tmp_path: Path) -> None:
    stated = ["9,0,9,,,4", "1e-320,0,9,,,4", "9,0,5e-324,,,4", "9,0,9,,,1e-320", "0.99e-8,0,9,,,4", "1.01e-8,0,9,,,4"]
    rows = ["gps_time_s,lat_deg,lon_deg,cov_ee_m2,cov_en_m2,cov_nn_m2,cov_eu_m2,cov_nu_m2,cov_uu_m2"]
    rows += [f"{1.3e9 + i},{48 + 5e-4 * i},2,{cov}" for i, cov in enumerate(stated)]
    (tmp_path / "cov.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    epochs = material(tmp_path / "cov.csv", requirement="RNP 1", rnp_m=1852).epochs
    assert epochs["reason_id"].to_list() == [None, *["zero_covariance"] * 4, None]


@pytest.mark.parametrize("axis", ["e", "n", "u"])
def test_an_axis_without_an_error_is_one_whose_accuracy_the_file_does_not_have(axis: str, tmp_path: Path) -> None:
    sigma_m = {name: 0 if name == axis else 5 for name in "enu"}
    rows = ["gps_time_s,lat_deg,lon_deg,height_m,sigma_e_m,sigma_n_m,sigma_u_m"]
    rows += [f"{1.3e9 + i},{48 + 5e-4 * i},2,900,{sigma_m['e']},{sigma_m['n']},{sigma_m['u']}" for i in range(60)]
    (tmp_path / "sigma.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    assert set(material(tmp_path / "sigma.csv", requirement="RNP 1", rnp_m=1852).epochs["status"]) == {"degraded"}


@pytest.mark.parametrize("rnp_m", [0.0, -1.0, math.nan, math.inf])
def test_an_rnp_value_outside_its_domain_is_refused(tmp_path: Path, rnp_m: float) -> None:
    with pytest.raises(InputError, match="rnp_m"):
        material(tmp_path / "absent.csv", requirement="RNP 0", rnp_m=rnp_m)


def test_a_route_in_csv_is_the_route_in_toml(tmp_path: Path) -> None:
    (tmp_path / "route.toml").write_text(ROUTE, encoding="utf-8")
    rows = ["name,lat_deg,lon_deg,radius_m", "ALPHA,40,116,", "BRAVO,39,116.5,0", "CHARLIE,39,118,0"]
    (tmp_path / "route.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    line = path.line(*np.radians([40.0, 116.0, 39.0, 116.5]).tolist())
    track = make_track(tmp_path, line, [30.0] * 20, 100.0, 50.0)
    both = [material(track, path=tmp_path / name, requirement="RNP 1", rnp_m=1852) for name in ("route.toml", "route.csv")]
    assert both[0].epochs.equals(both[1].epochs)
    assert both[0].waypoints == both[1].waypoints
    assert (both[1].cross_track[0].n_points, both[1].cross_track[0].n_tracks) == (20, 1)


def test_each_track_has_its_own_truth(tmp_path: Path) -> None:
    """Two aircraft one degree of latitude apart, at the same times; a truth of one alone is the truth of all."""
    head = "icao24,gps_time_s,lat_deg,lon_deg"
    both = [f"{who},{1.3e9 + i},{lat},2" for who, lat in (("a", 48.0), ("b", 49.0)) for i in range(3)]
    (tmp_path / "estimate.csv").write_text("\n".join([head, *both]) + "\n", encoding="utf-8")
    (tmp_path / "truth.csv").write_text("\n".join([head, *reversed(both)]) + "\n", encoding="utf-8")
    (tmp_path / "one.csv").write_text("\n".join([head, *both[:3]]) + "\n", encoding="utf-8")
    own = material(tmp_path / "estimate.csv", truth=tmp_path / "truth.csv", requirement="RNP 1", rnp_m=1852).epochs
    assert own["nse_n_m"].to_list() == [0.0] * 6
    shared = material(tmp_path / "estimate.csv", truth=tmp_path / "one.csv", requirement="RNP 1", rnp_m=1852).epochs
    assert shared.filter(pl.col("track") == "a")["nse_n_m"].to_list() == [0.0] * 3
    # Southwards one degree: 111.2 km of meridian at 49 degrees; the radius at one end stands for the whole, 0.02 % off.
    assert np.abs(shared.filter(pl.col("track") == "b")["nse_n_m"].to_numpy() + 111_208).max() < 30


def test_an_epoch_in_two_files_counts_once(tmp_path: Path) -> None:
    head = "icao24,gps_time_s,lat_deg,lon_deg"
    rows = [f"a,{1.3e9 + i},48,2" for i in range(6)]
    for name, part in (("first.csv", rows[:4]), ("second.csv", rows[2:])):
        (tmp_path / name).write_text("\n".join([head, *part]) + "\n", encoding="utf-8")
    m = material([tmp_path / "first.csv", tmp_path / "second.csv"], requirement="RNP 1", rnp_m=1852)
    assert m.epochs.height == 6
    assert [(r.reason, r.count) for r in m.rejected] == [("time repeated within a track of several files", 2)]
    assert [i.n_rows for i in m.inputs] == [4, 4]


@needs_data
def test_the_shared_falsified_flight_has_two_impossible_steps_by_the_time_of_position() -> None:
    """Rows of 09:39:43 and 09:58:11 UTC, reached from those a second earlier; the catalogue gives the larger as 563 km on the sphere."""
    reading = read(SPOOFED)
    epochs, doubts = check(reading.epochs)
    jumps = epochs.filter(pl.col("reason_id") == "position_jump")
    # GPS time is 18 s ahead of UTC.
    of_day = [(t // 1_000_000_000 - 18) % 86_400 for t in jumps["time_ns"]]
    assert of_day == [9 * 3600 + 39 * 60 + 43, 9 * 3600 + 58 * 60 + 11]
    # The chord on the ellipsoid: the flattening (1/298) bounds what a sphere differs by.
    assert abs(doubts.largest_step_m / 563_000 - 1) < 1 / 298
    assert (doubts.n_jump, doubts.n_late) == (2, 0)
    assert epochs["position_time_ns"].null_count() == 0
    assert not any("last_position" in note for note in reading.notes)


def test_a_fast_step_is_never_silent_and_the_time_of_position_decides_it(tmp_path: Path) -> None:
    """2.9 km in one second: lateness may explain it where nothing dates the positions, and nothing does where they are dated."""
    north = [0.0, 250.0, 500.0, 3400.0, 3650.0, 3900.0]
    rows = [[1_700_000_000 + k, 50 + m / 111_200, 10.0, 486.0, 1_700_000_000 + k] for k, m in enumerate(north)]
    table = pl.DataFrame(rows, schema=["timestamp", "latitude", "longitude", "groundspeed", "last_position"], orient="row")
    (dated := tmp_path / "dated.csv").write_text(table.write_csv())
    (undated := tmp_path / "undated.csv").write_text(table.drop("last_position").write_csv())
    epochs, doubts = check(read(undated).epochs)
    assert epochs["reason_id"].to_list() == [None] * 3 + ["position_late"] + [None] * 2
    assert epochs["status"][3] == "degraded"
    assert "1 step is faster than the aircraft's own speed" in doubts.words
    assert check(read(dated).epochs)[0]["reason_id"][3] == "position_jump"
    # A time of position that is later than its row is no such time.
    (wrong := tmp_path / "wrong.csv").write_text(table.with_columns(last_position=pl.col("last_position") + 500).write_csv())
    assert any("later than its row" in r.reason and r.count == 6 for r in read(wrong).rejected)


@pytest.mark.parametrize("sigma_m", [np.float32(10), np.int64(10), np.array(10.0)])
def test_a_number_of_numpy_is_that_number_in_the_record(tmp_path: Path, sigma_m: Any) -> None:
    rows = "".join(f"2026-11-22T12:00:{k:02d}Z,{48.0 + k * 100.0 / 111_195.0:.9f},2.0\n" for k in range(60))
    (tmp_path / "a.csv").write_text("time,lat_deg,lon_deg\n" + rows)
    run = navbound.analyze(tmp_path / "a.csv", sigma_m=sigma_m, solve=np.bool_(False), out=tmp_path / "run")
    assert run.summary.covariance.sigma_m == 10.0
    for wrong in ({"sigma_m": [10.0]}, {"columns": {"ground_track_rad": None}}):
        with pytest.raises(InputError):
            navbound.analyze(tmp_path / "a.csv", **wrong)
