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
from navbound import InputError, algorithms, maps
from navbound.cli.main import app
from navbound.maps.sources import Times
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
    assert set(algorithms._ENTRIES) <= set(algorithms.algorithms())
