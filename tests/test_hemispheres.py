"""The side of the equator and of Greenwich in a column of its own, and whose an accuracy is that counts on."""

from __future__ import annotations

from pathlib import Path

import polars as pl
import pytest

import navbound
from navbound.errors import FormatError
from navbound.records.run import Verdict

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


@pytest.mark.parametrize("reason", ["S", "T", "TS"])
def test_letters_of_another_kind_beside_a_coordinate_with_its_own_are_none_of_it(tmp_path: Path, reason: str) -> None:
    """Loggers write by which event a row was recorded: time, distance, speed."""
    lines = logged(tmp_path / "a.csv", ("N", "E")).read_text().splitlines()
    rows = [f"{line},{reason if k % 3 else 'T'}" for k, line in enumerate(lines[1:])]
    (tmp_path / "b.csv").write_text("\n".join([f"{lines[0]},RCR", *rows]) + "\n")
    assert navbound.analyze(tmp_path / "b.csv", spec="RNP 0.3", sigma_m=5.0).summary.verdict.id == "inside"


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


def table(path: Path, columns: dict[str, object], lat: float = 33.5, lon: float = 70.6, order: tuple[str, ...] = ()) -> Path:
    """60 rows of positions without a sign, and columns beside them: one value, or one of each row."""
    rows = []
    for k in range(60):
        beside = {name: value(k) if callable(value) else value for name, value in columns.items()}
        rows.append({"time": 1_700_000_000 + k, "lat": round(lat + k * 1e-4, 6), "lon": lon} | beside)
    names = [*order, *(name for name in rows[0] if name not in order)]
    pl.DataFrame(rows, strict=False).select(names).write_csv(path)
    return path


def judged(path: Path, **declared: str) -> Verdict:
    return navbound.analyze(path, spec="RNP 0.3", sigma_m=5.0, columns=declared or None).summary.verdict


@pytest.mark.parametrize(
    "names",
    [
        ("u", "v"),
        ("h1", "h2"),
        ("S/N", "W/E"),
        ("lat_quadrant", "lon_quadrant"),
        ("hem_lat", "hem_lon"),
        ("latChar", "lonChar"),
        ("dir", "dir2"),
    ],
)
@pytest.mark.parametrize(("letters", "shown"), [(("S", "W"), False), (("South", "Ouest"), False), (("N", "E"), True)])
def test_letters_under_any_name_contradict_a_coordinate_without_a_sign(
    tmp_path: Path, names: tuple[str, str], letters: tuple[str, str], shown: bool
) -> None:
    columns: dict[str, object] = dict(zip(names, letters, strict=True))
    path = table(tmp_path / "a.csv", columns, order=("time", "lat", names[0], "lon", names[1]))
    assert (judged(path).id == "inside") == shown
    if not shown:
        doubts = judged(path).position_doubts
        assert any(f"“{names[0]}” says another hemisphere than “lat” is read in at 60 of 60 rows" in each for each in doubts)
        run = navbound.analyze(path, spec="RNP 0.3", sigma_m=5.0, columns={"lat_hemisphere": names[0], "lon_hemisphere": "-"})
        assert run.summary.verdict.id == "inside"
        assert (run.epochs["est_lat_rad"] < 0.0).all()
        assert (run.epochs["est_lon_rad"] > 0.0).all()


@pytest.mark.parametrize("name", ["hemisphere", "hemispheres", "quadrant"])
@pytest.mark.parametrize(("south_west", "north_east"), [("SW", "NE"), ("South-West", "NORTHEAST"), ("S, W", "N/E")])
def test_letters_of_both_coordinates_in_one_column_contradict_both(tmp_path: Path, name: str, south_west: str, north_east: str) -> None:
    verdict = judged(table(tmp_path / "a.csv", {name: south_west.replace(",", ";")}))
    assert (verdict.id, len(verdict.position_doubts)) == ("not_shown", 2)
    assert judged(table(tmp_path / "b.csv", {name: north_east})).id == "inside"


