"""One source under the lane, with a journal: killed at any point and resumed, it gives what an undisturbed session gives.

The order of one round: bytes are written to the journal in, judged, their outputs written to the journal out, then shown, then perhaps a
snapshot is taken. On a restart the newest good snapshot is restored, the journal in is read from there, outputs that are written already
are compared and not written again.
"""

from __future__ import annotations

import json
import time
from contextlib import ExitStack
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from navbound import __version__, _core
from navbound.errors import FormatError, InputError
from navbound.live import journal
from navbound.live.settings import load
from navbound.live.sinks.events import Events
from navbound.live.source import File
from navbound.live.statements import unread
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from navbound.live.settings import Settings
    from navbound.live.source import Source

_HEARTBEAT_S = 1.0
_SNAPSHOT_S = 5.0
_WAIT_S = 0.1
_SLICE = 1 << 20
"""Journal bytes that are judged at once when a session is resumed. [B]"""


def now_ns() -> int:
    """GPS time by the clock of this host, which is taken to be disciplined to UTC. [ns]."""
    return int(_core.gps_from_unix_ns(np.array([time.time_ns()], dtype=np.int64))[0])


@dataclass(frozen=True)
class Origin:
    """Where the data of a session come from: for people and pages, nothing is judged by it.

    Attributes
    ----------
    kind : {"live", "recording", "replay"}
        Data that arrive now, a file or run that is read, or a journal that is read again.
    source : str
        Its name.
    speed : float, optional
        Times the pace of the data; 0 as fast as it goes; None: the data have their own. [1]
    points : list of lists
        Latitude, longitude, course [rad] and RNP [m] along the path.
    limits : dict, optional
        Alert limits beside which protection levels are shown: ``name``, ``hal_m``, ``val_m``.
    """

    kind: Literal["live", "recording", "replay"] = "recording"
    source: str = ""
    speed: float | None = None
    points: list[list[float]] = field(default_factory=list)
    limits: dict[str, Any] | None = None


def origin_of(folder: Path) -> dict[str, Any]:
    """Where the data of a session come from, as its folder says."""
    try:
        kept = json.loads((folder / journal.SETTINGS).read_text(encoding="utf-8")).get("origin")
    except (OSError, ValueError) as e:
        raise FormatError(folder / journal.SETTINGS, f"not the settings of a live session: {e}") from e
    return {"kind": "recording", "source": "", "speed": None, "points": [], "limits": None} | (kept if isinstance(kept, dict) else {})


_OTHERWISE = (
    f"{journal.IN} judged again gives other outputs than stand here: one of the two was changed, or another version of navbound "
    "wrote them; navbound live judge makes a new session of the journal in. If nobody touched the folder, please report it"
)


