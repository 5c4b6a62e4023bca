"""The list of algorithms: one entry is enough for help, documentation, map, prediction, evaluation and report."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib import util
from pathlib import Path

import numpy as np
import polars as pl
import pytest
from typer.testing import CliRunner

import navbound
from navbound import InputError, algorithms, araim, gnss, maps, raim
from navbound.araim import listed
from navbound.cli.main import app
from navbound.errors import ConflictError
from navbound.maps.sources import Times
from navbound.methods import ProtectionMethod
from navbound.run.predict import Request, place, predict
from test_raim import day
from toy_algorithm import TOY, WORDS

TESTS = Path(__file__).parent
HOURS = Times(None, 4 * 3600.0, 600.0)


def test_a_toy_appears_in_help_and_in_the_list_of_methods() -> None:
    """Options state their choices when the command line is loaded, so the entry is there before it."""
    program = (
        "import toy_algorithm, navbound.algorithms as a\n"
        "with a.register(toy_algorithm.TOY):\n"
        "    from typer.testing import CliRunner\n"
        "    from navbound.cli.main import app\n"
        "    for words in (['map', '--help'], ['predict', '--help'], ['evaluate', '--help'], ['methods']):\n"
        "        print('toy' in CliRunner().invoke(app, words, terminal_width=200).output.lower())\n"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=TESTS, capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["True"] * 4


def test_a_toy_appears_in_the_documentation() -> None:
    spec = util.spec_from_file_location("docs_build", TESTS.parent / "docs" / "build.py")
    assert spec is not None
    assert spec.loader is not None
    build = util.module_from_spec(spec)
    spec.loader.exec_module(build)
    assert WORDS not in build.page()
    with algorithms.register(TOY):
        assert f"- assumes: {WORDS}" in build.page()


def test_a_toy_can_be_mapped(tmp_path: Path) -> None:
    grid = maps.Grid.degrees(30.0)
    raim = maps.make("raim", grid=grid, times=HOURS, model="single-frequency")
    with algorithms.register(TOY):
        toy = maps.make("toy", grid=grid, times=HOURS, out=tmp_path / "map", limits={"hpl_m": 1000.0})
    assert any(WORDS in words for words in toy.summary.assumptions)
    assert (tmp_path / "map" / "report.html").read_text(encoding="utf-8").count("Toy levels") > 0
    assert toy.points["hpl_p50_m"].median() > raim.points["hpl_p50_m"].median()  # type: ignore[operator]


def test_a_toy_can_be_predicted() -> None:
    with algorithms.register(TOY):
        result = predict(Request(["gps"], HOURS, ("RNP 0.3",), kind="toy"), [place("50,8")])
        printed = CliRunner().invoke(app, ["predict", "toy", "gps", "--at", "50,8", "--hours", "2", "--every-s", "600", "--json"])
    usual = predict(Request(["gps"], HOURS, ("RNP 0.3",)), [place("50,8")])
    assert result.kind == json.loads(printed.output)["kind"] == "toy"
    assert result.lines[0].p_exclusion is None
    assert result.lines[0].p_detection <= usual.lines[0].p_detection
    assert WORDS in result.assumptions


def test_a_toy_can_be_evaluated_and_stands_in_the_report(shared_data: Path, tmp_path: Path) -> None:
    observations, navigation, truth = day(shared_data)
    arguments = {"levels": "NPA", "truth": ",".join(map(str, truth))}
    with algorithms.register(TOY):
        navbound.evaluate([observations, navigation], protection="toy", out=tmp_path / "toy", **arguments)  # type: ignore[arg-type]
    navbound.evaluate([observations, navigation], protection="raim", out=tmp_path / "raim", **arguments)  # type: ignore[arg-type]
    assert WORDS in (tmp_path / "toy" / "report.html").read_text(encoding="utf-8")
    doubled, usual = (pl.read_parquet(tmp_path / run / "epochs.parquet")["hpl_m"].to_numpy() for run in ("toy", "raim"))
    assert np.isfinite(usual).sum() > 2800
    np.testing.assert_array_equal(doubled, 2.0 * usual)


def test_a_taken_id_or_name_is_refused_and_the_session_forgets() -> None:
    with algorithms.register(TOY), pytest.raises(InputError, match="an id beside"), algorithms.register(TOY):
        pass
    assert "toy" not in algorithms.algorithms()
    with pytest.raises(InputError, match="protection = toy: no algorithm"):
        algorithms.entry(algorithms.Recorded, "protection", "toy")


def test_every_entry_belongs_to_an_algorithm_of_the_core_and_can_be_called() -> None:
    for algorithm in algorithms.algorithms().values():
        for one in algorithm.entries:
            assert callable(algorithms._loaded(one.call)), one.name
            if isinstance(one, algorithms.Place):
                assert one.words("single-frequency")
    assert set(algorithms._FUNCTIONS) <= set(algorithms.algorithms())


def test_an_algorithm_of_orbits_needs_no_entry_in_python(monkeypatch: pytest.MonkeyPatch) -> None:
    """The core's line is enough for help, map and prediction; what a service corrects needs its messages."""
    monkeypatch.setattr(algorithms, "_FUNCTIONS", {})
    assert {"raim-slope", "raim-separation", "araim"} <= set(listed.known())
    assert set(listed.known()) == set(algorithms.entries(algorithms.Place)) == set(algorithms.entries(algorithms.Grid))
    assert not {"sbas", "gbas", "error-extraction"} & set(listed.known())
    made = maps.make("raim-separation", grid=maps.Grid.degrees(45.0), times=HOURS, limits={"hpl_m": 1000.0})
    assert made.points["hpl_p50_m"].is_finite().all()
    result = predict(Request(["gps"], HOURS, ("RNP 0.3",), kind="raim-separation"), [place("50,8")])
    assert result.kind == "raim-separation"
    assert any("RAIM by solution separation" in words for words in result.assumptions)


