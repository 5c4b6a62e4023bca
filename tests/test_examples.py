"""Examples run, and print what they say they print."""

from __future__ import annotations

import ast
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("*.py"))


RECORDED = {
    "an_hour_of_sbas": (
        "sbas/virtual_user_2025046_17h.25O.gz",
        "sbas/gps_2025046_17h_rinex3.nav",
        "sbas/msas137_2025046_17h.ems",
        "-3962108.2258",
        "3381309.0271",
        "3668678.5241",
    )
}
"""Examples that need recorded files, with their arguments."""


def test_there_are_examples() -> None:
    assert EXAMPLES


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_prints_what_it_says(example: Path, request: pytest.FixtureRequest) -> None:
    arguments: tuple[str, ...] = ()
    if example.stem in RECORDED:
        folder: Path = request.getfixturevalue("shared_data")
        arguments = tuple(str(folder / word) if "/" in word else word for word in RECORDED[example.stem])
    text = ast.get_docstring(ast.parse(example.read_text(encoding="utf-8")))
    assert text
    expected = textwrap.dedent(text.split("Expected output:\n", 1)[1]).strip()
    done = subprocess.run([sys.executable, str(example), *arguments], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == expected