class Session:
    """A lane between two journals.

    Parameters
    ----------
    out : Path
        Folder of the session.
    settings : Settings
        How it judges.
    origin : Origin, optional
        Kept in the folder, for the display.
    resume : bool
        Go on with what stands in the folder; otherwise it must be empty.
    report : callable, optional
        Takes each transition once it is written.
    say : callable, optional
        Takes sentences about the session itself.
    passed : callable, optional
        Called with the name of each point of a round; a test ends the process there.

    Attributes
    ----------
    unfinished : str, optional
        Why the source was not judged to its end; None where it was, or where it has no end.

    Raises
    ------
    FormatError
        The folder holds something else, is written by another process, or holds a damaged journal, journals of two sessions, or one that
        gives other outputs than before when it is judged again.
    InputError
        Resumed with other settings.
    """

    def __init__(
        self,
        out: Path,
        settings: Settings,
        *,
        origin: Origin | None = None,
        resume: bool = False,
        report: Callable[[dict[str, Any]], None] = lambda _: None,
        say: Callable[[str], None] = lambda _: None,
        passed: Callable[[str], None] = lambda _: None,
    ) -> None:
        self.settings, self.folder = settings, out
        self._report, self._say, self._passed = report, say, passed
        self._core = settings.core()
        self.n_epochs = self.n_transitions = 0
        self.unfinished: str | None = None
        self._named: set[str] = set()
        _prepare(out, settings, origin or Origin(), resume=resume)
        self._lock = journal.alone(out)
        self._lock.__enter__()
        with ExitStack() as opened:
            opened.push(self._lock)
            self._in = journal.Journal(out / journal.IN)
            opened.callback(self._in.close)
            self._out = journal.Journal(out / journal.OUT)
            opened.callback(self._out.close)
            journal.require_pair(out, self._in.content(), self._out.content())
            for written in (self._in, self._out):
                if written.torn:
                    say(
                        f"{written.path.name}: {counted(written.torn, 'byte')} of an unfinished frame "
                        f"{agreeing(written.torn, 'was', 'were')} cut off"
                    )
            self._events = Events(out, settings, say=say)
            self._lane, position = self._restored()
            self._recover(position)
            # What is open stays open; before that it was given back.
            opened.pop_all()
        self._snapshot_at = time.monotonic()

    @property
    def n_bytes(self) -> int:
        """Bytes of the source that are in the journal. [B]."""
        return int(self._lane.counters()["n_bytes"])

    @property
    def event_time_ns(self) -> int | None:
        """Largest time of the data. [ns]."""
        return self._lane.event_time_ns

    @property
    def n_tracks(self) -> int:
        """Tracks that are watched."""
        return self._lane.n_tracks

    def passed_over(self) -> dict[str, int]:
        """Keys of lines of JSON that nothing reads, by name, and how often each came."""
        return self._lane.passed_over()

    def against(self) -> dict[str, int]:
        """Keys of lines, and words of a receiver's messages, that took positions away, and of how many."""
        return self._lane.against()

    def counters(self) -> dict[str, float]:
        """What was counted: records, refusals by reason, and the monitors' counters."""
        return dict(self._lane.counters())

    def take(self, frames: bytes) -> None:
        """Journal frames of inputs: written down, judged, reported."""
        self._passed("before-journal")
        position = self._in.length
        self._in.append(frames)
        self._passed("after-journal")
        self._judge(frames, position)
        if time.monotonic() - self._snapshot_at > _SNAPSHOT_S:
            self.snapshot()

    def _judge(self, frames: bytes, position: int) -> None:
        taken, written, rows, n_epochs, behind = self._lane.push(frames, position, now_ns())
        if taken != len(frames):
            raise FormatError(self._in.path, f"an input is {behind} at byte {position + taken}")
        self._passed("after-step")
        self._passed("before-commit")
        self._out.append(written)
        self._passed("after-commit")
        self.n_epochs += n_epochs
        self._show(rows)
        if new := self.passed_over().keys() - self._named:
            # At once: a session may never end.
            self._named |= new
            self._say(unread(new))

    def _show(self, rows: list[_core._TransitionRow], *, replayed: bool = False) -> None:
        if not rows:
            return
        reported = self._events.records(rows, replayed=replayed)
        if not replayed:
            self.n_transitions += len(reported)
        self._events.append(reported)
        for t in reported:
            self._report(t)

    def snapshot(self) -> None:
        """Keep the state behind all that was taken."""
        self._in.sync()
        self._out.sync()
        self._events.require(self._out.content)
        self._passed("in-snapshot")
        content = self._lane.snapshot(self._in.length, self._out.length)
        partial = self.folder / f"{journal.SNAPSHOT}.partial"
        partial.write_bytes(content)
        self._passed("before-rename")
        partial.replace(self.folder / journal.SNAPSHOT)
        self._snapshot_at = time.monotonic()

    def _restored(self) -> tuple[_core.LiveLane, int]:
        """The lane of the snapshot, or a new one that reads the journal from its beginning."""
        path = self.folder / journal.SNAPSHOT
        if path.exists():
            try:
                lane, position, written = _core.LiveLane.restore(self._core, path.read_bytes())
            except ValueError as e:
                self._say(f"{path.name} is refused: {e}; the state is built anew from the journal")
            else:
                if position <= self._in.length and written <= self._out.length:
                    return lane, position
                self._say(f"{path.name} is refused: it is ahead of the journals; the state is built anew from the journal")
        return _core.LiveLane(self._core), 0

    def _recover(self, position: int) -> None:
        """Judge again what came in behind the snapshot; what is out already must be the same and is not written again."""
        before = journal.behind(self._out.content(), 0, self._in.length)
        if len(before) != self._out.length:
            self._say("the journal out is ahead of the journal in: it is cut")
            self._out.cut(len(before))
        again_shown = [row for row in _core.live_transitions(before) if row[3] > position]
        self._events.restore(before, ahead=again_shown)
        comparable = _core.live_comparable(before)
        committed = comparable[-1][0] if comparable else 0
        expected = [output for output in comparable if output[0] > position]
        again: list[tuple[int, bytes]] = []
        at = position
        for frames in _slices(self._in.content(position)):
            _, written, _, n_epochs, _ = self._lane.push(frames, at, now_ns())
            at += len(frames)
            self.n_epochs += n_epochs
            part = journal.behind(written, committed, at)
            again += [output for output in _core.live_comparable(written) if output[0] <= committed]
            self._out.append(part)
            self._show(_core.live_transitions(part))
        if again != expected:
            raise FormatError(self._out.path, _OTHERWISE)
        self._show(again_shown, replayed=True)
        if at > position:
            self._say(
                f"recovered: {counted(at - position, 'byte')} of the journal judged again, "
                f"{counted(len(again), 'output was', 'outputs were')} there already"
            )

    def finish(self, *, ended: bool = True) -> None:
        """Judge what waits, keep everything, leave the folder; of a source that has more to say nothing is flushed: it goes on there."""
        if ended:
            self.take(_core.live_input("end", None, b""))
        self.snapshot()
        self._out.sync()
        self.close()

    def close(self) -> None:
        """Leave the folder as it is."""
        for each in (self._in, self._out):
            each.close()
        self._lock.__exit__(None, None, None)

    def run(self, source: Source, *, stop: Callable[[], bool] = lambda: False, speed: float = 0.0) -> None:
        """Take what a source gives until its end, or until `stop`.

        Parameters
        ----------
        source : Source
            Opened.
        stop : callable
            Called every tenth of a second.
        speed : float
            Of a file: times its own pace; 0 as fast as it goes. [1]
        """
        if self.n_bytes and isinstance(source, File) and not source.begins_with(self._chunks()):
            raise InputError("source", "another file", domain=f"the file whose first {self.n_bytes} bytes this session has read")
        source.skip(self.n_bytes)
        # What arrives is gone; a file that is left in the middle is read on from there.
        pace, up, beat, ended = Pace(speed), True, time.monotonic(), source.live
        while not stop():
            data = source.read(_WAIT_S)
            if data is None:
                ended = True
                break
            arrival = now_ns() if source.live else None
            if source.live and source.up != up:
                up = source.up
                self.take(_core.live_input("up" if up else "down", arrival, b""))
            if data:
                self.take(_core.live_input("chunk", arrival, data))
                pace.wait(self.event_time_ns, stop)
            if source.live and time.monotonic() - beat >= _HEARTBEAT_S:
                beat = time.monotonic()
                self.take(_core.live_input("heartbeat", now_ns(), b""))
        if not ended:
            self.unfinished = stopped(self.n_bytes, source.size)
        self.finish(ended=ended)

    def _chunks(self) -> Iterator[bytes]:
        """What the journal holds of the source."""
        return (content for kind, _, content in _core.live_inputs(journal.read(self._in.path)) if kind == "chunk")


