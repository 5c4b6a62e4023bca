"""What came in and what came out, on the disk: appended, whole or cut, with one writer.

A killed process leaves at most a torn last frame, which the next writer cuts off. A frame that is damaged elsewhere is an error.
"""

from __future__ import annotations

import fcntl
import os
from contextlib import contextmanager
from typing import TYPE_CHECKING

from navbound import _core
from navbound.errors import FormatError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

IN, OUT, SNAPSHOT, SETTINGS, EVENTS = "in.nvj", "out.nvj", "snapshot.bin", "live.json", "events.jsonl"
ACKNOWLEDGED = "acknowledged.jsonl"
"""What a person at the display has seen: written by the display, read by nobody."""
SENT = "sent.json"
"""How far a webhook has taken the transitions: written and read by who sends them."""

LONGEST_FRAME = (8 << 20) + 8
"""Bytes of the longest frame. [B]"""


class Journal:
    """A file of frames that grows.

    Attributes
    ----------
    length : int
        Bytes of whole frames. [B]
    torn : int
        Bytes that were cut off when it was opened. [B]
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        content = path.read_bytes() if path.exists() else b""
        ends, behind = _core.live_frames(content)
        self.length = ends[-1] if ends else 0
        if behind == "damaged":
            raise FormatError(path, f"a frame is damaged at byte {self.length}; move the file away to begin anew")
        _require_version(path, content[: ends[0]] if ends else b"")
        self._last = content[ends[-2] if len(ends) > 1 else 0 : self.length]
        self.torn = len(content) - self.length
        self._file = path.open("ab", buffering=0)
        self._file.truncate(self.length)

    def append(self, frames: bytes) -> int:
        """Write frames; the length then."""
        view = memoryview(frames)
        while view:
            view = view[self._file.write(view) :]
        self.length += len(frames)
        return self.length

    def cut(self, length: int) -> None:
        """Take frames off the end."""
        self._file.truncate(length)
        self.length = length

    def content(self, begin: int = 0) -> bytes:
        """Frames from a position on."""
        with self.path.open("rb") as file:
            file.seek(begin)
            return file.read(self.length - begin)

    @property
    def last_position(self) -> int:
        """Of a journal out: the position of the journal in that its last frame stands for; 0 where it has none."""
        return _core.live_last_position(self._last) if self._last else 0

    def sync(self) -> None:
        """To the disk."""
        os.fsync(self._file.fileno())

    def close(self) -> None:
        """Leave the file as it is."""
        self._file.close()


def _require_version(path: Path, first: bytes) -> None:
    """Refuse a journal out that another version wrote; what came in is read by all."""
    if path.name != OUT or not first:
        return
    try:
        _core.live_last_position(first)
    except ValueError as e:
        raise FormatError(path, f"{e}; navbound live judge makes a new one of the journal in") from e


def behind(frames: bytes, after: int, until: int | None = None) -> bytes:
    """Frames of a journal out whose inputs end behind one position, and not behind another. Positions only grow."""
    ends, _ = _core.live_frames(frames)
    kept, begin = list[bytes](), 0
    for end in ends:
        position = _core.live_last_position(frames[begin:end])
        if after < position and (until is None or position <= until):
            kept.append(frames[begin:end])
        begin = end
    return b"".join(kept)


def require_pair(folder: Path, came_in: bytes, went_out: bytes) -> None:
    """Refuse two journals that are not of one session: every output stands behind an input of the journal in, in its order.

    Raises
    ------
    FormatError
        An input or an output that cannot be read, outputs without inputs, or outputs of another journal in.
    """
    with readable(folder / IN):
        for begin, end in _parts(came_in):
            _core.live_inputs(came_in[begin:end])
    if went_out and not came_in:
        raise FormatError(folder / IN, f"is missing or empty, and {OUT} holds what was judged of it; put it back, or choose another --out")
    before, known = 0, {*_core.live_frames(came_in)[0]}
    begin = 0
    for end in _core.live_frames(went_out)[0]:
        with readable(folder / OUT):
            position = _core.live_last_position(went_out[begin:end])
            _core.live_comparable(went_out[begin:end])
        # Of a journal in that lost its end the outputs behind it are cut off.
        if position < before or (position <= len(came_in) and position not in known):
            raise FormatError(folder / OUT, _FOREIGN)
        begin, before = end, position


_FOREIGN = f"does not belong to {IN}: an output stands behind no input of it, or before an earlier one; put the session's own files back"
_PART_BYTES = 1 << 20


def _parts(frames: bytes) -> Iterator[tuple[int, int]]:
    """Begin and end of whole frames, about a megabyte together."""
    begin, ends = 0, _core.live_frames(frames)[0]
    for end in ends:
        if end - begin >= _PART_BYTES or end == ends[-1]:
            yield begin, end
            begin = end


@contextmanager
def readable(path: Path) -> Iterator[None]:
    """What cannot be read of a journal's frames is a fault of the file."""
    try:
        yield
    except FormatError:
        raise
    except ValueError as e:
        raise FormatError(path, f"not the journal of a session, or damaged: {e}") from e


def torn(path: Path) -> int:
    """Bytes behind the last whole frame of a journal: it was cut, or its writer was killed or still writes. [B]."""
    return path.stat().st_size - len(read(path))


def read(path: Path) -> bytes:
    """Whole frames of a journal that nobody writes any more, or still does.

    Raises
    ------
    FormatError
        It cannot be read, or is damaged before its end.
    """
    try:
        content = path.read_bytes()
    except OSError as e:
        raise FormatError(path, e.strerror or str(e)) from e
    ends, behind = _core.live_frames(content)
    if behind == "damaged" or not ends:
        raise FormatError(path, f"not a journal, or damaged at byte {ends[-1] if ends else 0}")
    _require_version(path, content[: ends[0]])
    return content[: ends[-1]]


@contextmanager
def alone(folder: Path) -> Iterator[None]:
    """Be the only writer in a folder.

    Raises
    ------
    FormatError
        Another process writes there.
    """
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as e:
            raise FormatError(folder, "another session writes here; choose another --out, or end it") from e
        yield
    finally:
        os.close(descriptor)


def put(path: Path, content: bytes) -> None:
    """Replace a file: whoever reads it sees the old one or the new one."""
    partial = path.with_name(f"{path.name}.partial")
    partial.write_bytes(content)
    os.replace(partial, path)
