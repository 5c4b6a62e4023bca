"""The call of Python that a command makes: `navbound --python ...` prints it instead of making it."""

from __future__ import annotations

import dataclasses
import inspect
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

import typer

if TYPE_CHECKING:
    from collections.abc import Callable

COMMANDS = ("fly", "analyze", "evaluate", "map", "predict", "study", "compare")
"""Commands that make one call."""
P = ParamSpec("P")
R = TypeVar("R")

_OF_THE_SCREEN = {"command", "progress"}
"""Arguments about the terminal and the record of its command line."""
_printed: list[bool] = []


def print_calls() -> None:
    """From now on calls are printed, not made."""
    _printed.append(True)


def call(name: str, function: Callable[P, R], /, *args: P.args, **kwargs: P.kwargs) -> R:
    """Call a function; or print the lines that do, and end.

    Parameters
    ----------
    name : str
        As a user writes it: ``navbound.analyze``, ``maps.make``; without a dot, it is imported by itself.
    function : callable
        Which.
    """
    if not _printed:
        return function(*args, **kwargs)
    _printed.clear()
    typer.echo(lines(name, function, args, kwargs))
    raise typer.Exit


def lines(name: str, function: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any]) -> str:
    """The lines of Python that make a call; arguments that have their default are left out."""
    package, dot, _ = name.partition(".")
    whence = (
        "import navbound"
        if package == "navbound"
        else f"from navbound import {package}"
        if dot
        else f"from {function.__module__} import {name}"
    )
    imports = {whence}
    defaults = {each.name: each.default for each in inspect.signature(inspect.unwrap(function)).parameters.values()}
    written = [_source(value, imports) for value in args]
    for argument, value in kwargs.items():
        unused = value is None or value in ({}, "") or value is False or (argument in defaults and value == defaults[argument])
        if argument not in _OF_THE_SCREEN and not unused:
            written.append(f"{argument}={_source(value, imports)}")
    body = f"result = {name}({', '.join(written)})"
    if len(body) > 100:
        body = "\n".join([f"result = {name}(", *(f"    {each}," for each in written), ")"])
    return "\n".join([*sorted(imports, key=lambda line: (line.startswith("from"), line)), "", body])


def _source(value: Any, imports: set[str]) -> str:
    from navbound.records.base import Record  # noqa: PLC0415 - only where a call is printed

    if isinstance(value, Path | str):
        # As Python code is written here; what JSON escapes, Python reads the same.
        return json.dumps(str(value), ensure_ascii=False)
    if isinstance(value, list | tuple):
        inside = [_source(each, imports) for each in value]
        return f"[{', '.join(inside)}]" if isinstance(value, list) else f"({', '.join(inside)}{',' if len(inside) == 1 else ''})"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_source(k, imports)}: {_source(v, imports)}" for k, v in value.items()) + "}"
    kind = type(value)
    if isinstance(value, Record):
        imports.add(f"from {kind.__module__} import {kind.__name__}")
        stated = ", ".join(f"{field}={_source(getattr(value, field), imports)}" for field in sorted(value.model_fields_set))
        return f"{kind.__name__}({stated})"
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        imports.add(f"from {kind.__module__} import {kind.__name__}")
        changed = [
            f"{each.name}={_source(getattr(value, each.name), imports)}"
            for each in dataclasses.fields(value)
            if each.init and (each.default is dataclasses.MISSING or getattr(value, each.name) != each.default)
        ]
        return f"{kind.__name__}({', '.join(changed)})"
    return repr(value)
