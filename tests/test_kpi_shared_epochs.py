"""No recorded row with a known error is left out of the count of misleading information, however its time lies on the grid."""

from __future__ import annotations

import polars as pl
import pytest

from navbound import InputError, kpi

SECOND = 1_000_000_000


def series(times_s: list[float], error_u_m: list[float], vpl_m: float | None = 20.0) -> pl.DataFrame:
    n = len(times_s)
    return pl.DataFrame(
        {
            "time_ns": [round(t * SECOND) for t in times_s],
            "nse_e_m": [1.0] * n,
            "nse_n_m": [1.0] * n,
            "nse_u_m": error_u_m,
            "hpl_m": [15.0] * n,
            "vpl_m": [vpl_m] * n,
        }
    ).sort("time_ns")


GOOD_S = [float(k) for k in range(60)]


def test_a_misleading_row_off_the_grid_is_counted() -> None:
    table = series([*GOOD_S, *(k + 0.4 for k in range(10, 20))], [1.0] * 60 + [500.0] * 10)
    result = kpi.evaluate(table, "LPV-200", period_s=1.0)
    assert result.n_expected == 60
    assert result.n_repeated == 10
    assert result.levels[0].n_hazard_epochs == 10
    assert any("10 rows share an epoch" in note for note in result.notes)


@pytest.mark.parametrize("offset", range(5))
def test_a_longer_period_hides_nothing(offset: int) -> None:
    table = series(GOOD_S, [500.0 if k % 5 == offset else 1.0 for k in range(60)])
    result = kpi.evaluate(table, "LPV-200", period_s=5.0)
    assert result.levels[0].n_hazard_epochs == 12, "each bad second in an epoch of its own"


def test_a_hazard_counts_before_a_larger_ratio() -> None:
    """25 m above a level of 5 m misleads but is within the limit of 35 m; 36 m above a level of 34 m is a hazard."""
    table = series([0.0, 1.0, 1.1, 2.0], [1.0, 25.0, 36.0, 1.0]).with_columns(vpl_m=pl.Series([5.0, 5.0, 34.0, 5.0]))
    assert kpi.evaluate(table, "LPV-200", period_s=1.0).levels[0].n_hazard_epochs == 1


def test_percentiles_are_those_of_the_rows_that_count() -> None:
    table = series([*GOOD_S, *(k + 0.4 for k in range(60))], [1.0] * 60 + [10.0] * 60)
    error = kpi.evaluate(table, "LPV-200", period_s=1.0).axes[1].error_m
    assert error is not None
    assert error.p50 == 10.0


def test_a_table_that_goes_over_earlier_epochs_may_not_hide_misleading_information() -> None:
    good = series(GOOD_S, [1.0] * 60)
    campaign = kpi.Campaign("LPV-200", first=good)
    campaign.add(good)
    with pytest.raises(InputError, match="above the protection level"):
        campaign.add(series([59.0, 60.0], [500.0, 1.0]))
