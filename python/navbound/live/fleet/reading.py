"""What the workers of a fleet wrote, read by somebody else."""

from __future__ import annotations

import contextlib
import json
from typing import TYPE_CHECKING, Any

from navbound import _core
from navbound.live.settings import Settings
from navbound.live.sinks import transition

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from navbound.live.fleet.transport import Transport


class Reader:
    """Transitions of all lanes, each once.

    Parameters
    ----------
    transport : Transport
        Of the fleet.
    """

    def __init__(self, transport: Transport) -> None:
        self._logs = [transport.went_out(lane) for lane in range(transport.n_lanes)]
        self._at = [0] * transport.n_lanes
        self._settings = Settings(**transport.record["settings"])
        self._replayed = transport.record["origin"]["kind"] != "live"

    def more(self) -> list[dict[str, Any]]:
        """Those since the last call: a part of what is there, lane by lane."""
        entry = list[dict[str, Any]]()
        for lane, log in enumerate(self._logs):
            frames = log.read(self._at[lane])
            self._at[lane] += len(frames)
            rows = _core.live_transitions(frames)
            entry += [transition.record(row, self._settings, replayed=self._replayed) for row in rows]
        return entry

    @property
    def behind(self) -> bool:
        """Whether there is more; asks whoever carries the fleet."""
        return any(at < log.end() for at, log in zip(self._at, self._logs, strict=True))


def newest_status(transport: Transport, lane: int) -> dict[str, Any]:
    """What a lane's worker has shown last since the last call; nothing where there is none, or it is damaged."""
    for status, _ in reversed(transport.shown(lane)):
        with contextlib.suppress(ValueError):
            shown = json.loads(status)
            if isinstance(shown, dict) and isinstance(shown.get("position"), int) and isinstance(shown.get("counters"), dict):
                return shown
    return {}


def records(transport: Transport, *, stop: Callable[[], bool], follow: bool) -> Iterator[dict[str, Any]]:
    """Every transition until now, or until `stop`."""
    reader = Reader(transport)
    while not stop():
        entry = reader.more()
        yield from entry
        if not entry and not follow and not reader.behind:
            return
        if not entry:
            transport.wait()
