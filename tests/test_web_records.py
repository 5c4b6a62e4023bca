"""The generated TypeScript names the fields of the performance records as Python declares them."""

from __future__ import annotations

import re
import types
import typing
from pathlib import Path

import pytest

from navbound.records import performance as kpi_records
from navbound.records.base import Record

SOURCE = Path(__file__).parents[1] / "web" / "src" / "records.gen.ts"
RECORDS = {
    name: value
    for name, value in vars(kpi_records).items()
    if isinstance(value, type) and issubclass(value, Record) and value is not Record
}


def interfaces() -> dict[str, dict[str, str]]:
    matches = re.findall(r"export interface (\w+) \{\n(.*?)\n\}", SOURCE.read_text(), re.DOTALL)
    return {name: dict(re.findall(r"^ {4}(\w+): (.*);$", body, re.MULTILINE)) for name, body in matches if name in RECORDS}


def written(kind: object) -> str:
    """A type as TypeScript writes it, but for unions of words, which are strings here."""
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin is typing.Literal:
        return "string"
    if origin in (typing.Union, types.UnionType):
        return " | ".join(written(part) for part in arguments)
    if origin is list:
        inner = written(arguments[0])
        return f"({inner})[]" if "|" in inner else f"{inner}[]"
    if origin is dict:
        return f"Record<string, {written(arguments[1])}>"
    if isinstance(kind, type) and issubclass(kind, Record):
        return kind.__name__
    return {int: "number", float: "number", str: "string", bool: "boolean", type(None): "null"}[kind]  # type: ignore[index]


def test_every_record_has_its_interface() -> None:
    assert len(RECORDS) >= 12
    assert set(interfaces()) == set(RECORDS)


@pytest.mark.parametrize("name", sorted(RECORDS))
def test_fields_and_their_types_agree(name: str) -> None:
    shown = interfaces()[name]
    declared = {field: written(info.annotation) for field, info in RECORDS[name].model_fields.items()}
    assert list(shown) == list(declared)
    for field, kind in shown.items():
        words = re.sub(r'"[^"]*"(?: \| "[^"]*")*|\bAxis\b|\bProvenance\b', "string", kind)
        assert words == declared[field], f"{name}.{field}"
