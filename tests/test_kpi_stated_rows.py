"""An error above a level that a row states is never lost, whatever else the row lacks or says."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import navbound
from navbound import kpi

if TYPE_CHECKING:
    from pathlib import Path

    from navbound.records.run import Verdict

N = 100
T0 = 1_400_000_000
HEADER = "time,e,n,u,hpl,vpl,n_sv,status,reason_id"
HEALTHY = "0.3,0.4,1.0,15,22,10,ok,"
"""Errors 0.5 m and 1 m; LPV-200 limits 40 m and 35 m."""


def verdict(folder: Path, row: str, n_rows: int = 3, level: str = "LPV-200") -> Verdict:
    """Of a healthy table some of whose rows are another."""
    rows = [row if 20 <= k < 20 + n_rows else HEALTHY for k in range(N)]
    columns = HEADER.replace(",e,n,u,", ",nse_e_m,nse_n_m,nse_u_m,").replace("hpl,vpl", "hpl_m,vpl_m")
    text = "\n".join([columns, *(f"{T0 + k},{each}" for k, each in enumerate(rows))])
    (folder / "levels.csv").write_text(text + "\n", encoding="utf-8")
    return navbound.evaluate([folder / "levels.csv"], levels=level).summary.verdict


def test_the_healthy_table_is_inside(tmp_path: Path) -> None:
    assert verdict(tmp_path, HEALTHY).id == "inside"


@pytest.mark.parametrize(
    "row",
    [
        "100,0,1,15,22,10,degraded,few_satellites",
        "100,0,1,15,22,10,degraded,",
        "100,0,1,15,22,10,ok,few_satellites",
        "0,0,40,15,22,10,degraded,few_satellites",
        "100,0,1,15,22,10,ok,",
    ],
)
def test_an_error_above_the_level_of_a_degraded_row_is_a_hazard(row: str, tmp_path: Path) -> None:
    judged = verdict(tmp_path, row)
    assert judged.id == "not_believable"
    assert "Hazardously misleading information: LPV-200 at 3 epochs" in judged.words


@pytest.mark.parametrize(("row", "id_"), [("0.3,0.4,1,15,22,10,degraded,few_satellites", "inside"), ("100,0,1,,,10,degraded,", "inside")])
def test_a_degraded_row_without_an_error_above_a_level_has_no_level(row: str, id_: str, tmp_path: Path) -> None:
    judged = verdict(tmp_path, row)
    assert (judged.id, judged.n_judged) == (id_, N - 3)
    assert "3 without a level" in judged.words


@pytest.mark.parametrize("status", ["not_available", "invalid_input", "RAIM FAIL", "0", "", "NO FIX"])
def test_a_row_that_says_that_there_is_no_level_has_none(status: str, tmp_path: Path) -> None:
    judged = verdict(tmp_path, f"100,0,1,15,22,10,{status},")
    assert (judged.id, judged.n_judged) == ("inside", N - 3)


def table(**changed: Any) -> dict[str, Any]:
    """Ten healthy epochs, with other numbers in the fourth."""
    columns: dict[str, Any] = {
        "time_ns": np.arange(10) * 1_000_000_000,
        **{
            name: np.full(10, value)
            for name, value in (("nse_e_m", 0.3), ("nse_n_m", 0.4), ("nse_u_m", 1.0), ("hpl_m", 15.0), ("vpl_m", 22.0))
        },
        "status": np.array(["ok"] * 10, dtype=object),
    }
    for name, value in changed.items():
        columns[name][3] = value
    return columns


def test_a_degraded_epoch_is_available_only_where_it_misleads() -> None:
    misleading = kpi.evaluate(table(status="degraded", nse_e_m=16.0), "LPV-200")
    assert (misleading.n_mi_epochs, misleading.levels[0].n_mi_epochs, misleading.levels[0].n_hazard_epochs) == (1, 1, 0)
    assert any("1 row is degraded and states a protection level that its error exceeds" in note for note in misleading.notes)
    kept = kpi.evaluate(table(status="degraded", nse_e_m=14.0), "LPV-200")
    assert (kept.n_mi_epochs, kept.levels[0].n_available, kept.n_no_solution) == (0, 9, 1)


def test_a_vertical_that_no_level_limits_makes_no_degraded_epoch_available() -> None:
    result = kpi.evaluate(table(status="degraded", nse_u_m=100.0), kpi.rnp(0.3, tta_s=10.0))
    assert (result.levels[0].n_available, result.n_no_solution) == (9, 1)


@pytest.mark.parametrize("errors", ["100,,1", ",-100,1", "100,nan,1", "100,NaN,1"])
def test_half_an_error_above_the_level_is_a_hazard(errors: str, tmp_path: Path) -> None:
    judged = verdict(tmp_path, f"{errors},15,22,10,ok,")
    assert judged.id == "not_believable"
    assert "Hazardously misleading information: LPV-200 at 3 epochs" in judged.words


def test_half_an_error_within_the_level_is_not_known() -> None:
    result = kpi.evaluate(table(nse_n_m=np.nan, nse_e_m=14.9), "LPV-200")
    assert result.axes[0].error_m is not None
    assert (result.n_mi_epochs, result.axes[0].error_m.n, result.n_solution) == (0, 9, 10)


@pytest.mark.parametrize("errors", ["inf,0,1", "1e300,0,1", "100 steps,0,1", '"100,0",0,1', "0,-inf,1", "0,0,inf", "0,0,1e5 steps"])
def test_an_error_that_is_written_and_no_number_shows_nothing(errors: str, tmp_path: Path) -> None:
    judged = verdict(tmp_path, f"{errors},15,22,10,ok,")
    assert judged.id == "not_shown"
    assert "the file states an error that is no finite number, so that it may be of any size, in 3 rows" in judged.words
    # A row that has no level claims nothing.
    assert verdict(tmp_path, f"{errors},15,22,10,not_available,").id == "inside"


@pytest.mark.parametrize("levels", ["0,22", "-1,22", "-inf,22", "15,0", "15 steps,22"])
def test_no_level_beside_ok_shows_nothing(levels: str, tmp_path: Path) -> None:
    judged = verdict(tmp_path, f"100,0,1,{levels},10,ok,")
    assert judged.id in {"not_shown", "not_believable"}
    assert "a protection level that is none (0 or less, or no number) beside the status ok, in 3 rows" in judged.words
    assert verdict(tmp_path, f"0,0,1,{levels},10,not_available,").id == "inside"


@pytest.mark.parametrize("row", ["nan,,1,15,22,10,ok,", "0,0,1,inf,22,10,ok,", "0,0,1,,,10,ok,"])
def test_what_is_not_written_is_no_fault_of_the_file(row: str, tmp_path: Path) -> None:
    assert verdict(tmp_path, row).id == "inside"


@pytest.mark.parametrize(("n_sv", "status", "has"), [(3, "", False), (4, "", True), (3, ",ok", True)])
def test_a_row_on_too_few_satellites_has_no_level(n_sv: int, status: str, has: bool, tmp_path: Path) -> None:
    """Four determine a position with its clock; a status of the table's own counts, as in tables of positions."""
    rows = ["time,nse_e_m,nse_n_m,nse_u_m,hpl_m,vpl_m,n_sv" + (",status" if status else "")]
    rows += [f"{T0 + k},0.3,0.4,1,15,22,{n_sv if 20 <= k < 30 else 10}{status}" for k in range(N)]
    (tmp_path / "levels.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    judged = navbound.evaluate([tmp_path / "levels.csv"], levels="LPV-200").summary.verdict
    assert (judged.id, judged.n_judged) == (("inside", N) if has else ("not_shown", N - 10))


@pytest.mark.parametrize("row", ["100 m,0,1,15m", "1e2 m,0,1,0.015 km", "1E+2 M,0,1 m,15"])
def test_an_error_and_a_level_with_their_unit_are_read(row: str, tmp_path: Path) -> None:
    """An error of 100 m beside a level of 15 m."""
    bare, with_units = (verdict(tmp_path, f"{each},22,10,ok,") for each in ("100,0,1,15", row))
    assert (with_units.id, with_units.words) == (bare.id, bare.words)
    assert bare.id == "not_believable"
