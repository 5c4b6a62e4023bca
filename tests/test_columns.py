"""Every column once: what is generated from the list is up to date, a new line reaches every reader, and no file states it again."""

from __future__ import annotations

import ast
import json
import re
import runpy
from pathlib import Path
from typing import Any

import polars as pl
import pytest

import report_fixture
from navbound.methods import methods
from navbound.report import payload
from navbound.run.directory import EPOCHS, EVENTS, Run
from navbound.table import columns, lookup
from navbound.table.declare import UNITS, Drawn, row, schema, unit_of

ROOT = Path(__file__).parents[1]
TOY = row("toy_m", "a toy, made for this test", "bound", shown=Drawn("Toys", "The toy"))


@pytest.fixture
def pages(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """The generator of the pages."""
    monkeypatch.syspath_prepend(ROOT / "docs")
    return runpy.run_path(str(ROOT / "docs" / "generate.py"), run_name="generate")


@pytest.fixture
def toy(monkeypatch: pytest.MonkeyPatch) -> None:
    """The list with one more line."""
    monkeypatch.setattr(columns, "EPOCHS", (*columns.EPOCHS, *TOY))
    tables = tuple(table if table.id != "epochs" else type(table)("epochs", columns.EPOCHS) for table in columns.TABLES)
    monkeypatch.setattr(columns, "TABLES", tables)


def test_generated_pages_are_what_their_lists_say(pages: dict[str, Any]) -> None:
    assert pages["stale"]() == [], "run ./dev generate"


def toy_page() -> payload.Page:
    fixture = report_fixture.flight(n=50)
    epochs = fixture.epochs.with_columns(pl.lit(3.5).alias("toy_m"))
    return payload.build(fixture.summary, fixture.record, epochs, fixture.events, [])


def test_a_column_that_is_not_declared_stays_out_of_the_report() -> None:
    page = toy_page()
    assert "toy_m" not in {column["name"] for column in page.data["tracks"][0]["columns"]}
    assert page.data["charts"] == []


@pytest.mark.usefixtures("toy")
def test_a_column_declared_in_one_line_reaches_the_report_the_notation_the_types_and_the_files(pages: dict[str, Any]) -> None:
    page = toy_page()
    assert "toy_m" in {column["name"] for column in page.data["tracks"][0]["columns"]}
    line = {"column": "toy_m", "label": "The toy", "about": "a toy, made for this test", "limit": False}
    assert page.data["charts"] == [{"title": "Toys", "unit": "m", "lines": [line]}]
    notation = pages["notation"]((ROOT / "docs" / "notation.md").read_text(encoding="utf-8"))
    assert "| `toy_m` | m | a toy, made for this test | bound | drawn |" in notation
    assert '    | "toy_m"' in pages["columns_page"]()
    assert {path.name for path in pages["stale"]()} == {"notation.md", "columns.gen.ts"}
    stated = json.loads(lookup.metadata(["toy_m"])["navbound_columns"])
    assert stated == {"toy_m": {"unit": "m", "meaning": "a toy, made for this test"}}
    assert schema(lookup.named(["toy_m"])) == {"toy_m": pl.Float64}


def test_the_report_of_a_flight_with_two_filters_carries_their_distance(flown: Run) -> None:
    page = payload.build(flown.summary, flown.record, flown.epochs, flown.events, [])
    lines = [(line["column"], line["limit"]) for chart in page.data["charts"] for line in chart["lines"]]
    assert lines == [("separation_m", False), ("separation_limit_m", True)]
    assert {"separation_m", "separation_limit_m"} <= {column["name"] for column in page.data["tracks"][0]["columns"]}


def test_a_column_whose_name_has_no_unit_must_state_its_kind() -> None:
    with pytest.raises(ValueError, match="toy ends in no unit"):
        row("toy", "a toy", "bound")
    with pytest.raises(ValueError, match="stage attic"):
        row("toy_m", "a toy", "attic")


@pytest.mark.parametrize(
    ("name", "unit"),
    [("hpl_m", "m"), ("cov_ee_m2", "m2"), ("time_ns", "ns"), ("vel_e_mps", "mps"), ("p_exceed_2rnp", "1"), ("n_sv", "1"), ("hdop", "1")],
)
def test_the_unit_is_the_ending_of_the_name(name: str, unit: str) -> None:
    assert unit_of(name) == unit


def test_no_table_has_a_name_twice() -> None:
    for table in columns.TABLES:
        names = [column.name for column in table.columns]
        assert len(set(names)) == len(names), table.id


def stated(path: Path) -> dict[str, dict[str, str]]:
    return dict(json.loads(pl.read_parquet_metadata(path)["navbound_columns"]))


def test_a_written_run_has_the_declared_types_and_units(flown: Run) -> None:
    assert flown.path is not None
    written = pl.read_parquet_schema(flown.path / EPOCHS)
    by_name = {name: lookup.declaration(name, methods()) for name in written}
    assert len(by_name) > 60
    assert [name for name, column in by_name.items() if column is None] == []
    declared = {name: next(iter(schema([column]).values())) for name, column in by_name.items() if column is not None}
    assert dict(written) == declared
    units = stated(flown.path / EPOCHS)
    assert set(units) == set(written)
    assert units["hpl_m"]["unit"] == "m"
    assert units["cov_ee_m2"]["unit"] == "m²"
    assert units["status"]["unit"] == "text"
    assert {entry["unit"] for entry in units.values()} <= set(UNITS.values())
    assert pl.read_parquet_schema(flown.path / EVENTS) == dict(schema(columns.EVENTS))


def collections(text: str) -> list[set[str]]:
    """The texts in each collection literal, the keys of a dictionary among them."""
    listed = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Tuple | ast.List | ast.Set | ast.Dict):
            parts = node.keys if isinstance(node, ast.Dict) else node.elts
            listed.append({part.value for part in parts if isinstance(part, ast.Constant) and isinstance(part.value, str)})
    return listed


def test_the_covariance_is_spelled_once() -> None:
    package = ROOT / "python" / "navbound"
    again = [
        str(path.relative_to(package))
        for path in sorted(package.rglob("*.py"))
        if any(len(texts & set(columns.COVARIANCE)) >= 3 for texts in collections(path.read_text(encoding="utf-8")))
    ]
    assert again == ["table/columns.py"]


def test_the_binding_reads_the_declared_inputs_of_methods() -> None:
    source = (ROOT / "crates" / "python" / "src" / "methods.rs").read_text(encoding="utf-8")
    listed = re.search(r"const COLUMNS: \[&str; \d+\] = \[(.*?)\];", source, re.DOTALL)
    assert listed
    names = re.findall(r'"(\w+)"', listed.group(1))
    assert tuple(names[: len(columns.METHOD_INPUTS)]) == columns.METHOD_INPUTS
    # Errors and levels follow, which other functions of the core read.
    assert {"nse_e_m", "nse_n_m", "nse_u_m"} <= set(names)
    assert [name for name in names if lookup.declaration(name) is None] == []
