"""The side of the equator and of Greenwich in a column of its own, and whose an accuracy is that counts on."""

from __future__ import annotations

from pathlib import Path

import pytest

import navbound
from navbound.errors import FormatError

NAMES = [
    ("N/S", "E/W"),
    ("NS", "EW"),
    ("lat_dir", "lon_dir"),
    ("Latitude Hemisphere", "Longitude Hemisphere"),
    ("GPSLatitudeRef", "GPSLongitudeRef"),
    ("latitude_ns", "longitude_ew"),
    ("N/S indicator", "E/W indicator"),
]


def logged(path: Path, letters: tuple[str, str], names: tuple[str, str] = ("N/S", "E/W"), sign: int = 1, odd: str | None = None) -> Path:
    rows = []
    for k in range(60):
        of_lat = odd if odd is not None and k == 30 else letters[0]
        rows.append(f"{1_700_000_000 + k},{sign * (33.5 + k * 1e-4):.6f},{of_lat},{sign * 70.6},{letters[1]}")
    path.write_text("\n".join([f"time,LATITUDE,{names[0]},LONGITUDE,{names[1]}", *rows]) + "\n")
    return path


@pytest.mark.parametrize("names", NAMES)
@pytest.mark.parametrize(
    ("letters", "signs"), [(("N", "E"), (1, 1)), (("S", "W"), (-1, -1)), (("s", "east"), (-1, 1)), (("North", "w"), (1, -1))]
)
def test_a_coordinate_is_on_the_side_that_its_letter_says(
    tmp_path: Path, names: tuple[str, str], letters: tuple[str, str], signs: tuple[int, int]
) -> None:
    run = navbound.analyze(logged(tmp_path / "a.csv", letters, names), spec="RNP 0.3", sigma_m=5.0)
    assert run.summary.verdict.n_judged == 60
    for name, sign in zip(("est_lat_rad", "est_lon_rad"), signs, strict=True):
        assert (run.epochs[name].sign() == sign).all()


def test_a_minus_in_the_south_says_the_same_and_in_the_north_the_contrary(tmp_path: Path) -> None:
    run = navbound.analyze(logged(tmp_path / "a.csv", ("S", "W"), sign=-1), spec="RNP 0.3", sigma_m=5.0)
    assert (run.epochs["est_lat_rad"] < 0.0).all()
    with pytest.raises(FormatError, match="below zero, and “N/S” says otherwise"):
        navbound.analyze(logged(tmp_path / "b.csv", ("N", "E"), sign=-1), spec="RNP 0.3", sigma_m=5.0)


@pytest.mark.parametrize("odd", ["", "X", "E"])
def test_a_row_without_a_hemisphere_has_no_position(tmp_path: Path, odd: str) -> None:
    run = navbound.analyze(logged(tmp_path / "a.csv", ("S", "W"), odd=odd), spec="RNP 0.3", sigma_m=5.0)
    (rejection,) = run.summary.rejected
    assert (rejection.count, rejection.reason) == (1, "LATITUDE: “N/S” says no hemisphere")
    assert run.summary.verdict.n_missing == 1


@pytest.mark.parametrize("piece_rows", [None, 20])
@pytest.mark.parametrize("names", [("N/S", "E/W"), ("lat_dir", "lon_dir")])
def test_letters_that_come_with_the_first_fix_count_too(tmp_path: Path, names: tuple[str, str], piece_rows: int | None) -> None:
    path = logged(tmp_path / "a.csv", ("S", "W"), names)
    head, *rows = path.read_text().splitlines()
    without = [f"{row.split(',')[0]},,,," for row in rows[:25]]
    path.write_text("\n".join([head, *without, *rows[25:]]) + "\n")
    run = navbound.analyze(path, spec="RNP 0.3", sigma_m=5.0, piece_rows=piece_rows)
    assert (run.summary.verdict.n_judged, run.summary.verdict.n_missing) == (35, 25)
    assert (run.epochs["est_lat_rad"] < 0.0).all()


@pytest.mark.parametrize("piece_rows", [None, 7])
def test_an_accuracy_beside_a_position_of_others_is_none_of_the_rows_after_it(tmp_path: Path, piece_rows: int | None) -> None:
    rows = [f"{1_700_000_000 + k},3c6444,{48 + k * 1e-4:.5f},2.5,{'tisb_icao,9' if k % 60 == 0 else ','}" for k in range(900)]
    (tmp_path / "a.csv").write_text("\n".join(["time,icao24,latitude,longitude,type,nac_p", *rows]) + "\n")
    run = navbound.analyze(tmp_path / "a.csv", spec="RNP 0.3", piece_rows=piece_rows)
    assert (run.summary.verdict.id, run.summary.verdict.n_judged) == ("nothing_judged", 0)
    assert run.summary.verdict.n_reason == {"no_covariance": 885, "reported": 15}


@pytest.mark.parametrize("word", ["SPS", "DGPS", "PPS"])
def test_a_service_is_a_word_of_a_valid_position(tmp_path: Path, word: str) -> None:
    rows = [f"{1_700_000_000 + k},{48 + k * 1e-4:.5f},2.5,5,5,{word}" for k in range(60)]
    (tmp_path / "a.csv").write_text("\n".join(["time,lat,lon,sigma_e_m,sigma_n_m,VALID", *rows]) + "\n")
    assert navbound.analyze(tmp_path / "a.csv", spec="RNP 0.3").summary.verdict.id == "inside"
