"""What moved? The shipped scenarios against the outputs kept in tests/golden (`./dev golden` rewrites them)."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import pytest

sys.path.insert(0, str(Path(__file__).parent))

import golden

RELATIVE = 1e-9
"""Ten digits are kept, so nine must agree."""
RELATIVE_OF_ARRAYS = 1e-6
"""Of the taxi scenarios: their sky and navigation are arithmetic of arrays in Python.

Its sines, tangents and logarithms are those that the C library and NumPy choose for a processor. Numbers of a processor without AVX-512 are
up to 3.8e-7 of themselves from those under review; without FMA (GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4), 4.8e-7."""


def same(kept: Any, actual: Any, relative: float) -> bool:
    if isinstance(kept, dict):
        return isinstance(actual, dict) and kept.keys() == actual.keys() and all(same(kept[k], actual[k], relative) for k in kept)
    if isinstance(kept, list):
        return (
            isinstance(actual, list) and len(kept) == len(actual) and all(same(k, f, relative) for k, f in zip(kept, actual, strict=True))
        )
    if isinstance(kept, float):
        return isinstance(actual, float) and abs(actual - kept) <= relative * abs(kept)
    return bool(kept == actual)


@pytest.mark.parametrize("name", golden.names())
def test_the_numbers_of_a_shipped_scenario_are_those_under_review(name: str) -> None:
    kept = json.loads((golden.FOLDER / f"{name}.json").read_text(encoding="utf-8"))
    data = json.loads(json.dumps(golden.kept(name)))
    relative = RELATIVE_OF_ARRAYS if "taxi" in name else RELATIVE
    moved = [key for key in kept if not same(kept[key], data.get(key), relative)]
    assert not moved, f"{moved} moved: if it was meant, run ./dev golden and say so in CHANGELOG.md under Numbers changed"
