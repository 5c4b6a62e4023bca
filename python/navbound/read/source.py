"""A file as it lies on the disk: its bytes, its digest, what kind it is."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from navbound import _packed
from navbound.errors import FormatError, visible
from navbound.read import receivers
from navbound.run.records import InputFile

Kind = Literal["csv", "json", "parquet", "rtklib", "ubx", "sbf", "novatel", "nmea"]


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
    """

    path: Path
    content: bytes
    sha256: str
    n_bytes: int

    @property
    def kind(self) -> Kind:
        """What the content is, told from the content and not from the name."""
        if self.content.startswith(b"PAR1"):
            return "parquet"
        start = self.content[:4096].removeprefix(b"\xef\xbb\xbf").lstrip()
        if start.startswith((b"{", b"[")):
            return "json"
        if start.startswith(b"%"):
            return "rtklib"
        return receivers.kind(self.content) or "csv"

    @property
    def stem(self) -> str:
        """The name without its endings."""
        return visible(self.path.name.split(".")[0] or self.path.name)

    def text(self) -> str:
        """Content as text.

        Raises
        ------
        FormatError
            Not UTF-8, with the line of the first byte that is not.
        """
        try:
            text = self.content.decode("utf-8-sig")
        except UnicodeDecodeError as e:
            line = self.content.count(b"\n", 0, e.start) + 1
            found = self.content[e.start : e.start + 8].hex(" ")
            raise FormatError(self.path, f"not UTF-8 text: bytes {found} at offset {e.start}", line) from e
        if "\0" in text:
            raise FormatError(self.path, "not text: it holds zero bytes", text.count("\n", 0, text.index("\0")) + 1)
        return text

    def record(self, n_rows: int | None) -> InputFile:
        """Entry of the run record."""
        return InputFile(path=str(self.path), sha256=self.sha256, n_bytes=self.n_bytes, n_rows=n_rows)


def load(path: str | Path) -> Source:
    """Read a file, unpacking gzip.

    Raises
    ------
    FormatError
        No such file, not a file, empty, or packed and damaged, cut short or above the limit of :mod:`navbound._packed`.
    """
    path = Path(path)
    try:
        stored = path.read_bytes()
    except FileNotFoundError as e:
        raise FormatError(path, "no such file") from e
    except OSError as e:
        raise FormatError(path, f"cannot be read: {e.strerror}") from e
    content = _packed.plain(path, stored)
    if not content.strip():
        raise FormatError(path, "the file is empty")
    return Source(path, content, hashlib.sha256(stored).hexdigest(), len(stored))
