"""Formats of files: one list of what is recognised, what it holds, and what is refused by name.

The list stands in the core (`crates/formats/src/registry`). A format of your own is registered in front of it.
"""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import PurePath
from typing import TYPE_CHECKING

from navbound import _core

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from navbound.read.receivers import Log
    from navbound.read.source import Source


@dataclass(frozen=True)
class Format:
    """One format.

    Attributes
    ----------
    id : str
        Its id.
    title : str
        Its name.
    holds : tuple of str
        What a file of it may hold: ``positions``, ``observations``, ``navigation``, ``messages``, ``orbits``, ``clocks``, ``almanac``,
        ``packed``, ``nothing``.
    sign : str
        How it is recognised.
    instead : str, optional
        What to do instead, where it is recognised and not read.
    read : callable, optional
        From a source to its positions, where they are the messages of a log.
    recognises : callable, optional
        Whether content is of this format; None where the core knows.
    """

    id: str
    title: str
    holds: tuple[str, ...]
    sign: str
    instead: str | None = None
    read: Callable[[Source], Log] | None = None
    recognises: Callable[[bytes], bool] | None = None


MESSAGES: dict[str, str] = dict(_core.position_logs())
"""Formats of receivers' logs, and the messages of each that positions are read from."""


def _positions(source: Source, name: str) -> Log:
    from navbound.read import receivers  # noqa: PLC0415  (who only recognises a format needs no tables)

    return receivers.read(source, name=name)


def _of_core() -> Iterator[Format]:
    for id_, title, holds, sign, instead in _core.formats():
        log = partial(_positions, name=id_) if id_ in MESSAGES else None
        yield Format(id_, title, tuple(holds), sign, instead, log)


FORMATS: tuple[Format, ...] = tuple(_of_core())
"""Formats in the order in which they are tried."""
_BY_ID = {each.id: each for each in FORMATS}
_OWN: list[Format] = []


@contextmanager
def register(own: Format) -> Iterator[None]:
    """Recognise, and read, a format of your own within a block; it is tried before all others."""
    _OWN.insert(0, own)
    try:
        yield
    finally:
        _OWN.remove(own)


def of(content: bytes, name: str = "") -> Format:
    """The format of a file.

    Parameters
    ----------
    content : bytes
        Its content, or the beginning of it.
    name : str
        Its name; some formats have no sign but the ending of their name.
    """
    own = next((each for each in _OWN if each.recognises is not None and each.recognises(content)), None)
    return own or _BY_ID[_core.format_of(content, _plain(name))]


def _plain(name: str) -> str:
    """A file's name in small letters, without the ending of its packing."""
    name = PurePath(name).name.lower()
    return name.removesuffix(".gz").removesuffix(".z").removesuffix(".zip")
