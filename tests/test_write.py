"""The epoch table as an RTKLIB solution file, and back through the reader."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

from navbound import InputError, write
from navbound.read import read

NS = 1_000_000_000
START_NS = (2270 * 604_800 + 194_670) * NS
"""2023-07-11 06:04:30 GPST (RTKLIB's own sample file)."""


def table(n: int = 50, **columns: Any) -> pl.DataFrame:
    random = np.random.default_rng(20230711)
    root = random.normal(size=(n, 3, 3)) * [2.0, 3.0, 5.0]
    cov = root @ root.transpose(0, 2, 1)
    values = {
        "track": ["rover"] * n,
        "time_ns": START_NS + np.arange(n, dtype=np.int64) * 200_000_000,
        "est_lat_rad": np.radians(random.uniform(-89, 89, n)),
        "est_lon_rad": np.radians(random.uniform(-180, 180, n)),
        "est_h_m": random.uniform(-100, 12_000, n),
        "n_sv": random.integers(4, 40, n),
        **{f"cov_{'enu'[i]}{'enu'[j]}_m2": cov[:, i, j] for i in range(3) for j in range(i, 3)},
    }
    return pl.DataFrame(values | columns)


def test_a_table_comes_back_from_its_file(tmp_path: Path) -> None:
    epochs = table()
    written = write.rtklib(epochs, tmp_path / "rover.pos")
    assert (written.n_rows, written.n_left_out) == (50, 0)
    back = read(tmp_path / "rover.pos")
    assert back.rejected == []
    assert back.epochs["time_ns"].to_list() == epochs["time_ns"].to_list()
    assert back.epochs["n_sv"].to_list() == epochs["n_sv"].to_list()
    # Nine decimals of a degree; four of a metre.
    for column, tolerance in (("est_lat_rad", np.radians(0.6e-9)), ("est_lon_rad", np.radians(0.6e-9)), ("est_h_m", 0.6e-4)):
        np.testing.assert_allclose(back.epochs[column].to_numpy(), epochs[column].to_numpy(), rtol=0, atol=tolerance)
    for column in ("cov_ee_m2", "cov_en_m2", "cov_nn_m2", "cov_eu_m2", "cov_nu_m2", "cov_uu_m2"):
        original = epochs[column].to_numpy()
        # A root r is rounded to 5e-5, its square so to 2 r times that.
        assert (np.abs(back.epochs[column].to_numpy() - original) <= 1.1e-4 * np.sqrt(np.abs(original)) + 1e-8).all(), column


def test_the_text_is_what_the_program_writes(tmp_path: Path) -> None:
    one = {
        "est_lat_rad": np.radians([35.5]), "est_lon_rad": np.radians([-139.25]), "est_h_m": [70.5], "n_sv": [9],
        "cov_ee_m2": [4.0], "cov_en_m2": [-0.25], "cov_nn_m2": [9.0], "cov_eu_m2": [1.0], "cov_nu_m2": [-4.0], "cov_uu_m2": [16.0],
    }  # fmt: skip
    write.rtklib(table(1, **one), tmp_path / "one.pos", quality=1)
    lines = (tmp_path / "one.pos").read_text(encoding="ascii").splitlines()
    assert lines[2].split()[:4] == ["%", "GPST", "latitude(deg)", "longitude(deg)"]
    # Order north, east, up, then north-east, east-up, up-north; roots with the sign of the covariance.
    assert lines[3] == (
        "2023/07/11 06:04:30.000   35.500000000 -139.250000000    70.5000   1   9"
        "   3.0000   2.0000   4.0000  -0.5000   1.0000  -2.0000   0.00    0.0"
    )


def test_times_keep_their_nanoseconds(tmp_path: Path) -> None:
    times = START_NS + np.array([1, 250_000, 1_500_000_000], dtype=np.int64)
    write.rtklib(table(3, time_ns=times), tmp_path / "fine.pos")
    assert read(tmp_path / "fine.pos").epochs["time_ns"].to_list() == times.tolist()


def test_epochs_without_position_or_covariance_are_left_out_and_counted(tmp_path: Path) -> None:
    epochs = table(4, est_h_m=[1.0, None, 2.0, 3.0], cov_uu_m2=[1.0, 1.0, None, float("nan")])
    written = write.rtklib(epochs, tmp_path / "holes.pos")
    assert (written.n_rows, written.n_left_out) == (1, 3)


def test_wrong_tables_are_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "no.pos"
    with pytest.raises(InputError, match="cov_uu_m2"):
        write.rtklib(table().drop("cov_uu_m2"), path)
    with pytest.raises(InputError, match="quality"):
        write.rtklib(table(), path, quality=9)
    with pytest.raises(InputError, match="track"):
        write.rtklib(table(2, track=["a", "b"]), path)
    with pytest.raises(InputError, match="track"):
        write.rtklib(table(), path, track="nobody")
    with pytest.raises(InputError, match="one epoch at least"):
        write.rtklib(table(1, est_h_m=[None]), path)
    with pytest.raises(InputError, match=r"covariance\[0\] = -1"):
        write.rtklib(table(1, cov_ee_m2=[-1.0]), path)
    assert not path.exists()
    assert write.rtklib(table(2, track=["a", "b"]), path, track="b").n_rows == 1