def test_letters_of_one_coordinate_leave_those_of_the_other_compared(tmp_path: Path) -> None:
    """One is known by its name, or declared; the other column still says that its coordinate is in the west."""
    known = table(tmp_path / "a.csv", {"N/S": "S", "x2": "W"})
    assert any("“x2” says another hemisphere than “lon”" in each for each in judged(known).position_doubts)
    unknown = table(tmp_path / "b.csv", {"x1": "S", "x2": "W"})
    assert len(judged(unknown).position_doubts) == 2
    assert judged(unknown, lat_hemisphere="x1").id == "not_shown"
    assert judged(unknown, lon_hemisphere="x2").id == "not_shown"
    assert judged(unknown, lat_hemisphere="x1", lon_hemisphere="x2").id == "inside"


@pytest.mark.parametrize("code", [-1, 1, 83])
def test_numbers_in_a_column_of_hemispheres_are_declared(tmp_path: Path, code: int) -> None:
    assert judged(table(tmp_path / "a.csv", {"hemisphere": code})).id == "not_shown"
    assert judged(table(tmp_path / "b.csv", {"lat_hem": code, "lon_hem": code})).id == "not_shown"
    assert judged(table(tmp_path / "c.csv", {"hemisphere": code}, lat=-33.5, lon=-70.6)).id == "inside"


@pytest.mark.parametrize(
    "columns",
    [
        {"wind_dir": "S"},
        {"on_ground": "N"},
        {"wake": "W"},
        {"phase": "S"},
        {"heading": lambda k: ["N", "NE", "SW", "S", "W"][k % 5]},
        {"dest_lat": 12.0, "dest_N/S": "S", "dest_lon": 13.0, "dest_E/W": "W"},
        {"ns": lambda k: 7 + k % 2},
        {"remark": lambda k: f"S{k}"},
    ],
)
def test_words_that_are_no_hemisphere_of_the_vehicle_contradict_nothing(tmp_path: Path, columns: dict[str, object]) -> None:
    assert judged(table(tmp_path / "a.csv", columns)).id == "inside"


@pytest.mark.parametrize("codes", [(-1, -1), (83, 87), (0, 0), (1, 1)])
@pytest.mark.parametrize("names", [("lat_dir", "lon_dir"), ("N/S", "E/W"), ("lat_sign", "lon_sign")])
def test_numbers_in_a_column_of_letters_are_declared_or_nothing_is_shown(
    tmp_path: Path, names: tuple[str, str], codes: tuple[int, int]
) -> None:
    path = table(tmp_path / "a.csv", dict(zip(names, codes, strict=True)))
    assert (judged(path).id, len(judged(path).position_doubts)) == ("not_shown", 2)
    assert judged(path, lat_hemisphere="-", lon_hemisphere="-").id == "inside"


@pytest.mark.parametrize("n_numbers", [1, 20, 59])
@pytest.mark.parametrize("piece_rows", [None, 20])
def test_a_number_among_the_first_letters_hides_none(tmp_path: Path, n_numbers: int, piece_rows: int | None) -> None:
    columns: dict[str, object] = {"lat_dir": lambda k: "1" if k < n_numbers else "S", "lon_dir": lambda k: "1" if k < n_numbers else "W"}
    run = navbound.analyze(table(tmp_path / "a.csv", columns), spec="RNP 0.3", sigma_m=5.0, piece_rows=piece_rows)
    assert run.summary.verdict.id == "not_shown"


@pytest.mark.parametrize("kind", ["categorical", "bytes", "list", "nulls"])
def test_letters_of_other_types_sign_or_refuse_as_texts_do(tmp_path: Path, kind: str) -> None:
    frame = pl.read_csv(table(tmp_path / "a.csv", {"N/S": "S", "E/W": "W"}))
    letters = pl.col("N/S", "E/W")
    of_kind = {
        "categorical": letters.cast(pl.Categorical),
        "bytes": letters.cast(pl.Binary),
        "list": letters.implode().over("time", mapping_strategy="join"),
        "nulls": pl.lit(None).alias("N/S"),
    }[kind]
    frame.with_columns(of_kind).write_parquet(tmp_path / "a.parquet")
    if kind == "nulls":
        with pytest.raises(FormatError, match="“N/S” says no hemisphere"):
            judged(tmp_path / "a.parquet")
    elif kind == "list":
        assert judged(tmp_path / "a.parquet").id == "not_shown"
    else:
        run = navbound.analyze(tmp_path / "a.parquet", spec="RNP 0.3", sigma_m=5.0)
        assert run.summary.verdict.id == "inside"
        assert (run.epochs["est_lat_rad"] < 0.0).all()


