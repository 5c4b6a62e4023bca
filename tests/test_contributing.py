"""CONTRIBUTING.md runs: every example works as it stands, in a process of its own; those in Rust are documentation tests of the core."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from navbound import verify

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
WEB = ROOT / "web"
LISTS = ("A method", "A protection level", "A format", "A column", "A chart", "A study", "A scenario")
PREAMBLE = """
import sys
import navbound, navbound.read, navbound.studies
for package in (navbound.read, navbound.studies):
    package.__path__.append("/".join([sys.argv[1], "python", *package.__name__.split(".")]))
"""
"""Files of the examples lie beside those of the package, as if they had been added to it."""


def blocks(heading: str, language: str) -> dict[str, str]:
    """Examples of one section by the file that each stands for."""
    section = PAGE.split(f"### {heading}\n")[1].split("\n### ")[0].split("\n## ")[0]
    matches = re.findall(rf"```{language}\n(.*?)```", section, re.DOTALL)
    return {text.splitlines()[0].removeprefix("//").removeprefix("#").strip(): text for text in matches}


@pytest.mark.parametrize("heading", LISTS)
def test_every_list_has_an_example_for_files_that_exist(heading: str) -> None:
    section = PAGE.split(f"### {heading}\n")[1].split("\n### ")[0]
    assert "```" in section
    for path in re.findall(r"`((?:crates|python|web|docs|tests|fuzz)/[^`<]*)[`<]", section):
        assert (ROOT / path).exists(), path


def test_the_vector_file_of_the_page_is_met(tmp_path: Path) -> None:
    for name, text in blocks("A method", "toml").items():
        path = tmp_path / Path(name).name
        path.write_text(text, encoding="utf-8")
        outcome = verify.run(verify.load(path))
        assert outcome.checked == 1
        assert outcome.failures == []


@pytest.mark.parametrize("heading", ["A protection level", "A format", "A column", "A study", "A scenario"])
def test_the_python_of_the_page_runs(heading: str, tmp_path: Path) -> None:
    scripts = blocks(heading, "python")
    assert scripts
    for name, text in (scripts | blocks(heading, "toml")).items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    # What is there to be imported is imported by the last one.
    *_, last = scripts.values()
    assert "assert " in last
    done = subprocess.run(
        [sys.executable, "-c", PREAMBLE + last, str(tmp_path)], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.skipif(
    shutil.which("node") is None or not (WEB / "node_modules").is_dir(),
    reason="web/node_modules is missing: the chart was NOT type-checked",
)
def test_the_chart_of_the_page_passes_the_type_check(tmp_path: Path) -> None:
    ((name, text),) = blocks("A chart", "ts").items()
    folder = (ROOT / name).parent
    settings = {
        "extends": str(WEB / "tsconfig.json"),
        "compilerOptions": {"typeRoots": [str(WEB / "node_modules" / "@types")]},
        "files": ["chart.ts"],
    }
    (tmp_path / "tsconfig.json").write_text(json.dumps(settings), encoding="utf-8")
    placed = re.sub(r'from "(\.\.?/[^"]+)"', lambda result: f'from "{(folder / result.group(1)).resolve()}"', text)
    # A column that no report carries shows that the check looks at the columns.
    for column, passes in (("hdop", True), ("altitude_m", False)):
        (tmp_path / "chart.ts").write_text(placed.replace('column("hdop")', f'column("{column}")'), encoding="utf-8")
        tsc = [str(WEB / "node_modules" / ".bin" / "tsc"), "--noEmit", "-p", str(tmp_path)]
        done = subprocess.run(tsc, cwd=WEB, capture_output=True, text=True, check=False)
        assert (done.returncode == 0) is passes, done.stdout
        assert passes or "altitude_m" in done.stdout


def test_the_rust_of_the_page_is_a_documentation_test() -> None:
    text = (ROOT / "crates" / "core" / "src" / "lib.rs").read_text(encoding="utf-8")
    assert '#[cfg(doctest)]\n#[doc = include_str!("../../../CONTRIBUTING.md")]' in text
    assert all("assert" in code for heading in LISTS[:2] for code in blocks(heading, "rust").values())
