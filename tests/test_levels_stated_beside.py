"""What a table of errors and levels states beside them counts, or is named in the verdict."""

from __future__ import annotations

from typing import TYPE_CHECKING

import polars as pl
import pytest

import navbound
from navbound import kpi

if TYPE_CHECKING:
    from pathlib import Path

    from navbound.records.run import Verdict

N = 300


def verdict(folder: Path, column: str, value: object) -> Verdict:
    """Of a table that is inside its limits (HPL 20 m, error 1 m) but for one more column."""
    rows = [f"time,hpl,vpl,hpe,vpe,{column}", *(f"{1_400_000_000 + k},20,25,1,1,{value}" for k in range(N))]
    (folder / "levels.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    return navbound.evaluate([folder / "levels.csv"], levels="APV-I").summary.verdict


@pytest.mark.parametrize(
    ("column", "value"),
    [("note", 1), ("epu", 19), ("sigma_n_m", 19), ("tse", 19), ("NumSat", 9), ("hdop", 99), ("mode", "pa"), ("faults", 0)],
)
def test_what_does_not_contradict_a_level_changes_nothing(column: str, value: object, tmp_path: Path) -> None:
    assert verdict(tmp_path, column, value).id == "inside"


@pytest.mark.parametrize(
    ("column", "value"), [("epu", 21), ("sigma_n_m", 900), ("tse", 5000), ("h_error", 500), ("herr", 500), ("CEP95", 21)]
)
def test_an_accuracy_or_error_above_the_level_is_against_it(column: str, value: float, tmp_path: Path) -> None:
    of = verdict(tmp_path, column, value)
    assert (of.id, of.n_stated_worse) == ("not_shown", N)
    assert "states an accuracy or an error (EPU, sigma) above its horizontal protection level at 300 epochs" in of.words


def test_one_component_of_an_error_is_no_smaller_than_the_error(tmp_path: Path) -> None:
    assert verdict(tmp_path, "nerr", 500).id == "not_believable"


@pytest.mark.parametrize(
    ("column", "value"),
    [
        ("mode", "dead reckoning"),
        ("available", 0),
        ("xpl_valid", "false"),
        ("faults", "2 satellites"),
        ("warn", "RAIM"),
        ("gps_primary", "lost"),
    ],
)
def test_a_statement_against_the_position_leaves_no_level(column: str, value: object, tmp_path: Path) -> None:
    assert verdict(tmp_path, column, value).id == "nothing_judged"


@pytest.mark.parametrize(("column", "value"), [("hal_margin", 1), ("hpl_flag", "unusable")])
def test_what_is_not_understood_is_named_in_the_verdict(column: str, value: object, tmp_path: Path) -> None:
    of = verdict(tmp_path, column, value)
    assert of.unread == [column]
    assert f"Not understood and not used, though the names speak of accuracy, of integrity or of another position: {column}." in of.words


def test_an_error_above_its_level_counts_at_any_dilution(tmp_path: Path) -> None:
    rows = ["time,hpl,vpl,hpe,vpe,hdop", *(f"{1_400_000_000 + k},20,25,{30 if k == 9 else 1},1,99" for k in range(N))]
    (tmp_path / "levels.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    assert navbound.evaluate([tmp_path / "levels.csv"], levels="APV-I").summary.verdict.id == "not_believable"


@pytest.mark.parametrize(
    ("columns", "bad"),
    [
        ("hpe,nse_e_m,nse_n_m", "100,1,1"),
        ("hpe,nse_e_m,nse_n_m", "1,60,80"),
        ("hpe,nse_e_m,nse_n_m", "1,nan,80"),
        ("hpe,nse_e_m,nse_n_m", "100,0,0"),
        ("nse_e_m,nse_n_m,est_lat_deg,est_lon_deg,truth_lat_deg,truth_lon_deg", "1,1,48.0,2.0,48.01,2.0"),
    ],
)
def test_of_two_statements_of_one_error_the_larger_counts(columns: str, bad: str, tmp_path: Path) -> None:
    fine = "1,1,1" if columns.startswith("hpe") else "1,1,48.0,2.0,48.00001,2.00001"
    rows = [f"time,hpl,vpl,vpe,{columns}", *(f"{1_400_000_000 + k},20,25,1,{bad if 100 <= k < 160 else fine}" for k in range(N))]
    (tmp_path / "levels.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    result = navbound.evaluate([tmp_path / "levels.csv"], levels="APV-I")
    assert result.summary.verdict.id == "not_believable"
    assert result.summary.performance is not None
    assert result.summary.performance.levels[0].n_hazard_epochs == 60


@pytest.mark.parametrize("word", ["RAIM FAIL", "INVALID", "NO FIX", "V", "0", "degraded", "", "None", "nonsense"])
def test_an_epoch_whose_status_is_not_ok_has_no_level(word: str, tmp_path: Path) -> None:
    of = verdict(tmp_path, "status", word)
    assert (of.id, of.n_judged) == ("nothing_judged", 0)
    assert verdict(tmp_path, "status", "OK").id == "inside"


def test_a_status_that_is_not_understood_is_counted_and_named(tmp_path: Path) -> None:
    verdict(tmp_path, "status", "RAIM FAIL")
    notes = navbound.evaluate([tmp_path / "levels.csv"], levels="APV-I").summary.assumptions
    assert any(f"{N} epochs have a status that is none of" in each and "(RAIM FAIL)" in each for each in notes)


@pytest.mark.parametrize("word", ["RAIM FAIL", "OK", "", None])
def test_the_indicators_refuse_a_status_that_is_none(word: str | None) -> None:
    table = {"time_ns": list(range(0, 3_000_000_000, 1_000_000_000)), "hpl_m": [15.0] * 3, "status": ["ok", word, "ok"]}
    with pytest.raises(navbound.InputError, match=r"status\[1\]"):
        kpi.evaluate(pl.DataFrame(table), "APV-I")
