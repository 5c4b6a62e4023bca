"""Positions with a service's corrections: back to a chosen place, beside an independent engine on real EGNOS, and one with their levels."""

from __future__ import annotations

import gzip
import shutil
import subprocess
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl
import pytest

from navbound import InputError, gnss, sbas
from sbas_synthesis import EPOCH, pseudoranges, rinex
from test_gnss_positions import ecef
from test_sbas import MSAS_USER, geodetic, seconds

if TYPE_CHECKING:
    from numpy.typing import NDArray

MSAS_ECEF = np.array([-3962108.2258, 3381309.0271, 3668678.5241])
Recording = tuple[gnss.Observations, gnss.Navigation, sbas.Messages]


@pytest.fixture(scope="module")
def msas(shared_data: Path) -> Recording:
    folder = shared_data / "sbas"
    return (
        gnss.read_observations(folder / "virtual_user_2025046_17h.25O.gz"),
        gnss.read_navigation(folder / "gps_2025046_17h_rinex3.nav"),
        sbas.read(folder / "msas137_2025046_17h.ems"),
    )


@pytest.fixture(scope="module")
def egnos(shared_data: Path) -> Recording:
    folder = shared_data / "sbas" / "more"
    return (
        gnss.read_observations(folder / "EGNS2990.12O.gz"),
        gnss.read_navigation(folder / "gps_2012299_12h.12N"),
        sbas.read(folder / "egnos_2012299.ems"),
    )


def positions(epochs: pl.DataFrame) -> NDArray[np.float64]:
    return ecef(*(epochs[name].to_numpy() for name in ("est_lat_rad", "est_lon_rad", "est_h_m")))


def test_ranges_made_with_the_services_corrections_lead_back_to_their_place(msas: Recording, shared_data: Path, tmp_path: Path) -> None:
    _, navigation, log = msas
    instants = [int(t) for t in seconds(581_000, 583_000)[::400]]
    source = shared_data / "sbas" / "gps_2025046_17h_rinex3.nav"
    # A clock fast by 100 µs: taken for the satellites' clocks' or orbits' time it would cost 0.3 m of orbit.
    made = {t: pseudoranges(log, source, t, MSAS_USER, MSAS_ECEF, 30_000.0) for t in instants}
    (tmp_path / "made.rnx").write_text(rinex(made))
    solved = sbas.solve(gnss.read_observations(tmp_path / "made.rnx"), navigation, log, mode="pa", truth_ecef_m=MSAS_ECEF)
    assert solved.epochs["status"].to_list() == ["ok"] * len(instants)
    error = solved.epochs.select("nse_e_m", "nse_n_m", "nse_u_m").to_numpy()
    # Ranges are written to the millimetre; dilutions are below 3.
    assert np.abs(error).max() < 3e-3
    assert solved.satellites["residual_m"].abs().max() < 2e-3  # type: ignore[operator]


def test_levels_of_a_solution_are_those_of_its_place(msas: Recording) -> None:
    observations, navigation, log = msas
    result = sbas.solve(observations, navigation, log)
    assert result.epochs["mode"].to_list() == [m or None for m in sbas.protection_levels(log, navigation, seconds(), **MSAS_USER).mode]
    solved = result.epochs.filter(pl.col("mode") == "pa")
    place: dict[str, Any] = dict(
        zip(("lat_rad", "lon_rad", "h_m"), (solved[f"est_{n}"].to_numpy() for n in ("lat_rad", "lon_rad", "h_m")), strict=True)
    )
    levels = sbas.protection_levels(log, navigation, solved["time_ns"].to_numpy(), **place, mode="pa")
    assert (solved["n_sv"].to_numpy() == levels.n_sv).all()
    # The same satellites from the same place; the receiver's clock moves them by up to 0.1 mm, directions by 1e-11.
    assert np.abs(solved["hpl_m"].to_numpy() / levels.hpl_m - 1).max() < 1e-6
    assert np.abs(solved["vpl_m"].to_numpy() / levels.vpl_m - 1).max() < 1e-6
    # A covariance is that of its levels: VPL = 5.33 sigma_U.
    assert np.abs(solved["vpl_m"].to_numpy() / np.sqrt(solved["cov_uu_m2"].to_numpy()) / 5.33 - 1).max() < 1e-12


