"""A journal read again, at any speed and in any grouping, and two runs compared bit by bit."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from navbound import _core
from navbound.errors import FormatError
from navbound.live import journal
from navbound.live.course import points
from navbound.live.session import Origin, Pace, Session, origin_of, stopped
from navbound.live.settings import load
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from navbound.live.settings import Settings


_MOST_REPLAYS = 100
"""Replays of replays that are followed to their recording. [1]"""


def _journal(source: Path) -> Path:
    return source / journal.IN if source.is_dir() else source


def is_journal(source: Path) -> bool:
    """Whether this is a session's folder or its journal, and not a run or a log."""
    return (source / journal.IN).is_file() if source.is_dir() else source.suffix == ".nvj"


def settings_of(source: Path) -> Settings:
    """Settings of a session by its folder or its journal."""
    return load(_journal(source).parent / journal.SETTINGS)


def replay(
    source: Path,
    out: Path,
    *,
    speed: float = 0.0,
    group: int = 1,
    settings: Settings | None = None,
    report: Callable[[dict[str, Any]], None] = lambda _: None,
    stop: Callable[[], bool] = lambda: False,
    say: Callable[[str], None] = lambda _: None,
    started: Callable[[Session], None] = lambda _: None,
    limits: dict[str, Any] | None = None,
) -> Session:
    """Read a journal through a new lane.

    Parameters
    ----------
    source : Path
        Folder of a session, or its journal in.
    out : Path
        Folder of the new session.
    speed : float
        Times the pace of the data; 0: as fast as it goes. [1]
    group : int
        Inputs that are judged at once.
    settings : Settings, optional
        Default: those of the session.
    report : callable, optional
        Takes each transition.
    stop : callable, optional
        Ends it early.
    say : callable, optional
        Takes a sentence on a journal that does not end with a whole frame.
    started : callable, optional
        Takes the new session before it reads.
    limits : dict, optional
        Alert limits that the display shows.

    Returns
    -------
    Session
        Finished.

    Raises
    ------
    FormatError
        Not a journal, or the folder is not free.
    """
    frames, torn = journal.read(_journal(source)), journal.torn(_journal(source))
    if torn:
        name = _journal(source).name
        say(
            f"{name}: {counted(torn, 'byte')} at its end {agreeing(torn, 'is', 'are')} no whole frame and "
            f"{agreeing(torn, 'is', 'are')} not judged: it was cut, or its writer was killed or still writes"
        )
    selected = settings or settings_of(source)
    origin = Origin("replay", str(source), speed, points(selected, ""), limits)
    session = Session(out, selected, origin=origin, report=report)
    started(session)
    ends, _ = _core.live_frames(frames)
    pace, begin = Pace(speed), 0
    for place, end in enumerate(ends, 1):
        if place % group and place != len(ends):
            continue
        if stop():
            break
        session.take(frames[begin:end])
        begin = end
        pace.wait(session.event_time_ns, stop)
    session.unfinished = _unfinished(source, frames, begin)
    session.snapshot()
    session.close()
    return session


def _unfinished(source: Path, frames: bytes, taken: int) -> str | None:
    """Why a journal was not judged to the end of its source; of a live source nobody knows an end."""
    if taken < len(frames):
        return f"stopped at byte {taken} of {len(frames)} of the journal; the rest was not judged"
    came_from = _recorded(_journal(source).parent)
    if came_from is None:
        return None
    inputs = _core.live_inputs(frames)
    if inputs and inputs[-1][0] == "end":
        return None
    size = Path(came_from).stat().st_size if Path(came_from).is_file() else None
    n_bytes = sum(len(content) for kind, _, content in inputs if kind == "chunk")
    return f"the journal has no end, since its session was stopped or killed: {stopped(n_bytes, size)}"


def _recorded(folder: Path) -> str | None:
    """The file or run that a session read, by whatever number of replays; None of data that arrived, and where nobody says."""
    for _ in range(_MOST_REPLAYS):
        if not (folder / journal.SETTINGS).is_file():
            return None
        origin = origin_of(folder)
        name = str(origin["source"])
        if origin["kind"] == "replay" and name and is_journal(Path(name)):
            folder = _journal(Path(name)).parent
            continue
        return None if origin["kind"] == "live" else name or None
    return None


def judge(source: Path, out: Path, *, say: Callable[[str], None] = lambda _: None) -> Session:
    """The causal batch: the whole journal judged at once.

    Raises
    ------
    FormatError
        As :func:`replay`.
    """
    return replay(source, out, group=1 << 60, say=say)


@dataclass(frozen=True)
class Comparison:
    """How the outputs of two runs differ: every bound as its bits, every status, reason, alert and transition, and their order."""

    n_epochs: int
    n_transitions: int
    n_differing: int
    first: str | None
    apart: str | None = None
    """Why they may differ."""


def compare(a: Path, b: Path) -> Comparison:
    """Compare the journals out of two sessions, whatever was written at once and when.

    Raises
    ------
    FormatError
        A journal that cannot be read or holds nothing: there would be nothing to compare.
    """
    both = [journal.read(folder / journal.OUT) for folder in (a, b)]
    sides = list[list[tuple[int, bytes]]]()
    for folder, frames in zip((a, b), both, strict=True):
        with journal.readable(folder / journal.OUT):
            sides.append(_core.live_comparable(frames))
    left, right = sides
    n_transitions = len(_core.live_transitions(both[0]))
    if not left:
        raise FormatError(a / journal.OUT, "holds no output: nothing to compare")
    differing = [k for k, (x, y) in enumerate(zip(left, right, strict=False)) if x != y]
    n_differing = len(differing) + abs(len(left) - len(right))
    first = None if not n_differing else f"output {differing[0] if differing else min(len(left), len(right))}"
    return Comparison(len(left) - n_transitions, n_transitions, n_differing, first, _apart(a, b) if n_differing else None)


def _apart(a: Path, b: Path) -> str | None:
    """Why two sessions may differ: they judged other data, or in another way; None where they did not."""
    settings, inputs = [], []
    for folder in (a, b):
        with journal.readable(folder / journal.IN):
            settings.append(load(folder / journal.SETTINGS))
            frames = journal.read(folder / journal.IN)
            inputs.append(hashlib.sha256(frames).digest())
        journal.require_pair(folder, frames, journal.read(folder / journal.OUT))
    if inputs[0] != inputs[1]:
        return "the two journals in differ"
    if settings[0] != settings[1]:
        return "the settings differ"
    ends = [bool(journal.torn(folder / journal.OUT)) for folder in (a, b)]
    return "a journal out has no whole end" if any(ends) else None
