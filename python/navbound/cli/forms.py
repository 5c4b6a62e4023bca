"""Forms of commands: read from what the command line itself is made of, so that an option stands on the page as soon as it is declared."""

from __future__ import annotations

import re
import typing
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from navbound.cli.choices import LISTS, Selectable, Written
from navbound.workbench.forms import Field, Form

if TYPE_CHECKING:
    from collections.abc import Callable

_KINDS: dict[object, str] = {int: "integer", float: "number", Path: "file", bool: "flag"}
_OWN = {"json", "help"}
"""Options about what is printed, which no page shows."""


def form(name: str, command: Callable[..., None]) -> Form:
    """The form of a command."""
    app = typer.Typer(add_completion=False)
    app.command(name)(command)
    made: Any = typer.main.get_command(app)
    declared = typing.get_type_hints(command, include_extras=True)
    fields = [_field(parameter, declared[parameter.name]) for parameter in made.params if _shown(parameter)]
    return Form(name, re.split(r"\n\s*\n", made.help.strip())[0].replace("\n", " "), tuple(fields))


def _shown(parameter: Any) -> bool:
    return not getattr(parameter, "hidden", False) and parameter.name not in _OWN


def _plain(annotation: Any) -> tuple[object, bool]:
    """The type of one value of ``X``, ``X | None`` or ``list[X]``, and whether there may be several."""
    while typing.get_origin(annotation) is not None:
        if typing.get_origin(annotation) is list:
            return _plain(typing.get_args(annotation)[0])[0], True
        annotation = next(each for each in typing.get_args(annotation) if each is not type(None))
    return annotation, False


def _field(parameter: Any, annotation: Any) -> Field:
    beside = {type(each): each for each in getattr(annotation, "__metadata__", ())}
    selectable: Selectable = beside.get(Selectable, Selectable())
    written: Written | None = beside.get(Written)
    one, repeated = _plain(annotation)
    kind = (
        "out"
        if written is not None
        else "run"
        if selectable.runs
        else "parts"
        if parameter.name == "checkpoint"
        else _KINDS.get(one, "text")
    )
    words = [(value, "") for value in selectable.words] + (LISTS[selectable.lists]() if selectable.lists else [])
    decides = (written.argument, tuple(value for value, _ in LISTS[written.lists]())) if written is not None and written.argument else None
    return Field(
        name=parameter.name,
        flag=parameter.opts[0] if parameter.param_type_name == "option" else "",
        help=(parameter.help or "").strip(),
        kind=kind,
        several="commas" if selectable.commas else "repeated" if repeated else "",
        required=bool(parameter.required),
        default="" if kind == "flag" or parameter.default in (None, ()) else str(parameter.default),
        choices=tuple(words),
        search=selectable.search,
        free=selectable.free,
        typed=selectable.typed or not (words or selectable.search),
        first=selectable.first,
        files=selectable.files,
        when=decides,
    )
