"""The page about procedures runs: its program prints what it says, and its commands are accepted."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from navbound import _core
from navbound.cli.main import app

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "methods" / "procedures.md").read_text(encoding="utf-8")


def test_the_program_of_the_page_prints_what_it_says(tmp_path: Path) -> None:
    match = re.search(r"```python\n(.*?)```\n\nprints\n\n((?:    [^\n]*\n)+)", PAGE, re.S)
    assert match
    program = tmp_path / "program.py"
    program.write_text(match.group(1), encoding="utf-8")
    done = subprocess.run([sys.executable, str(program)], capture_output=True, text=True, check=True, timeout=120.0, cwd=ROOT)
    assert done.stdout == re.sub(r"(?m)^    ", "", match.group(2))


COMMANDS = re.findall(r"(?m)^    navbound (procedures .*)$", PAGE)


def test_the_page_has_commands() -> None:
    assert len(COMMANDS) >= 3


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_of_the_page_is_accepted(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    arguments = [str(ROOT / word) if word.startswith("tests/") else word for word in shlex.split(command)]
    assert CliRunner().invoke(app, arguments).exit_code == 0


def test_every_state_and_kind_of_the_core_is_on_the_page() -> None:
    states, tracked, kinds = _core.procedure_words()
    for word in [*states, *(set(tracked) - {"missing"}), *kinds]:
        assert f"`{word}`" in PAGE, word
