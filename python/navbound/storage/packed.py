"""Files as they are kept, unpacked within a limit: one door for every reader, so that no compressed file ends the process.

``NAVBOUND_UNPACKED_BYTES`` and ``NAVBOUND_UNPACKED_RATIO`` set the limit: plain bytes in all, and plain bytes per packed byte above 64 MiB.
"""

from __future__ import annotations

import os
import stat
import zlib
from pathlib import Path
from typing import TYPE_CHECKING

from navbound import _core
from navbound.errors import FormatError, InputError

if TYPE_CHECKING:
    from collections.abc import Iterable

MOST_BYTES = 4 << 30
"""Plain bytes that a file may unpack to: fifty times the largest daily file. [B]"""
MOST_RATIO = 200
"""Plain bytes per packed byte: logs and tables pack to a third, repeated rows to a fiftieth, a bomb to a thousandth. [1]"""
ALWAYS_BYTES = 64 << 20
"""What is unpacked whatever its ratio. [B]"""


NO_SUCH_FILE = "no such file"


def require_there(paths: Iterable[str | Path]) -> None:
    """Refuse what is not there before anything heavy is loaded or worked out.

    Raises
    ------
    FormatError
        The first path that does not exist, or is a device, which need not end.
    """
    for path in paths:
        if not os.path.lexists(path):
            raise FormatError(path, NO_SUCH_FILE)
        require_no_device(path)


_STANDARD_INPUT = "/dev/stdin"


def require_no_device(path: str | Path) -> None:
    """Refuse a device (``/dev/zero``): nothing says that what it gives ends. A terminal or a pipe under ``/dev/stdin`` is none of these.

    Raises
    ------
    FormatError
        A character or block device that is no terminal.
    """
    try:
        mode = os.stat(path).st_mode
    except OSError:
        return
    if stat.S_ISBLK(mode) or (stat.S_ISCHR(mode) and not os.path.samefile(path, os.devnull) and not _is_terminal(path)):
        raise FormatError(path, "a device, not a file")
    # What is read of it once is gone, and every file is looked at before it is read. Standard input has a name of its own.
    if stat.S_ISFIFO(mode) and os.fspath(path) != _STANDARD_INPUT:
        raise FormatError(path, "a pipe, not a file; write what comes out of it to a file first (`navbound live` judges a pipe as it is)")


def _is_terminal(path: str | Path) -> bool:
    try:
        with open(path, "rb", buffering=0) as file:
            return file.isatty()
    except OSError:
        return False


def limit() -> tuple[int, int]:
    """Plain bytes in all and per packed byte, as the environment sets them. [B, 1].

    Raises
    ------
    InputError
        A setting that is no positive whole number.
    """
    return _setting("NAVBOUND_UNPACKED_BYTES", MOST_BYTES), _setting("NAVBOUND_UNPACKED_RATIO", MOST_RATIO)


def read(path: str | Path) -> bytes:
    """Bytes of a file, unpacked.

    Raises
    ------
    FormatError
        A file that cannot be read, or as :func:`plain`.
    """
    place = Path(path)
    require_no_device(place)
    try:
        stored = place.read_bytes()
    except OSError as e:
        raise FormatError(place, e.strerror or str(e)) from e
    return plain(place, stored)


def plain(path: str | Path, stored: bytes) -> bytes:
    """Unpack what may be packed.

    Raises
    ------
    FormatError
        A damaged stream, one that unpacks to more than the limit, or a packing that is not read, which is named.
    """
    try:
        unpacked = _core.unpack(stored, str(path), *limit())
    except FormatError as e:
        if (n_plain := _cut_after(stored, limit()[0])) is None:
            raise
        where = f"it ends within its packed data, after {len(stored)} bytes, which unpack to {n_plain}"
        how = "get it whole, or write what is left of it to a file first (gzip -dc FILE > PART)"
        raise FormatError(path, f"the gzip stream is damaged: {where}; the file looks cut: {how}") from e
    return stored if unpacked is None else unpacked


_GZIP, _GZIP_WINDOW = b"\x1f\x8b", 31
_PIECE_BYTES, _STEP_BYTES = 1 << 16, 1 << 20


def _cut_after(stored: bytes, most: int) -> int | None:
    """How many bytes a gzip file unpacks to that ends too early; None where it does not, or where its data are damaged. [B]."""
    n_plain, at, stream = 0, 0, None
    try:
        while at < len(stored) and n_plain <= most:
            if stream is None:
                # Files of several members are one after the other.
                if stored[at : at + 2] != _GZIP[: len(stored) - at]:
                    return None
                stream = zlib.decompressobj(_GZIP_WINDOW)
            piece = stored[at : at + _PIECE_BYTES]
            n_plain += len(stream.decompress(piece, _STEP_BYTES))
            at += len(piece) - len(stream.unconsumed_tail) - len(stream.unused_data)
            stream = None if stream.eof else stream
    except zlib.error:
        return None
    return n_plain if stream is not None and n_plain <= most else None


def require_room(path: str | Path, packed: int, unpacked: int) -> None:
    """Refuse what says of itself that it unpacks to more than the limit.

    Parameters
    ----------
    path : str or Path
        The file, for the message.
    packed, unpacked : int
        Its size on the disk and in memory. [B]

    Raises
    ------
    FormatError
        Above the limit.
    """
    total, ratio = limit()
    most = min(total, max(ratio * packed, ALWAYS_BYTES))
    if unpacked > most:
        sizes = f"its {packed / 1e6:.1f} MB unpack to {unpacked / 1e6:.0f} MB, more than the {most / 1e6:.0f} MB that are allowed"
        raise FormatError(path, f"{sizes} (NAVBOUND_UNPACKED_BYTES, NAVBOUND_UNPACKED_RATIO)")


def _setting(name: str, default: int) -> int:
    text = os.environ.get(name)
    if text is None:
        return default
    if not (text.isascii() and text.isdigit() and len(text) < 19 and int(text) > 0):
        raise InputError(name, text[:60], domain="a positive whole number")
    return int(text)