def test_a_satellite_that_is_not_measured_is_in_neither(msas: Recording, shared_data: Path, tmp_path: Path) -> None:
    _, navigation, log = msas
    t = int(seconds(581_000, 581_001)[0])
    made = pseudoranges(log, shared_data / "sbas" / "gps_2025046_17h_rinex3.nav", t, MSAS_USER, MSAS_ECEF, 0.0)
    lost = max(made)
    (tmp_path / "less.rnx").write_text(rinex({t: {prn: p for prn, p in made.items() if prn != lost}}))
    solved = sbas.solve(gnss.read_observations(tmp_path / "less.rnx"), navigation, log, mode="pa", truth_ecef_m=MSAS_ECEF)
    whole = sbas.protection_levels(log, navigation, [t], **MSAS_USER, mode="pa")
    assert set(solved.satellites["prn"]) == set(made) - {lost}
    assert solved.epochs["vpl_m"][0] > whole.vpl_m[0]
    assert abs(solved.epochs["nse_u_m"][0]) < 5e-3


def peer(folder: Path, prn: int, data: Path) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Seconds and positions of rnx2rtkp with the corrections of one satellite: its weights are others, its models the same."""
    program = shutil.which("rnx2rtkp")
    if program is None:
        pytest.skip("rnx2rtkp (Debian package rtklib) is not installed")
    options = {"pos1-posmode": "single", "pos1-frequency": "l1", "pos1-elmask": 5, "pos1-navsys": 1, "out-solformat": "xyz"}
    options |= {"pos1-ionoopt": "sbas", "pos1-tropopt": "sbas", "pos1-sateph": "brdc+sbas", "misc-sbasatsel": prn}
    (folder / "conf").write_text("".join(f"{name}={value}\n" for name, value in options.items()))
    (folder / "obs").write_bytes(gzip.decompress((data / "EGNS2990.12O.gz").read_bytes()))
    (folder / "log.ems").write_bytes((data / "egnos_2012299.ems").read_bytes())
    files = [str(folder / "obs"), str(data / "gps_2012299_12h.12N"), str(folder / "log.ems")]
    subprocess.run([program, "-k", str(folder / "conf"), "-o", str(folder / "pos"), *files], check=True, capture_output=True)
    rows = [line.split() for line in (folder / "pos").read_text().splitlines() if not line.startswith("%")]
    times = [datetime.strptime(" ".join(row[:2]), "%Y/%m/%d %H:%M:%S.%f").replace(tzinfo=UTC) for row in rows]
    return np.array([round((t - EPOCH).total_seconds()) for t in times]), np.array([[float(v) for v in row[2:5]] for row in rows])


def test_real_egnos_beside_an_independent_engine(egnos: Recording, shared_data: Path, tmp_path: Path) -> None:
    times, theirs = peer(tmp_path, 120, shared_data / "sbas" / "more")
    observations, navigation, log = egnos
    solved = sbas.solve(observations, navigation, log.of(120), smoothing_s=None).epochs.filter(pl.col("mode") == "pa")
    _, a, b = np.intersect1d(solved["time_ns"].to_numpy() // 10**9, times, return_indices=True)
    assert a.size > 400
    difference = positions(solved)[a] - theirs[b]
    # Other weights, each with a noise of a metre or so of a receiver of 2012 unsmoothed: their mean over 20 minutes is common to a
    # fraction of it. Without corrections the mean is 11 m away.
    assert np.linalg.norm(difference.mean(axis=0)) < 0.4
    assert float(np.median(np.linalg.norm(difference, axis=1))) < 0.8


def test_real_egnos_is_smoothed_and_stays_far_inside_its_levels(egnos: Recording) -> None:
    observations, navigation, log = egnos
    rough, smooth = (sbas.solve(observations, navigation, log.of(120), smoothing_s=w) for w in (None, 100.0))
    solved = [p.epochs.filter(pl.col("mode") == "pa") for p in (rough, smooth)]
    assert solved[0].height == solved[1].height > 500
    spread = [positions(s).std(axis=0) for s in solved]
    # White noise through 100 s at 3 s leaves sqrt(0.03 / 1.97) = 0.12 of itself; multipath of minutes stays. Half is required.
    assert (spread[1] < 0.5 * spread[0]).all()
    # No truth is known: the median of the solutions stands for it, which cannot see what all have in common.
    middle = np.median(positions(solved[1]), axis=0)
    known = sbas.solve(observations, navigation, log.of(120), truth_ecef_m=middle).epochs.filter(pl.col("mode") == "pa")
    assert (np.hypot(known["nse_e_m"], known["nse_n_m"]) < known["hpl_m"]).all()
    assert (known["nse_u_m"].abs() < known["vpl_m"]).all()
    assert smooth.epochs["status"].is_in(["ok", "not_available"]).all()
    assert rough.unused["not in the PRN mask"] > 0
    assert rough.smoothed_share is None
    # All but the first code of each arc.
    assert smooth.smoothed_share is not None
    assert 0.95 < smooth.smoothed_share < 1.0


def test_en_route_without_a_grid_the_broadcast_ionosphere_serves(shared_data: Path) -> None:
    folder = shared_data / "sbas" / "more"
    log = sbas.read(folder / "prn137_2025046_17h.ems.gz")
    guam: dict[str, Any] = geodetic(-5068980.1532, 3576315.4078, 1477493.2509)
    with_model, without = folder / "gps_2025046_17h.25N", shared_data / "sbas" / "gps_2025046_17h_rinex3.nav"
    instant = seconds(581_000, 581_001)
    seen = sbas.satellites(log, with_model, instant, **guam, mode="npa")
    alone = seen.from_grid == False  # noqa: E712
    assert alone.any()
    # DO-229 J.2.3 at 5 degrees of geomagnetic latitude: tau is 9 m, a fifth of the delay where that is more.
    obliquity = 1 / np.sqrt(1 - (6378136.3 / 6728136.3 * np.cos(seen.el_rad)) ** 2)
    expected = obliquity * np.maximum(seen.iono_vertical_m / 5, 9.0)
    assert np.abs(seen.sigma_uire_m[alone] / expected[alone] - 1).max() < 1e-9
    assert set(seen.prn[seen.from_grid]) == set(sbas.satellites(log, without, instant, **guam, mode="npa").prn)
    # Approaches never lean on it.
    assert sbas.satellites(log, with_model, instant, **guam, mode="pa").from_grid.all()
    observations = gnss.read_observations(folder / "PGUM0460.25O.gz")
    solved = sbas.solve(observations, gnss.read_navigation(with_model), log, mode="npa")
    assert (solved.epochs["mode"] == "npa").sum() > 3000
    assert solved.epochs["vpl_m"].is_null().all()
    assert "Klobuchar" in solved.models["ionosphere"]


def test_message_0_obeyed_leaves_not_one_position(shared_data: Path) -> None:
    folder = shared_data / "sbas" / "more"
    log = sbas.read(folder / "prn122_2025046_17h.ems.gz")
    observations = gnss.read_observations(folder / "YPDN0460.25O.gz")
    solved = sbas.solve(observations, folder / "gps_2025046_17h.25N", log)
    assert (solved.epochs["status"] == "not_available").all()
    assert solved.epochs["est_lat_rad"].is_null().all()
    assert solved.epochs["reason"].str.contains("do not use").any()
    tested = sbas.solve(observations, folder / "gps_2025046_17h.25N", log, test_signal=True)
    assert tested.test_signal
    assert set(tested.epochs["status"]) == {"degraded", "not_available"}


def test_ranges_of_geostationary_satellites_are_counted_not_used(egnos: Recording, tmp_path: Path) -> None:
    observations, navigation, log = egnos
    first = int(log.of(120).time_ns[0]) + 600_000_000_000
    text = rinex({first: {3: 2.0e7}}).replace("G03", "S20").replace("G    1 C1C", "S    1 C1C")
    (tmp_path / "geo.rnx").write_text(text)
    solved = sbas.solve(gnss.read_observations(tmp_path / "geo.rnx"), navigation, log.of(120))
    assert solved.epochs["status"].to_list() == ["not_available"]
    # Every message 9 of every recorded service carries URA index 15.
    assert [why for why in solved.unused if "URA index 15" in why]
    assert observations.n_epochs == 1165


def test_wrong_settings_are_named(msas: Recording) -> None:
    observations, navigation, log = msas
    wrong: list[dict[str, Any]] = [
        {"mask_rad": float("nan")},
        {"noise_m": -1.0},
        {"smoothing_s": 0.0},
        {"false_alarm": 1.0},
        {"mode": "cat-i"},
    ]
    for settings in wrong:
        with pytest.raises(InputError, match=next(iter(settings))):
            sbas.solve(observations, navigation, log, **settings)
    with pytest.raises(InputError, match="PRNs"):
        sbas.solve(observations, navigation, replace(log, prn=np.arange(log.prn.size, dtype=np.uint8)))


def test_columns_are_in_the_glossary(msas: Recording) -> None:
    observations, navigation, log = msas
    glossary = (Path(__file__).parents[1] / "docs" / "notation.md").read_text(encoding="utf-8")
    columns = sbas.solve(observations, navigation, log, truth_ecef_m=MSAS_ECEF).epochs.columns
    assert [c for c in columns if f"`{c}`" not in glossary] == []