def test_letters_sign_the_coordinate_that_they_stand_beside_and_no_other(tmp_path: Path) -> None:
    order = ("time", "lat", "lon", "true_lat", "N/S", "true_lon", "E/W")
    columns: dict[str, object] = {"true_lat": lambda k: 33.5 + k * 1e-4, "N/S": "S", "true_lon": 70.6, "E/W": "W"}
    verdict = judged(table(tmp_path / "a.csv", columns, order=order))
    assert verdict.id == "not_shown"
    assert any("“N/S” says another hemisphere" in each for each in verdict.position_doubts)
    two: dict[str, object] = {"N/S": "N", "E/W": "E", "lat_dir": "S", "lon_dir": "W"}
    assert judged(table(tmp_path / "b.csv", two)).id == "not_shown"


def test_a_coordinate_without_a_sign_beside_one_with_letters_is_declared(tmp_path: Path) -> None:
    path = table(tmp_path / "a.csv", {"N/S": "S"})
    (doubt,) = judged(path).position_doubts
    assert "“lon” has neither a hemisphere nor a sign" in doubt
    assert judged(path, lon_hemisphere="-").id == "inside"
    assert judged(table(tmp_path / "b.csv", {"N/S": "S"}, lon=-70.6)).id == "inside"


def test_a_column_of_letters_that_is_declared_and_absent_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="there is no column “nowhere”"):
        judged(table(tmp_path / "a.csv", {}), lat_hemisphere="nowhere")


@pytest.mark.parametrize("name", ["gps_lat_lon", "lat_lon_gps", "latlon2", "latitude_longitude"])
@pytest.mark.parametrize("off_deg", [0.0, 0.5])
def test_a_pair_under_a_name_of_both_coordinates_is_another_place(tmp_path: Path, name: str, off_deg: float) -> None:
    columns: dict[str, object] = {name: lambda k: f"{33.5 + off_deg + k * 1e-4:.5f} 70.6"}
    assert (judged(table(tmp_path / "a.csv", columns)).id == "inside") == (off_deg == 0.0)


@pytest.mark.parametrize("off_deg", [0.0, 0.5])
def test_a_pair_of_integers_is_another_place(tmp_path: Path, off_deg: float) -> None:
    frame = pl.read_csv(table(tmp_path / "a.csv", {}))
    pairs = [[round((lat + off_deg) * 1e7), round(lon * 1e7)] for lat, lon in frame.select("lat", "lon").iter_rows()]
    frame.with_columns(gps_lat_lon=pl.Series(pairs)).write_parquet(tmp_path / "a.parquet")
    assert (judged(tmp_path / "a.parquet").id == "inside") == (off_deg == 0.0)


@pytest.mark.parametrize("off_deg", [0.0, 0.5])
def test_two_numbered_columns_of_both_coordinates_are_another_place(tmp_path: Path, off_deg: float) -> None:
    columns: dict[str, object] = {"gps_lat_lon_0": lambda k: 33.5 + off_deg + k * 1e-4, "gps_lat_lon_1": 70.6}
    assert (judged(table(tmp_path / "a.csv", columns)).id == "inside") == (off_deg == 0.0)


def test_a_count_is_no_place(tmp_path: Path) -> None:
    counts: dict[str, object] = {"lat_counter": lambda k: k, "delta_lat_lon[0]": lambda k: 1e-6 * k, "delta_lat_lon[1]": 0.0}
    assert judged(table(tmp_path / "a.csv", counts)).id == "inside"


@pytest.mark.parametrize("name", ["ANP", "actual_navigation_performance"])
@pytest.mark.parametrize(("value", "verdict"), [(0.05, "not_shown"), (5.0, "inside"), (1000.0, "not_shown")])
def test_a_small_anp_without_a_unit_is_declared(tmp_path: Path, name: str, value: float, verdict: str) -> None:
    path = table(tmp_path / "a.csv", {name: value})
    assert judged(path).id == verdict
    if value < 1.0:
        assert any("may be in nautical miles" in each for each in judged(path).position_doubts)
        assert navbound.analyze(path, spec="RNP 0.3", columns={"epu_m": f"{name}:nm"}).summary.verdict.id == "inside"
