"""A file as it lies on the disk: its bytes, its digest, what kind it is."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from navbound.errors import FormatError, visible
from navbound.read import receivers
from navbound.read.tables import foreign
from navbound.records.run import InputFile
from navbound.storage import packed

Kind = Literal["csv", "json", "parquet", "rtklib", "ubx", "sbf", "novatel", "nmea"]


PACKED = (b"\x1f\x8b", b"\x1f\x9d", b"PK\x03\x04", b"PK\x05\x06", b"BZh", b"\xfd7zXZ")
"""Beginnings of packed files: those that are unpacked, and those that are named."""


_LOOK_AT = 1 << 16


@dataclass(frozen=True)
class Source:
    """A file read into memory.

    Attributes
    ----------
    path : Path
        Where it lies.
    content : bytes
        Its content, unpacked.
    sha256 : str
        Digest of the file as it lies on the disk.
    n_bytes : int
        Its size on the disk.
    open_end : bool
        A text whose last line has no end.
    """

    path: Path
    content: bytes
    sha256: str
    n_bytes: int
    open_end: bool = False

    @property
    def kind(self) -> Kind:
        """What the content is, told from the content and not from the name."""
        if self.content.startswith(b"PAR1"):
            return "parquet"
        start = self.content[:4096].removeprefix(b"\xef\xbb\xbf").lstrip()
        if start.startswith((b"{", b"[")):
            return receivers.kind(_behind_banner(self.content)) or "json"
        if start.startswith(b"%"):
            return "rtklib"
        return receivers.kind(self.content) or "csv"

    @property
    def stem(self) -> str:
        """The name without its endings."""
        return visible(self.path.name.split(".")[0] or self.path.name)

    def refuse_unknown(self) -> None:
        """Refuse content that is neither text nor of a kind that is known.

        Raises
        ------
        FormatError
            With the first bytes, or the first that are no text.
        """
        start = self.content[:_LOOK_AT]
        if self.kind == "csv":
            # Cut within a character it would be no text, so not at its end.
            Source(self.path, start[: start.rfind(b"\n") + 1] or start, self.sha256, self.n_bytes).text()

    def text(self, offset: int = 0, line: int = 1) -> str:
        """Content as text; of a part of a file, `offset` and `line` say where it begins.

        Raises
        ------
        FormatError
            Not UTF-8, with the line of the first byte that is not.
        """
        try:
            text = self.content.decode("utf-8" if offset else "utf-8-sig")
        except UnicodeDecodeError as e:
            line += self.content.count(b"\n", 0, e.start)
            found = self.content[e.start : e.start + 8].hex(" ")
            raise FormatError(self.path, f"not UTF-8 text: bytes {found} at offset {offset + e.start}", line) from e
        if "\0" in text:
            raise FormatError(self.path, "not text: it holds zero bytes", line + text.count("\n", 0, text.index("\0")))
        return text

    def record(self, n_rows: int | None) -> InputFile:
        """Entry of the run record."""
        return InputFile(path=str(self.path), sha256=self.sha256, n_bytes=self.n_bytes, n_rows=n_rows)


def _behind_banner(content: bytes) -> bytes:
    """What follows the lines of JSON at the beginning, which a program writes that passes a receiver's log on."""
    at = 0
    while (line := content[at : at + 4096].lstrip()).startswith(b"{"):
        end = content.find(b"\n", at + 1)
        # An object over several lines is no banner.
        if end < 0 or not content[at:end].rstrip().endswith(b"}"):
            return b""
        at = end + 1
    return b"" if line.startswith((b"[", b"]", b"}", b'"')) else content[at:]


def load(path: str | Path) -> Source:
    """Read a file, unpacking gzip, compress (``.Z``) and zip.

    Raises
    ------
    FormatError
        No such file, not a file, empty, packed and damaged, cut short, of several files above the limit of
        :mod:`navbound.storage.packed`, or a kind that is known and not read.
    """
    path = Path(path)
    try:
        packed.require_no_device(path)
        stored = path.read_bytes()
    except FileNotFoundError as e:
        raise FormatError(path, packed.NO_SUCH_FILE) from e
    except OSError as e:
        raise FormatError(path, f"cannot be read: {e.strerror}") from e
    content = packed.plain(path, stored)
    if not content.strip():
        raise FormatError(path, "the file is empty")
    other = foreign.kind(content)
    if other is not None:
        raise FormatError(path, other)
    return Source(path, content, hashlib.sha256(stored).hexdigest(), len(stored))


LARGE_BYTES = 64 << 20
"""Size from which a text table is read in pieces. [B] Provenance: ours; below it the whole takes less than about 0.7 GB."""


def is_text_table(path: str | Path, least_bytes: int = 0) -> bool:
    """Whether this is a plain text table of at least this size, told from its beginning."""
    path = Path(path)
    try:
        if path.stat().st_size < least_bytes:
            return False
        with path.open("rb") as file:
            start = file.read(1 << 20)
    except OSError:
        # Whoever reads it says what is wrong.
        return False
    packed = start.startswith(PACKED)
    return not packed and bool(start.strip()) and foreign.kind(start) is None and Source(path, start, "", len(start)).kind == "csv"
