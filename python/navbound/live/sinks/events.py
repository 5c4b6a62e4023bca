"""The list of transitions beside the journals: one line of JSON each, for people and programs that follow a session.

Nothing is judged by it, and it can be made again of the journal out: what is lost of it is restored, and said.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from navbound import _core
from navbound.live import journal
from navbound.live.sinks import transition
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from navbound.live.settings import Settings


class Events:
    """The file of a session.

    Parameters
    ----------
    folder : Path
        Of the session.
    settings : Settings
        How it judges.
    say : callable
        Takes a sentence on what was restored.
    """

    def __init__(self, folder: Path, settings: Settings, *, say: Callable[[str], None]) -> None:
        self._path, self._settings, self._say = folder / journal.EVENTS, settings, say
        self._n_written = 0

    def records(self, rows: Sequence[_core._TransitionRow], *, replayed: bool) -> list[dict[str, Any]]:
        """Transitions as they are listed."""
        return [transition.record(row, self._settings, replayed=replayed) for row in rows]

    def append(self, records: Sequence[dict[str, Any]]) -> None:
        """List some more."""
        with self._path.open("a", encoding="utf-8") as file:
            file.writelines(transition.line(record) + "\n" for record in records)
        self._n_written += len(records)

    def require(self, out: Callable[[], bytes]) -> None:
        """Make the file again where it was removed while the session ran."""
        if self._n_written and not self._path.is_file():
            self.restore(out(), ahead=())

    def restore(self, out: bytes, *, ahead: Sequence[_core._TransitionRow]) -> None:
        """List what the frames of a journal out hold and the file does not; lines of transitions `ahead` are listed by the caller."""
        later = {_name(row) for row in ahead}
        rows = [row for row in _core.live_transitions(out) if _name(row) not in later]
        lines = _lines(self._path)
        listed = {(line["key"], line["transition"]) for line in lines}
        missing = [row for row in rows if _name(row) not in listed]
        self._n_written += len(lines)
        if not missing:
            return
        whole = self.records(rows, replayed=False)
        others = [line for line in lines if line.get("replayed") or (line["key"], line["transition"]) in later]
        text = "".join(transition.line(record) + "\n" for record in [*whole, *others])
        journal.put(self._path, text.encode())
        self._n_written = len(whole) + len(others)
        self._say(
            f"{self._path.name}: {len(missing)} of {counted(len(rows), 'transition')} {agreeing(len(missing), 'was', 'were')} "
            f"missing and {agreeing(len(missing), 'is', 'are')} restored from {journal.OUT}"
        )


def _name(row: _core._TransitionRow) -> tuple[str, str]:
    """What tells a transition from all others of a session."""
    key, _, _, _, turn = row[0]
    return key, turn


def _lines(path: Path) -> list[dict[str, Any]]:
    """The lines of a file that are transitions."""
    lines = []
    try:
        text = path.read_bytes().decode("utf-8", "replace")
    except FileNotFoundError:
        return []
    for line in text.splitlines():
        try:
            record = json.loads(line)
        except (ValueError, RecursionError):
            continue
        if isinstance(record, dict) and {"key", "transition"} <= record.keys():
            lines.append(record)
    return lines
