"""Every case of the shared reference numbers stands in a vector file: by its id, or, where it has none, by its digits."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from navbound import verify

if TYPE_CHECKING:
    from collections.abc import Iterator

REFERENCE = Path(__file__).parents[1].parent / "shared" / "reference"

# Which vector files may carry which reference: ids of different references may be the same.
CARRIERS = {"ref-tse.json": ("tse-", "gnss-"), "ref-anp.json": ("anp-",), "ref-bayes.json": ("rnp-", "dme-")}

# Groups whose numbers are nautical miles and stand in their file in metres, under ids of their own: as many cases must be there.
CONVERTED = {
    "dme_dme": "dme-pairs",
    "dme_sigma": "dme-range-sigma",
    "dme_equal_pairs": "dme-icao-two-sigma",
    "vor_dme": "dme-vor",
}

# Expected numbers of this many digits identify their case.
LONG_NUMBER = re.compile(r"-?\d*\.\d{9,}(e-?\d+)?")


def is_a_bound(case: dict[str, object]) -> bool:
    """Bounds take risks up to one half (docs/decisions/0014); a case beyond it is no bound that the product gives."""
    inputs = case.get("inputs")
    return not (isinstance(inputs, dict) and float(str(inputs.get("alpha", 0.0))) > 0.5)


def groups(reference: dict[str, object]) -> dict[str, list[dict[str, object]]]:
    """The lists of cases, whatever else a reference file holds."""
    by_name = {}
    for name, group in reference.items():
        cases = group.get("cases") if isinstance(group, dict) else group
        if isinstance(cases, list) and cases and all(isinstance(case, dict) for case in cases):
            by_name[name] = cases
    return by_name


def digits(value: object) -> Iterator[str]:
    """The long numbers a reference expects, as written."""
    if isinstance(value, dict):
        for v in value.values():
            yield from digits(v)
    elif isinstance(value, list):
        for v in value:
            yield from digits(v)
    elif isinstance(value, str) and LONG_NUMBER.fullmatch(value):
        yield value


def carried(case: dict[str, object], place: str, ids: set[str], text: str) -> bool:
    """Whether its id, or its group and place, or one of its expected numbers stands in the vector files."""
    if str(case.get("id", place)) in ids:
        return True
    expected = list(digits({k: v for k, v in case.items() if k != "input"}))
    return any(number in text for number in expected) if expected else str(case.get("table", "")) in text


@pytest.mark.parametrize("name", CARRIERS)
def test_every_case_is_carried(name: str) -> None:
    path = REFERENCE / name
    if not path.exists():
        pytest.skip(f"{path} is not on this machine; the vector files carry its numbers")
    files = [f for f in verify.VECTORS.glob("*.toml") if f.stem.startswith(CARRIERS[name])]
    text = "\n".join(f.read_text() for f in files)
    ids = {case.id for f in files for case in verify.load(f).cases}
    data = groups(json.loads(path.read_text()))
    for group in CONVERTED.keys() & data.keys():
        assert len(verify.load(verify.VECTORS / f"{CONVERTED[group]}.toml").cases) >= len(data.pop(group)), group
    missing = {
        group: lost
        for group, cases in data.items()
        if (lost := [str(c.get("id", k)) for k, c in enumerate(cases, 1) if is_a_bound(c) and not carried(c, f"{group}-{k}", ids, text)])
    }
    assert sum(map(len, data.values())) > 50, "the search is broken"
    assert not missing


def test_a_case_that_is_not_there_is_missed() -> None:
    text = 'expect = { value = "0.86602540378443864676" }'
    assert carried({"id": "A"}, "g-1", {"A"}, "")
    assert carried({"expect": "0.86602540378443864676"}, "g-1", set(), text)
    assert not carried({"expect": "0.96602540378443864676"}, "g-1", set(), text)
    assert not carried({"id": "B", "expect": {"x": ["0.5"]}, "table": "other"}, "g-1", {"A"}, text)
