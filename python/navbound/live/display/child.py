"""The display beside a session, in a process of its own that ends with it."""

from __future__ import annotations

import multiprocessing
import signal
from typing import TYPE_CHECKING

from navbound.errors import FormatError
from navbound.live.display.server import Options, Server, serve

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from pathlib import Path
    from types import TracebackType

_START_S = 30.0


class Child:
    """A display of a folder; a context that ends it.

    Attributes
    ----------
    address : str
        Where a browser finds it.

    Raises
    ------
    FormatError
        It cannot be served, and why.
    """

    def __init__(self, folder: Path, options: Options) -> None:
        spawned = multiprocessing.get_context("spawn")
        self._pipe, theirs = spawned.Pipe()
        self._process = spawned.Process(target=_main, args=(folder, options, theirs), daemon=True)
        self._process.start()
        theirs.close()
        kind, text = "trouble", "the display did not start"
        if self._pipe.poll(_START_S):
            try:
                kind, text = self._pipe.recv()
            except EOFError:
                text = "the display ended while it started"
        if kind != "ready":
            self.end()
            raise FormatError(folder, f"cannot be shown: {text}")
        self.address = text

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


def _main(folder: Path, options: Options, pipe: Connection) -> None:
    # A key pressed in a terminal goes to both processes: the session decides when both end.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)

    def ready(server: Server) -> None:
        pipe.send(("ready", server.address))

    # The other end of the pipe is gone when the session has ended, however it did.
    def ended() -> bool:
        return pipe.poll(0)

    try:
        serve(folder, options, ready=ready, stop=ended)
    except FormatError as e:
        pipe.send(("trouble", str(e)))
