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


def same(kept: Any, actual: Any) -> bool:
    if isinstance(kept, dict):
        return isinstance(actual, dict) and kept.keys() == actual.keys() and all(same(kept[k], actual[k]) for k in kept)
    if isinstance(kept, list):
        return isinstance(actual, list) and len(kept) == len(actual) and all(same(k, f) for k, f in zip(kept, actual, strict=True))
    if isinstance(kept, float):
        return isinstance(actual, float) and abs(actual - kept) <= RELATIVE * abs(kept)
    return bool(kept == actual)


@pytest.mark.parametrize("name", golden.names())
def test_the_numbers_of_a_shipped_scenario_are_those_under_review(name: str) -> None:
    kept = json.loads((golden.FOLDER / f"{name}.json").read_text(encoding="utf-8"))
    data = json.loads(json.dumps(golden.kept(name)))
    moved = [key for key in kept if not same(kept[key], data.get(key))]
    assert not moved, f"{moved} moved: if it was meant, run ./dev golden and say so in CHANGELOG.md under Numbers changed"
