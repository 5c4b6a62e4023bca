"""Positions with a service's corrections: back to a chosen place, beside an independent engine on real EGNOS, and one with their levels."""

from __future__ import annotations

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
from test_sbas import MSAS_USER, YPDN, seconds

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
    found = sbas.solve(gnss.read_observations(tmp_path / "made.rnx"), navigation, log, mode="pa", truth_ecef_m=MSAS_ECEF)
    assert found.epochs["status"].to_list() == ["ok"] * len(instants)
    error = found.epochs.select("nse_e_m", "nse_n_m", "nse_u_m").to_numpy()
    # Ranges are written to the millimetre; dilutions are below 3.
    assert np.abs(error).max() < 3e-3
    assert found.satellites["residual_m"].abs().max() < 2e-3  # type: ignore[operator]


def test_levels_of_a_solution_are_those_of_its_place(msas: Recording) -> None:
    observations, navigation, log = msas
    found = sbas.solve(observations, navigation, log)
    assert found.epochs["mode"].to_list() == [m or None for m in sbas.protection_levels(log, navigation, seconds(), **MSAS_USER).mode]
    solved = found.epochs.filter(pl.col("mode") == "pa")
    place = dict(zip(("lat_rad", "lon_rad", "h_m"), (solved[f"est_{n}"].to_numpy() for n in ("lat_rad", "lon_rad", "h_m")), strict=True))
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
    found = sbas.solve(gnss.read_observations(tmp_path / "less.rnx"), navigation, log, mode="pa", truth_ecef_m=MSAS_ECEF)
    whole = sbas.protection_levels(log, navigation, [t], **MSAS_USER, mode="pa")
    assert set(found.satellites["prn"]) == set(made) - {lost}
    assert found.epochs["vpl_m"][0] > whole.vpl_m[0]
    assert abs(found.epochs["nse_u_m"][0]) < 5e-3


def peer(folder: Path, prn: int, data: Path) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Seconds and positions of rnx2rtkp with the corrections of one satellite: its weights are others, its models the same."""
    program = shutil.which("rnx2rtkp")
    if program is None:
        pytest.skip("rnx2rtkp (Debian package rtklib) is not installed")
    options = {"pos1-posmode": "single", "pos1-frequency": "l1", "pos1-elmask": 5, "pos1-navsys": 1, "out-solformat": "xyz"}
    options |= {"pos1-ionoopt": "sbas", "pos1-tropopt": "sbas", "pos1-sateph": "brdc+sbas", "misc-sbasatsel": prn}
    (folder / "conf").write_text("".join(f"{name}={value}\n" for name, value in options.items()))
    import gzip  # noqa: PLC0415

    (folder / "obs").write_bytes(gzip.decompress((data / "EGNS2990.12O.gz").read_bytes()))
    (folder / "log.ems").write_bytes((data / "egnos_2012299.ems").read_bytes())
    files = [str(folder / "obs"), str(data / "gps_2012299_12h.12N"), str(folder / "log.ems")]
    subprocess.run([program, "-k", str(folder / "conf"), "-o", str(folder / "pos"), *files], check=True, capture_output=True)
    rows = [line.split() for line in (folder / "pos").read_text().splitlines() if not line.startswith("%")]
    times = [datetime.strptime(" ".join(row[:2]), "%Y/%m/%d %H:%M:%S.%f").replace(tzinfo=UTC) for row in rows]
    return np.array([round((t - EPOCH).total_seconds()) for t in times]), np.array([[float(v) for v in row[2:5]] for row in rows])
