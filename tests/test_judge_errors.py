"""The errors of an epoch along the axes of its path come from the core alone."""

from __future__ import annotations

import ast
from pathlib import Path

import numpy as np
import polars as pl
import pytest

import navbound
from navbound import anp, tse
from navbound.methods import with_errors
from navbound.run import judge

MATHEMATICS = {"sqrt", "sin", "cos", "tan", "hypot", "linalg", "exp", "expm1", "log", "log1p", "arctan2", "atan2", "arcsin", "arccos"}
SHOWING = ("run", "report", "cli", "records", "table")
"""Parts of the package that call, keep and show what subjects work out."""


def mathematics(source: str) -> list[str]:
    """Names of mathematical functions that a source text uses."""
    return [node.attr for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Attribute) and node.attr in MATHEMATICS]


def test_the_search_sees_mathematics() -> None:
    assert mathematics("x = np.sqrt(a**2) + pl.col('c').cos()") == ["sqrt", "cos"]


@pytest.mark.parametrize("part", SHOWING)
def test_what_calls_and_shows_holds_no_mathematics(part: str) -> None:
    files = list((Path(navbound.__file__).parent / part).rglob("*.py"))
    assert files
    assert {str(path): names for path in files if (names := mathematics(path.read_text(encoding="utf-8")))} == {}


def test_the_job_of_judging_holds_no_powers() -> None:
    tree = ast.parse(Path(judge.__file__).read_text(encoding="utf-8"))
    assert not [node for node in ast.walk(tree) if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow)]


DECISIONS = {"bounds", "bounds_of", "with_errors", "exceedance_risk", "probabilities", "tightest", "overridden", "step", "run", "tracks"}
"""Names by which parts of a step are called one by one."""


def test_the_job_of_judging_decides_nothing_of_an_epoch() -> None:
    tree = ast.parse(Path(judge.__file__).read_text(encoding="utf-8"))
    called = {node.func for node in ast.walk(tree) if isinstance(node, ast.Call)}
    names = {f.attr if isinstance(f, ast.Attribute) else f.id for f in called if isinstance(f, ast.Attribute | ast.Name)}
    assert names & DECISIONS == set()
    assert "Judges" in names


def along_only(n: int) -> pl.DataFrame:
    """Covariances of errors along the course alone, at random courses and sizes; seed 1."""
    random = np.random.default_rng(1)
    course, sigma = random.uniform(0.0, 2 * np.pi, n), random.uniform(0.1, 100.0, n)
    east, north = sigma * np.sin(course), sigma * np.cos(course)
    return pl.DataFrame({"course_rad": course, "cov_ee_m2": east * east, "cov_en_m2": east * north, "cov_nn_m2": north * north})


def test_an_error_along_the_course_alone_has_a_deviation_across_of_zero_at_every_epoch() -> None:
    table = along_only(100_000)
    sigma = with_errors(table)["sigma_cross_m"]
    assert sigma.null_count() == 0
    # Rounding of three products leaves 1e-15 of the variance, whose root is 3e-8 of the deviation along.
    along = (table["cov_ee_m2"] + table["cov_nn_m2"]).sqrt()
    assert (sigma / along).to_numpy().max() < 1e-7
    covariance = np.stack([table["cov_ee_m2"], table["cov_en_m2"], table["cov_en_m2"], table["cov_nn_m2"]], axis=-1).reshape(-1, 2, 2)
    core = tse.project(np.zeros((table.height, 2)), covariance, table["course_rad"].to_numpy()).sigma_m
    assert np.array_equal(sigma.to_numpy(), core)


def test_errors_and_their_absence() -> None:
    table = pl.DataFrame(
        {
            "course_rad": [np.pi / 2, np.pi / 2, None],
            "path_angle_rad": [0.1, 0.1, 0.1],
            "fte_m": [10.0, None, 10.0],
            "fte_v_m": [-2.0, -2.0, -2.0],
            "nse_e_m": [3.0, 3.0, 3.0],
            "nse_n_m": [4.0, 4.0, 4.0],
            "nse_u_m": [12.0, None, 12.0],
        }
    )
    errors = with_errors(table)
    # Due east: along is east, right of it is south.
    assert errors["nse_along_m"].to_list()[:2] == pytest.approx([3.0, 3.0])
    assert errors["nse_cross_m"].to_list()[:2] == pytest.approx([-4.0, -4.0])
    assert errors["nse_h_m"].to_list() == pytest.approx([5.0] * 3)
    assert (errors["nse_3d_m"][0], errors["nse_3d_m"][1]) == (pytest.approx(13.0), None)
    assert (errors["tse_m"][0], errors["tse_m"][1], errors["tse_m"][2]) == (pytest.approx(6.0), None, None)
    # 10 m above less what 3 m along a path of 0.1 rad are worth: tan(0.1) = 0.1003346720854505.
    assert errors["tse_v_m"].to_list() == [pytest.approx(-2.0 + 12.0 - 0.1003346720854505 * 3.0), None, None]
    assert "sigma_cross_m" not in errors.columns


@pytest.mark.parametrize("risk", [0.05, 1e-5, 1e-300])
def test_a_deviation_of_zero_leaves_the_error_itself(risk: float) -> None:
    """What a zero across the path flows on to: the bound is |fte|, the risk is a step at the limit."""
    assert tse.exact(-30.0, 0.0, risk) == 30.0
    assert tse.ltem(30.0, 0.0, risk) == 30.0
    assert tse.exceedance_risk([30.0, 29.0, 31.0], 0.0, 30.0).tolist()[1:] == [0.0, 1.0]
    assert anp.circle(np.zeros((2, 2)), risk) == 0.0
