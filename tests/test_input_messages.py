"""Input that belongs together and does not fit, and options that go with each other: taken, or refused in one sentence."""

from __future__ import annotations

import gzip
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

import navbound
import rinex_fixture
from navbound import InputError, gnss
from navbound.read.truth import TOLERANCE_S


@pytest.fixture(scope="module")
def folder(shared_data: Path) -> Path:
    return shared_data / "gnss" / "taroz_static"


@pytest.fixture(scope="module")
def place(folder: Path) -> str:
    """The surveyed point, as it is typed."""
    lat, lon, h = (float(v) for v in (folder / "rover_position.txt").read_text().split())
    a, e2 = 6378137.0, 6.69437999014e-3
    lat, lon = np.radians(lat), np.radians(lon)
    n = a / np.sqrt(1 - e2 * np.sin(lat) ** 2)
    x, y, z = (n + h) * np.cos(lat) * np.cos(lon), (n + h) * np.cos(lat) * np.sin(lon), (n * (1 - e2) + h) * np.sin(lat)
    return f"{x:.3f},{y:.3f},{z:.3f}"


@pytest.fixture(scope="module")
def minute(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The first minute of the rover with two frequencies of GPS."""
    path = tmp_path_factory.mktemp("minute") / "minute.rnx"
    observations = gnss.read_observations(folder / "rover.obs.gz")
    rinex_fixture.write(observations, path, {"G": ["C1C", "L1C", "S1C", "C2W", "L2W", "S2W"]}, until_s=60.0)
    return path


def command(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "navbound", *map(str, arguments)], capture_output=True, text=True, check=False)


def test_a_fixed_point_is_truth_for_solved_positions_too(folder: Path, place: str, minute: Path) -> None:
    run = navbound.analyze([minute, folder / "base.nav"], truth=place)
    verdict = run.summary.verdict
    assert verdict.truth_known
    assert verdict.n_truth == run.epochs.height
    # A receiver in the open: metres, not kilometres, from its surveyed point.
    assert 0.0 < float(np.hypot(run.epochs["nse_e_m"], run.epochs["nse_n_m"]).max()) < 20.0
    assert any("fixed point" in words for words in run.summary.assumptions)


def test_navigation_of_another_day_is_named_with_both_dates(folder: Path, minute: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.nav"
    other.write_bytes(gzip.decompress(next(folder.parent.rglob("ESBC00DNK_R_20201770000_01D_MN.rnx.gz")).read_bytes()))
    kinds: tuple[dict[str, Any], ...] = ({}, {"levels": "NPA"}, {"levels": "NPA", "protection": "raim"})
    for more in kinds:
        with pytest.raises(InputError, match=r"ephemerides of 2020-06-2[45] to 2020-06-2[56] for observations of 2024-06-24"):
            (navbound.evaluate if more else navbound.analyze)([minute, other], **more)


@pytest.mark.parametrize("protection", ["raim", "araim"])
def test_a_monitor_takes_signals_and_systems(folder: Path, minute: Path, tmp_path: Path, protection: str) -> None:
    out = tmp_path / "run"
    done = command(
        "evaluate",
        minute,
        folder / "base.nav",
        "--levels",
        "NPA",
        "--protection",
        protection,
        "--signals",
        "dual",
        "--systems",
        "G",
        "--out",
        out,
    )
    assert done.returncode in {0, 4}, done.stderr
    words = " ".join(done.stdout.split())
    assert "ionosphere-free" in words or "dual" in words
    single = command(
        "evaluate", minute, folder / "base.nav", "--levels", "NPA", "--protection", protection, "--signals", "auto", "--out", out
    )
    assert single.returncode == 2
    assert "single or dual with --protection" in " ".join(single.stderr.split())


def test_the_tolerance_of_truth_is_one_number() -> None:
    shown = " ".join(command("analyze", "--help").stdout.replace("│", " ").split())
    assert f"[default: {TOLERANCE_S:g}]" in shown
    page = (Path(__file__).parents[1] / "docs" / "methods" / "recorded-tracks.md").read_text(encoding="utf-8")
    assert f"within {TOLERANCE_S:g} s" in page


# Tables of errors and levels.


def levels(path: Path, n: int = 200, **columns: object) -> Path:
    rng = np.random.default_rng(5)
    table = {"gps_time_s": 1.4e9 + np.arange(n), "hpe": np.abs(rng.normal(size=n)), "hpl": np.full(n, 12.0), "vpl": np.full(n, 15.0)}
    pl.DataFrame(table | columns).select(pl.exclude("none")).write_csv(path)
    return path


def test_a_level_whose_vertical_errors_are_unknown_says_so(tmp_path: Path) -> None:
    verdict = navbound.evaluate(levels(tmp_path / "a.csv"), levels="LPV-200").summary.verdict
    assert verdict.id == "not_shown"
    assert "The vertical was not judged: no vertical error is known." in verdict.words
    both = navbound.evaluate(levels(tmp_path / "b.csv", vpe=np.full(200, 0.5)), levels="LPV-200").summary.verdict
    assert both.id == "inside"
    assert "not judged" not in both.words
    lateral = navbound.evaluate(levels(tmp_path / "c.csv"), levels="NPA").summary.verdict
    assert (lateral.id, "not judged" in lateral.words) == ("inside", False)


def test_errors_at_few_epochs_show_nothing_of_the_others(tmp_path: Path) -> None:
    few = [0.5 if k < 20 else None for k in range(200)]
    verdict = navbound.evaluate(levels(tmp_path / "a.csv", hpe=few), levels="NPA").summary.verdict
    assert verdict.id == "not_shown"
    assert "Errors are known: horizontal at 20 of 200 epochs with a protection level (10.0 %)." in verdict.words


def test_sizes_of_errors_stand_in_the_epochs(tmp_path: Path) -> None:
    n = 50
    east, up = np.full(n, 3.0), np.full(n, -2.0)
    path = levels(tmp_path / "a.csv", n, hpe=None, nse_e_m=east, nse_n_m=np.full(n, 4.0), nse_u_m=up)
    navbound.evaluate(path, levels="NPA", out=tmp_path / "run")
    epochs = pl.read_parquet(tmp_path / "run" / "epochs.parquet")
    assert (set(epochs["hpe_m"]), set(epochs["vpe_m"])) == ({5.0}, {2.0})


def test_truth_columns_of_a_level_table_are_used_or_named(tmp_path: Path) -> None:
    n = 60
    # 1e-5 degrees of latitude are 1.1 m.
    places = {"lat": np.full(n, 48.0), "lon": np.full(n, 2.0), "truth_lat": np.full(n, 48.00001), "truth_lon": np.full(n, 2.0)}
    used = navbound.evaluate(levels(tmp_path / "a.csv", n, hpe=None, **places), levels="NPA")
    assert used.epochs["hpe_m"].to_list() == pytest.approx([1.11] * n, abs=0.01)
    stated = navbound.evaluate(levels(tmp_path / "b.csv", n, **places), levels="NPA").summary.assumptions
    assert any("the error of an epoch is the larger of what the table states (hpe_m) and of its true positions" in s for s in stated)
    alone = {name: places[name] for name in ("truth_lat", "truth_lon")}
    words = navbound.evaluate(levels(tmp_path / "c.csv", n, hpe=None, **alone), levels="NPA").summary.assumptions
    assert any("are not used: the table holds no estimated positions" in s for s in words)
    other = navbound.evaluate(levels(tmp_path / "d.csv", n, mystery=np.zeros(n)), levels="NPA").summary.assumptions
    assert any("columns not used: mystery" in s for s in other)


def test_a_smooth_error_is_few_independent_epochs(tmp_path: Path) -> None:
    """A day of 30 s epochs whose errors swing once in twelve hours, with levels that are noise: two swings are no 2880 draws."""
    n = 2880
    t = 30.0 * np.arange(n)
    rng = np.random.default_rng(8)
    noise = {"gps_time_s": 1.4e9 + t, "hpl": 20 + rng.random(n), "vpl": 25 + rng.random(n)}

    def independent(error: np.ndarray[Any, Any]) -> float:
        run = navbound.evaluate(levels(tmp_path / "a.csv", n, hpe=error, **noise), levels="NPA")
        assert run.summary.performance is not None
        (level,) = run.summary.performance.levels
        return level.n_effective

    assert independent(1.5 + np.sin(2 * np.pi * t / 43_200.0)) < 40.0
    # The levels alone are worth nearly all epochs, and so are errors that are noise: the estimate is within a factor of 1.5 (test_kpi.py).
    assert independent(1.0 + rng.random(n)) > n / 1.5