def test_levels_by_id_are_those_of_the_function_of_the_family() -> None:
    sky = (gnss.constellation("gps") + gnss.constellation("galileo"), [0.9, -0.2], [0.1, 2.0], 0.0, HOURS.offsets_s())
    slope, usual = listed.predict(*sky, algorithm="raim-slope"), raim.predict(*sky)
    for name in ("hpl_m", "vpl_m", "n_sv", "status"):
        np.testing.assert_array_equal(getattr(slope, name), getattr(usual, name))
    np.testing.assert_array_equal(slope.beside["hpl_slope_m"], usual.hpl_slope_m)
    by_id, own = listed.predict(*sky, algorithm="araim", model="dual-frequency"), araim.predict(*sky)
    for name in ("hpl_m", "vpl_m", "n_sv", "status"):
        np.testing.assert_array_equal(getattr(by_id, name), getattr(own, name))
    np.testing.assert_array_equal(by_id.beside["emt_m"], own.emt_m)
    assert np.isfinite(own.vpl_m).any()
    with pytest.raises(InputError, match="algorithm = gbas: no algorithm of orbits"):
        listed.predict(*sky, algorithm="gbas")


def test_a_service_of_messages_is_mapped_by_its_entry(shared_data: Path) -> None:
    """SBAS has no map of its own: what takes messages is mapped as it is."""
    folder = shared_data / "sbas" / "more"
    files = {"messages": folder / "prn137_2025046_17h.ems.gz", "navigation": (folder / "gps_2025046_17h.25N",)}
    work = {"grid": maps.Grid.degrees(5.0, (30.0, 40.0, 130.0, 140.0)), "times": Times(None, 600.0, 300.0), "mode": "npa", **files}
    declared = ProtectionMethod("toy-service", "Toy", "toy_algorithm.sent", "a test", "yours", "nothing", WORDS, integrity=False)
    toy = algorithms.Sent(name="toy-service", call="toy_algorithm.sent", title="Toy service", columns=(algorithms.HPL,))
    usual = maps.make("sbas", **work)  # type: ignore[arg-type]
    with algorithms.register(algorithms.Algorithm(declared, (toy,))):
        doubled = maps.make("toy-service", limits={"hpl_m": 100.0}, **work)  # type: ignore[arg-type]
    assert usual.points["hpl_p50_m"].is_finite().all()
    np.testing.assert_array_equal(doubled.points["hpl_p50_m"], 2.0 * usual.points["hpl_p50_m"])
    assert "vpl_p50_m" not in doubled.points.columns
    with (
        pytest.raises(ConflictError, match="toy-service takes the levels of a message log"),
        algorithms.register(algorithms.Algorithm(declared, (toy,))),
    ):
        maps.make("toy-service", grid=work["grid"])  # type: ignore[arg-type]
