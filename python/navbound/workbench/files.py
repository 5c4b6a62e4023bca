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
MOST_UNUSABLE = 200
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
    unusable : str
        Why it cannot be named by a page; empty where it can. Its name is as it is shown then.
    """

    name: str
    n_bytes: int
    changed_ns: int
    unusable: str = ""


def tidy(name: str) -> str:
    """The name under which a dropped file is kept: that of the file without what a name of this disk should not have."""
    last = name.replace("\\", "/").rpartition("/")[2]
    kept = "".join(c if c.isalnum() or c in _IN_NAMES else "_" for c in last).strip()
    kept = kept.lstrip(".-") or "file"
    while len(kept.encode()) > MOST_NAME_BYTES:
        # The ending says what it is.
        kept = kept[1:]
    return kept


def shown(name: str) -> str:
    """A name in which every character can be seen: others by their number."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in name)


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
        self.refused: list[File] = []
        self._recognised: dict[File, Recognised] = {}
        self._coming: set[str] = set()

    def look(self) -> None:
        """See which files there are; links are listed and not followed, and neither runs nor hidden files are shown."""
        self.n_left_out = 0
        listed: dict[str, File] = {}
        refused: list[File] = []
        for file in self._walk(self.folder, "", DEPTH):
            if len(refused if file.unusable else listed) >= (MOST_UNUSABLE if file.unusable else MOST_FILES):
                self.n_left_out += 1
            elif file.unusable:
                refused.append(file)
            else:
                listed[file.name] = file
        self.known, self.refused = listed, refused

    def rows(self) -> list[dict[str, object]]:
        """Every file for a page; what is new is recognised."""
        known, refused = dict(self.known), list(self.refused)
        fresh = {file: self._recognised.get(file) or recognise(self.folder / file.name) for file in known.values()}
        self._recognised = fresh
        fresh |= {file: Recognised(file.unusable, refused=True) for file in refused}
        newest = sorted([*known.values(), *refused], key=lambda file: (not file.name.startswith(f"{DROPPED}/"), file.name.casefold()))
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
        except OSError as e:
            yield File(before.rstrip("/") or ".", 0, 0, f"a folder that cannot be read: {e.strerror or e}")
            return
        for entry in entries:
            if entry.name.startswith(".") or entry.name.endswith(_PARTIAL):
                continue
            name = f"{before}{entry.name}"
            try:
                state = entry.stat(follow_symlinks=False)
                is_folder = stat.S_ISDIR(state.st_mode)
                if is_folder and is_ours(entry, before):
                    continue
            except OSError as e:
                yield File(shown(name), 0, 0, f"cannot be read: {e.strerror or e}")
                continue
            why = unusable(entry.name, state.st_mode)
            if why or (is_folder and depth <= 1):
                why = why or f"a folder {DEPTH} deep: its files are not listed"
                yield File(shown(name), state.st_size, state.st_mtime_ns, why)
            elif is_folder:
                yield from self._walk(folder / entry.name, f"{name}/", depth - 1)
            else:
                yield File(name, state.st_size, state.st_mtime_ns)


def unusable(name: str, mode: int) -> str:
    """Why an entry of a folder cannot be named by a page; empty where it can."""
    if stat.S_ISLNK(mode):
        return "a link, which is not followed"
    if not name.isprintable():
        return "its name has characters that cannot be shown: rename it"
    return "" if stat.S_ISREG(mode) or stat.S_ISDIR(mode) else "is not a file"


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
