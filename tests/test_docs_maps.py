"""The pages about maps and scaling out run: their commands are accepted and their program prints what they say."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from navbound.cli import main as cli

DOCS = Path(__file__).parents[1] / "docs"


def test_the_program_of_the_page_prints_what_it_says(tmp_path: Path) -> None:
    pytest.importorskip("distributed", reason="SKIPPED ALOUD: Dask is not installed")
    page = (DOCS / "scale-out.md").read_text(encoding="utf-8")
    match = re.search(r"```python\n(.*?)```\n\nprints\n\n    (.*)\n", page, re.S)
    assert match
    program = tmp_path / "program.py"
    program.write_text(match.group(1), encoding="utf-8")
    done = subprocess.run([sys.executable, str(program)], capture_output=True, text=True, check=True, timeout=120.0)
    assert done.stdout.strip() == match.group(2).strip()


def commands(page: str) -> list[list[str]]:
    """Every command of a page."""
    lines = (DOCS / page).read_text(encoding="utf-8").splitlines()
    return [shlex.split(line, comments=True)[1:] for line in lines if line.startswith("    navbound map ")]


@pytest.mark.parametrize("page", ["methods/maps.md", "scale-out.md"])
def test_the_commands_of_the_page_make_maps(page: str, shared_data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each as printed, but on a coarse grid, in this process, and with files of ours for those that a reader would have."""
    monkeypatch.chdir(tmp_path)
    sbas, almanac = shared_data / "sbas" / "more", shared_data / "gnss" / "almanacs" / "20160331.alm"
    ours = {
        "current.al3": str(almanac),
        "2026-11-21T00:00": "2016-04-02T00:00",
        "day.ems": str(sbas / "prn137_2025046_17h.ems.gz"),
        "brdc.rnx": str(sbas / "gps_2025046_17h.25N"),
    }
    listed = commands(page)
    assert listed
    for number, words in enumerate(listed):
        # The stations of dme know no time.
        seldom = [] if "dme" in words else ["--every-s", "1200"]
        coarse = ["--step-deg", "15", *seldom, "--backend", "serial", "--out", f"map-{number}", "--json"]
        # A cluster belongs to Dask, which is not used here.
        at = words.index("--cluster") if "--cluster" in words else len(words)
        run = CliRunner().invoke(cli.app, [ours.get(word, word) for word in words[:at] + words[at + 2 :]] + coarse)
        assert run.exit_code == 0, (words, run.output, run.exception)
        assert (tmp_path / f"map-{number}" / "report.html").exists()
