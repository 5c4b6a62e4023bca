"""What is printed as a standard's was read or confirmed; nothing is remembered."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from navbound import _core

ROOT = Path(__file__).parents[1]
REMEMBERED = re.compile(r"from memory|general knowledge|to be confirmed|clauses? to be cited")
SEARCHED = ("crates", "python/navbound", "docs", "vectors", "README.md")
TEXT = {".rs", ".py", ".md", ".toml", ".csv", ".pyi"}


def remembered(text: str) -> list[str]:
    return REMEMBERED.findall(text)


def test_the_search_sees_the_words() -> None:
    assert remembered("ICAO Annex 10, partly from memory; to be confirmed") == ["from memory", "to be confirmed"]


@pytest.mark.parametrize("place", SEARCHED)
def test_no_number_is_printed_from_memory(place: str) -> None:
    root = ROOT / place
    files = [root] if root.is_file() else [p for p in root.rglob("*") if p.suffix in TEXT and "_web" not in p.parts]
    assert files
    by_name = {str(p.relative_to(ROOT)): words for p in files if (words := remembered(p.read_text(encoding="utf-8")))}
    assert by_name == {}


def test_a_limit_of_the_standard_names_two_texts() -> None:
    levels = _core.service_levels()
    standard = [level for level in levels if level["limits"] == "standard"]
    assert len(standard) == 8
    for level in standard:
        assert level["limits_source"].count(";") >= 1, level["id"]
        assert "Doc 9849" in level["limits_source"], level["id"]
    assert {level["rest"] for level in levels} == {"inferred"}
