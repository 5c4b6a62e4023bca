"""What earlier jobs left in the folder: whole runs by their manifest, and broken ones, which are named as such."""

from __future__ import annotations

import hashlib
import json
import os
import stat
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from navbound.errors import FormatError, visible
from navbound.storage import folders
from navbound.workbench.files import OUT, shown, unusable

if TYPE_CHECKING:
    from collections.abc import Iterator

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
        n_left_out = 0
        for path, name, trouble in self._walk(self.folder, "", DEPTH):
            if name in busy:
                continue
            if len(listed) >= MOST_RUNS:
                n_left_out += 1
                continue
            key = (name, _state(path))
            run = _refused(path, name, trouble) if trouble else self._seen.get(key) or _read(path, name)
            seen[key] = listed[run.id] = run
        if n_left_out:
            rest = _refused(self.folder, ".", f"{MOST_RUNS} of its runs are listed, {n_left_out} more are not")
            listed[rest.id] = rest
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

    def _walk(self, folder: Path, before: str, depth: int) -> Iterator[tuple[Path, str, str]]:
        """Place, name and, where it cannot be used, the reason. What lies elsewhere than runs do, :class:`Files` lists."""
        try:
            entries = sorted(os.scandir(folder), key=lambda entry: entry.name)
        except OSError as e:
            yield folder, before.rstrip("/") or ".", f"cannot be read: {e.strerror or e}"
            return
        for entry in entries:
            if entry.name.startswith("."):
                continue
            path, name = folder / entry.name, f"{before}{entry.name}"
            among_runs = name == OUT or before.startswith(f"{OUT}/")
            try:
                mode = entry.stat(follow_symlinks=False).st_mode
            except OSError as e:
                if among_runs:
                    yield path, name, f"cannot be read: {e.strerror or e}"
                continue
            why = unusable(entry.name, mode)
            is_folder = stat.S_ISDIR(mode)
            if why and (among_runs or (is_folder and _began(path))):
                yield path, name, why
            elif is_folder and not why:
                if _began(path):
                    yield path, name, ""
                elif depth > 1:
                    yield from self._walk(path, f"{name}/", depth - 1)


def _began(path: Path) -> bool:
    """Whether a job wrote here, or began to."""
    marks = (folders.MANIFEST, _RUN, *RECORDS)
    return any(os.path.isfile(path / mark) for mark in marks) or bool(_unfinished(path) & {f"{mark}.partial" for mark in marks})


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


def _refused(path: Path, name: str, trouble: str) -> Run:
    try:
        ended_s = path.stat(follow_symlinks=False).st_mtime
    except OSError:
        ended_s = 0.0
    return Run(_id(name), shown(name), ended_s, trouble=visible(trouble))


def _id(name: str) -> str:
    return hashlib.sha256(name.encode("utf-8", "surrogateescape")).hexdigest()[:16]


def _read(path: Path, name: str) -> Run:
    manifest = path / folders.MANIFEST
    try:
        linked = [entry.name for entry in os.scandir(path) if entry.is_symlink()]
        if linked:
            raise FormatError(path, f"{linked[0]} is a link, which no job writes")
        if manifest.exists():
            _require_small(manifest)
        # What is shown of a run is what its job wrote: the manifest names every file that is read here.
        used = [each for each in (_RUN, *RECORDS, *PAGES, *_COMPARED) if os.path.lexists(path / each)]
        folders.require_whole(path, used, "a run")
        if not {_RUN, *RECORDS} & {*used}:
            raise FormatError(path, "no record says what it is")
        stated, record = _first(path, RECORDS), _json(path / _RUN)
        ended_s = manifest.stat().st_mtime
    except FormatError as e:
        began = _unfinished(path)
        refused = _refused(manifest if manifest.exists() else path, name, _words(e, path))
        return replace(refused, trouble="the job that wrote here did not finish") if began or not manifest.exists() else refused
    except OSError as e:
        return _refused(path, name, f"cannot be read: {e.strerror or e}")
    verdict = stated.get("verdict")
    words = verdict.get("words") if isinstance(verdict, dict) else stated.get("words")
    if isinstance(words, list):
        # Of a comparison all sentences are short, and the last says what moved.
        words = " ".join(map(str, words)) if (path / "comparison.json").is_file() else next(iter(words), "")
    page = next((each for each in PAGES if (path / each).is_file()), "")
    return Run(
        _id(name),
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
    """A record; nothing where there is none.

    Raises
    ------
    FormatError
        It is damaged, or larger than is read here.
    """
    if not os.path.lexists(path):
        return {}
    _require_small(path)
    try:
        value = json.loads(path.read_bytes())
    except (ValueError, RecursionError) as e:
        raise FormatError(path, f"is damaged: {e}") from e
    if not isinstance(value, dict):
        raise FormatError(path, "is damaged: no object of JSON")
    return value


def _require_small(path: Path) -> None:
    n_bytes = path.stat().st_size
    if n_bytes > _MOST_RECORD:
        raise FormatError(path, f"has {n_bytes} bytes, more than the {_MOST_RECORD} that are read here")


def _words(error: FormatError, path: Path) -> str:
    """The reason, with the name of the file where it is one of the run."""
    return error.message if error.path == path else f"{Path(error.path).name}: {error.message}"
