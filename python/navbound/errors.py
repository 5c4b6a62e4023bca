"""What navbound says when it must refuse: one class for wrong arguments, one for unreadable data."""

from __future__ import annotations

import re
from pathlib import Path

UNSEEN = r"[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]"
"""Characters that a text from a file is shown without: control characters (colours and titles of a terminal, ends of lines), and those that
turn the direction of writing, behind which a name looks like another."""
_UNSEEN = re.compile(UNSEEN)


def visible(text: str) -> str:
    """Drop from a text what is not seen and changes how the rest is shown; ends of lines and tabs become blanks."""
    return _UNSEEN.sub(lambda match: " " if match[0] in "\n\t" else "", text)


class NavboundError(Exception):
    """Any refusal of navbound."""


class InputError(NavboundError, ValueError):
    """An argument outside its domain, or arrays whose shapes do not fit.

    Attributes
    ----------
    argument : str
        The argument's public name.
    value : object
        What was found.
    index : int or None
        Position in a flattened array argument.
    """

    def __init__(self, argument: str, value: object, unit: str = "", domain: str = "", index: int | None = None) -> None:
        self.argument = argument
        self.value = value
        self.unit = unit
        self.domain = domain
        self.index = index
        where = argument if index is None else f"{argument}[{index}]"
        shown = f"{value} [{unit}]" if unit else f"{value}"
        refusal = f"is outside {domain}" if domain[:1] in "([{" else f"is not accepted; expected {domain}"
        super().__init__(visible(f"{where} = {shown} {refusal}"))

    def __reduce__(self) -> tuple[type[InputError], tuple[object, ...]]:
        """From its parts, so that a refusal crosses from a worker process to the caller."""
        return type(self), (self.argument, self.value, self.unit, self.domain, self.index)


class InternalError(NavboundError, RuntimeError):
    """A bug in navbound: an invariant of its own does not hold. Neither the arguments nor the data are at fault.

    Attributes
    ----------
    where : str
        The public function, or the command.
    """

    def __init__(self, where: str, cause: object) -> None:
        self.where = where
        self.cause = str(cause)
        super().__init__(f"{where}: this is a bug in navbound, please report it: {cause}")

    def __reduce__(self) -> tuple[type[InternalError], tuple[object, ...]]:
        """From its parts, as that of :class:`InputError`."""
        return type(self), (self.where, self.cause)


class FormatError(NavboundError, ValueError):
    """Data that cannot be read.

    Attributes
    ----------
    path : Path
        The file.
    line : int or None
        Line number, from 1; None when the file as a whole is at fault.
    field : str or None
        Column or field name.
    """

    def __init__(self, path: str | Path, message: str, line: int | None = None, field: str | None = None) -> None:
        self.path = Path(path)
        self.message = message
        self.line = line
        self.field = field
        where = f"{path}" if line is None else f"{path}:{line}"
        super().__init__(visible(f"{where}: {field}: {message}" if field else f"{where}: {message}"))

    def __reduce__(self) -> tuple[type[FormatError], tuple[object, ...]]:
        """From its parts, as that of :class:`InputError`."""
        return type(self), (self.path, self.message, self.line, self.field)
