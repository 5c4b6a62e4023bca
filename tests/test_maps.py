"""Maps: what a row of the grid says, which share of the area meets a limit, what goes in and out."""

from __future__ import annotations

import json
import math
import re
from datetime import datetime
from pathlib import Path

import numpy as np
import polars as pl
import pytest
from scipy.io import netcdf_file
from typer.testing import CliRunner

from navbound import exit_status, gnss, maps
from navbound.cli import main as cli
from navbound.errors import FormatError, InputError
from navbound.maps.sources import Times
from navbound.maps.statistics import Evaluate, Tile, percentile_name
from navbound.report import world
from navbound.time import gps_ns, utc_text

SIX_HOURS = Times(duration_s=21_600.0, step_s=1_800.0)
COARSE = maps.Grid.degrees(30.0)


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> maps.Map:
    """A map of dilutions with a limit that a part of the area misses."""
    out = tmp_path_factory.mktemp("map") / "dop"
    return maps.make("dop", grid=COARSE, limits={"pdop": 2.5}, times=SIX_HOURS, out=out)


def test_a_percentile_is_not_exceeded_in_that_share_of_the_epochs() -> None:
    values = np.arange(1.0, 201.0)[::-1].copy()
    gaps = np.where(values > 190, np.nan, values)
    rows = Evaluate(lambda lat, _lon: {"x_m": np.stack([values, gaps])[: len(lat)]}, ("x_m",), (("x_m", 100.0),))(
        Tile(np.zeros(2), np.zeros(2))
    )
    # Of 200 epochs 99.5 % are 199. Ten without a number are five per cent: there is one for 95 % of the time, none for 99 %.
    assert rows["x_p50_m"].tolist() == [100.0, 100.0]
    assert rows["x_p95_m"].tolist() == [190.0, 190.0]
    assert rows["x_p995_m"].tolist() == [199.0, math.inf]
    assert rows["x_p99_m"].tolist() == [198.0, math.inf]
    assert rows["p_available"].tolist() == [0.5, 0.5]


def test_names_of_percentiles_keep_the_unit_last() -> None:
    assert percentile_name("hpl_m", 99.5) == "hpl_p995_m"
    assert percentile_name("pdop", 50.0) == "pdop_p50"


def test_a_point_of_the_map_is_that_user_through_the_day(written: maps.Map) -> None:
    row = written.points.row(17, named=True)
    orbits = gnss.constellation("gps")
    sky = gnss.geometry(orbits, row["lat_rad"], row["lon_rad"], 0.0, SIX_HOURS.offsets_s(), mask_rad=math.radians(5.0))
    pdop = np.sort(gnss.dop(sky.az_rad, sky.el_rad, orbits.constellation).pdop)
    assert row["p_available"] == np.mean(pdop <= 2.5)
    # The way through angles rounds otherwise: a dozen roundings times the condition of the geometry, below 1e4.
    assert row["pdop_p50"] == pytest.approx(pdop[5], rel=1e-11)
    assert row["pdop_p999"] == pytest.approx(pdop[11], rel=1e-11)
    assert row["n_sv_least"] == sky.n_sv.min()


def test_coverage_is_a_share_of_area(written: maps.Map) -> None:
    summary, points = written.summary, written.points
    assert 0.0 < summary.available_mean < 1.0, "the limit parts nothing"
    # The area between two parallels is the difference of their sines; a cell's midpoint rule has the same share of its row.
    lat = points["lat_rad"].to_numpy()
    cells = np.cos(lat)
    for coverage in summary.coverage:
        good = points["p_available"].to_numpy() >= coverage.available
        assert coverage.share == pytest.approx(cells[good].sum() / cells.sum(), abs=1e-12)
    worst = points.row(int(points["p_available"].to_numpy().argmin()), named=True)
    assert summary.worst.available == worst["p_available"]
    assert f"{100 * worst['p_available']:.2f} % of the time" in summary.words


def test_a_map_comes_back_as_it_was_written(written: maps.Map) -> None:
    assert written.path is not None
    again = maps.load(written.path)
    assert again.summary == written.summary
    assert again.points.equals(written.points)
    with netcdf_file(written.path / "map.nc", mmap=False) as file:
        assert file.variables["lat"].units == b"degrees_north"
        np.testing.assert_allclose(file.variables["lat"][:], np.degrees(COARSE.lat_rad), rtol=0, atol=1e-12)
        np.testing.assert_allclose(file.variables["lon"][:], np.degrees(COARSE.lon_rad), rtol=0, atol=1e-12)
        for name in written.points.columns[2:]:
            assert file.variables[name][:].ravel().tolist() == written.points[name].to_list(), name
        assert file.variables["pdop_p95"].long_name == b"Position dilution of precision"


def test_every_column_of_every_kind_is_declared() -> None:
    glossary = (Path(__file__).parents[1] / "docs" / "notation.md").read_text(encoding="utf-8")
    declared = set(re.findall(r"`([a-z_0-9]+)`", glossary[glossary.index("## Maps") :]))
    for kind in maps.KINDS.values():
        assert {c.name for c in kind.columns} <= declared
        assert all((c.unit == "m") == c.name.endswith("_m") for c in kind.columns)
        assert {c.name for c in kind.causes} <= declared
    assert {"p_available", "n_sv_least"} <= declared


