"""A run on maps of other programs: every position is where it was, states are distinguished, and hostile names stay text."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree as ET

import numpy as np
import polars as pl
import pytest

import navbound
from navbound import read, write
from navbound.cli import main as cli
from navbound.errors import FormatError, InputError
from navbound.records.run import Waypoint

if TYPE_CHECKING:
    from pathlib import Path

    from navbound.run.directory import Run

KML = "{http://www.opengis.net/kml/2.2}"


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return navbound.fly("beijing-shanghai-misled", out=tmp_path_factory.mktemp("run") / "out")


def features(path: Path) -> list[dict[str, Any]]:
    whole = json.loads(path.read_text(encoding="utf-8"))
    assert whole["type"] == "FeatureCollection"
    return list(whole["features"])


def test_lines_hold_every_position_and_events_stand_on_them(run: Run, tmp_path: Path) -> None:
    made = write.shapes(run.epochs, events=run.events, waypoints=run.waypoints)
    lines = [f for f in features(write.geojson(made, tmp_path / "a.geojson")) if f["properties"]["what"] == "track"]
    # A line ends where the next begins.
    places = [tuple(p) for k, line in enumerate(lines) for p in line["geometry"]["coordinates"][(0 if k == 0 else 1) :]]
    epochs = run.epochs
    expected = np.degrees(epochs.select("est_lon_rad", "est_lat_rad").to_numpy())
    np.testing.assert_allclose(np.array(places)[:, :2], expected, atol=6e-10)
    np.testing.assert_allclose(np.array(places)[:, 2], epochs["est_h_m"].to_numpy(), atol=6e-5)
    changes = int((epochs["alert"] != epochs["alert"].shift()).sum())
    assert len(lines) == changes + 1
    assert {line["properties"]["state"] for line in lines} == set(epochs["alert"].unique())
    points = [f for f in features(tmp_path / "a.geojson") if f["properties"]["what"] == "event"]
    assert len(points) == run.events.height > 0
    for point in points:
        assert tuple(point["geometry"]["coordinates"]) in {p[:2] for p in places}


def test_what_is_not_judged_is_a_line_of_its_own() -> None:
    epochs = pl.DataFrame(
        {
            "track": ["A"] * 6,
            "time_ns": [10**18 + k * 10**9 for k in range(6)],
            "est_lat_rad": [0.1, 0.11, None, 0.13, 0.14, 0.15],
            "est_lon_rad": [0.2] * 6,
            "status": ["ok", "ok", "not_available", "invalid_input", "invalid_input", "ok"],
        }
    )
    made = write.shapes(epochs)
    assert [(s.properties["state"], len(s.places)) for s in made] == [("normal", 3), ("not judged", 3)]


def test_nothing_joins_epochs_between_which_nothing_is_known() -> None:
    """A line went on through 35 losses of monitoring, the longest of 69 s."""
    second = [0, 1, 2, 3, 30, 60, 61, 62, 90]
    epochs = pl.DataFrame(
        {
            "track": ["a"] * len(second),
            "time_ns": [1_400_000_000_000_000_000 + k * 1_000_000_000 for k in second],
            "est_lat_rad": [0.8 + 1e-5 * k for k in second],
            "est_lon_rad": [0.1] * len(second),
        }
    )
    made = write.shapes(epochs)
    assert [(each.kind, len(each.places)) for each in made] == [("LineString", 4), ("Point", 1), ("LineString", 3), ("Point", 1)]
    assert sum(len(each.places) for each in made) == len(second)


def test_a_track_across_the_date_line_is_cut_on_it(tmp_path: Path) -> None:
    lon = np.radians([179.0, 179.6, -179.8, -179.0])
    epochs = pl.DataFrame(
        {"track": ["A"] * 4, "time_ns": [10**18 + k for k in range(4)], "est_lat_rad": [0.0, 0.01, 0.02, 0.03], "est_lon_rad": lon}
    )
    first, second = (f["geometry"]["coordinates"] for f in features(write.geojson(write.shapes(epochs), tmp_path / "a.geojson")))
    assert [p[0] for p in first] == pytest.approx([179.0, 179.6, 180.0])
    assert [p[0] for p in second] == pytest.approx([-180.0, -179.8, -179.0])
    # 0.4 of 0.6 degrees lie before the line.
    assert first[-1][1] == pytest.approx(math.degrees(0.01 + 0.01 * 0.4 / 0.6), abs=1e-9)
    assert first[-1][1] == second[0][1]


def test_an_ellipse_holds_the_share_that_it_states(tmp_path: Path) -> None:
    """Its points are 2.4477 deviations away, chi-square of two at 95 %; closed, against the clock, as RFC 7946 requires."""
    epochs = pl.DataFrame(
        {
            "track": ["A"] * 3,
            "time_ns": [10**18 + k * 10**9 for k in range(3)],
            "est_lat_rad": [0.85] * 3,
            "est_lon_rad": [0.05] * 3,
            "cov_ee_m2": [90_000.0, 90_000.0, math.nan],
            "cov_en_m2": [10_000.0] * 3,
            "cov_nn_m2": [40_000.0] * 3,
        }
    )
    polygons = [s for s in write.shapes(epochs, ellipse_every_s=1.0) if s.kind == "Polygon"]
    assert len(polygons) == 2
    ring = np.radians(np.array(polygons[0].places))
    assert polygons[0].places[0] == polygons[0].places[-1]
    off = np.stack([(ring[:, 0] - 0.05) * 6_371_000 * math.cos(0.85), (ring[:, 1] - 0.85) * 6_371_000], -1)
    squared = np.einsum("ki,ij,kj->k", off, np.linalg.inv(np.array([[90_000.0, 10_000.0], [10_000.0, 40_000.0]])), off)
    # Nine decimals of a degree are 0.1 mm of some hundred metres.
    np.testing.assert_allclose(squared, 5.991464547107979, rtol=1e-5)
    (x0, y0), (x1, y1) = off[:-1].T, off[1:].T
    assert (x0 * y1 - x1 * y0 > 0).all()
    path = write.geojson(polygons, tmp_path / "a.geojson")
    assert features(path)[0]["geometry"]["coordinates"][0][0] == polygons[0].places[0]


def test_kml_says_the_same_and_hostile_names_stay_text(tmp_path: Path) -> None:
    name = '<b>"&\u202e\x07'
    epochs = pl.DataFrame({"track": [name] * 2, "time_ns": [10**18, 10**18 + 1], "est_lat_rad": [0.1, 0.2], "est_lon_rad": [0.3, 0.4]})
    made = write.shapes(epochs, waypoints=[Waypoint(name=name, lat_rad=0.1, lon_rad=0.3, kind="waypoint")])
    root = ET.fromstring(write.kml(made, tmp_path / "a.kml").read_text(encoding="utf-8"))
    marks = root.findall(f".//{KML}Placemark")
    assert [mark.findtext(f"{KML}name") for mark in marks] == ['<b>"&', '<b>"&']
    (line,) = root.findall(f".//{KML}LineString/{KML}coordinates")
    assert line.text is not None
    places = np.array([[float(v) for v in place.split(",")] for place in line.text.split()])
    np.testing.assert_allclose(places, np.degrees([[0.3, 0.1], [0.4, 0.2]]), atol=1e-9)
    styles = {f"#{style.get('id')}" for style in root.findall(f".//{KML}Style")}
    assert {mark.findtext(f"{KML}styleUrl") for mark in marks} <= styles


def test_the_command_writes_each_kind_and_refuses_others(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def navbound_(*arguments: object) -> int:
        monkeypatch.setattr("sys.argv", ["navbound", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        return int(ended.value.code or 0)

    assert run.path is not None
    assert navbound_("export", run.path, tmp_path / "a.geojson", "--ellipse-every-s", 600) == 0
    whats = {f["properties"]["what"] for f in features(tmp_path / "a.geojson")}
    assert whats == {"track", "path", "event", "ellipse"}
    assert navbound_("export", run.path, tmp_path / "a.kml") == 0
    assert navbound_("export", run.path, tmp_path / "a.pos") == 0
    assert read.read(tmp_path / "a.pos").epochs.height == run.epochs.height
    capsys.readouterr()
    for arguments, status, words in (
        ((run.path, tmp_path / "a.gpx"), 2, ".geojson, .kml or .pos"),
        ((run.path, tmp_path / "b.kml", "--track", "none"), 2, "flight-000"),
        ((run.path, tmp_path / "b.kml", "--ellipse-every-s", 0), 2, "(0, inf)"),
        ((tmp_path, tmp_path / "b.kml"), 3, "run directory"),
        ((run.path, tmp_path / "none" / "b.kml"), 3, "cannot be written"),
    ):
        assert navbound_("export", *arguments) == status
        assert words in capsys.readouterr().err
    assert not (tmp_path / "b.kml").exists()


def test_tables_that_have_no_place_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="est_lat_rad"):
        write.shapes(pl.DataFrame({"track": ["A"], "time_ns": [1]}))
    with pytest.raises(FormatError, match="cannot be written"):
        write.geojson([], tmp_path / "none" / "a.geojson")
