"""Logs of receivers: their own positions, covariances and protection levels, as the extra `receivers` decodes them.

Decoders are those of the optional packages; what the fields mean stands in docs/methods/formats.md with its source.
"""

from __future__ import annotations

import re
from importlib import import_module
from typing import TYPE_CHECKING, Literal, TypeGuard

from navbound.errors import FormatError

if TYPE_CHECKING:
    from collections.abc import Callable

    from navbound.read.receivers.log import Log
    from navbound.read.source import Source

Kind = Literal["ubx", "sbf", "novatel", "nmea"]

_LOOK_AT = 1 << 17
_POSITIONS: dict[Kind, re.Pattern[bytes]] = {
    "ubx": re.compile(rb"\xb5\x62\x01\x07"),
    # Blocks 4006 and 4007, the revision in the upper three bits.
    "sbf": re.compile(rb"\$@..[\xa6\xa7][\x0f\x2f\x4f\x6f\x8f\xaf\xcf\xef]", re.DOTALL),
    "novatel": re.compile(rb"\xaa\x44\x12\x1c\x2a\x00|#BESTPOSA,"),
    "nmea": re.compile(rb"\$[A-Z]{2}GGA,"),
}
"""Beginnings of messages that hold a position, in the order of preference: covariances first."""
_FRAMES: dict[Kind, re.Pattern[bytes]] = {
    "ubx": re.compile(rb"\xb5\x62[\x01-\x29][\x00-\x92]"),
    "sbf": re.compile(rb"\$@..[\x00-\xff][\x0f-\xff].[\x00-\x1f]", re.DOTALL),
    "novatel": re.compile(rb"\xaa\x44\x12\x1c|#[A-Z]+A,(COM|USB|FILE|ICOM)"),
    "nmea": re.compile(rb"\$[A-Z]{2}[A-Z]{3},[^\r\n]*\*[0-9A-F]{2}(,\d+)?\r?\n"),
}
"""Beginnings of any message: the file is a log, whatever it holds."""


def is_log(name: str) -> TypeGuard[Kind]:
    """Whether this is the name of a receiver's log."""
    return name in _FRAMES


def kind(content: bytes) -> Kind | None:
    """Tell which receiver's log this is, or None."""
    start = content[:_LOOK_AT]
    frames = next((name for name, sign in _FRAMES.items() if sign.search(start)), None)
    if frames is None:
        return None
    return next((name for name, sign in _POSITIONS.items() if sign.search(content)), frames)


def read(source: Source, name: Kind) -> Log:
    """Positions of a log.

    Raises
    ------
    InputError
        The package that decodes it is not installed.
    FormatError
        No message with a position.
    """
    decode: Callable[[Source], Log] = import_module(f"navbound.read.receivers.{name}").read
    log = decode(source)
    log.drop_unsound()
    if log.n_rows == 0:
        raise FormatError(source.path, f"a log of kind {name} without a message that holds a position ({log.needs})")
    return log
