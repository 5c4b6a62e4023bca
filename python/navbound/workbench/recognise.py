"""What a file is, in words; or why it is refused, in the sentence that a run would say."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from typing import TYPE_CHECKING

from navbound.errors import FormatError, visible
from navbound.read import formats
from navbound.read.source import Source
from navbound.storage import packed

if TYPE_CHECKING:
    from pathlib import Path

LOOKED_AT = 1 << 16
UNPACKED_BYTES = 32 << 20
"""Size up to which a packed file is unpacked to see whether it is whole. [B]"""
ARINC_CHARACTERS = 132
NAMED = 6
"""Columns of a table that are named."""


@dataclass(frozen=True)
class Recognised:
    """What a file is.

    Attributes
    ----------
    words : str
        Its format, or the sentence that refuses it.
    refused : bool
        Whether it cannot be read.
    """

    words: str
    refused: bool = False


def recognise(path: Path) -> Recognised:
    """Look at the beginning of a file, and unpack it where it is packed and not large."""
    try:
        return Recognised(_words(path))
    except FormatError as e:
        return Recognised(visible(e.message if e.line is None else f"line {e.line}: {e.message}"), refused=True)
    except OSError as e:
        return Recognised(f"cannot be read: {e.strerror or e}", refused=True)


def _words(path: Path) -> str:
    packed.require_no_device(path)
    n_bytes = path.stat().st_size
    with path.open("rb") as file:
        start = file.read(LOOKED_AT)
    of = formats.of(start, path.name)
    also = ""
    if "packed" in of.holds:
        if n_bytes > UNPACKED_BYTES:
            return f"{of.title}; what is in it is seen when it is read"
        also = f", {of.title}"
        start = packed.read(path)
        of = formats.of(start, path.name)
    if not start.strip():
        raise FormatError(path, "the file is empty")
    if of.instead is not None:
        raise FormatError(path, f"a {of.title}, which is not read: {of.instead}")
    source = Source(path, start[:LOOKED_AT], "", n_bytes)
    source.refuse_unknown()
    return (_text(source) if of.id == "csv" else of.title) + also


def _text(source: Source) -> str:
    """What a text holds: a table by the names of its columns, TOML, or a navigation database by the length of its lines."""
    from navbound.read.columns.assign import is_header  # noqa: PLC0415 - loads tables
    from navbound.read.tables.table import layout_of, lines_of  # noqa: PLC0415

    text = source.content.decode("utf-8-sig", "replace")
    if source.path.suffix.lower() == ".toml":
        try:
            tomllib.loads(source.path.read_text(encoding="utf-8") if source.n_bytes > LOOKED_AT else text)
        except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as e:
            raise FormatError(source.path, f"not TOML: {e}") from e
        return "TOML: a plan, a route or a configuration"
    lines = lines_of(text[: text.rfind("\n") + 1] or text, 1)
    if lines.is_empty():
        raise FormatError(source.path, "nothing but comments")
    first = str(lines["text"][0])
    if len(first) == ARINC_CHARACTERS:
        return "Lines of 132 characters: a navigation database (ARINC 424)"
    names = [name for name in layout_of(source.path, lines).names if name]
    if not is_header(names):
        return visible(f"Text in which no column is known by its name; it begins: {first[:80]}")
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return visible(f"Table of {len(names)} columns: {', '.join(name[:40] for name in names[:NAMED])}{more}")
