"""The flight display: a process of its own that reads the journals of a session and shows them in browsers on this host.

`watch` follows the journals; `server` tells the pages what they hold, by the server of :mod:`navbound.serve`. It may be slow, attacked or
killed: the monitor does not notice.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from navbound.live.child import Child
from navbound.live.display.fleet import FleetServer, FleetWatch, beside_fleet
from navbound.live.display.server import Server, beside, serve
from navbound.live.display.watch import Watch
from navbound.serve.service import Options

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["FleetServer", "FleetWatch", "Options", "Server", "Watch", "beside_fleet", "child", "serve"]


def child(folder: Path, options: Options) -> Child:
    """The display of a folder in a process beside the session; its `text` is the address.

    Raises
    ------
    FormatError
        It cannot be served, and why.
    """
    return Child(beside, folder, options, "the display cannot be shown")
