"""Files of the folder, and new ones that are dropped: what is not in this list cannot be named by a page."""

from __future__ import annotations

import os
import shutil
import stat
from dataclasses import dataclass
from typing import TYPE_CHECKING

from navbound.errors import FormatError
from navbound.workbench.recognise import Recognised, recognise

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path
    from typing import BinaryIO

DROPPED = "dropped"
"""Folder of files that were dropped, for this user alone."""
OUT, PARTS = "out", "parts"
"""Folders of runs, and of finished parts of those that were stopped."""
DEPTH = 3
MOST_FILES = 1000
MOST_NAME_BYTES = 150
MOST_FILE_BYTES = 8 << 30
LEFT_BYTES = 1 << 30
"""Space that a dropped file leaves free on the disk. [B]"""
_PARTIAL = ".partial"
_IN_NAMES = frozenset("._-+ ()=@")


@dataclass(frozen=True)
class File:
    """One file.

    Attributes
    ----------
    name : str
        Its place within the folder, with `/`.
    n_bytes, changed_ns : int
        Size and time of the last change.
    """

    name: str
    n_bytes: int
    changed_ns: int


def tidy(name: str) -> str:
    """The name under which a dropped file is kept: that of the file without what a name of this disk should not have."""
    last = name.replace("\\", "/").rpartition("/")[2]
    kept = "".join(c if c.isalnum() or c in _IN_NAMES else "_" for c in last).strip()
    kept = kept.lstrip(".-") or "file"
    while len(kept.encode()) > MOST_NAME_BYTES:
        # The ending says what it is.
        kept = kept[1:]
    return kept


class Files:
    """The files of one folder.

    Parameters
    ----------
    folder : Path
        Which.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.n_left_out = 0
        self.known: dict[str, File] = {}
        self._recognised: dict[File, Recognised] = {}
        self._coming: set[str] = set()

    def look(self) -> None:
        """See which files there are; links are not followed, and neither runs nor hidden files are shown."""
        self.n_left_out = 0
        listed: dict[str, File] = {}
        for file in self._walk(self.folder, "", DEPTH):
            if len(listed) < MOST_FILES:
                listed[file.name] = file
            else:
                self.n_left_out += 1
        self.known = listed

    def rows(self) -> list[dict[str, object]]:
        """Every file for a page; what is new is recognised."""
        known = dict(self.known)
        fresh = {file: self._recognised.get(file) or recognise(self.folder / file.name) for file in known.values()}
        self._recognised = fresh
        newest = sorted(known.values(), key=lambda file: (not file.name.startswith(f"{DROPPED}/"), file.name.casefold()))
        return [
            {"name": f.name, "n_bytes": f.n_bytes, "changed_ns": f.changed_ns, "words": fresh[f].words, "refused": fresh[f].refused}
            for f in newest
        ]

    def take(self, name: str, n_bytes: int) -> Coming:
        """Make room for a file that is dropped.

        Raises
        ------
        FormatError
            It is larger than is taken, or leaves too little space.
        """
        place = self.folder / DROPPED
        if n_bytes > MOST_FILE_BYTES:
            raise FormatError(
                name, f"{n_bytes / 1e9:.1f} GB; a dropped file may have {MOST_FILE_BYTES / 1e9:.1f} GB: put it into the folder"
            )
        try:
            place.mkdir(mode=0o700, exist_ok=True)
            if place.is_symlink():
                raise FormatError(place, "is a link; files are not dropped there")
            free = shutil.disk_usage(place).free
        except OSError as e:
            raise FormatError(place, f"cannot be written: {e.strerror or e}") from e
        if n_bytes > free - LEFT_BYTES:
            raise FormatError(
                name, f"{n_bytes / 1e9:.1f} GB; the disk has {free / 1e9:.1f} GB and must keep {LEFT_BYTES / 1e9:.1f} GB free"
            )
        kept = self._free(place, tidy(name))
        self._coming.add(kept)
        return Coming(self, place, kept)

    def forget(self, kept: str) -> None:
        """A file that came, or did not."""
        self._coming.discard(kept)

    def _free(self, place: Path, name: str) -> str:
        stem, dot, ending = name.partition(".")
        names = (name if n == 1 else f"{stem}-{n}{dot}{ending}" for n in range(1, 10_000))
        return next(each for each in names if each not in self._coming and not os.path.lexists(place / each))

    def _walk(self, folder: Path, before: str, depth: int) -> Iterator[File]:
        try:
            entries = sorted(os.scandir(folder), key=lambda entry: entry.name)
        except OSError:
            return
        for entry in entries:
            if entry.name.startswith(".") or entry.name.endswith(_PARTIAL) or not entry.name.isprintable():
                continue
            try:
                if entry.is_dir(follow_symlinks=False):
                    if depth > 1 and not is_ours(entry, before):
                        yield from self._walk(folder / entry.name, f"{before}{entry.name}/", depth - 1)
                    continue
                state = entry.stat(follow_symlinks=False)
            except OSError:
                continue
            if stat.S_ISREG(state.st_mode):
                yield File(f"{before}{entry.name}", state.st_size, state.st_mtime_ns)


def is_ours(entry: os.DirEntry[str], before: str) -> bool:
    """Whether a folder is what jobs write: runs, and finished parts."""
    return (not before and entry.name in {OUT, PARTS}) or os.path.lexists(os.path.join(entry.path, "manifest.json"))


class Coming:
    """A file that arrives; it appears under its name when it is whole, and leaves nothing where it is not."""

    def __init__(self, files: Files, place: Path, kept: str) -> None:
        self.name = f"{DROPPED}/{kept}"
        self._files, self._kept, self._path = files, kept, place / kept
        self._partial = place / f".{kept}{_PARTIAL}"

    def __enter__(self) -> BinaryIO:
        """The file to write to: a new one, that nobody else may read."""
        descriptor = os.open(self._partial, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0), 0o600)
        self._file: BinaryIO = os.fdopen(descriptor, "wb")
        return self._file

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        """Put it in its place, or remove it."""
        self._files.forget(self._kept)
        self._file.close()
        if kind is None:
            os.replace(self._partial, self._path)
        else:
            self._partial.unlink(missing_ok=True)
