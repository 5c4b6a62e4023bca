"""The shipped table of stations, the restated one of Ukraine, and what is refused in a user's own."""

from __future__ import annotations

import csv
import gzip
import io
from pathlib import Path

import numpy as np
import pytest

from navbound import FormatError, InputError, dme
from navbound.studies.ukraine_rnav.flight import network

SHARED = Path(__file__).parents[2] / "shared" / "data"
SOURCE = SHARED / "infra" / "navaids" / "ourairports_navaids.csv.gz"
RESTATED = SHARED / "infra" / "ukraine" / "vhf_navaids_cai2207.csv"
SHIPPED = Path(__file__).parents[1] / "python" / "navbound" / "data" / "stations.csv.gz"

HEAD = (
    "# DME stations (VOR-DME, VORTAC, DME, TACAN, NDB-DME). Source: OurAirports, navaids.csv, repository davidmegginson/ourairports-data, "
    "commit 1fb3eea; public domain (Unlicense).\n# Reduced for navbound: see README.md beside this file.\n"
)
COLUMNS = ["ident", "country", "kind", "lat_deg", "lon_deg", "elevation_ft", "frequency_khz", "power"]


def reduced(text: str) -> str:
    """The shipped table, made again from its source as python/navbound/data/README.md says."""
    rows = []
    for row in csv.DictReader(io.StringIO(text)):
        elevation = row["dme_elevation_ft"] or row["elevation_ft"]
        if row["type"] not in {"VOR-DME", "VORTAC", "DME", "TACAN", "NDB-DME"} or not elevation:
            continue
        own = "dme_" if row["dme_latitude_deg"] and row["dme_longitude_deg"] else ""
        lat, lon = (f"{float(row[f'{own}{axis}_deg']):.5f}" for axis in ("latitude", "longitude"))
        frequency = row["dme_frequency_khz"] or row["frequency_khz"]
        rows.append((row["ident"], row["iso_country"], row["type"], lat, lon, elevation, frequency, row["power"]))
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(sorted(rows))
    return HEAD + out.getvalue()


@pytest.mark.skipif(not SOURCE.exists(), reason="the source table is not at hand")
def test_the_shipped_table_is_the_reduction_of_its_source() -> None:
    assert gzip.decompress(SHIPPED.read_bytes()).decode() == reduced(gzip.decompress(SOURCE.read_bytes()).decode())


def test_the_shipped_table_says_where_it_comes_from_and_is_whole() -> None:
    text = gzip.decompress(SHIPPED.read_bytes()).decode()
    assert text.startswith(HEAD)
    world = dme.stations()
    # The count of python/navbound/data/README.md.
    assert len(world) == 4077
    assert len(set(zip(world.ident, world.country, world.kind, world.lat_rad.tolist(), strict=True))) == 4077
    for numbers in (world.lat_rad, world.lon_rad, world.h_m, world.service_m):
        assert np.isfinite(numbers).all()
    assert set(world.kind) == {"VOR-DME", "VORTAC", "DME", "TACAN", "NDB-DME"}


def test_a_known_station_stands_where_it_is_published() -> None:
    """Boryspil, published 50 17 08.5 N 030 54 03.5 E: the README says off by 120 m."""
    here = dme.stations().near(np.radians(50.2857), np.radians(30.9010), 500.0)
    assert here.ident == ("BRP",)
    assert here.bearing.tolist() == [True]
    assert dme.SERVICE_NM["HIGH"] * 1852 == here.service_m[0]


