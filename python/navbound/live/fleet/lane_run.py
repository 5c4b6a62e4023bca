"""One lane between its two logs: a worker may be killed anywhere and another go on, and what went out is as if one had never stopped.

The order of one round: frames are read from what came in, judged, their transitions written to what went out, then reported, then perhaps
a snapshot is kept. Who takes a lane over restores the newest good snapshot, judges again from there, and compares with what is out already.
"""

from __future__ import annotations

import contextlib
import json
import time
import zlib
from typing import TYPE_CHECKING, Any

from navbound import _core
from navbound.errors import FormatError
from navbound.live import journal
from navbound.live.fleet.transport import UnreachableError
from navbound.live.session import now_ns
from navbound.live.statements import unread
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from collections.abc import Callable

    from navbound.live.fleet.transport import Log, Transport

SNAPSHOT_S = 5.0
STATES_S = 1.0
STATES_MOST = 500
"""Epochs of a frame of states: about 125 kB."""


class LaneRun:
    """A lane that this process has claimed.

    Parameters
    ----------
    transport : Transport
        Of the fleet.
    lane : int
        Which.
    settings : LiveSettings
        How it judges.
    report : callable
        Takes transitions once they are written.
    say : callable
        Takes sentences.

    Attributes
    ----------
    position : int
        Behind what was judged. [B]
    replayed : int
        Bytes that were judged again when the lane was taken over. [B]

    Raises
    ------
    FormatError
        A log is damaged, or gives other outputs when it is judged again.
    FencedError
        Another worker has the lane.
    """

    def __init__(
        self,
        transport: Transport,
        lane: int,
        settings: _core.LiveSettings,
        *,
        report: Callable[[list[_core._TransitionRow]], None],
        say: Callable[[str], None],
    ) -> None:
        self.lane, self._transport, self._settings = lane, transport, settings
        self._report, self._say = report, say
        self._in, self._out = transport.came_in(lane), transport.went_out(lane)
        self._written = self._out.end()
        self._unsent = b""
        self._core, self.position, begun = self._restored()
        self.replayed = 0
        self._last, self._judged_ns, self._heard_s = b"", 0, time.monotonic()
        self.n_epochs = 0
        self._named: set[str] = set()
        self._recover(begun)
        self._snapshot_at = self._shown_at = time.monotonic()

    def _restored(self) -> tuple[_core.LiveLane, int, int]:
        """The lane of the newest good snapshot, the position it stands behind, and what was out then."""
        for content in self._transport.kept(self.lane):
            try:
                core, position, written = _core.LiveLane.restore(self._settings, zlib.decompress(content))
            except (ValueError, zlib.error) as e:
                self._say(f"lane {self.lane}: a snapshot is refused: {e}")
                continue
            if written <= self._written:
                return core, position, written
            self._say(f"lane {self.lane}: a snapshot is refused: it is ahead of what went out")
        return _core.LiveLane(self._settings), 0, 0

    def _recover(self, begun: int) -> None:
        """Judge again until all that is out already was judged; a difference is no repeat of the same lane."""
        expected, at = list[tuple[int, bytes]](), begun
        while at < self._written:
            frames = self._out.read(at)
            if not frames:
                self._wait(self._out, at)
                continue
            expected += _core.live_comparable(frames)
            at += len(frames)
        if not expected:
            return
        committed, again = expected[-1][0], list[tuple[int, bytes]]()
        while self.position < committed:
            frames = self._in.read(self.position)
            if not frames:
                self._wait(self._in, self.position)
                continue
            begin = self.position
            written = self._push(frames)
            self.replayed += self.position - begin
            again += [output for output in _core.live_comparable(written) if output[0] <= committed]
            self._write(journal.behind(written, committed))
        if again != expected:
            raise FormatError(
                self._transport.name, f"lane {self.lane}: judged again it gives other outputs than went out; please report it"
            )
        self._say(
            f"lane {self.lane}: recovered, {counted(self.replayed, 'byte')} judged again, "
            f"{counted(len(again), 'output was', 'outputs were')} out already"
        )

    def _wait(self, log: Log, at: int) -> None:
        """Until a log that holds more gives it."""
        if log.end() <= at:
            raise FormatError(self._transport.name, f"lane {self.lane}: what went out was made of inputs that are not there any more")
        self._transport.wait()

    def _push(self, frames: bytes) -> bytes:
        taken, written, _, n_epochs, behind = self._core.push(frames, self.position, now_ns(), epochs=False)
        if taken != len(frames):
            raise FormatError(self._transport.name, f"lane {self.lane}: an input is {behind} at byte {self.position + taken}")
        self.position += taken
        self.n_epochs += n_epochs
        return written

    def _write(self, written: bytes) -> bool:
        """Write outputs behind those that nobody took yet; whether all are out."""
        self._unsent += written
        if self._unsent:
            try:
                self._out.append(self._unsent, self._written)
            except UnreachableError:
                # What may stand there already is recognised when it is written again.
                return False
            self._written += len(self._unsent)
            self._report(_core.live_transitions(self._unsent))
            self._unsent = b""
        return True

    def step(self) -> int:
        """Judge what is there; how many bytes. What was judged is out before more is read."""
        if not self._write(b""):
            return 0
        frames = self._in.read(self.position)
        if not frames:
            self._show()
            return 0
        self._last, self._judged_ns, self._heard_s = frames, now_ns(), time.monotonic()
        written = self._push(frames)
        if not self._write(written):
            return len(frames)
        if time.monotonic() - self._snapshot_at > SNAPSHOT_S:
            with contextlib.suppress(UnreachableError):
                self.snapshot()
        self._show()
        return len(frames)

    @property
    def is_unsent(self) -> bool:
        """Whether outputs wait that nobody took yet."""
        return bool(self._unsent)

    def snapshot(self) -> None:
        """Keep the state behind all that was judged."""
        self._transport.keep(self.lane, zlib.compress(self._core.snapshot(self.position, self._written), 1))
        self._snapshot_at = time.monotonic()

    def _show(self) -> None:
        if time.monotonic() - self._shown_at < STATES_S:
            return
        self._shown_at = time.monotonic()
        self.show()

    def show(self) -> None:
        """Show the newest states and what was counted, and name keys that nothing reads as they come."""
        if new := self._core.passed_over().keys() - self._named:
            self._named |= new
            self._say(f"lane {self.lane}: {unread(new)}")
        status: dict[str, Any] = {"lane": self.lane, "position": self.position}
        status |= {"n_tracks": self._core.n_tracks, "event_ns": self._core.event_time_ns}
        status |= {"lag_s": self._lag_s(), "heard_s": round(time.monotonic() - self._heard_s, 2), "counters": self._core.counters()}
        self._transport.show(self.lane, json.dumps(status).encode(), self._core.states(now_ns(), STATES_MOST))

    def _lag_s(self) -> float | None:
        """How old the newest input was when it was judged. [s]."""
        inputs = _core.live_inputs(self._last)
        arrival = inputs[-1][1] if inputs else None
        return None if arrival is None else round((self._judged_ns - arrival) / 1e9, 3)

    @property
    def event_time_ns(self) -> int | None:
        """Largest time of the data. [ns]."""
        return self._core.event_time_ns

    def counters(self) -> dict[str, Any]:
        """What was counted."""
        return dict(self._core.counters())

    def release(self) -> None:
        """Keep the state, unless what it gave could not be written, and give the lane back."""
        # What is shown is out: no lane whose outputs could not be written counts as judged.
        if self._write(b""):
            with contextlib.suppress(UnreachableError):
                self.snapshot()
            self.show()
        self._transport.release(self.lane)