def stopped(n_bytes: int, size: int | None) -> str:
    """What a recording that was not read to its end has to say."""
    return f"stopped at byte {n_bytes} of {'an unknown number' if size is None else size} of the source; the rest was not judged"


class Pace:
    """Keeps the time of the data to a multiple of the time that passes."""

    def __init__(self, speed: float) -> None:
        self._speed = speed
        self._begun: tuple[float, int] | None = None

    def wait(self, event_ns: int | None, stop: Callable[[], bool]) -> None:
        """Until the time of the data may be shown."""
        if not self._speed or event_ns is None:
            return
        if self._begun is None:
            self._begun = (time.monotonic(), event_ns)
        begun_s, first_ns = self._begun
        due_s = begun_s + (event_ns - first_ns) / 1e9 / self._speed
        while (left_s := due_s - time.monotonic()) > 0 and not stop():
            time.sleep(min(left_s, _WAIT_S))


def _slices(frames: bytes) -> list[bytes]:
    """Whole frames, about a megabyte together."""
    ends, _ = _core.live_frames(frames)
    cuts, begin = list[bytes](), 0
    for end in ends:
        if end - begin >= _SLICE or end == ends[-1]:
            cuts.append(frames[begin:end])
            begin = end
    return cuts


def _prepare(out: Path, settings: Settings, origin: Origin, *, resume: bool) -> None:
    """A folder of this session: empty, or one with the same settings where it is resumed."""
    ours = {
        journal.IN,
        journal.OUT,
        journal.SNAPSHOT,
        journal.SETTINGS,
        journal.EVENTS,
        journal.ACKNOWLEDGED,
        journal.SENT,
        f"{journal.SNAPSHOT}.partial",
        f"{journal.SENT}.partial",
    }
    ours |= {f"{name}.parquet{end}" for name in ("epochs", "events") for end in ("", ".partial")}
    try:
        out.mkdir(parents=True, exist_ok=True)
        present = {p.name for p in out.iterdir()}
    except OSError as e:
        raise FormatError(out, f"cannot be written: {e.strerror or e}") from e
    if folders := sorted(name for name in present & ours if not (out / name).is_file()):
        raise FormatError(out / folders[0], "is no file: not the folder of a live session; choose another --out")
    if strangers := sorted(present - ours):
        raise FormatError(out, f"holds files that are not a live session's ({', '.join(strangers[:3])}); choose another --out")
    if resume and journal.SETTINGS in present:
        kept = load(out / journal.SETTINGS)
        if kept != settings:
            differing = sorted(name for name in vars(kept) if getattr(kept, name) != getattr(settings, name))
            raise InputError("resume", str(out), domain=f"a session of the same settings; these differ: {', '.join(differing)}")
    elif present and journal.SETTINGS not in present:
        parts = f"holds parts of a session ({', '.join(sorted(present)[:3])}) and no {journal.SETTINGS}, without which it cannot be resumed"
        raise FormatError(out, f"{parts}; put it back, or choose another --out")
    elif present:
        raise FormatError(out, "holds a session already; go on with --resume, or choose another --out")
    record = {"navbound_version": __version__, "settings": json.loads(settings.text()), "origin": asdict(origin)}
    journal.put(out / journal.SETTINGS, json.dumps(record, indent=1).encode())
