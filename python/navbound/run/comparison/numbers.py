"""The records of two runs: numbers that moved, and what was set otherwise."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

from navbound.records.comparison import Differs, MovedNumber

if TYPE_CHECKING:
    from collections.abc import Iterator

    from navbound.records.run import RunRecord, Summary

_KEYS = ("track", "phase", "id", "by", "name", "runway", "column", "method", "level", "region", "path", "kind", "sv", "rnp_m", "risk")
"""Fields that say which record of a list it is: two runs may list them in another order."""
_LEFT_OUT = ("events", "rejected")
"""Parts of a summary that list what the epochs and the events say one by one."""


def moved_numbers(a: Summary, b: Summary) -> list[MovedNumber]:
    """Numbers of both summaries that are not the same, in the order of the records."""
    before, after = (dict(_numbers(run.model_dump(exclude=set(_LEFT_OUT)), ())) for run in (a, b))
    moved = []
    for place in dict.fromkeys([*before, *after]):
        old, new = before.get(place), after.get(place)
        if old == new:
            continue
        difference = new - old if old is not None and new is not None and math.isfinite(old) and math.isfinite(new) else None
        moved.append(MovedNumber(group=" ".join(place[:-1]) or "run", name=place[-1], a=old, b=new, difference=difference))
    return moved


def _numbers(value: Any, place: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], float]]:
    """Every number beneath, with where it stands; a record of a list stands under what names it."""
    if isinstance(value, dict):
        for name, part in value.items():
            yield from _numbers(part, (*place, name))
    elif isinstance(value, list) and value and all(isinstance(part, dict) for part in value):
        for i, part in enumerate(value):
            named = [f"{part[key]:g}" if isinstance(part[key], float) else str(part[key]) for key in _KEYS if part.get(key) is not None]
            yield from _numbers(part, (*place, *(named or [str(i + 1)])))
    elif isinstance(value, list):
        for i, part in enumerate(value):
            yield from _numbers(part, (*place, str(i + 1)))
    elif isinstance(value, int | float) and not isinstance(value, bool) and not math.isnan(value):
        yield place, float(value)


def settings(a: RunRecord, b: RunRecord) -> list[Differs]:
    """What was set, or went in, otherwise."""
    before, after = (dict(_settings(_set(run), ())) for run in (a, b))
    names = dict.fromkeys([*before, *after])
    return [Differs(what=" ".join(name), a=before.get(name), b=after.get(name)) for name in names if before.get(name) != after.get(name)]


def _set(record: RunRecord) -> dict[str, Any]:
    stated = record.model_dump(include={"navbound_version", "seed", "methods", "risk_accuracy", "risk_integrity", "scenario", "settings"})
    # What the monitor and the filter counted is a result.
    stated["settings"] = {name: value for name, value in stated["settings"].items() if name not in {"monitor", "filter"}}
    return stated | {"inputs": {f"file {i + 1}": f.sha256 for i, f in enumerate(record.inputs)}}


def _settings(value: Any, place: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], str]]:
    if isinstance(value, dict):
        for name, part in value.items():
            yield from _settings(part, (*place, str(name)))
    elif value is not None:
        yield place, value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
