"""The flight display: a process of its own that reads the journals of a session and shows them in browsers on this host.

`watch` follows the journals; `hub` keeps what each page has still to receive; `request` reads and answers HTTP and decides who may ask;
`server` joins them; `child` runs the server beside a session. It may be slow, attacked or killed: the monitor does not notice.
"""

from navbound.live.display.child import Child
from navbound.live.display.server import Options, Server, serve
from navbound.live.display.watch import Watch

__all__ = ["Child", "Options", "Server", "Watch", "serve"]
