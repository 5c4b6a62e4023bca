"""What the count of instructions refuses; the counts themselves are compared by ./dev instructions."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path

from navbound import _core

BENCH = Path(__file__).parents[1] / "bench"
spec = importlib.util.spec_from_file_location("instructions", BENCH / "instructions.py")
assert spec is not None
assert spec.loader is not None
instructions = importlib.util.module_from_spec(spec)
spec.loader.exec_module(instructions)


def test_growth_beyond_a_twentieth_and_what_is_new_or_gone_is_refused() -> None:
    kept = {"a": 1000, "b": 1000, "gone": 5}
    grown, *others = instructions.differences(kept, {"a": 1050, "b": 1051, "new": 7})
    assert grown.startswith("b: 1051 instructions, 1000 are kept")
    assert others == ["gone: kept and no longer counted", "new: counted and not kept"]
    assert instructions.differences(kept, dict(kept)) == []


def test_every_bound_of_one_epoch_and_every_level_of_one_sky_is_counted() -> None:
    counted = json.loads((BENCH / "instructions.json").read_text(encoding="utf-8"))["instructions"]
    assert all(n > 0 for n in counted.values())
    assert {method["id"] for method in _core.methods()} <= counted.keys()
    assert {"rnp-monitor", "navigated-flight", "araim"} <= counted.keys()
