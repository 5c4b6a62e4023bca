"""What navbound says when it must refuse. Four patterns, each with its own sentence.

A value outside its domain (:class:`InputError`), arguments that do not go together (:class:`ConflictError`), a name that nothing has
(:class:`NotFoundError`), and data that cannot be read (:class:`FormatError`). The command line writes the name of an option as it is typed.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Iterable
from pathlib import Path

UNSEEN = r"[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]"
"""Characters that a text from a file is shown without: control characters (colours and titles of a terminal, ends of lines), and those that
turn the direction of writing, behind which a name looks like another."""
_UNSEEN = re.compile(UNSEEN)


def visible(text: str) -> str:
    """Drop from a text what is not seen and changes how the rest is shown; ends of lines and tabs become blanks."""
    if type(text) is str and text.isprintable():
        # None of them is printable.
        return text
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
        super().__init__(visible(self.words(str)))

    def words(self, name: Callable[[str], str]) -> str:
        """The sentence, with every argument under its name by `name`."""
        where = name(self.argument) if self.index is None else f"{name(self.argument)}[{self.index}]"
        shown = f"{self.value} [{self.unit}]" if self.unit else f"{self.value}"
        refusal = f"is outside {self.domain}" if self.domain[:1] in "([{" else f"is not accepted; expected {self.domain}"
        return f"{where} = {shown} {refusal}"

    def __reduce__(self) -> tuple[object, ...]:
        """From its parts, so that a refusal crosses from a worker process to the caller."""
        return type(self), (self.argument, self.value, self.unit, self.domain, self.index)


class ConflictError(InputError):
    """Arguments that do not go together.

    Attributes
    ----------
    argument : str
        The one that is too many.
    needs, excludes : tuple of str
        The arguments of which it needs one, or beside which it has no meaning.
    because : str
        Why, as the rest of a sentence.
    """

    def __init__(
        self, argument: str, *, needs: tuple[str, ...] = (), excludes: tuple[str, ...] = (), because: str = "", value: object = None
    ) -> None:
        self.needs = needs
        self.excludes = excludes
        self.because = because
        super().__init__(argument, value)

    def words(self, name: Callable[[str], str]) -> str:
        """As :meth:`InputError.words`."""
        needs, excludes = (" or ".join(map(name, names)) for names in (self.needs, self.excludes))
        rule = f"needs {needs}" if self.needs else f"cannot stand beside {excludes}" if self.excludes else "cannot be used here"
        return f"{name(self.argument)} {rule}" + (f": {self.because}" if self.because else "")

    def __reduce__(self) -> tuple[object, ...]:
        """From its parts, as that of :class:`InputError`."""
        more = {"needs": self.needs, "excludes": self.excludes, "because": self.because, "value": self.value}
        return _rebuilt, (type(self), (self.argument,), more)


class UnpairedError(InputError):
    """A file that says nothing without another one.

    Attributes
    ----------
    because : str
        What it holds and which other file it needs, as the rest of a sentence.
    """

    def __init__(self, argument: str, value: object, because: str) -> None:
        self.because = because
        super().__init__(argument, value)

    def words(self, name: Callable[[str], str]) -> str:
        """The sentence: a file says what it is by its own name."""
        del name
        return f"{self.value} {self.because}"

    def __reduce__(self) -> tuple[object, ...]:
        """From its parts, as that of :class:`InputError`."""
        return type(self), (self.argument, self.value, self.because)


class NotFoundError(InputError):
    """A name that nothing has.

    Attributes
    ----------
    what : str
        What was looked for: "method", "scenario".
    known : tuple of str
        Names that there are.
    more : str
        What else may stand there, as the rest of a sentence.
    """

    def __init__(self, argument: str, value: object, what: str, known: Iterable[object] = (), more: str = "") -> None:
        self.what = what
        self.known = tuple(map(str, known))
        self.more = more
        super().__init__(argument, value)

    def words(self, name: Callable[[str], str]) -> str:
        """As :meth:`InputError.words`."""
        folded = {each.casefold().replace(" ", "-"): each for each in self.known}
        near = difflib.get_close_matches(str(self.value).casefold().replace(" ", "-"), folded, n=1)
        listed = f"; there are {', '.join(self.known)}" if len(self.known) > 1 else f"; there is {self.known[0]}" if self.known else ""
        more = f"; {self.more}" if self.more else ""
        meant = f"; did you mean {folded[near[0]]}?" if near else ""
        return f"{name(self.argument)} = {self.value}: no {self.what} of that name{listed}{more}{meant}"

    def __reduce__(self) -> tuple[object, ...]:
        """From its parts, as that of :class:`InputError`."""
        return type(self), (self.argument, self.value, self.what, self.known, self.more)


def _rebuilt(kind: type[InputError], parts: tuple[object, ...], more: dict[str, object]) -> InputError:
    """An error of arguments by name: pickle calls with those by place alone."""
    return kind(*parts, **more)  # type: ignore[arg-type]


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
