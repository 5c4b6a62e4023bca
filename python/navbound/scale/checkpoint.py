"""Finished tiles in a folder."""

from __future__ import annotations

import hashlib
import os
import pickle
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from navbound import _core
from navbound.errors import FormatError

if TYPE_CHECKING:
    from typing import BinaryIO

    from numpy.typing import NDArray

_DIGEST_BYTES = 64
"""SHA-256 in hexadecimal. [B]"""


class Nothing:
    """Keeps nothing."""

    def load(self, index: int, tile: object) -> None:
        """Nothing is there."""

    def store(self, index: int, tile: object, result: dict[str, NDArray[np.generic]]) -> None:
        """Nothing is kept."""


class Folder:
    """One file a tile; its last 64 bytes (the comment of the archive) hold the digest of all before them, so that no changed tile is taken.

    Its name holds a digest of version, function and tile, so that no job takes the tile of another.
    """

    def __init__(self, path: str | Path, function: object) -> None:
        self.path = Path(path)
        self._function = pickle.dumps((_core.__version__, function))
        try:
            self.path.mkdir(parents=True, exist_ok=True)
        except OSError as e:
            raise FormatError(self.path, f"cannot keep tiles: {e.strerror}") from e

    def file(self, index: int, tile: object) -> Path:
        """Where a tile's result lies."""
        digest = hashlib.sha256(self._function + pickle.dumps(tile)).hexdigest()[:24]
        return self.path / f"tile-{index:06d}-{digest}.npz"

    def load(self, index: int, tile: object) -> dict[str, NDArray[np.generic]] | None:
        """A tile's result; None where there is none, or none that is what was kept: it is worked off again."""
        file = self.file(index, tile)
        try:
            with file.open("rb") as content:
                # Only what this class wrote is taken apart: whatever else lies there has no way to fail.
                if _stated(content) != _digest(content):
                    return None
                with np.load(content, allow_pickle=False) as columns:
                    return {name: columns[name] for name in columns.files}
        except (OSError, ValueError, zipfile.BadZipFile):
            # A digest that agrees with something else before it is that of another program.
            return None

    def store(self, index: int, tile: object, result: dict[str, NDArray[np.generic]]) -> None:
        """Keep a result: written whole under another name, then renamed, so that a kill leaves no half tile."""
        file = self.file(index, tile)
        partial = file.with_suffix(".partial")
        try:
            # Not savez: the keyword names it needs clash with a column called "file".
            with zipfile.ZipFile(partial, "w") as archive:
                archive.comment = b"0" * _DIGEST_BYTES
                for name, values in result.items():
                    with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                        np.lib.format.write_array(member, np.asarray(values), allow_pickle=False)
            with partial.open("r+b") as content:
                digest = _digest(content)
                content.seek(-_DIGEST_BYTES, os.SEEK_END)
                content.write(digest)
            partial.replace(file)
        except OSError as e:
            # Half a tile on a full disk is of no use, and in the way.
            partial.unlink(missing_ok=True)
            raise FormatError(self.path, f"cannot keep tile {index}: {e.strerror}") from e


def _stated(content: BinaryIO) -> bytes:
    """The digest at the end of a tile; of a file that has no room for one, nothing."""
    if content.seek(0, os.SEEK_END) < _DIGEST_BYTES:
        return b""
    content.seek(-_DIGEST_BYTES, os.SEEK_END)
    return content.read()


def _digest(content: BinaryIO) -> bytes:
    """The digest of what stands before it; the file is left at its start."""
    left = max(content.seek(0, os.SEEK_END) - _DIGEST_BYTES, 0)
    content.seek(0)
    digest = hashlib.sha256()
    while left and (piece := content.read(min(left, 1 << 20))):
        digest.update(piece)
        left -= len(piece)
    content.seek(0)
    return digest.hexdigest().encode()
