"""Examples run, and print what they say they print."""

from __future__ import annotations

import ast
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("*.py"))


def test_there_are_examples() -> None:
    assert EXAMPLES


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_prints_what_it_says(example: Path) -> None:
    text = ast.get_docstring(ast.parse(example.read_text(encoding="utf-8")))
    assert text
    expected = textwrap.dedent(text.split("Expected output:\n", 1)[1]).strip()
    done = subprocess.run([sys.executable, str(example)], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == expected
