"""What a user meets who tries the tool on a public recording: refusals that state what is missing, columns that are what they look like."""

from __future__ import annotations

import datetime as dt
from pathlib import Path
from typing import TYPE_CHECKING

import polars as pl
import pytest

import navbound
from navbound import FormatError, InputError, write
from navbound.read.checks.statements import other_place
from test_write import table as solution

if TYPE_CHECKING:
    from navbound.run.directory import Run


def test_a_solution_file_without_a_vertical_covariance_is_refused_by_what_it_lacks(tmp_path: Path) -> None:
    vertical = [pl.lit(None, pl.Float64).alias(name) for name in ("cov_eu_m2", "cov_nu_m2", "cov_uu_m2")]
    with pytest.raises(
        InputError, match=r"a table of 2 epochs, 2 without a vertical covariance \(cov_eu_m2, cov_nu_m2, cov_uu_m2\) is not"
    ):
        write.rtklib(solution(2).with_columns(vertical), tmp_path / "a.pos")
    with pytest.raises(
        InputError, match=r"a table of 1 epoch, 1 without a height \(est_h_m\) is .* \.geojson and \.kml need no covariance"
    ):
        write.rtklib(solution(1).drop("est_h_m"), tmp_path / "a.pos")


def _way(n: int = 60, **columns: object) -> pl.DataFrame:
    """Positions of n seconds on end, some 60 m apart, and further columns."""
    at = pl.int_range(n, eager=True)
    start = dt.datetime(2024, 5, 13, 12, 30)
    times = [f"{start + dt.timedelta(seconds=k):%Y-%m-%dT%H:%M:%SZ}" for k in range(n)]
    plain: dict[str, object] = {"time": times, "lat": 48.0 + at * 5e-4, "lon": 11.0 + at * 3e-4}
    return pl.DataFrame({name: values for name, values in (plain | columns).items() if values is not None})


def _analyzed(tmp_path: Path, table: pl.DataFrame, name: str = "a.csv", **settings: object) -> Run:
    table.write_csv(tmp_path / name)
    return navbound.analyze(tmp_path / name, **{"sigma_m": 5.0, "out": tmp_path / "run"} | settings)


def test_resets_of_a_position_are_no_other_place(tmp_path: Path) -> None:
    # `vehicle_global_position` of PX4 counts the resets of its position, and has the step of the last one in degrees.
    later = [0] * 30 + [3] * 30
    resets = {"lat_lon_reset_counter": later, "delta_lat_lon[0]": [k * 1e-2 for k in later], "delta_lat_lon[1]": [k * -2e-2 for k in later]}
    run = _analyzed(tmp_path, _way(**resets, lat_dot=[k * 1e-2 for k in later]))
    assert run.summary.verdict.id == "inside"
    assert "another position" not in run.summary.verdict.words
    assert not any(other_place(name) for name in (*resets, "lat_rate", "lon_variance"))
    assert other_place("lat2") is not None


@pytest.mark.parametrize("name", ["Altitude (Ellipsoid)", "Alt (HAE)", "height-above-ellipsoid", "altitude_ellipsoid", "alt_ellipsoid_m"])
def test_a_height_above_the_ellipsoid_beside_an_altitude_is_the_height(tmp_path: Path, name: str) -> None:
    run = _analyzed(tmp_path, _way(**{"Altitude (ft)": [1000.0] * 60, name: [351.5] * 60}))
    assert run.epochs["est_h_m"].to_list() == [351.5] * 60
    assert run.epochs["altitude_m"].to_list() == pytest.approx([304.8] * 60)


def test_of_two_heights_of_one_kind_nothing_is_guessed(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"“Altitude” and “altitude \(m\)” are one name in another writing"):
        _analyzed(tmp_path, _way(**{"Altitude": [1000.0] * 60, "altitude (m)": [304.8] * 60}))
    # An autopilot writes it in metres in one table and in millimetres in another.
    assert "est_h_m" not in _analyzed(tmp_path, _way(alt_ellipsoid=[351_500] * 60)).epochs.columns
