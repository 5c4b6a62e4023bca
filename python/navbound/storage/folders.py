"""Folders that a job writes: nothing of anyone else's is touched, and a folder is whole or no reader takes it.

Every file is written beside its place, under its name and ``.partial``. When all are there they are renamed, and the manifest with their
digests is renamed last. A reader takes a folder only with a manifest that agrees with every file, so a job that was killed at any instant
leaves either what stood there before or a folder that no reader takes for a result.
"""

from __future__ import annotations

import errno
import hashlib
import json
import os
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from navbound.errors import FormatError

try:
    import fcntl
except ImportError:  # pragma: no cover - where there are no file locks two jobs in one folder are not noticed
    fcntl = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator

MANIFEST = "manifest.json"
_PARTIAL = ".partial"


class Writer:
    """Takes the files of one job; they appear together when the ``with`` of :func:`own` ends.

    Attributes
    ----------
    folder : Path
        Where they appear.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._names: list[str] = []

    def write(self, name: str, write: Callable[[Path], object]) -> None:
        """Have a file written; `write` is called with the path that it shall write to."""
        self._names.append(name)
        write(self.folder / f"{name}{_PARTIAL}")

    def text(self, name: str, content: str) -> None:
        """Have a text written."""
        self.write(name, lambda path: path.write_text(content, encoding="utf-8"))

    def appear(self) -> None:
        """Put every file in its place; the manifest last."""
        files = {name: _digest(self.folder / f"{name}{_PARTIAL}") for name in self._names}
        self.text(MANIFEST, json.dumps({"files": files}, indent=1))
        (self.folder / MANIFEST).unlink(missing_ok=True)
        for name in self._names:
            os.replace(self.folder / f"{name}{_PARTIAL}", self.folder / name)

    def forget(self) -> None:
        """Remove what was written and did not appear, also what a writer of whole files began beside it."""
        for remains in _remains(self.folder):
            remains.unlink(missing_ok=True)


@contextmanager
def own(out: Path, ours: Collection[str], whose: str) -> Iterator[Writer]:
    """Make a folder and write in it, alone, from before the work until its files are there.

    Parameters
    ----------
    out : Path
        Which.
    ours : collection of str
        Names that may stand in it already.
    whose : str
        In the refusal of anything else: "a run's".

    Raises
    ------
    FormatError
        The folder holds something else, or another job writes in it; or it, or a file of it, cannot be written.
    """
    known = {MANIFEST, *ours}
    try:
        out.mkdir(parents=True, exist_ok=True)
        strangers = sorted(p.name for p in out.iterdir() if _place(p.name) not in known)
        if strangers:
            raise FormatError(out, f"holds files that are not {whose} ({', '.join(strangers[:3])}); choose another --out")
        with _alone(out):
            for remains in _remains(out):
                remains.unlink()
            writer = Writer(out)
            try:
                yield writer
                writer.appear()
            except BaseException:
                writer.forget()
                raise
    except OSError as e:
        raise FormatError(out, f"cannot be written: {e.strerror or e}") from e
    except Exception as e:
        # What Parquet is written by has errors of its own; it is not loaded here, where only what writes needs it.
        if not type(e).__module__.startswith("polars"):
            raise
        raise FormatError(out, f"cannot be written: {str(e).splitlines()[0]}") from e


def _remains(folder: Path) -> list[Path]:
    return [path for path in folder.iterdir() if _place(path.name) != path.name]


def unfinished(folder: Path) -> list[str]:
    """Names of what a later job began to write in a whole folder and did not finish, or has not finished yet."""
    return sorted(path.name for path in _remains(folder))


def _place(name: str) -> str:
    """The name under which a file appears; what writes whole files itself puts the suffix on once more."""
    while name.endswith(_PARTIAL):
        name = name.removesuffix(_PARTIAL)
    return name


@contextmanager
def _alone(out: Path) -> Iterator[None]:
    """Hold the folder's lock, which ends with the process and leaves no file."""
    if fcntl is None:
        yield
        return
    descriptor = os.open(out, os.O_RDONLY)
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as e:
            if e.errno in (errno.EWOULDBLOCK, errno.EACCES):
                raise FormatError(out, "another job is writing here; choose another --out, or wait for it") from e
            # A file system without locks (some network folders) is no reason to refuse the job.
        yield
    finally:
        os.close(descriptor)


def require_whole(folder: Path, needed: Collection[str], what: str) -> None:
    """Refuse a folder that is not whole.

    Raises
    ------
    FormatError
        No manifest, or one that does not agree with the files: the job that wrote here did not finish, or a file was changed after it.
    """
    try:
        _require_file(folder / MANIFEST)
        content = json.loads((folder / MANIFEST).read_bytes())
        files = {str(name): str(digest) for name, digest in content["files"].items()}
    except FileNotFoundError as e:
        missing = "no such folder" if not folder.is_dir() else f"no {MANIFEST}: the job that wrote here did not finish"
        raise FormatError(folder, f"is not {what} ({missing})") from e
    except OSError as e:
        raise FormatError(folder, f"is not {what}: {e.strerror or e}") from e
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as e:
        raise FormatError(folder / MANIFEST, f"is damaged: {e}") from e
    absent = sorted(set(needed) - files.keys())
    if absent:
        raise FormatError(folder, f"is not {what}: its manifest lacks {', '.join(absent)}")
    # What lies in the folder itself, the page among it, is what people open.
    for name in sorted({*needed, *(name for name in files if Path(name).name == name)}):
        try:
            _require_file(folder / name)
            actual = _digest(folder / name)
        except OSError as e:
            raise FormatError(folder / name, f"cannot be read: {e.strerror or e}") from e
        except ValueError as e:
            raise FormatError(folder / MANIFEST, f"names what no file can be called: {e}") from e
        if actual != files[name]:
            raise FormatError(folder / name, f"is not the file that the job wrote: its digest differs from the one in {MANIFEST}")


def _require_file(path: Path) -> None:
    """Refuse a pipe or a device in the place of a file: nothing says that reading it ends."""
    if path.exists() and not path.is_file():
        raise FormatError(path, "is not a file")


def _digest(path: Path) -> str:
    with path.open("rb") as content:
        return hashlib.file_digest(content, "sha256").hexdigest()
