"""docs/architecture.md leads a newcomer to files that exist and hold what the page says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")


def rows(heading: str) -> list[list[str]]:
    """Cells of the table of one section, without its head."""
    section = PAGE.split(f"## {heading}\n")[1].split("\n## ")[0]
    lines = [line for line in section.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split(" | ")] for line in lines[2:]]


def test_the_page_answers_enough_questions() -> None:
    assert len(rows("Where do I find")) >= 20
    assert len(rows("Where do I put")) >= 12


@pytest.mark.parametrize("row", rows("Where do I find"), ids=lambda row: row[0])
def test_the_answer_stands_in_the_file_that_the_page_names(row: list[str]) -> None:
    for file in re.findall(r"`([^`]*)`", row[1]):
        text = (ROOT / file).read_text(encoding="utf-8")
        assert row[2].strip("`") in text, f"{file} does not hold {row[2]}"


@pytest.mark.parametrize("row", rows("Where do I put"), ids=lambda row: row[0])
def test_every_place_for_something_new_exists(row: list[str]) -> None:
    places = [place.partition("<")[0] for place in re.findall(r"`([a-z]+/[^`]*)`", " ".join(row))]
    assert places
    for place in places:
        assert (ROOT / place).exists(), place


@pytest.mark.parametrize("row", rows("Where do I put"), ids=lambda row: row[0])
def test_every_list_that_the_page_names_is_in_its_file(row: list[str]) -> None:
    for name, file in re.findall(r"`([A-Z_]+)` in `([^`]+)`", row[-1]):
        assert name in (ROOT / file).read_text(encoding="utf-8")
