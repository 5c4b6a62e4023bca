"""Workers of one host as processes of their own: one that ends, however it does, is started again."""

from __future__ import annotations

import contextlib
import os
import time
from typing import TYPE_CHECKING, Any

from navbound.errors import FormatError, NavboundError
from navbound.live.fleet.transport import connect
from navbound.live.fleet.worker import Worker
from navbound.scale.spawned import CONTEXT, deaf_to_interrupts
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from collections.abc import Callable
    from multiprocessing.connection import Connection

_AGAIN_FIRST_S, _AGAIN_MOST_S = 0.5, 30.0
_END_S = 5.0
_STEADY_S = 60.0
_FINISH_TRIES = 5
"""How often in a row a worker is started again to judge what is left."""


class _Member:
    """A process and the way it speaks."""

    def __init__(self, name: str, number: int) -> None:
        self._name, self.number = name, number
        self.again_s, self.next_s = _AGAIN_FIRST_S, 0.0
        self.n_ends, self.last = 0, ""
        self.is_finishing = False
        self.begin()

    def begin(self) -> None:
        """Start it."""
        self.pipe, theirs = CONTEXT.Pipe()
        self.process = CONTEXT.Process(target=_main, args=(self._name, theirs), daemon=True)
        deaf_to_interrupts(self.process.start)
        theirs.close()
        self.since_s = time.monotonic()
        if self.is_finishing:
            self.finish()

    def finish(self) -> None:
        """Let it, and whoever follows it, end once all is judged."""
        self.is_finishing = True
        with contextlib.suppress(OSError):
            # A process that is gone is followed by another, which hears the same.
            self.pipe.send("finish")

    @property
    def is_done(self) -> bool:
        """Whether it ended because all is judged."""
        return self.is_finishing and self.process.exitcode == 0

    def spoken(self) -> list[tuple[str, Any]]:
        """What it said since the last look."""
        taken = list[tuple[str, Any]]()
        try:
            while self.pipe.poll(0):
                taken.append(self.pipe.recv())
        except (EOFError, OSError):
            pass
        return taken


class Crew:
    """Workers of a fleet; a context that ends them.

    Parameters
    ----------
    name : str
        Of the transport.
    n : int
        How many.
    report : callable
        Takes each transition.
    say : callable
        Takes sentences.
    """

    def __init__(self, name: str, n: int, *, report: Callable[[dict[str, Any]], None], say: Callable[[str], None]) -> None:
        self._name, self._report, self._say = name, report, say
        self.members = [_Member(name, k) for k in range(1, n + 1)]

    def look(self) -> None:
        """Pass on what the workers said, and start again those that ended."""
        for member in self.members:
            self._hear(member)
            now = time.monotonic()
            if member.is_done:
                continue
            if member.process.is_alive():
                if now - member.since_s > _STEADY_S:
                    member.again_s = _AGAIN_FIRST_S
                continue
            if member.next_s == 0.0:
                self._hear(member)
                member.n_ends += 1
                member.next_s = now + member.again_s
                self._say(f"worker {member.number} ended ({member.process.exitcode}); another begins in {member.again_s:g} s")
                member.again_s = min(2 * member.again_s, _AGAIN_MOST_S)
            elif now >= member.next_s:
                member.next_s = 0.0
                member.begin()

    def _hear(self, member: _Member) -> None:
        for kind, what in member.spoken():
            if kind == "transition":
                self._report(what)
            else:
                member.last = what
                self._say(f"worker {member.number}: {what}")

    def finish(self, stop: Callable[[], bool]) -> None:
        """Let them judge what is left, and end; who ends before is followed by another.

        Raises
        ------
        FormatError
            A worker ended again and again, and something is left.
        """
        for member in self.members:
            member.finish()
            member.n_ends = 0
        until = None
        while not all(member.is_done for member in self.members):
            self.look()
            if failed := next((member for member in self.members if member.n_ends > _FINISH_TRIES), None):
                raise FormatError(
                    self._name,
                    f"not judged to its end: worker {failed.number} ended {counted(failed.n_ends, 'time')}"
                    f"{f' ({failed.last})' if failed.last else ''}; when the cause is gone, navbound live work {self._name} goes on",
                )
            if stop():
                until = until or time.monotonic() + _END_S
                if time.monotonic() > until:
                    self._say(f"stopped before all was judged; navbound live work {self._name} goes on")
                    break
            time.sleep(0.02)
        for member in self.members:
            self._hear(member)

    def __enter__(self) -> Crew:
        """Begin."""
        return self

    def __exit__(self, *_: object) -> None:
        """End all."""
        for member in self.members:
            member.pipe.close()
        for member in self.members:
            member.process.join(_END_S)
            if member.process.is_alive():
                member.process.kill()
                member.process.join()


def _main(name: str, pipe: Connection) -> None:
    heard = list[str]()

    def send(kind: str) -> Callable[[Any], None]:
        def sent(what: Any) -> None:
            try:
                pipe.send((kind, what))
            except OSError:
                # Nobody listens any more: `stop` says so.
                return

        return sent

    def stop() -> bool:
        try:
            while pipe.poll(0):
                heard.append(pipe.recv())
        except (EOFError, OSError):
            return True
        return False

    say = send("sentence")
    try:
        with connect(name, patience_s=10.0) as transport:
            worker = Worker(transport, report=send("transition"), say=say)
            worker.run(stop=stop, finishing=lambda: bool(heard))
    except NavboundError as e:
        say(str(e))
        os._exit(1)
