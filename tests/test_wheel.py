"""The wheel, installed into an empty environment: what a person gets who has neither the repository nor a compiler."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
UV = shutil.which("uv") or shutil.which("uv", path=ROOT / ".dev" / "uv" / "bin")
pytestmark = pytest.mark.skipif(UV is None, reason="uv is not installed: the wheel was NOT built and NOT tried")


def called(*command: str | Path, cwd: Path, status: int = 0) -> str:
    # Nothing of the repository may be found by the package that is tried.
    environment = {name: value for name, value in os.environ.items() if name not in {"PYTHONPATH", "VIRTUAL_ENV"}}
    done = subprocess.run(list(map(str, command)), cwd=cwd, env=environment, capture_output=True, text=True, check=False, timeout=1200)
    assert done.returncode == status, (command, done.returncode, done.stdout[-2000:], done.stderr[-4000:])
    return done.stdout


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the programs of an environment that holds the wheel and what it depends on, nothing else."""
    folder = tmp_path_factory.mktemp("wheel")
    called(UV or "uv", "build", "--quiet", "--wheel", "--out-dir", folder / "dist", ROOT, cwd=folder)
    (wheel,) = (folder / "dist").glob("*.whl")
    # Of every Python from 3.11.
    assert "-cp311-abi3-" in wheel.name
    called(UV or "uv", "venv", "--quiet", "--python", sys.executable, folder / "env", cwd=folder)
    programs = folder / "env" / ("Scripts" if sys.platform == "win32" else "bin")
    called(UV or "uv", "pip", "install", "--quiet", "--python", programs / "python", wheel, cwd=folder)
    return programs


def test_the_package_is_the_installed_one_and_brings_its_bill_of_materials(installed: Path, tmp_path: Path) -> None:
    place = Path(called(installed / "python", "-c", "import navbound; print(navbound.__file__)", cwd=tmp_path).strip())
    assert place.is_relative_to(installed.parent)
    packages = place.parents[1]
    (bill,) = packages.glob("navbound-*.dist-info/sboms/*.cyclonedx.json")
    assert '"nalgebra"' in bill.read_text(encoding="utf-8")
    assert called(installed / "navbound", "--version", cwd=tmp_path).startswith("navbound ")


def test_the_reference_vectors_are_met(installed: Path, tmp_path: Path) -> None:
    assert "tse-exact" in called(installed / "navbound", "verify", cwd=tmp_path)


def test_the_demonstration_runs_and_its_flight_is_judged_again_live(installed: Path, tmp_path: Path) -> None:
    assert "What to do next" in called(installed / "navbound", "demo", "--out", tmp_path / "demo", cwd=tmp_path)
    for run in ("interference", "quiet"):
        assert (tmp_path / "demo" / run / "report.html").stat().st_size > 100_000
    flight = tmp_path / "demo" / "interference"
    lines = called(installed / "navbound", "live", flight, "--speed", "100000", "--out", tmp_path / "live", cwd=tmp_path)
    assert "warning" in lines


def test_a_recording_is_analysed(installed: Path, tmp_path: Path) -> None:
    rows = [f"2026-11-22T12:{k // 60:02d}:{k % 60:02d}Z,{49 + k * 7e-4:.7f},2.5,100.0,8.0,8.0" for k in range(600)]
    (tmp_path / "track.csv").write_text("\n".join(["time,lat,lon,h_m,sigma_e_m,sigma_n_m", *rows]) + "\n")
    words = called(installed / "navbound", "analyze", tmp_path / "track.csv", "--spec", "RNP 0.3", "--out", tmp_path / "run", cwd=tmp_path)
    assert "inside RNP 0.3" in words
    assert (tmp_path / "run" / "report.html").is_file()
