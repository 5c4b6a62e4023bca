"""Every case of the shared reference numbers stands in a vector file, under its own id or that of its group and place."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from navbound import verify

REFERENCE = Path(__file__).parents[1].parent / "shared" / "reference"

# What is carried by no vector file yet, each with its reason.
NOT_CARRIED = {
    "ref-anp.json": dict.fromkeys(("title", "conventions", "methods", "count"), "a description, not a case"),
    "ref-bayes.json": {"dme": "positions from distance measuring equipment come with navbound.dme"},
}
# Which vector files may carry which reference: ids of different references may be the same.
CARRIERS = {
    "ref-tse.json": ("tse-", "gnss-"),
    "ref-anp.json": ("anp-",),
    "ref-bayes.json": ("rnp-", "dme-"),
}


def case_ids(reference: dict[str, object]) -> dict[str, list[str]]:
    """Group to the ids of its cases; a case without an id is called after its group and its place, from 1."""
    return {
        name: [str(case.get("id", f"{name}-{k}")) for k, case in enumerate(group, 1)]
        for name, group in reference.items()
        if isinstance(group, list) and all(isinstance(case, dict) for case in group)
    }


@pytest.mark.parametrize("name", CARRIERS)
def test_every_case_is_carried(name: str) -> None:
    path = REFERENCE / name
    if not path.exists():
        pytest.skip(f"{path} is not on this machine; the vector files carry its numbers")
    groups = case_ids(json.loads(path.read_text()))
    carried = {case.id for file in verify.files() if file.id.startswith(CARRIERS[name]) for case in file.cases}
    if not carried and name != "ref-tse.json":
        pytest.skip(f"no vector file of {CARRIERS[name]} yet")
    missing = {
        group: lost
        for group, ids in groups.items()
        if not any(group.startswith(prefix) for prefix in NOT_CARRIED.get(name, {}))
        if (lost := [i for i in ids if i not in carried])
    }
    assert not missing


def test_the_search_finds_ids_and_places() -> None:
    assert case_ids({"meta": {}, "a": [{"id": "X1"}, {}], "count": 2}) == {"a": ["X1", "a-2"]}
