"""The end of a journal that another process writes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from navbound import _core
from navbound.errors import FormatError

if TYPE_CHECKING:
    from pathlib import Path

SLICE = 1 << 20
"""Bytes of a journal that are read at once. [B]"""


class Tail:
    """Whole frames at the end of a file that another process writes.

    Attributes
    ----------
    behind : bool
        Whether there is more to read at once.
    """

    def __init__(self, path: Path) -> None:
        self.path, self._at, self._left, self.behind = path, 0, b"", False

    def frames(self) -> bytes:
        """Whole frames that were added.

        Raises
        ------
        FormatError
            A frame is damaged, or the file became shorter: it is another session's.
        """
        try:
            with self.path.open("rb") as file:
                size = file.seek(0, 2)
                if size < self._at:
                    raise FormatError(self.path, "became shorter while it was read: another session writes it")
                file.seek(self._at)
                read = file.read(SLICE)
        except FileNotFoundError:
            return b""
        self._at += len(read)
        self.behind = self._at < size
        content = self._left + read
        ends, behind = _core.live_frames(content)
        end = ends[-1] if ends else 0
        if behind == "damaged":
            raise FormatError(self.path, f"a frame is damaged at byte {self._at - len(content) + end}")
        self._left = content[end:]
        return content[:end]
