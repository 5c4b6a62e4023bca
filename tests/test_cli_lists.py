"""Lists that a narrow screen can show, what `--json` prints by its published schema, and the Python that does the same."""

from __future__ import annotations

import io
import json
import math
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from rich.console import Console

from conftest import Ended
from navbound import kpi, scenario
from navbound.cli import calls, lists, parts, printed, schema, verify
from navbound.studies import registry

Command = Callable[..., Ended]
TRACK = "time,lat_deg,lon_deg,height_m\n" + "".join(f"{1400000000 + k},49.0,2.5,{300 - k}\n" for k in range(5))


@pytest.fixture
def track(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "track.csv"
    path.write_text(TRACK, encoding="utf-8")
    return path


@pytest.mark.parametrize("command", [lists.methods_command, lists.levels_command, lists.scenarios_command, verify.verify_command])
def test_a_list_is_read_on_a_screen_of_80_columns(command: Callable[[], None], monkeypatch: pytest.MonkeyPatch) -> None:
    shown = io.StringIO()
    for module in (lists, verify):
        monkeypatch.setattr(module, "out_console", Console(file=shown, width=80))
    command()
    lines = shown.getvalue().splitlines()
    assert max(map(len, lines)) <= 80
    # No word is cut, and none is broken over lines.
    assert "…" not in shown.getvalue().replace("|…|", "")
    words = set(re.findall(r"[a-z]{4,}", shown.getvalue()))
    assert {"methods_command": "provenance", "levels_command": "operation", "scenarios_command": "taxi"}.get(
        command.__name__, "cases"
    ) in words


def test_the_shipped_scenarios_are_listed(navbound: Command) -> None:
    rows = json.loads(navbound("scenarios", "--json").stdout)
    assert [row["name"] for row in rows] == scenario.shipped()
    assert {row["kind"] for row in rows} == set(scenario.KINDS)
    assert "beijing-shanghai-jammed" in navbound("scenarios").stdout


def test_each_source_of_a_service_level_is_printed_once_and_every_level_names_its_own(navbound: Command) -> None:
    printed_words = " ".join(navbound("levels").stdout.split())
    levels = kpi.levels().values()
    sources = list(dict.fromkeys(level.source for level in levels))
    assert len(sources) < len(levels)
    for number, source in enumerate(sources, 1):
        assert printed_words.count(f"[{number}] {source}") == 1
        # Once for each level, and once at the source.
        assert printed_words.count(f"[{number}]") == 1 + sum(level.source == source for level in levels)


PROCEDURES = Path(__file__).parent / "procedures" / "KDEN_H26-Z.txt"
"""Its missed approach has legs whose length is no number."""
CALLS = {
    "analyze": ["analyze", "track.csv", "--sigma-m", "5"],
    "map": ["map", "dop", "--step-deg", "45", "--hours", "1"],
    "predict": ["predict", "raim", "gps", "--at", "40,116", "--hours", "1"],
    "levels": ["levels"],
    "methods": ["methods"],
    "scenarios": ["scenarios"],
    "verify": ["verify"],
    "study": ["study", "vertical-budget"],
    "procedures-list": ["procedures", "list", str(PROCEDURES)],
    "procedures-show": ["procedures", "show", str(PROCEDURES), "KDEN/H26-Z:CAPTJ", "--missed"],
    "procedures-check": ["procedures", "check", str(PROCEDURES)],
}


@pytest.mark.parametrize("name", CALLS)
def test_what_is_printed_as_json_is_what_the_schema_says(name: str, navbound: Command, track: Path) -> None:
    published = json.loads(navbound("schema", name).stdout)
    validator = jsonschema.Draft202012Validator(published)
    validator.check_schema(published)
    # What JSON does not have, as NaN and Infinity, is no JSON.
    printed = json.loads(navbound(*CALLS[name], "--json").stdout, parse_constant=pytest.fail)
    assert list(validator.iter_errors(printed)) == []
    # A schema that takes anything says nothing.
    assert not validator.is_valid({"verdict": "fine"})
    assert not validator.is_valid([{"verdict": "fine"}])


def test_a_field_that_is_missing_or_of_another_kind_is_no_list_of_methods() -> None:
    validator = jsonschema.Draft202012Validator(schema.of("scenarios"))
    row = {"name": "a", "kind": "flight", "title": "A"}
    assert validator.is_valid([row])
    for wrong in ({**row, "title": 3}, {**row, "more": "b"}, {"name": "a", "kind": "flight"}):
        assert not validator.is_valid([wrong]), wrong


def test_every_study_has_a_record_with_a_schema() -> None:
    assert set(registry.RECORDS) == set(registry.STUDIES)
    published = schema.of("study")
    # A record of one study is no record of another: fields that are not declared are refused.
    assert len(published["anyOf"]) == len(registry.STUDIES)
    named = [published["$defs"][one["$ref"].rpartition("/")[2]] for one in published["anyOf"]]
    assert all(one["additionalProperties"] is False for one in named)


def test_a_difference_that_is_no_number_is_null(capsys: pytest.CaptureFixture[str]) -> None:
    row = printed.Verified("a", "navbound.a", "here", "ours", 1, math.nan, math.inf, ["a: no number"])
    printed.write([row])
    read = json.loads(capsys.readouterr().out, parse_constant=pytest.fail)
    assert read[0]["worst_share_of_tolerance"] is None
    assert jsonschema.Draft202012Validator(schema.of("verify")).is_valid(read)


def test_every_schema_is_one_and_another_command_has_none(navbound: Command) -> None:
    for name in (*schema.RECORDS, "live"):
        jsonschema.Draft202012Validator.check_schema(schema.of(name))
    refused = navbound("schema", "demo")
    assert refused.status == 2
    assert "analyze" in refused.stderr


def test_the_python_of_a_command_does_the_same(navbound: Command, track: Path) -> None:
    printed = navbound("--python", *CALLS["analyze"], "--out", "out/one")
    assert printed.status == 0
    assert not (track.parent / "out").exists()
    names: dict[str, Any] = {}
    exec(printed.stdout, names)
    other = json.loads(navbound(*CALLS["analyze"], "--out", "out/other", "--json").stdout)
    assert json.loads(names["result"].summary.model_dump_json()) == other
    assert 'navbound.analyze(["track.csv"]' in printed.stdout.replace("\n    ", "")


def test_only_what_makes_a_call_has_its_python(navbound: Command) -> None:
    refused = navbound("--python", "demo")
    assert refused.status == 2
    assert all(command in refused.stderr for command in calls.COMMANDS)


def test_workers_stay_within_the_machine(navbound: Command) -> None:
    cores = os.cpu_count() or 1
    refused = navbound("map", "dop", "--backend", "processes", "--workers", str(cores + 1 + parts.LEAST_WORKERS))
    assert refused.status == 2
    assert f"this machine has {cores} cores" in refused.stderr
