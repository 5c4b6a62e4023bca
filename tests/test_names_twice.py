"""A table in which a name stands twice: a person chooses by place, and nothing is guessed."""

from __future__ import annotations

from pathlib import Path

import pytest

import navbound
from navbound.errors import FormatError
from navbound.read.pieces import read_pieces
from navbound.read.tables.epochs import read

N, DEG_PER_M = 60, 1 / 111_195


def twice(tmp_path: Path, header: str = "time,lat,lon,nac_p,lat,nac_p") -> Path:
    """Two latitudes of one time, a hundredth of a degree apart, and two accuracies."""
    rows = [f"{1_700_000_000 + k},{48 + 60 * k * DEG_PER_M:.7f},2.0,10,{48.01 + 60 * k * DEG_PER_M:.7f},8" for k in range(N)]
    (tmp_path / "twice.csv").write_text("\n".join([header, *rows]) + "\n")
    return tmp_path / "twice.csv"


def test_nothing_is_guessed_and_the_refusal_says_how_to_choose(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r'“lat” is named twice; .*choose by place.*--map "QUANTITY=lat#1"'):
        read(twice(tmp_path))


@pytest.mark.parametrize(("place", "first_deg"), [(1, 48.0), (2, 48.01)])
@pytest.mark.parametrize("unit", ["", ":deg"])
def test_a_column_is_selected_by_its_place(tmp_path: Path, place: int, first_deg: float, unit: str) -> None:
    columns = {"est_lat_rad": f"lat#{place}{unit}", "nac_p": f"nac_p#{place}"}
    for epochs in (read(twice(tmp_path), columns=columns).epochs, next(read_pieces(twice(tmp_path), columns=columns).epochs())):
        assert epochs["est_lat_rad"].degrees()[0] == pytest.approx(first_deg)
        assert set(epochs["nac_p"]) == {10 if place == 1 else 8}


def test_a_choice_of_one_name_is_none_of_another(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="“nac_p” is named twice"):
        read(twice(tmp_path), columns={"est_lat_rad": "lat#1"})


def test_there_is_no_third_column_of_two(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="there is no column “lat#3”; found: lat#"):
        read(twice(tmp_path), columns={"est_lat_rad": "lat#3", "nac_p": "nac_p#1"})


def test_what_is_known_of_a_name_holds_of_both_of_its_columns(tmp_path: Path) -> None:
    """Whoever reads one column of validity as something else does not set the other aside."""
    path = twice(tmp_path, "time,lat,lon,valid,lat,valid")
    path.write_text(path.read_text().replace(",2.0,10,", ",2.0,1,").replace(",8\n", ",0\n"))
    with pytest.raises(FormatError, match="“valid” is named twice"):
        read(path, columns={"est_lat_rad": "lat#1"})
    columns = {"est_lat_rad": "lat#1", "callsign": "valid#1"}
    assert set(read(path, columns=columns).epochs["status"]) == {"not_available"}
    assert navbound.analyze(path, columns=columns, sigma_m=5.0).summary.verdict.id == "nothing_judged"
