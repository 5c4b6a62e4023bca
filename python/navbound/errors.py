"""What navbound says when it must refuse: one class for wrong arguments, one for unreadable data."""

from __future__ import annotations

from pathlib import Path


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
        super().__init__(f"{where} = {shown} {refusal}")

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
        super().__init__(f"{where}: {field}: {message}" if field else f"{where}: {message}")

    def __reduce__(self) -> tuple[type[FormatError], tuple[object, ...]]:
        """From its parts, as that of :class:`InputError`."""
        return type(self), (self.path, self.message, self.line, self.field)
