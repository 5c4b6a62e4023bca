"""A fixed point as truth: Earth-fixed, or latitude, longitude and height."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import polars as pl
import pytest

import navbound
from navbound import gnss
from navbound.errors import InputError
from navbound.read.truth import truth_of

SEMI_MAJOR_M = 6378137.0
SEMI_MINOR_M = 6356752.3142
"""Of WGS-84 as NIMA TR8350.2 prints them, table 3.1 and 3.3; the last to 0.1 mm."""


@pytest.mark.parametrize(
    ("point", "expected_m"),
    [
        ("0,0,0", (SEMI_MAJOR_M, 0.0, 0.0)),
        ("0, 90, 100", (0.0, SEMI_MAJOR_M + 100.0, 0.0)),
        ("0,-180,-50", (-SEMI_MAJOR_M + 50.0, 0.0, 0.0)),
        ("90,17,8000", (0.0, 0.0, SEMI_MINOR_M + 8000.0)),
        ("-90,0,0", (0.0, 0.0, -SEMI_MINOR_M)),
    ],
)
def test_points_of_axis_and_equator(point: str, expected_m: tuple[float, float, float]) -> None:
    ecef_m = truth_of(point, 0.01).ecef_m
    assert ecef_m is not None
    # Half a digit of the printed semi-minor axis.
    np.testing.assert_allclose(ecef_m, expected_m, rtol=0.0, atol=5e-5)


@pytest.mark.parametrize("place", [(48.99, 2.57, 120.0), (-33.946, 151.177, 6.0), (71.3, -156.8, 9000.0)])
def test_the_core_reads_the_same_place_back(place: tuple[float, float, float]) -> None:
    ecef_m = truth_of(",".join(map(str, place)), 0.01).ecef_m
    assert ecef_m is not None
    lat_rad, lon_rad, h_m = gnss.geodetic(ecef_m)
    # 1e-11 degrees are a micrometre; the heights are sums of 6e6 m in doubles.
    assert math.degrees(lat_rad) == pytest.approx(place[0], abs=1e-11)
    assert math.degrees(lon_rad) == pytest.approx(place[1], abs=1e-11)
    assert h_m == pytest.approx(place[2], abs=1e-8)


@pytest.mark.parametrize(
    "point", ["90.1,2.57,120", "-91,0,0", "48.99,181,120", "48.99,-180.5,0", "48.99,2.57,-1001", "48.99,2.57,100001", "1,2", "1,2,3,4"]
)
def test_what_is_no_place_is_refused_with_what_is_allowed(point: str) -> None:
    with pytest.raises(InputError, match=r"^truth = .* is not accepted; expected LAT,LON,H .*, X,Y,Z .*, or a file$"):
        truth_of(point, 0.01)


def test_a_standing_receiver_has_the_errors_from_the_point(tmp_path: Path) -> None:
    table = tmp_path / "standing.csv"
    rows = [f"{1316000000 + k},48.99,2.57,{120.0 + k % 3},2.0" for k in range(60)]
    table.write_text("\n".join(["time_s,lat_deg,lon_deg,h_m,sigma_m", *rows]) + "\n", encoding="utf-8")
    run = navbound.analyze(table, truth="48.99,2.57,121", spec="RNP 0.3", columns={"time": "time_s:gps_s"}, sigma_m=2.0)
    epochs = run.epochs
    assert isinstance(epochs, pl.DataFrame)
    # True minus estimated.
    np.testing.assert_allclose(epochs["nse_u_m"].to_numpy(), [1.0 - k % 3 for k in range(60)], rtol=0.0, atol=1e-6)
    np.testing.assert_allclose(epochs["nse_n_m"].to_numpy(), 0.0, rtol=0.0, atol=1e-6)
    words = " ".join(run.summary.assumptions)
    assert "Truth: the fixed point latitude 48.99 deg, longitude 2.57 deg, height 121 m above the ellipsoid (WGS-84)." in words