@pytest.mark.skipif(not RESTATED.exists(), reason="the source table is not at hand")
def test_the_stations_of_ukraine_are_those_of_the_source() -> None:
    """Every en-route DME (second letter of the class D, no ILS), to the digits of the source."""
    with RESTATED.open(encoding="utf-8") as file:
        source = {row["ident"]: row for row in csv.DictReader(file) if row["class"][1] == "D"}
    ours = network()
    assert set(ours.ident) == set(source)
    ranges = {"L": 40.0, "H": 130.0}
    for k, ident in enumerate(ours.ident):
        row = source[ident]
        assert np.degrees(ours.lat_rad[k]) == pytest.approx(float(row["dme_lat"]), abs=1e-9)
        assert np.degrees(ours.lon_rad[k]) == pytest.approx(float(row["dme_lon"]), abs=1e-9)
        assert ours.h_m[k] == pytest.approx(0.3048 * float(row["dme_elev_ft"]), abs=1e-9)
        assert ours.frequency_khz[k] == 10 * float(row["freq"])
        assert ours.bearing[k] == (row["class"][0] == "V")
        assert ours.service_m[k] == 1852 * ranges.get(row["class"][2], np.inf)


GOOD = "ident,kind,lat_deg,lon_deg,elevation_ft,service_nm\nAAA,DME,50.0,31.0,400,130\nBBB,VOR-DME,49.5,30.0,380,\n"


def read(folder: Path, text: str) -> dme.Stations:
    file = folder / "stations.csv"
    file.write_text(text, encoding="utf-8")
    return dme.read_stations(file)


def test_a_table_of_ones_own(tmp_path: Path) -> None:
    reading = read(tmp_path, "# a comment\n" + GOOD)
    assert reading.ident == ("AAA", "BBB")
    assert reading.service_m.tolist() == [130 * 1852.0, np.inf]
    assert reading.without("AAA").ident == ("BBB",)
    assert reading.only("AAA").ident == ("AAA",)
    packed = tmp_path / "stations.csv.gz"
    packed.write_bytes(gzip.compress(GOOD.encode()))
    assert dme.read_stations(packed).ident == reading.ident
    with pytest.raises(InputError, match="'CCC'"):
        reading.without("CCC")
    with pytest.raises(InputError, match="distance_m"):
        reading.near(0.8, 0.5, float("nan"))


@pytest.mark.parametrize(
    ("old", "new", "line", "field"),
    [
        ("50.0,31.0,400", ",31.0,400", 2, "lat_deg"),
        ("50.0,31.0", "nan,31.0", 2, "lat_deg"),
        ("50.0,31.0", "90.1,31.0", 2, "lat_deg"),
        ("50.0,31.0", "50.0,181", 2, "lon_deg"),
        ("50.0,31.0", "50.0,east", 2, "lon_deg"),
        (",400,", ",inf,", 2, "elevation_ft"),
        (",400,130", ",400,-1", 2, "service_nm"),
        ("BBB,VOR-DME", "AAA,VOR-DME", 3, "ident"),
        ("BBB,VOR-DME", ",VOR-DME", 3, "ident"),
        ("BBB,VOR-DME", "BBB,ILS", 3, "kind"),
        (",380,", ",380", 3, None),
        ("lat_deg,lon_deg", "lat,lon_deg", 1, "lat_deg"),
        ("service_nm", "range_nm", 1, "range_nm"),
    ],
)
def test_a_wrong_field_is_named_with_its_line(tmp_path: Path, old: str, new: str, line: int, field: str | None) -> None:
    assert old in GOOD
    with pytest.raises(FormatError) as refused:
        read(tmp_path, GOOD.replace(old, new))
    assert (refused.value.line, refused.value.field) == (line, field)


@pytest.mark.parametrize("text", ["", "# nothing\n", GOOD.splitlines()[0]])
def test_an_empty_table_is_refused(tmp_path: Path, text: str) -> None:
    with pytest.raises(FormatError, match="holds no"):
        read(tmp_path, text)


def test_what_is_no_text_and_what_is_not_there(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_bytes(b"ident\xff\xfe")
    (tmp_path / "b.csv").write_bytes(gzip.compress(GOOD.encode())[:40])
    for name in ("a.csv", "b.csv", "missing.csv"):
        with pytest.raises(FormatError, match=name):
            dme.read_stations(tmp_path / name)
