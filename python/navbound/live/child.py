"""A process beside a session that ends with it: the display, or what sends transitions on."""

from __future__ import annotations

import signal
from typing import TYPE_CHECKING, Any

from navbound.errors import FormatError, NavboundError
from navbound.scale.spawned import CONTEXT, deaf_to_interrupts

if TYPE_CHECKING:
    from collections.abc import Callable
    from multiprocessing.connection import Connection
    from pathlib import Path
    from types import TracebackType

    Work = Callable[[Path, Any, Callable[[str], None], Callable[[str], None], Callable[[], bool]], None]
    """(folder, options, ready, say, stop): `ready` takes a text once it works, `say` sentences; `stop`: the session is gone."""

_START_S = 30.0


class Child:
    """Work on a folder in another process; a context that ends it.

    Parameters
    ----------
    work : callable
        A function of a module: (folder, options, ready, say, stop).
    folder : Path
        Of a session.
    options : object
        How, for `work`.
    name : str
        What it means where it does not start: "the display cannot be shown".

    Attributes
    ----------
    text : str
        What it said when it was ready: an address.

    Raises
    ------
    FormatError
        It does not start, and why.
    """

    def __init__(self, work: Work, folder: Path, options: Any, name: str) -> None:
        self._pipe, theirs = CONTEXT.Pipe()
        self._process = CONTEXT.Process(target=_main, args=(work, folder, options, theirs), daemon=True)
        deaf_to_interrupts(self._process.start)
        theirs.close()
        kind, text = "trouble", "it did not start"
        if self._pipe.poll(_START_S):
            try:
                kind, text = self._pipe.recv()
            except EOFError:
                text = "it ended while it started"
        if kind != "ready":
            self.end()
            raise FormatError(folder, f"{name}: {text}")
        self.text = text

    def sentences(self) -> list[str]:
        """Sentences since the last look; the last one where it ended by itself says why."""
        spoken = list[str]()
        try:
            while self._pipe.poll(0):
                spoken.append(str(self._pipe.recv()[1]))
        except (EOFError, OSError):
            pass
        return spoken

    @property
    def works(self) -> bool:
        """Whether it has not ended."""
        return self._process.is_alive()

    def end(self) -> None:
        """End it."""
        self._pipe.close()
        self._process.join(2.0)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()

    def __enter__(self) -> Child:
        """Begin."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        """End it."""
        self.end()


def _main(work: Work, folder: Path, options: Any, pipe: Connection) -> None:
    signal.signal(signal.SIGTERM, signal.SIG_DFL)

    # The other end of the pipe is gone when the session has ended, however it did.
    def ended() -> bool:
        return pipe.poll(0)

    def send(kind: str) -> Callable[[str], None]:
        def sent(text: str) -> None:
            try:
                pipe.send((kind, text))
            except OSError:
                # Nobody listens any more: `ended` says so at the next look.
                return

        return sent

    try:
        work(folder, options, send("ready"), send("sentence"), ended)
    except NavboundError as e:
        send("trouble")(str(e))
