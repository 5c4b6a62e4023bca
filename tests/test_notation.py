"""docs/notation.md is law: what the code names must stand there, and bare numbers end in a unit."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from navbound.methods import methods

ROOT = Path(__file__).parents[1]
GLOSSARY = (ROOT / "docs" / "notation.md").read_text(encoding="utf-8")
WORDS = {
    "sv",
    "track",
    "leg",
    "phase",
    "status",
    "reason",
    "reason_id",
    "excluded_sv",
    "mode",
    "nav_mode",
    "nav_reasons",
    "nav_source",
    "alert",
    "stated_alert",
    "state",
    "kind",
    "words",
    "satellite",
    "station",
    "decision",
    "signals",
    "message",
    "level",
    "cause",
    "callsign",
    "mode_before",
    "mode_onset",
    "fate",
}
SUFFIXES = ("_m", "_m2", "_s", "_ns", "_rad", "_mps", "_mps2", "_radps", "_hpa", "_dbhz")
UNITLESS = ("p_", "n_")
DIMENSIONLESS = {"pdop", "hdop", "vdop", "gdop", "innovation_memory", "nac_p", "nic", "pic", "nuc_p", "over_tta", "flight", "nees"}
DIMENSIONLESS |= {f"innovation_{of}" for of in ("range", "station", "baro")}
ENDINGS = ("_square", "_lag_one", "_memory_max")
"""Squares, correlations and memories of normalised innovations."""


def declared() -> set[str]:
    table = GLOSSARY[GLOSSARY.index("## The epoch table") :]
    return {name for line in table.splitlines() if line.startswith("| `") for name in re.findall(r"`([^`]+)`", line.split("|")[1])}


def test_the_glossary_declares_columns() -> None:
    assert len(declared()) > 40


@pytest.mark.parametrize("name", sorted(declared()))
def test_every_declared_column_ends_in_a_unit(name: str) -> None:
    plain = name.removeprefix("reversion_")
    assert plain in WORDS | DIMENSIONLESS or plain.endswith((*SUFFIXES, *ENDINGS)) or plain.startswith(UNITLESS), name


def test_every_column_of_a_run_is_declared(flown) -> None:  # type: ignore[no-untyped-def]
    of_methods = {c for m in methods().values() for c in (m.column, m.integrity_column)}
    states = {f"p_state_{k}" for k in range(1, 20)}
    unknown = set(flown.epochs.columns) - declared() - of_methods - states
    assert not unknown, f"columns without a line in docs/notation.md: {sorted(unknown)}"


def test_every_event_column_is_declared(flown) -> None:  # type: ignore[no-untyped-def]
    events = GLOSSARY[GLOSSARY.index("## Events") :]
    assert set(flown.events.columns) <= set(re.findall(r"`([a-z_]+)`", events))
