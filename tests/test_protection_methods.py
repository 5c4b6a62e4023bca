"""The list of algorithms of protection levels: complete, callable, printed."""

from __future__ import annotations

import importlib
import json
from pathlib import Path
from typing import get_args

import pytest
from typer.testing import CliRunner

from navbound.cli.main import app
from navbound.methods import ProtectionMethod, Provenance, methods, protection_methods

BOUND = Path(__file__).parents[1] / "crates" / "core" / "src" / "bound"


@pytest.mark.parametrize("entry", protection_methods().values(), ids=lambda p: p.id)
def test_an_entry_names_a_function_and_says_everything(entry: ProtectionMethod) -> None:
    module, name = entry.function.rsplit(".", 1)
    assert callable(getattr(importlib.import_module(module), name))
    assert entry.provenance in get_args(Provenance)
    assert all((entry.title, entry.source, entry.covers, entry.assumes))


def test_every_family_with_levels_is_listed() -> None:
    declared = sum(path.read_text(encoding="utf-8").count("pub const PROTECTION: Protection =") for path in BOUND.rglob("*.rs"))
    assert len(protection_methods()) == declared
    assert not set(protection_methods()) & set(methods())


def test_only_levels_that_integrity_may_rest_on_say_so() -> None:
    assert [p.id for p in protection_methods().values() if not p.integrity] == ["error-extraction"]


def test_the_command_lists_both() -> None:
    table = CliRunner().invoke(app, ["methods"]).output
    data = json.loads(CliRunner().invoke(app, ["methods", "--json"]).output)
    assert [m["id"] for m in data["methods"]] == list(methods())
    assert [p["id"] for p in data["protection_levels"]] == list(protection_methods())
    assert "Protection levels" in table
