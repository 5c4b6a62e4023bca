"""A text file in chunks of whole lines."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING

from navbound.errors import FormatError
from navbound.read.source import Source
from navbound.read.tables.table import lines_of

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    import polars as pl

CHUNK_BYTES = 8 << 20
"""How much of a file is read at a time. [B]"""
MOST_LINE_BYTES = 64 << 20
"""The longest line of a file that is read in chunks. [B]"""


class Chunks:
    """Lines of a file, chunk after chunk.

    Attributes
    ----------
    source : Source
        The file without its content; digest and size are those of what was read so far.
    """

    def __init__(self, path: Path, chunk_bytes: int = CHUNK_BYTES) -> None:
        self.source = Source(path, b"", "", 0)
        self._chunk_bytes = chunk_bytes

    def __iter__(self) -> Iterator[pl.DataFrame]:
        """Lines with their numbers.

        Raises
        ------
        FormatError
            A file that cannot be read, is no text, or has a line that is too long.
        """
        path, line, at, digest, rest = self.source.path, 1, 0, hashlib.sha256(), b""
        try:
            with path.open("rb") as file:
                while more := file.read(self._chunk_bytes):
                    digest.update(more)
                    whole, end, begun = (rest + more).rpartition(b"\n")
                    if len(begun) > MOST_LINE_BYTES:
                        limit = f"{MOST_LINE_BYTES >> 20} MiB, the longest that is read of a file in pieces"
                        raise FormatError(path, f"a line is longer than {limit}", line + whole.count(b"\n") + len(end))
                    rest = begun
                    if end:
                        yield lines_of(Source(path, whole, "", 0).text(at, line), line)
                        line, at = line + whole.count(b"\n") + 1, at + len(whole) + 1
                if rest:
                    yield lines_of(Source(path, rest, "", 0).text(at, line), line)
                self.source = Source(path, b"", digest.hexdigest(), file.tell())
        except OSError as e:
            raise FormatError(path, f"cannot be read: {e.strerror}") from e
