"""The published comparison, done again: our rows stand where section 8.3 of the specification has them, and the verdicts follow."""

from __future__ import annotations

import io
from functools import cache

import pytest
from rich.console import Console

from navbound import InputError
from navbound.studies.tse_coverage import study

# Section 8.3: exact, SQSM, CTEM, LTEM at both levels [%], computed independently with the same constellation.
EXPECTED = {
    "fte = 0.0289 sigma": ((95.000, 97.747, 97.692, 95.320), (99.999000, 99.999823, 99.999819, 99.999088)),
    "fte = 0": ((95.000, 97.582, 97.582, 95.000), (99.999000, 99.999799, 99.999799, 99.998966)),
    "fte normal, 2 m": ((95.000, 98.231, 98.007, 96.313), (99.999000, 99.999868, 99.999851, 99.999324)),
    "fte normal, 10 m": ((95.000, 98.644, 98.048, 97.187), (99.999000, 99.999892, 99.999827, 99.999447)),
    "fte normal, 50 m": ((95.000, 98.761, 97.749, 97.435), (99.999000, 99.999898, 99.999695, 99.999476)),
}


@cache
def result() -> study.Study:
    return study.run()


@pytest.mark.parametrize("assumption", EXPECTED)
def test_rows_stand_where_they_were_computed_before(assumption: str) -> None:
    row = next(r for r in result().rows if r.assumption == assumption)
    accuracy, integrity = EXPECTED[assumption]
    for k, method in enumerate(study.METHODS):
        # 60 s against 120 s steps differ by 0.004 and 1e-6 percentage points; the specification allows 0.01 and 5e-6.
        assert 100 * getattr(row.accuracy, method) == pytest.approx(accuracy[k], abs=0.01)
        assert 100 * getattr(row.integrity, method) == pytest.approx(integrity[k], abs=5e-6)


def test_the_sky_is_the_one_described() -> None:
    outcome = result()
    assert (outcome.n_sv_min, outcome.n_sv_max) == (6, 11)
    # Means as printed in the specification, to the last digit printed and the choice of the first epoch.
    assert outcome.n_sv_mean == pytest.approx(7.6, abs=0.05)
    assert outcome.sigma_cross_m_mean == pytest.approx(8.51, abs=0.02)
    assert outcome.sigma_major_m_mean == pytest.approx(10.30, abs=0.02)
    assert outcome.ratio_mean == pytest.approx(1.215, abs=0.005)


def test_the_verdicts_are_those_of_the_specification() -> None:
    verdicts = {(e.method, e.level): e.verdict for e in result().entries}
    assert {k for k, v in verdicts.items() if v == "not reproducible"} == {
        ("ctem", "accuracy"),
        ("sqsm", "integrity"),
        ("ctem", "integrity"),
    }
    assert len(verdicts) == 8


def test_the_published_table_breaks_the_coverage_inequality() -> None:
    """SQSM minus CTEM may not exceed LTEM minus exact: it does in the published accuracy column and in none of ours."""
    for row in result().rows:
        holds = row.accuracy.sqsm - row.accuracy.ctem <= row.accuracy.ltem - row.accuracy.exact + 1e-12
        # With the factor 1.96 in place of 1.95996 ours moves by 4e-6.
        assert holds == (row.origin != "published") or row.assumption == "fte = 0"


def test_repeated_sampling_is_another_coverage() -> None:
    """Section 8.4: 100 % up to K, 97.7 % at 2, 95.6 % at 2.2, 95.0 % from 3 deviations."""
    for deviation, percent in [(0.0, 100.0), (1.9, 100.0), (2.0, 97.7), (2.2, 95.6), (3.0, 95.0), (6.0, 95.0)]:
        assert 100 * study.repeated_coverage(deviation) == pytest.approx(percent, abs=0.06)


def test_the_drawn_row_agrees_within_four_standard_errors() -> None:
    n = 200_000
    drawn = next(r for r in study.run(step_s=600, monte_carlo=n, seed=5).rows if r.origin == "monte carlo")
    exact = next(r for r in study.run(step_s=600).rows if r.assumption == "fte = 0.0289 sigma")
    assert drawn.n_samples == n
    for method in study.METHODS:
        p = getattr(exact.accuracy, method)
        assert abs(getattr(drawn.accuracy, method) - p) <= 4 * (p * (1 - p) / n) ** 0.5
        # About two exceedances are expected; seven or more have a chance below 0.5 %.
        assert n * (1 - getattr(drawn.integrity, method)) < 7


def test_wrong_settings_are_refused() -> None:
    with pytest.raises(InputError, match="step_s"):
        study.run(step_s=float("nan"))
    with pytest.raises(InputError, match="monte_carlo"):
        study.run(monte_carlo=-1)


def test_it_renders_and_survives_json() -> None:
    console = Console(width=200, record=True, file=io.StringIO())
    console.print(result().table())
    text = console.export_text()
    assert "97.747" in text
    assert "not reproducible" in text
    assert study.Study.model_validate_json(result().model_dump_json()) == result()
