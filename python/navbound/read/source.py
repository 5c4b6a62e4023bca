"""A file as it lies on the disk: its bytes, its digest, what kind it is."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from navbound.errors import FormatError, visible
from navbound.read import formats
from navbound.records.run import InputFile
from navbound.storage import packed

if TYPE_CHECKING:
    from navbound.read.formats import Format

_LOOK_AT = 1 << 16
_BINARY = "binary, of no kind that is known here; convert it to NMEA, RINEX or a table with the maker's program"
_BINARY_SHARE = 0.05
"""Share of bytes that no text has, from which a beginning is binary and not a damaged text. [1] Provenance: ours."""
_BINARY_BYTES = 8
"""Number of such bytes above which the share counts: two wrong bytes in a text of one line are damage. [1] Provenance: ours."""
_TEXT_BYTES = bytes(byte for byte in range(256) if byte >= 0x20 or byte in b"\t\n\v\f\r\x1b")


def _is_binary(content: bytes) -> bool:
    """Whether a file begins with control characters among its bytes, or with bytes that are no UTF-8, as binary data do everywhere."""
    begin = content[:4096]
    unlike = len(begin.translate(None, _TEXT_BYTES)) + begin.decode("utf-8", "replace").count("\ufffd")
    return unlike > max(_BINARY_BYTES, _BINARY_SHARE * len(begin))


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
    def format(self) -> Format:
        """What the content is; only where it has no sign of its own, what the name says."""
        return formats.of(self.content, self.path.name)

    @property
    def kind(self) -> str:
        """Id of the format of its positions; what holds none is taken for a text table, and refused as such."""
        of = self.format
        return of.id if "positions" in of.holds else "csv"

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
            if not offset and _is_binary(self.content):
                raise FormatError(self.path, f"{_BINARY}: it begins with {self.content[:8].hex(' ')}") from e
            line += self.content.count(b"\n", 0, e.start)
            first_bytes = self.content[e.start : e.start + 8].hex(" ")
            raise FormatError(self.path, f"not UTF-8 text: bytes {first_bytes} at offset {offset + e.start}", line) from e
        if "\0" in text:
            if not offset and _is_binary(self.content):
                raise FormatError(self.path, f"{_BINARY}: it begins with {self.content[:8].hex(' ')}")
            raise FormatError(self.path, "not text: it holds zero bytes", line + text.count("\n", 0, text.index("\0")))
        return text

    def plain(self) -> tuple[Path, bytes]:
        """Path and content, which is read again where it was not kept.

        Raises
        ------
        FormatError
            As :func:`navbound.storage.packed.read`.
        """
        return self.path, self.content or packed.read(self.path)

    def record(self, n_rows: int | None) -> InputFile:
        """Entry of the run record."""
        return InputFile(path=str(self.path), sha256=self.sha256, n_bytes=self.n_bytes, n_rows=n_rows)


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
    of = formats.of(content, path.name)
    if of.instead is not None:
        raise FormatError(path, f"a {of.title}, which is not read: {of.instead}")
    return Source(path, content, hashlib.sha256(stored).hexdigest(), len(stored))


def digested(path: Path) -> Source:
    """A file without its content: its digest and size.

    Raises
    ------
    FormatError
        It cannot be read.
    """
    try:
        with path.open("rb") as file:
            digest = hashlib.file_digest(file, "sha256")
            return Source(path, b"", digest.hexdigest(), file.tell())
    except OSError as e:
        raise FormatError(path, f"cannot be read: {e.strerror}") from e


LARGE_BYTES = 64 << 20
"""Size from which a text table is read in pieces. [B] Provenance: ours; below it the whole takes less than about 0.7 GB."""


def is_text_table(path: str | Path, least_bytes: int = 0) -> bool:
    """Whether this is a plain text table of at least this size, recognised by its beginning."""
    path = Path(path)
    try:
        if path.stat().st_size < least_bytes:
            return False
        with path.open("rb") as file:
            start = file.read(1 << 20)
    except OSError:
        # Whoever reads it says what is wrong.
        return False
    of = formats.of(start, path.name)
    return bool(start.strip()) and not {"packed", "nothing"} & {*of.holds} and Source(path, start, "", len(start)).kind == "csv"
