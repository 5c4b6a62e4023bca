"""Write what is generated from lists: `./dev generate` writes, `--check` compares.

docs/notation.md (the tables), docs/architecture.md (the pictures), docs/reference, web/src/columns.gen.ts and web/src/records.gen.ts.
The list of columns is navbound.table.columns, the records are those of navbound.records, the order of the parts is that of the tests
which hold it.
"""

from __future__ import annotations

import re
import runpy
import sys
import textwrap
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

import reference
from typescript import records_page

import navbound
from navbound.methods import methods
from navbound.table import columns
from navbound.table.declare import STAGES, UNITS, Column

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

ROOT = Path(__file__).parents[1]


def marked(text: str, parts: dict[str, str]) -> str:
    """A page with each part between its marks replaced.

    Raises
    ------
    ValueError
        A part has no place in the page, or a place has no part.
    """
    places = re.findall(r"<!-- generated: ([\w-]+) -->", text)
    if sorted(places) != sorted(parts):
        raise ValueError(f"the page has places for {sorted(places)}, there are {sorted(parts)}")
    for name, part in parts.items():
        begin, end = f"<!-- generated: {name} -->", "<!-- end -->"
        before, _, rest = text.partition(begin)
        text = f"{before}{begin}\n{part}\n{end}{rest.partition(end)[2]}"
    return text


def table_of(listed: Iterable[Column], *, report: bool) -> str:
    """One table of docs/notation.md; columns of one meaning that follow each other share a row."""
    head = ["column", "unit", "meaning", "added by", *(["in the report"] if report else [])]
    lines = [f"| {' | '.join(head)} |", "|" + "---|" * len(head)]
    for meaning, group in groupby(listed, lambda column: (column.meaning, column.stage)):
        of = list(group)
        units = ", ".join(dict.fromkeys(UNITS[column.unit] for column in of))
        cells = [_names(of), units, meaning[0].replace("|", r"\|"), meaning[1], *([_shown(of)] if report else [])]
        lines.append(f"| {' | '.join(cells)} |".replace("|  |", "| |"))
    return "\n".join(lines)


def _names(of: list[Column]) -> str:
    return " ".join(f"`{column.name}`" for column in of)


def _shown(of: list[Column]) -> str:
    shown = [column for column in of if column.shown]
    words = "drawn" if any(column.shown not in (True, False) for column in of) else "yes"
    return "" if not shown else words if len(shown) == len(of) else _names(shown)


def notation(text: str) -> str:
    """docs/notation.md with its tables as the list has them."""
    parts = {table.id: table_of(table.columns, report=table.id == "epochs") for table in columns.TABLES}
    parts["stages"] = "\n".join(["| added by | what it is |", "|---|---|", *(f"| {stage} | {words} |" for stage, words in STAGES.items())])
    return marked(text, parts)


def columns_page(_: str = "") -> str:
    """web/src/columns.gen.ts: names of the columns that a report carries. Another name is an error of type."""
    shown = [column for column in columns.EPOCHS if column.shown]
    plain = [column for column in shown if "<" not in column.name]
    numbers = [column.name for column in plain if column.kind != "text"]
    bounds = [name for method in methods().values() for name in (method.column, method.integrity_column)]
    return "\n".join(
        [
            "// Written by ./dev generate from python/navbound/table/columns.py: the columns of the epoch table that a report carries.",
            "",
            _union("NumberColumn", numbers),
            "",
            _union("WordColumn", [column.name for column in plain if column.kind == "text"]),
            "",
            "/** Bounds of methods. */",
            _union("MethodColumn", bounds),
            "",
            "/** Times of the epochs, numbers, bounds and probabilities of states. */",
            'export type ColumnName = "elapsed_s" | NumberColumn | MethodColumn | `p_state_${number}`;',
            "",
        ]
    )


def _union(name: str, words: list[str]) -> str:
    return "\n".join([f"export type {name} =", *(f'    | "{word}"' for word in words[:-1]), f'    | "{words[-1]}";'])


def architecture(text: str) -> str:
    """docs/architecture.md with the picture of the parts, as the tests hold their order."""
    order = (ROOT / "crates" / "core" / "tests" / "architecture.rs").read_text(encoding="utf-8")
    stages = _words(order.partition("const FLOW")[2].partition(";")[2].partition(";")[0])
    crates = re.findall(r'\("(\w+)", &\[(.*?)\]\)', order.partition("const CRATES")[2].partition("];\n")[0])
    layers = runpy.run_path(str(ROOT / "tests" / "test_layers.py"))["LAYERS"]
    lines = ["crates/core/src: what happens to one epoch; a stage uses the stages before it", "", f"  {' > '.join(stages)}", ""]
    lines += ["crates: what each uses", ""]
    lines += [f"  {name:<9} {', '.join(_words(used)) or 'nothing of ours'}" for name, used in crates]
    lines += ["", "python/navbound: a part uses its own line and the lines beneath it", ""]
    for place in range(len(layers), 0, -1):
        first, *more = textwrap.wrap("  ".join(layers[place - 1]), 90)
        lines += [f"  {place} {first}", *(f"    {line}" for line in more)]
    return marked(text, {"parts": "\n".join(["```text", *lines, "```"])})


def _words(text: str) -> list[str]:
    return re.findall(r'"(\w+)"', text)


PAGES: dict[Path, Callable[[str], str]] = {
    ROOT / "docs" / "notation.md": notation,
    ROOT / "docs" / "architecture.md": architecture,
    ROOT / "docs" / "reference" / "commands.md": reference.commands,
    ROOT / "docs" / "reference" / "python.md": reference.python,
    **{ROOT / "docs" / "reference" / "python" / f"{each}.md": reference.subject_page(each) for each in navbound.SUBJECTS},
    ROOT / "docs" / "reference" / "scenario.md": reference.scenario,
    ROOT / "web" / "src" / "columns.gen.ts": columns_page,
    ROOT / "web" / "src" / "records.gen.ts": records_page,
}
"""Every generated page, and what makes it of its present text."""


def stale() -> list[Path]:
    """Pages that differ from what the lists say."""
    return [
        path
        for path, page in PAGES.items()
        if not path.exists() or path.read_text(encoding="utf-8") != page(path.read_text(encoding="utf-8"))
    ]


if __name__ == "__main__":
    old = stale()
    if "--check" in sys.argv:
        sys.exit(f"differs from its lists, run ./dev generate: {', '.join(str(path.relative_to(ROOT)) for path in old)}" if old else 0)
    for path in old:
        path.parent.mkdir(exist_ok=True)
        path.write_text(PAGES[path](path.read_text(encoding="utf-8") if path.exists() else ""), encoding="utf-8")
