"""What a user meets who tries the tool on a public recording: refusals that state what is missing, columns that are what they look like."""

from __future__ import annotations

from pathlib import Path

import polars as pl
import pytest

from navbound import InputError, write
from test_write import table as solution


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
