"""Runways and procedures by a part of their name."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    Matches = list[dict[str, str]]

LISTED = 40


@lru_cache(1)
def _runways() -> tuple[str, ...]:
    from navbound.read import runways  # noqa: PLC0415 - loads the table

    table = runways.table()
    return tuple(sorted(f"{airport}/{end}" for airport, end in zip(table["airport"], table["end"], strict=True)))


def runways(words: str) -> Matches:
    """Runways whose name has the words in it; those that begin with them first."""
    requested = words.strip().upper()
    named = [name for name in _runways() if requested in name]
    return [{"value": name, "words": ""} for name in sorted(named, key=lambda name: (not name.startswith(requested), name))[:LISTED]]


@lru_cache(4)
def _procedures(path: Path, changed_ns: int) -> tuple[tuple[str, str], ...]:
    del changed_ns
    from navbound import procedures  # noqa: PLC0415 - loads the reader

    matches = []
    for entry in procedures.read(path).entries:
        transitions = list(dict.fromkeys(route.transition for route in entry.routes if route.transition))
        matches += [(f"{entry.airport}/{entry.ident}{f':{each}' if each else ''}", entry.kind) for each in ["", *transitions]]
    return tuple(matches)


def procedures(path: Path, words: str) -> Matches:
    """Procedures of a navigation database whose name has the words in it.

    Raises
    ------
    FormatError
        It cannot be read.
    """
    requested = words.strip().upper()
    every = _procedures(path, path.stat().st_mtime_ns)
    return [{"value": name, "words": kind} for name, kind in every if requested in name][:LISTED]
