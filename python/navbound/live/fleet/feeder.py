"""The feeder: reads one source, writes its lines down by lane, and passes them on.

Lines are grouped for 50 ms, so that a broker carries frames and not records. Before a broker there is a spool on the disk of this host:
what was read once is there, and goes on from the position that the broker has, however long that was away.
"""

from __future__ import annotations

import json
import threading
import time
from typing import TYPE_CHECKING

from navbound import _core
from navbound.errors import ConflictError
from navbound.live.fleet.transport import FencedError, UnreachableError
from navbound.live.session import Pace, now_ns

if TYPE_CHECKING:
    from collections.abc import Callable

    from navbound.live.fleet.transport import Log, Transport
    from navbound.live.settings import Settings
    from navbound.live.source import Source

FRAME_S = 0.05
"""Time for which lines are grouped. [s]"""
FRAME_BYTES = 256 * 1024
HEARTBEAT_S = 1.0
AGAIN_S = 0.5


class Feeder:
    """Writes what a source gives into the lanes of a fleet.

    Parameters
    ----------
    spool : Transport
        Files of this host, where what was read is written down.
    settings : Settings
        Of the fleet.
    target : Transport, optional
        The broker that the spool is passed on to; without one the spool is the fleet.
    say : callable, optional
        Takes sentences.

    Attributes
    ----------
    n_bytes : int
        Of the source. [B]
    """

    def __init__(
        self, spool: Transport, settings: Settings, *, target: Transport | None = None, say: Callable[[str], None] = lambda _: None
    ) -> None:
        self._logs = [spool.came_in(lane) for lane in range(spool.n_lanes)]
        self._ends = [log.end() for log in self._logs]
        self._splitter = _core.LiveSplitter(settings.format, spool.n_lanes)
        self._say, self.n_bytes = say, 0
        self.event_ns: int | None = None
        self._forwards = [] if target is None else [_Forward(log, target.came_in(k), say) for k, log in enumerate(self._logs)]

    @property
    def n_waiting(self) -> int:
        """Bytes that the broker has not taken yet. [B]."""
        return sum(max(0, end - forward.position) for end, forward in zip(self._ends, self._forwards, strict=False))

    def run(self, source: Source, *, stop: Callable[[], bool] = lambda: False, pace: Callable[[bytes], None] = lambda _: None) -> None:
        """Feed until the end of a source, or until `stop`.

        Parameters
        ----------
        source : Source
            Opened.
        stop : callable
            Called at least each tenth of a second.
        pace : callable
            Takes each piece of a recording before it is written, and lets time pass.

        Raises
        ------
        ConflictError
            A recording into a fleet that holds something: its records would come twice.
        """
        if any(self._ends) and not source.live:
            raise ConflictError("to", because="a recording is fed once, and this fleet holds inputs already; choose a new one")
        up, beat, ended, data, since = True, time.monotonic(), False, bytearray(), time.monotonic()
        while not stop():
            read = source.read(FRAME_S)
            now = time.monotonic()
            if read:
                data += read
                pace(read)
            if data and (now - since >= FRAME_S or len(data) >= FRAME_BYTES or read is None or not source.live):
                self._chunk(bytes(data), live=source.live)
                data.clear()
                since = now
            if not data:
                since = now
            if read is None:
                ended = True
                break
            if source.live and source.up != up:
                up = source.up
                self._all("up" if up else "down", now_ns())
            if source.live and now - beat >= HEARTBEAT_S:
                beat = now
                self._all("heartbeat", now_ns())
            self._check()
        if ended:
            self._all("end", now_ns() if source.live else None)
        while self.n_waiting and not stop():
            self._check()
            time.sleep(FRAME_S)
        self.close()

    def _chunk(self, data: bytes, *, live: bool) -> None:
        self.n_bytes += len(data)
        arrival = now_ns() if live else None
        for lane, lines in enumerate(self._splitter.push(data)):
            if lines:
                self._append(lane, _core.live_input("chunk", arrival, lines))

    def _all(self, kind: str, arrival: int | None) -> None:
        # A nanosecond apart: an alert of the source has a key of its own in each lane.
        for lane in range(len(self._logs)):
            self._append(lane, _core.live_input(kind, None if arrival is None else arrival + lane, b""))

    def _append(self, lane: int, frames: bytes) -> None:
        self._logs[lane].append(frames, self._ends[lane])
        self._ends[lane] += len(frames)
        if self._forwards:
            self._forwards[lane].more.set()

    def _check(self) -> None:
        for forward in self._forwards:
            if forward.trouble is not None:
                raise forward.trouble

    def close(self) -> None:
        """End the threads that pass on; what the broker has not is in the spool."""
        for forward in self._forwards:
            forward.end()


class _Forward:
    """Passes one log on, in order, one piece in flight."""

    def __init__(self, log: Log, target: Log, say: Callable[[str], None]) -> None:
        self._log, self._target, self._say = log, target, say
        self.position = target.end()
        self.more, self._stop = threading.Event(), threading.Event()
        self.trouble: Exception | None = None
        self.more.set()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self) -> None:
        lost = False
        while not self._stop.is_set():
            self.more.wait(FRAME_S)
            self.more.clear()
            try:
                while not self._stop.is_set() and (frames := self._log.read(self.position)):
                    self._target.append(frames, self.position)
                    self.position += len(frames)
                    if lost:
                        self._say("the broker is back; what was read meanwhile follows")
                        lost = False
            except UnreachableError as e:
                if not lost:
                    self._say(f"{e}; what is read meanwhile stays on the disk and follows")
                    lost = True
                self._stop.wait(AGAIN_S)
            except (FencedError, ValueError, OSError) as e:
                self.trouble = e
                return

    def end(self) -> None:
        """Stop."""
        self._stop.set()
        self._thread.join(5.0)


def paced(speed: float, time_of: Callable[[bytes], int | None], stop: Callable[[], bool]) -> Callable[[bytes], None]:
    """What lets a recording pass at a multiple of its own pace, by the times in its lines."""
    kept = Pace(speed)

    def wait(piece: bytes) -> None:
        kept.wait(time_of(piece), stop)

    return wait


def time_of(form: str) -> Callable[[bytes], int | None]:
    """What finds the time of the first line of a piece that has one: nanoseconds of the same kind throughout, for pacing alone."""
    key, scale = ("now", 1e9) if form == "readsb" else ("time_ns", 1.0)

    def of(piece: bytes) -> int | None:
        for line in piece.split(b"\n"):
            try:
                return int(float(json.loads(line)[key]) * scale)
            except (ValueError, KeyError, TypeError, RecursionError, OverflowError):
                continue
        return None

    return of
