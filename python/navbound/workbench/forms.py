"""What can be requested of the command line, and the command line of what was requested."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from navbound.errors import ConflictError, InputError

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping

MOST_VALUES = 500
MOST_CHARACTERS = 1000
_CONTROL = re.compile(r"[\x00-\x1f\x7f]")


@dataclass(frozen=True)
class Field:
    """One argument or option.

    Attributes
    ----------
    name : str
        Its name in the command.
    flag : str
        As it is typed; empty for an argument.
    help : str
        What it means.
    kind : str
        ``text``, ``integer``, ``number``, ``flag``, ``file`` or ``run`` (a finished one); ``out`` for the folder that is written, ``parts``
        for that of finished parts.
    several : str
        Empty for one value; ``repeated``, or ``commas`` where several stand in one.
    required : bool
        Whether it must be there.
    default : str
        What is taken without it, as it is typed.
    choices : tuple of (value, words)
        What may stand there.
    search : str
        List that is searched instead: ``runways``, ``procedures``.
    free : str
        Pattern of what else may be typed; empty where anything may.
    typed : bool
        Whether something else than the choices may be typed.
    first : bool
        Whether it is requested first, not under more options.
    files : bool
        Whether a file may stand there.
    when : tuple of (name, values) or None
        Of ``out``: the argument, and its values with which a folder is written; None: always.
    """

    name: str
    flag: str = ""
    help: str = ""
    kind: str = "text"
    several: str = ""
    required: bool = False
    default: str = ""
    choices: tuple[tuple[str, str], ...] = ()
    search: str = ""
    free: str = ""
    typed: bool = False
    first: bool = False
    files: bool = False
    when: tuple[str, tuple[str, ...]] | None = None


@dataclass(frozen=True)
class Form:
    """One command.

    Attributes
    ----------
    command : str
        Its name.
    summary : str
        What it does.
    fields : tuple of Field
        What can be requested, in the order of the command line.
    """

    command: str
    summary: str
    fields: tuple[Field, ...]

    def writes(self, values: Mapping[str, Any]) -> bool:
        """Whether the command writes a folder with these values."""
        out = next((field for field in self.fields if field.kind == "out"), None)
        if out is None:
            return False
        return out.when is None or str(values.get(out.when[0], "")) in out.when[1]


def arguments(
    form: Form, values: Mapping[str, Any], files: Collection[str], *, runs: Collection[str] = (), out: str, parts: str
) -> list[str]:
    """The command line of what was requested, without the program.

    Parameters
    ----------
    form : Form
        Of which command.
    values : mapping
        Field to text, number, flag or list of these; what is empty is left out.
    files : collection of str
        Names of files that may be named.
    runs : collection of str
        Names of finished runs that may be named.
    out, parts : str
        Folders that the command writes and keeps finished parts in, where it does.

    Raises
    ------
    InputError
        A field that the command does not have, a value of another kind, or a file or run that is none of these.
    """
    unknown = set(values) - {field.name for field in form.fields}
    if unknown:
        raise ConflictError(min(unknown), because=f"{form.command} has no such argument")
    line: list[str] = [form.command]
    behind: list[str] = []
    for field in form.fields:
        if field.kind in {"out", "parts"}:
            requested = form.writes(values) if field.kind == "out" else values.get(field.name) is True
            line += [field.flag, out if field.kind == "out" else parts] if requested else []
            continue
        if field.kind == "flag":
            line += [field.flag] if values.get(field.name) is True else []
            continue
        texts = [_checked(field, text, runs if field.kind == "run" else files) for text in _texts(field, values.get(field.name))]
        if field.required and not texts:
            raise LackingError(field.name, _expected(field))
        if field.several == "commas" and texts:
            texts = [",".join(texts)]
        if field.flag:
            # One word, so that a value that begins with a dash is a value.
            line += [word for text in texts if text != field.default for word in _option(field.flag, text)]
        else:
            behind += [f"./{text}" if text.startswith("-") else text for text in texts]
    return line[:1] + behind + line[1:]


class LackingError(InputError):
    """An argument that must be there and is not.

    Attributes
    ----------
    what : str
        What is expected.
    """

    def __init__(self, argument: str, what: str) -> None:
        self.what = what
        super().__init__(argument, None)

    def words(self, name: Callable[[str], str]) -> str:
        """As :meth:`InputError.words`."""
        return f"{name(self.argument)} is needed: {self.what}"

    def __reduce__(self) -> tuple[object, ...]:
        """From its parts, as that of :class:`InputError`."""
        return type(self), (self.argument, self.what)


def _option(flag: str, text: str) -> list[str]:
    return [f"{flag}={text}"] if text.startswith("-") else [flag, text]


def _expected(field: Field) -> str:
    return {"file": "a file: tick one of the list, or drop one", "run": "a finished run of the list"}.get(field.kind) or field.help[
        :1
    ].lower() + field.help[1:]


def _texts(field: Field, value: Any) -> list[str]:
    several = value if isinstance(value, list) else [] if value is None else [value]
    if len(several) > MOST_VALUES or (len(several) > 1 and not field.several):
        raise InputError(field.name, len(several), "1", "[0, 1]" if not field.several else f"[0, {MOST_VALUES}]")
    if any(not isinstance(each, (str, int, float)) or isinstance(each, bool) for each in several):
        raise InputError(field.name, type(value).__name__, domain="text or a number")
    return [text for each in several if (text := str(each).strip())]


def _checked(field: Field, text: str, listed: Collection[str]) -> str:
    if len(text) > MOST_CHARACTERS or _CONTROL.search(text):
        raise InputError(field.name, text[:60], domain=f"at most {MOST_CHARACTERS} characters that can be seen")
    if field.kind in {"integer", "number"}:
        try:
            int(text) if field.kind == "integer" else float(text)
        except ValueError as e:
            raise InputError(field.name, text, domain="a whole number" if field.kind == "integer" else "a number") from e
        return text
    if field.kind not in {"file", "run"} and not field.files:
        return text
    known = text in listed or text in {value for value, _ in field.choices}
    if known or (field.free and re.fullmatch(field.free, text)):
        return text
    # What the command would take for the name of a file is one of the list: nothing else of the disk can be named.
    domain = "a finished run of the list" if field.kind == "run" else "a file of the list"
    raise InputError(field.name, text, domain=domain if field.kind in {"file", "run"} else f"{domain}, or {_expected(field)}")
