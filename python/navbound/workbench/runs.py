"""What earlier jobs left in the folder: whole runs by their manifest, and broken ones, which are named as such."""

from __future__ import annotations

import hashlib
import json
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from navbound.errors import FormatError
from navbound.storage import folders

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

DEPTH = 4
MOST_RUNS = 500
PAGES = ("report.html", "page.html", "comparison.html", "table.md")
RECORDS = ("summary.json", "prediction.json", "study.json", "comparison.json")
_COMPARED = ("summary.json", "epochs.parquet")
"""Files of a run that can be compared with another."""
_RUN = "run.json"
_MOST_RECORD = 16 << 20


@dataclass(frozen=True)
class Run:
    """One folder that a job wrote, or began to.

    Attributes
    ----------
    id : str
        What a page calls it.
    name : str
        Its place within the folder.
    ended_s : float
        Time of its manifest, or of the folder where it has none; seconds of UTC since 1970.
    title, words, verdict : str
        As it says of itself.
    command : str
        Command line that made it; empty where it is not known.
    trouble : str
        Why it is not whole; empty where it is.
    page : str
        Name of its report; empty where it has none.
    comparable : bool
        Whether it has epochs that can be compared with those of another run.
    """

    id: str
    name: str
    ended_s: float
    title: str = ""
    words: str = ""
    verdict: str = ""
    command: str = ""
    trouble: str = ""
    page: str = ""
    comparable: bool = False

    def row(self) -> dict[str, Any]:
        """For a page."""
        return dict(vars(self))


class Runs:
    """The runs of one folder.

    Parameters
    ----------
    folder : Path
        Which.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.known: dict[str, Run] = {}
        self._seen: dict[tuple[str, tuple[tuple[str, int, int], ...]], Run] = {}

    def look(self, busy: set[str]) -> None:
        """See what there is, beside the folders that jobs are writing to."""
        listed: dict[str, Run] = {}
        seen: dict[tuple[str, tuple[tuple[str, int, int], ...]], Run] = {}
        for path, name in self._walk(self.folder, "", DEPTH):
            if name in busy or len(listed) >= MOST_RUNS:
                continue
            key = (name, _state(path))
            run = self._seen.get(key) or _read(path, name)
            seen[key] = listed[run.id] = run
        self._seen, self.known = seen, dict(sorted(listed.items(), key=lambda item: -item[1].ended_s))

    def comparable(self) -> list[str]:
        """Names of the whole runs that can be compared."""
        return [run.name for run in self.known.values() if run.comparable]

    def report(self, id_: str) -> Path | None:
        """The report of a whole run; None where there is none, or it is not whole any more."""
        run = self.known.get(id_)
        if run is None or run.trouble or not run.page:
            return None
        path = self.folder / run.name
        again = self._seen.get((run.name, _state(path)))
        return path / run.page if again is run else None

    def _walk(self, folder: Path, before: str, depth: int) -> Iterator[tuple[Path, str]]:
        try:
            entries = sorted(os.scandir(folder), key=lambda entry: entry.name)
        except OSError:
            return
        for entry in entries:
            if entry.name.startswith(".") or not entry.is_dir(follow_symlinks=False) or not entry.name.isprintable():
                continue
            path, name = folder / entry.name, f"{before}{entry.name}"
            if _began(path):
                yield path, name
            elif depth > 1:
                yield from self._walk(path, f"{name}/", depth - 1)


def _began(path: Path) -> bool:
    """Whether a job wrote here, or began to."""
    marks = (folders.MANIFEST, _RUN, *RECORDS)
    return any((path / mark).is_file() for mark in marks) or bool(_unfinished(path) & {f"{mark}.partial" for mark in marks})


def _unfinished(path: Path) -> set[str]:
    try:
        return set(folders.unfinished(path))
    except OSError:
        return set()


def _state(path: Path) -> tuple[tuple[str, int, int], ...]:
    """Names, sizes and times of all files: what is the same again need not be read again."""
    try:
        states = [(entry.name, entry.stat(follow_symlinks=False)) for entry in os.scandir(path)]
    except OSError:
        return ()
    return tuple(sorted((name, state.st_size, state.st_mtime_ns) for name, state in states))


def _read(path: Path, name: str) -> Run:
    id_ = hashlib.sha256(name.encode("utf-8", "surrogateescape")).hexdigest()[:16]
    manifest = path / folders.MANIFEST
    ended_s = (manifest if manifest.exists() else path).stat().st_mtime
    try:
        linked = [entry.name for entry in os.scandir(path) if entry.is_symlink()]
        if linked:
            raise FormatError(path, f"{linked[0]} is a link, which no job writes")
        folders.require_whole(path, (), "a run")
    except FormatError as e:
        began = _unfinished(path)
        trouble = "the job that wrote here did not finish" if began or not manifest.exists() else e.message
        return Run(id_, name, ended_s, trouble=trouble)
    stated, record = _first(path, RECORDS), _json(path / _RUN)
    verdict = stated.get("verdict")
    words = verdict.get("words") if isinstance(verdict, dict) else stated.get("words")
    if isinstance(words, list):
        # Of a comparison all sentences are short, and the last says what moved.
        words = " ".join(map(str, words)) if (path / "comparison.json").is_file() else next(iter(words), "")
    page = next((each for each in PAGES if (path / each).is_file()), "")
    return Run(
        id_,
        name,
        ended_s,
        title=_title(stated) or name,
        words=_text(words),
        verdict=_text(verdict.get("id")) if isinstance(verdict, dict) else "",
        command=_text(record.get("command") or stated.get("command")),
        page=page,
        comparable=all((path / each).is_file() for each in _COMPARED),
    )


def _title(stated: dict[str, Any]) -> str:
    """What a record says that it is; of a comparison, which runs."""
    both = [_text(stated[side].get("path")) for side in ("a", "b") if isinstance(stated.get(side), dict)]
    return f"{both[0]} compared with {both[1]}" if len(both) == 2 else _text(stated.get("title"))


def _text(value: Any) -> str:
    return value if isinstance(value, str) else ""


def _first(path: Path, names: tuple[str, ...]) -> dict[str, Any]:
    return next((_json(path / name) for name in names if (path / name).is_file()), {})


def _json(path: Path) -> dict[str, Any]:
    try:
        if path.stat().st_size > _MOST_RECORD:
            return {}
        value = json.loads(path.read_bytes())
    except (OSError, ValueError, RecursionError):
        return {}
    return value if isinstance(value, dict) else {}
