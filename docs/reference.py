"""The pages of docs/reference, from the command line, the subjects and the models of scenarios: `./dev generate` writes them."""

from __future__ import annotations

import ast
import inspect
import re
import sys
import typing
from typing import TYPE_CHECKING, Any

import typer
from pydantic_core import PydanticUndefined

import navbound
from navbound.cli.main import app
from navbound.scenario import faults, models, plan, sensors, taxi
from navbound.scenario.part import Part
from navbound.scenario.units import TO_SI

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import ModuleType

    import click

JOBS = ("analyze", "evaluate", "fly", "study")
"""Functions of the package itself."""
SCENARIO: tuple[ModuleType, ...] = (models, sensors, faults, plan, taxi)


def commands(_: str = "") -> str:
    """Every command with its help, as it prints it when the site is built."""
    lines = ["# Commands", "", "Written by `./dev generate` from the command line; the help is printed when the site is built.", ""]
    for words in ((), *_commands(typer.main.get_command(app), ())):
        lines += [
            f"## {' '.join(('navbound', *words))}",
            "",
            f"```{{program-output}} {' '.join(('navbound', *words, '--help'))}",
            "```",
            "",
        ]
    return "\n".join(lines)


def _commands(command: click.Command, before: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    for name, each in getattr(command, "commands", {}).items():
        yield (*before, name)
        yield from _commands(each, (*before, name))


def python(_: str = "") -> str:
    """The jobs, and the list of subjects."""
    lines = ["# Python", "", "Written by `./dev generate` from the list of subjects; the words are those of the docstrings.", ""]
    lines += ["`dir(navbound)` lists subjects and jobs. A subject is loaded when it is first used.", "", "## Subjects", "", "```{toctree}"]
    lines += [
        ":maxdepth: 1",
        "",
        *(f"python/{subject}" for subject in sorted(navbound.SUBJECTS)),
        "```",
        "",
        "## Jobs",
        "",
        "```{eval-rst}",
    ]
    lines += [f".. autofunction:: navbound.{job}" for job in JOBS]
    return "\n".join([*lines, ".. autoclass:: navbound.run.directory.Run", "   :members:", "```", ""])


def subject_page(subject: str) -> Callable[[str], str]:
    """What makes the page of a subject: its names with their first sentences, then each of them whole."""
    return lambda _: _subject(subject)


def _subject(subject: str) -> str:
    module = getattr(navbound, subject)
    lines = [f"# navbound.{subject}", "", "```{eval-rst}"]
    names = [name for name in getattr(module, "__all__", ()) if callable(getattr(module, name))]
    elsewhere = {name: home for name in names if (home := _first_home(getattr(module, name))) not in (subject, None)}
    options = ["   :members:", *(["   :imported-members:"] if hasattr(module, "__all__") else [])]
    if elsewhere:
        options.append(f"   :exclude-members: {', '.join(elsewhere)}")
    listed = [name for name in names if name not in elsewhere]
    if listed:
        lines += [f".. currentmodule:: navbound.{subject}", "", ".. autosummary::", "", *(f"   {name}" for name in listed), ""]
    lines += [f".. automodule:: navbound.{subject}", *options, "```", ""]
    data = [name for name in getattr(module, "__all__", ()) if name not in names]
    if data:
        lines.append(f"Data: {', '.join(f'`{name}`' for name in data)}.\n")
    lines += [f"Also here: `{name}` of [navbound.{home}]({home}.md).\n" for name, home in elsewhere.items()]
    return "\n".join(lines)


def _first_home(each: object) -> str | None:
    """The first subject that has a class, which shows it; functions have one subject each."""
    if not inspect.isclass(each):
        return None
    homes = (subject for subject in sorted(navbound.SUBJECTS) if _has(getattr(navbound, subject), each))
    return next(homes, None)


def _has(module: ModuleType, each: object) -> bool:
    return any(getattr(module, name) is each for name in getattr(module, "__all__", ()))


def scenario(_: str = "") -> str:
    """Every part of a scenario or a plan with its keys."""
    suffixes: dict[str, list[str]] = {}
    for suffix, (si, _factor) in TO_SI.items():
        suffixes.setdefault(si, []).append(suffix)
    lines = ["# Keys of scenarios and plans", "", "Written by `./dev generate` from the models that read the files.", ""]
    lines += ["A key ends in its unit. The tables have the SI unit; a file may use another one of the same quantity:", ""]
    lines += ["| key ends in | or in |", "|---|---|"]
    lines += [f"| {f'`{si}`' if si else 'nothing'} | {', '.join(f'`{each}`' for each in of)} |" for si, of in suffixes.items()]
    lines += [
        "",
        "A key that is not listed, a missing one, or a value outside its domain is refused with the file, the key and what is allowed.",
        "",
    ]
    for module in SCENARIO:
        for part in vars(module).values():
            if inspect.isclass(part) and issubclass(part, Part) and part is not Part and part.__module__ == module.__name__:
                lines += _part(part)
    return "\n".join(lines)


def _part(part: type[Part]) -> list[str]:
    words = attribute_words(part)
    lines = [f"## {part.__name__}", "", inspect.getdoc(part) or "", "", "| key | type | without it | meaning |", "|---|---|---|---|"]
    for name, field in part.model_fields.items():
        default = "required" if field.is_required() else f"`{_default(field)}`"
        cells = [f"`{field.alias or name}`", f"`{_type(field.annotation)}`", default, words.get(name, "")]
        lines.append(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |".replace("|  |", "| |"))
    return [*lines, ""]


def _default(field: Any) -> str:
    if field.default is not PydanticUndefined:
        return repr(field.default)
    made = field.default_factory()
    return f"{type(made).__name__}()" if isinstance(made, Part) else repr(made)


def _type(annotation: object) -> str:
    """The type as a reader of a file takes it: words for choices, names of parts, nothing of Python's modules."""
    arguments = typing.get_args(annotation)
    if typing.get_origin(annotation) is typing.Literal:
        return ", ".join(f'"{each}"' if isinstance(each, str) else str(each) for each in arguments)
    text = annotation.__name__ if inspect.isclass(annotation) and not arguments else str(annotation)
    text = re.sub(r"typing\.Literal\[([^\]]*)\]", r"\1", text)
    text = re.sub(r"\b(?:\w+\.)+(?=\w)", "", text).replace(" | None", "")
    return re.sub(r"Annotated\[(.*?), FieldInfo\(.*?\)\]", r"\1", text)


def attribute_words(part: type[Part]) -> dict[str, str]:
    """What stands beneath each key of a part in its source, on one line."""
    words: dict[str, str] = {}
    for each in reversed(part.__mro__):
        if not issubclass(each, Part) or each is Part:
            continue
        (tree,) = ast.parse(inspect.getsource(each)).body
        assert isinstance(tree, ast.ClassDef)
        for key, below in zip(tree.body, tree.body[1:], strict=False):
            if isinstance(key, ast.AnnAssign) and isinstance(key.target, ast.Name) and isinstance(below, ast.Expr):
                text = getattr(below.value, "value", None)
                if isinstance(text, str):
                    words[key.target.id] = " ".join(text.replace("``", "`").split())
    return words


if __name__ == "__main__":
    sys.stdout.write(scenario())
