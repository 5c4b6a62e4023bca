"""NUCp, the one category of a transponder of version 0: an accuracy and a containment radius at once."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import navbound
from test_verdict import table

N = 60
SIGMAS_OF_95 = math.sqrt(-2.0 * math.log(0.05))

# 95 % limit of the horizontal error and protection level of each category (DO-260, version 0; ICAO Doc 9871). [m]
LIMITS_M = {
    9: (3.0, 7.5),
    8: (10.0, 25.0),
    7: (92.6, 185.2),
    6: (185.2, 370.4),
    5: (463.0, 926.0),
    4: (926.0, 1852.0),
    3: (1852.0, 3704.0),
    2: (9260.0, 18520.0),
    1: (18520.0, 37040.0),
}


def run_of(tmp_path: Path, *, sigma_m: float | None = None, typed_m: float | None = None, **added: Any) -> Any:
    path = table(tmp_path / "a.csv", N, sigma_m=sigma_m, added={name: np.broadcast_to(value, N) for name, value in added.items()})
    return navbound.analyze(path, spec="RNP 1", sigma_m=typed_m)


@pytest.mark.parametrize("category", LIMITS_M)
def test_a_category_alone_is_an_accuracy_and_a_containment_radius(tmp_path: Path, category: int) -> None:
    """Of category 3 the limits are RNP 1 and twice RNP 1; an error is below them."""
    run = run_of(tmp_path, **{"NUCp" if category % 2 else "nuc_p": category})
    accuracy_m, radius_m = LIMITS_M[category]
    assert run.summary.covariance.id == "nuc_p"
    sigma_m = run.epochs["cov_ee_m2"].sqrt().to_numpy()
    assert sigma_m == pytest.approx(accuracy_m / SIGMAS_OF_95, rel=1e-10)
    assert run.epochs["stated_rc_m"].to_numpy() == pytest.approx(radius_m, rel=1e-15)
    assert run.summary.verdict.assumed[0] == "sigma_coded"
    assert run.summary.verdict.n_stated_uncontained == (N if category < 3 else 0)
    assert (run.summary.verdict.id == "inside") == (category >= 3)


def test_category_0_is_no_integrity(tmp_path: Path) -> None:
    run = run_of(tmp_path, nucp=[8] * (N // 2) + [0] * (N // 2))
    assert run.epochs["reason_id"].to_list() == [None] * (N // 2) + ["reported"] * (N // 2)


@pytest.mark.parametrize("beside", [{"sigma_m": 3.0}, {"typed_m": 3.0}, {"nac_p": 10, "nic": 8}, {"nic": 8}], ids=str)
def test_a_category_beside_other_accuracies_is_no_silence(tmp_path: Path, beside: dict[str, Any]) -> None:
    """NUCp 2 is a radius of 10 NM, beyond twice RNP 1; NUCp 7 one of 0.1 NM."""
    wide = run_of(tmp_path, nucp=2, **beside).summary.verdict
    assert (wide.id, wide.n_stated_uncontained) == ("not_shown", N)
    narrow = run_of(tmp_path, nucp=9, **beside).summary.verdict
    assert (narrow.id, narrow.n_stated_uncontained) == ("inside", 0)


def test_an_accuracy_below_the_category_is_worse_than_stated(tmp_path: Path) -> None:
    """NUCp 7 says 10 m at least; twice the distance root mean square of 3 m is 8.5 m. Beside NACp it is the code of a later version."""
    assert run_of(tmp_path, nucp=7, sigma_m=3.0).summary.verdict.n_stated_worse == N
    assert run_of(tmp_path, nucp=8, sigma_m=3.0).summary.verdict.n_stated_worse == 0
    assert run_of(tmp_path, nucp=7, nac_p=11).summary.verdict.n_stated_worse == 0


def test_of_two_categories_the_smaller_counts(tmp_path: Path) -> None:
    run = run_of(tmp_path, nucp=8, NUC_P=5)
    assert set(run.epochs["stated_rc_m"]) == {926.0}
    assert run.summary.verdict.unread == []


def test_a_category_that_is_none_is_counted(tmp_path: Path) -> None:
    summary = run_of(tmp_path, nucp=[8] * (N - 3) + [12] * 3).summary
    assert [(each.reason, each.count) for each in summary.rejected if "nucp" in each.reason] == [
        ("nucp: outside [0, 9]; row used without it", 3)
    ]


def test_pieces_carry_a_category_on(tmp_path: Path) -> None:
    path = table(tmp_path / "a.csv", N, sigma_m=None, added={"nucp": [7, *[None] * (N - 1)]})
    whole, pieces = (navbound.analyze(path, piece_rows=rows).summary.verdict for rows in (None, 7))
    assert whole == pieces
    assert whole.n_judged == N
