"""Pydantic records as TypeScript interfaces, and sentences as constants, for web/src/records.gen.ts."""

from __future__ import annotations

import ast
import inspect
import json
import textwrap
import types
import typing
from types import ModuleType

from navbound.records import faults, groups, maps, performance, procedure, run, verdict
from navbound.records.base import Record
from navbound.rnp import alerts

MODULES = (alerts, verdict, faults, groups, performance, procedure, run, maps)
"""Modules of records that a page receives, in the order of the file."""


def records_page(_: str = "") -> str:
    """web/src/records.gen.ts: every record that a page receives, with the names, types and words of Python."""
    parts = [
        "// Written by ./dev generate from python/navbound/records and python/navbound/rnp/alerts.py. Numbers that do not exist are null.",
        "",
    ]
    named: dict[object, str] = {}
    for module in MODULES:
        for name, words in aliases(module).items():
            if words not in named:
                named[words] = name
                parts += [f"export type {name} = {written(words, {})};", ""]
        parts += [line for name, words in sentences(module).items() for line in (constant(name, words), "")]
        for record in records(module).values():
            parts += [interface(record, named), ""]
    return "\n".join(parts)


def records(module: ModuleType) -> dict[str, type[Record]]:
    """Records that a module declares, in its order."""
    return {
        name: kind
        for name, kind in vars(module).items()
        if isinstance(kind, type) and issubclass(kind, Record) and kind.__module__ == module.__name__
    }


def aliases(module: ModuleType) -> dict[str, object]:
    """Lists of words that a module names."""
    return {name: words for name, words in vars(module).items() if typing.get_origin(words) is typing.Literal}


def sentences(module: ModuleType) -> dict[str, dict[str, str]]:
    """Dictionaries of sentences that a module declares, by the names of their constants."""
    return {name: words for name, words in vars(module).items() if name.isupper() and isinstance(words, dict)}


def constant(name: str, words: dict[str, str]) -> str:
    """Sentences by their ids, as a constant."""
    return "\n".join([f"export const {name} = {{", *(f"    {id_}: {json.dumps(text)}," for id_, text in words.items()), "} as const;"])


def interface(record: type[Record], named: dict[object, str]) -> str:
    """One record as an interface, with the docstrings of its fields."""
    notes = field_notes(record)
    lines = [f"/** {inspect.cleandoc(record.__doc__ or '')} */", f"export interface {record.__name__} {{"]
    for name, field in record.model_fields.items():
        if name in notes:
            lines.append(f"    /** {notes[name]} */")
        lines.append(f"    {name}: {written(field.annotation, named)};")
    return "\n".join([*lines, "}"])


def field_notes(record: type[Record]) -> dict[str, str]:
    """Docstrings that stand beneath the fields of a record, each in one line."""
    body = ast.parse(textwrap.dedent(inspect.getsource(record))).body[0]
    assert isinstance(body, ast.ClassDef)
    notes: dict[str, str] = {}
    for field, after in zip(body.body, body.body[1:], strict=False):
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name) and isinstance(after, ast.Expr):
            notes[field.target.id] = " ".join(str(ast.literal_eval(after.value)).split())
    return notes


def written(kind: object, named: dict[object, str]) -> str:
    """A type as TypeScript writes it."""
    if kind in named:
        return named[kind]
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin is typing.Literal:
        return " | ".join(f'"{word}"' for word in arguments)
    if origin in (typing.Union, types.UnionType):
        return " | ".join(written(part, named) for part in arguments)
    if origin is list:
        inner = written(arguments[0], named)
        return f"({inner})[]" if "|" in inner else f"{inner}[]"
    if origin is dict:
        return f"Record<{written(arguments[0], named)}, {written(arguments[1], named)}>"
    return PLAIN.get(kind) or kind.__name__  # type: ignore[attr-defined]


PLAIN: dict[object, str] = {int: "number", float: "number", str: "string", bool: "boolean", object: "unknown", type(None): "null"}