def test_a_fine_map_leaves_out_what_its_page_cannot_hold(written: maps.Map, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(world, "MOST_VALUES", 3 * len(COARSE))
    page = world.render(written, tmp_path / "report.html").read_text(encoding="utf-8")
    data = json.loads(page.split('id="navbound-data">')[1].split("</script>")[0])
    assert [column["name"] for column in data["columns"]] == ["share_available", "pdop_p50", "pdop_p95"]
    assert data["left_out"][0] == "pdop_p99"
    assert len(data["left_out"]) == 18


def test_a_strange_folder_is_not_written_to(written: maps.Map, tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").touch()
    reported: list[int] = []
    with pytest.raises(FormatError, match=r"thesis\.txt"):
        maps.make("dop", grid=COARSE, times=SIX_HOURS, out=tmp_path, progress=lambda done, _all: reported.append(done))
    assert reported == [], "it was refused after the work"
    with pytest.raises(FormatError, match="not the folder of a map"):
        maps.load(tmp_path)


def test_the_antimeridian_is_a_place_like_any_other() -> None:
    grid = maps.Grid.degrees(5.0, (-20.0, 0.0, 170.0, 190.0))
    assert np.degrees(grid.lon_rad) == pytest.approx([172.5, 177.5, -177.5, -172.5], abs=1e-12)
    assert grid.weights().sum() == pytest.approx(1.0, abs=1e-15)


@pytest.mark.parametrize("step_deg", [0.0, -1.0, 91.0, math.nan, math.inf, 1e-3])
def test_steps_outside_their_domain_are_refused(step_deg: float) -> None:
    with pytest.raises(InputError, match="step_rad"):
        maps.Grid.degrees(step_deg)


@pytest.mark.parametrize(
    "region", [(10.0, 10.0, 0.0, 20.0), (20.0, 10.0, 0.0, 20.0), (0.0, 10.0, 20.0, 0.0), (0.0, 95.0, 0.0, 20.0), (0.0, 2.0, 0.0, 2.0)]
)
def test_empty_regions_are_refused(region: tuple[float, float, float, float]) -> None:
    with pytest.raises(InputError):
        maps.Grid.degrees(5.0, region)


@pytest.mark.parametrize(
    ("kind", "options", "named"),
    [
        ("moon", {}, "dop, raim"),
        ("dop", {"service": "lpv-200"}, "dop takes constellation"),
        ("dop", {"limits": {"hpl_m": 3.0}}, "pdop, hdop"),
        ("dop", {"limits": {"pdop": -1.0}}, "pdop"),
        ("dop", {"level": "APV-I"}, "dop gives"),
        ("dop", {"level": "LPV-999"}, "LPV-200"),
        ("dop", {"constellation": ()}, "constellation"),
        ("dop", {"constellation": ("sirius",)}, "sirius"),
        ("dop", {"mask_rad": 2.0}, "mask_rad"),
        ("dop", {"h_m": math.nan}, "h_m"),
        ("dop", {"without": ("G01", "X99")}, "X99"),
        ("dop", {"times": Times(start_ns=0)}, "no date"),
        ("araim", {"service": "lpv-9"}, "lpv-200"),
        ("sbas", {}, "message log"),
        ("dme", {"fte_m": 5_000.0}, "fte"),
    ],
)
def test_wrong_calls_are_sentences(kind: str, options: dict[str, object], named: str) -> None:
    with pytest.raises(InputError, match=named):
        maps.make(kind, grid=COARSE, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("wrong", [{"step_s": 0.0}, {"step_s": math.nan}, {"duration_s": 10.0}, {"duration_s": 1e12}])
def test_times_outside_their_domain_are_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(InputError):
        Times(**wrong)  # type: ignore[arg-type]


def test_an_almanac_serves_its_own_week_only(shared_data: Path) -> None:
    almanac = shared_data / "gnss" / "almanacs" / "20160331.alm"
    day = gps_ns(datetime.fromisoformat("2016-04-02T00:00+00:00"))
    times = Times(start_ns=day, duration_s=7_200.0, step_s=3_600.0)
    made = maps.make("dop", grid=COARSE, constellation=(almanac,), times=times)
    assert made.record.inputs.keys() == {str(almanac)}
    for off_days in (-30, 30, 400):
        with pytest.raises(InputError, match="within a week of the almanac"):
            maps.make("dop", grid=COARSE, constellation=(almanac,), times=Times(start_ns=day + off_days * 86_400 * 10**9))
    with pytest.raises(InputError, match="one reference instant"):
        maps.make("dop", grid=COARSE, constellation=("galileo", almanac), times=times)


def test_broadcast_orbits_stand_where_the_receiver_saw_them(shared_data: Path) -> None:
    folder = shared_data / "gnss" / "ESBC_2020_177"
    noon = gps_ns(datetime.fromisoformat("2020-06-25T12:00+00:00"))
    orbits = gnss.constellation(folder / "ESBC00DNK_R_20201770000_01D_MN.rnx.gz", near_ns=noon)
    assert utc_text(orbits.reference_ns or 0) == "2020-06-25 12:00:00"
    seen = {s[0] for s in orbits.satellite}
    assert {"G", "E", "C"} <= seen
    precise = gnss.read_orbits(folder / "GRG0MGXFIN_20201770000_01D_15M_ORB.SP3.gz")
    gps = [k for k, name in enumerate(orbits.satellite) if name[0] == "G" and name in precise.satellites]
    assert len(gps) > 25
    lat, lon, h = 0.0, 0.0, 0.0
    az, el = gnss.directions(orbits, lat, lon, h, 0.0)
    for k in gps:
        x, y, z = precise.states(orbits.satellite[k], np.array([noon]))[0][0]
        east, north, up = y, z, x - 6_378_137.0
        # Elements without harmonics, an hour from their record: some kilometres at 20 000 km.
        assert abs(math.asin(up / math.hypot(east, north, up)) - el[k]) < 1e-3
        assert abs(math.remainder(math.atan2(east, north) - az[k], 2 * math.pi)) * math.cos(el[k]) < 1e-3
    with pytest.raises(InputError, match="within a day"):
        gnss.constellation(folder / "ESBC00DNK_R_20201770000_01D_MN.rnx.gz", near_ns=noon + 9 * 86_400 * 10**9)


def test_protection_levels_of_a_map_are_those_of_its_subject(shared_data: Path) -> None:
    from navbound import araim, dme, sbas  # noqa: PLC0415

    region = maps.Grid.degrees(10.0, (30.0, 40.0, 130.0, 150.0))
    lat, lon = region.points()
    made = maps.make("araim", grid=region, times=SIX_HOURS)
    computed = araim.predict(gnss.constellation("gps") + gnss.constellation("galileo"), lat, lon, 0.0, SIX_HOURS.offsets_s())
    assert made.points["vpl_p999_m"].to_list() == np.nan_to_num(computed.vpl_m, nan=np.inf).max(axis=0).tolist()
    made = maps.make("raim", grid=region, times=SIX_HOURS)
    computed = araim.predict(gnss.constellation("gps"), lat, lon, 0.0, SIX_HOURS.offsets_s(), service="raim", model="single-frequency")
    assert made.points["p_available"].to_list() == (computed.hpl_m <= 556.0).mean(axis=0).tolist()
    made = maps.make("dme", grid=region)
    covered = dme.coverage(lat, lon, 6_000.0, dme.stations(), rnp_m=1852.0, fte_m=926.0, sigma_altitude_m=30.0)
    assert made.points["p_available"].to_list() == covered.supports_best.astype(float).tolist()
    assert made.summary.n_epochs == 1
    log, navigation = shared_data / "sbas" / "msas137_2025046_17h.ems", shared_data / "sbas" / "gps_2025046_17h_rinex3.nav"
    heard = sbas.read(log)
    times = Times(int(heard.time_ns.min()), duration_s=3_600.0, step_s=600.0)
    made = maps.make("sbas", grid=region, messages=log, navigation=(navigation,), mode="npa", times=times)
    instants = int(heard.time_ns.min()) + (times.offsets_s() * 1e9).astype(np.int64)
    levels = sbas.protection_levels(heard, navigation, instants[:, None], lat_rad=lat, lon_rad=lon, h_m=0.0, mode="npa")
    assert np.isfinite(levels.hpl_m).any(), "no level: this compares nothing"
    assert made.points["p_available"].to_list() == (levels.hpl_m <= 556.0).mean(axis=0).tolist()
    assert made.record.inputs.keys() == {str(log), str(navigation)}
    with pytest.raises(InputError, match="time of the messages"):
        maps.make("sbas", grid=region, messages=log, navigation=(navigation,), times=Times(start_ns=0))


def test_the_command_writes_a_map_and_refuses_in_sentences(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    run = CliRunner().invoke(
        cli.app,
        [
            "map",
            "dop",
            "--step-deg",
            "20",
            "--region",
            "30,70,-20,40",
            "--hours",
            "3",
            "--every-s",
            "1800",
            "--limit",
            "pdop=3",
            "--out",
            str(tmp_path / "m"),
        ],
    )
    assert run.exit_code == 0, run.output
    assert "position dilution of precision of at most 3" in run.output.replace("\n", " ")
    assert pl.read_parquet(tmp_path / "m" / "map.parquet").height == 6
    for wrong in (["--step-deg", "0"], ["--region", "1,2"], ["--start", "yesterday"], ["--limit", "pdop"], ["--backend", "abacus"]):
        monkeypatch.setattr("sys.argv", ["navbound", "map", "dop", *wrong, "--out", str(tmp_path / "n")])
        with pytest.raises(SystemExit) as left:
            cli.main()
        assert left.value.code == exit_status.USAGE
        assert "Traceback" not in capsys.readouterr().err
