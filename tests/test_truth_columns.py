"""What is declared of columns where the estimates and the truth are two files with names of their own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import navbound
from navbound import FormatError

N = 120
M_PER_FT = 0.3048
NORTH_M, UP_M = 3.0, 7.0
OWN = {"time": "t:gps_s", "est_lat_rad": "north:deg", "est_lon_rad": "east:deg", "est_h_m": "alt:ft"}
OF_TRUTH = {"truth_time": "clock:gps_ns", "truth_lat_rad": "ref_n:rad", "truth_lon_rad": "ref_e:rad", "truth_h_m": "ref_alt:m"}


def files(folder: Path, names: str, scale: tuple[float, float, float]) -> tuple[Path, Path]:
    """A flight along the equator, 60 m/s, its estimate 3 m to the north and 7 m above the truth."""
    t = 1.4e9 + np.arange(N)
    lon, h = np.degrees(60.0 * np.arange(N) / 6_378_137.0), 1000.0
    north = np.degrees(NORTH_M / 6_335_439.0)
    rows = [f"{t[k]:.0f},{north:.12f},{lon[k]:.12f},{(h + UP_M) / M_PER_FT:.6f}" for k in range(N)]
    (folder / "own.csv").write_text("t,north,east,alt\n" + "\n".join(rows) + "\n")
    time, angle, height = scale
    rows = [f"{t[k] * time:.0f},0.0,{lon[k] * angle:.15f},{h * height:.6f}" for k in range(N)]
    (folder / "truth.csv").write_text(names + "\n" + "\n".join(rows) + "\n")
    return folder / "own.csv", folder / "truth.csv"


def errors(own: Path, truth: Path, columns: dict[str, str]) -> tuple[float, ...]:
    epochs = navbound.analyze(own, truth=truth, columns=columns, sigma_m=3.0).epochs
    return tuple(float(np.median(epochs[name].to_numpy())) for name in ("nse_n_m", "nse_u_m"))


def test_the_columns_of_a_truth_file_are_declared_by_their_own_names(tmp_path: Path) -> None:
    own, truth = files(tmp_path, "clock,ref_n,ref_e,ref_alt", (1e9, np.pi / 180, 1.0))
    # A navigation error is truth less estimate. Half a millimetre: at 1000 m of height the arc of three metres is longer.
    np.testing.assert_allclose(errors(own, truth, OWN | OF_TRUTH), (-NORTH_M, -UP_M), rtol=0, atol=1e-3)


def test_a_unit_declared_of_the_estimates_counts_for_a_truth_that_lacks_other_columns(tmp_path: Path) -> None:
    own, truth = files(tmp_path, "t,lat,lon,alt", (1.0, 1.0, 1.0 / M_PER_FT))
    np.testing.assert_allclose(errors(own, truth, OWN), (-NORTH_M, -UP_M), rtol=0, atol=1e-3)


def test_a_column_declared_of_a_truth_file_is_refused_where_it_is_missing(tmp_path: Path) -> None:
    own, truth = files(tmp_path, "clock,ref_n,ref_e,ref_alt", (1e9, np.pi / 180, 1.0))
    with pytest.raises(FormatError, match=r"truth.csv:1: est_lat_rad: there is no column “no such”"):
        errors(own, truth, OWN | OF_TRUTH | {"truth_lat_rad": "no such:rad"})


def test_an_evaluation_reads_the_truth_by_the_same_names(tmp_path: Path) -> None:
    own, truth = files(tmp_path, "clock,ref_n,ref_e,ref_alt", (1e9, np.pi / 180, 1.0))
    lines = own.read_text().splitlines()
    own.write_text("\n".join([lines[0] + ",hpl_m,vpl_m", *(f"{line},20,30" for line in lines[1:])]) + "\n")
    run = navbound.evaluate(own, truth=truth, columns=OWN | OF_TRUTH, levels=("APV-I",))
    np.testing.assert_allclose(np.median(run.epochs["nse_u_m"].to_numpy()), -UP_M, rtol=0, atol=1e-3)
