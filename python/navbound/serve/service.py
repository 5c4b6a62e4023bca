"""A server of pages: this host only, one stream of server-sent events a page, and what its owner adds to that."""

from __future__ import annotations

import asyncio
import contextlib
import socket
import time
from dataclasses import dataclass
from http import HTTPStatus
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from navbound.errors import FormatError, InputError
from navbound.serve import hub, request
from navbound.serve.request import RefusedError

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    Handler = Callable[[request.Request], bytes | Awaitable[bytes]]

TICK_S = 0.1
"""Period of the pages. [s]"""
WRITE_HIGH, SEND_BUFFER = 64 * 1024, 128 * 1024
UNSENT_MS = 10_000
"""Time after which the system gives up a connection that takes nothing. [ms]"""
_KINDS = {"js": "text/javascript; charset=utf-8", "css": "text/css; charset=utf-8"}
HTML = "text/html; charset=utf-8"


@dataclass(frozen=True)
class Options:
    """How pages are served.

    Attributes
    ----------
    port : int
        Of this host; 0: one that is free.
    """

    port: int = 0

    def __post_init__(self) -> None:
        if not 0 <= self.port <= 65_535:
            raise InputError("port", self.port, "1", "[0, 65535]")


def shell(title: str, bundle: str, without_scripts: str, root: str) -> str:
    """The page that a bundle fills."""
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<link rel="icon" href="data:,">
<link rel="stylesheet" href="/{bundle}.css">
</head>
<body>
<noscript>{without_scripts}</noscript>
<main id="{root}"></main>
<script src="/{bundle}.js"></script>
</body>
</html>
"""


def pages(page: str, *names: str) -> dict[str, tuple[bytes, str]]:
    """The page and the files of its bundle, made at the start: no path of a request reaches a file system."""
    web = files("navbound").joinpath("_web")
    return {"/": (page.encode(), HTML)} | {f"/{name}": (web.joinpath(name).read_bytes(), _KINDS[name.rpartition(".")[2]]) for name in names}


class Service:
    """Pages, questions and news of one owner, who overrides :meth:`turn`, :meth:`enter`, :meth:`snapshot` and :meth:`other`.

    Parameters
    ----------
    options : Options
        How.
    pages : dict
        What is served as it is: path to content and kind.
    policy : str
        Content security policy of these instead of the usual one.
    """

    most_body = request.MOST_BODY

    def __init__(self, options: Options, pages: dict[str, tuple[bytes, str]], policy: str = "") -> None:
        self.hub = hub.Hub()
        self._sockets = _listening(options.port)
        self.port = int(self._sockets[0].getsockname()[1])
        self.door = request.Door(self.port)
        self._pages = pages
        self._extra = {"Content-Security-Policy": policy} if policy else {}
        self.handlers: dict[tuple[str, str], Handler] = {
            ("POST", "/session"): self._begin,
            ("GET", "/session"): self._known,
            ("POST", "/alive"): self._alive,
        }
        self._tasks: set[asyncio.Task[None]] = set()

    @property
    def address(self) -> str:
        """Where a browser finds it. What follows the # is not sent: it stays in the browser."""
        return f"http://127.0.0.1:{self.port}/#{self.door.token}"

    def turn(self, now_s: float) -> bool:
        """What is to be done every tenth of a second; whether more waits."""
        raise NotImplementedError

    def enter(self, query: request.Request) -> hub.Client | None:
        """A page that asks for the stream; None where there are too many."""
        del query
        return self.hub.enter(None, time.monotonic())

    def snapshot(self, client: hub.Client) -> dict[str, Any]:
        """What a page receives first."""
        raise NotImplementedError

    async def other(self, query: request.Request, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Answer what no handler is for.

        Raises
        ------
        RefusedError
            Nothing of that name.
        """
        del reader, writer
        raise RefusedError(HTTPStatus.NOT_FOUND if query.method == "GET" else HTTPStatus.METHOD_NOT_ALLOWED)

    async def run(self, stop: Callable[[], bool]) -> None:
        """Serve until `stop`."""
        servers = [await asyncio.start_server(self._connected, sock=each, limit=request.MOST_HEAD) for each in self._sockets]
        try:
            while not stop():
                now = time.monotonic()
                more = self.turn(now)
                self.hub.drop_silent(now)
                await asyncio.sleep(0 if more else TICK_S)
        finally:
            for server in servers:
                server.close()
            for client in list(self.hub.clients.values()):
                client.close()
            for task in list(self._tasks):
                task.cancel()

    async def _connected(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        if task is not None:
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)
        peer = writer.get_extra_info("peername")
        try:
            query = await request.read_head(reader)
            self.door.check(query, str(peer[0]) if peer else "")
            await self._answer(query, reader, writer)
        except RefusedError as e:
            with contextlib.suppress(OSError):
                writer.write(request.answer(e.status))
                async with asyncio.timeout(request.REQUEST_S):
                    await writer.drain()
        except (OSError, TimeoutError, asyncio.CancelledError):
            pass
        finally:
            writer.close()
            with contextlib.suppress(OSError, TimeoutError, asyncio.CancelledError):
                async with asyncio.timeout(request.REQUEST_S):
                    await writer.wait_closed()
            # What a page does not take is given up.
            writer.transport.abort()

    async def _answer(self, query: request.Request, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        handler = self.handlers.get((query.method, query.path))
        if handler is not None:
            made = handler(await request.with_body(query, reader, self.most_body))
            writer.write(made if isinstance(made, bytes) else await made)
        elif query.method == "GET" and query.path in self._pages:
            body, kind = self._pages[query.path]
            writer.write(request.answer(HTTPStatus.OK, body, kind, self._extra))
        elif (query.method, query.path) == ("GET", "/events"):
            self.door.session(query)
            await self._stream(query, reader, writer)
            return
        else:
            await self.other(query, reader, writer)
        async with asyncio.timeout(request.REQUEST_S):
            await writer.drain()

    def _begin(self, query: request.Request) -> bytes:
        token = query.json().get("token")
        return request.answer(HTTPStatus.NO_CONTENT, extra=self.door.open(token if isinstance(token, str) else ""))

    def _known(self, query: request.Request) -> bytes:
        self.door.session(query)
        return request.answer(HTTPStatus.NO_CONTENT)

    def _alive(self, query: request.Request) -> bytes:
        self.door.session(query)
        number = query.json().get("client")
        client = self.hub.clients.get(number) if isinstance(number, int) else None
        if client is None:
            raise RefusedError(HTTPStatus.NOT_FOUND)
        client.alive_s = time.monotonic()
        return request.answer(HTTPStatus.NO_CONTENT)

    async def _stream(self, query: request.Request, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        client = self.enter(query)
        if client is None:
            raise RefusedError(HTTPStatus.SERVICE_UNAVAILABLE)
        _narrow(writer)
        gone = asyncio.ensure_future(reader.read(1))
        gone.add_done_callback(lambda _: client.close())
        try:
            snapshot = self.snapshot(client)
            writer.write(request.head(HTTPStatus.OK, "text/event-stream; charset=utf-8", None))
            writer.write(b"retry: 1000\n\n" + hub.event("snapshot", {"client": client.number, **snapshot}))
            while True:
                # A page that takes nothing ends here: it gives no sign of life either.
                drained = asyncio.ensure_future(writer.drain())
                while not drained.done() and not client.closed:
                    await asyncio.wait({drained}, timeout=TICK_S)
                if client.closed:
                    drained.cancel()
                    break
                drained.result()
                if data := await client.take():
                    writer.write(data)
        finally:
            gone.cancel()
            self.hub.leave(client)
            writer.transport.abort()


def _listening(port: int) -> list[socket.socket]:
    """Sockets of this host alone: IPv4, and IPv6 where there is one."""
    try:
        first = _bound(socket.AF_INET, "127.0.0.1", port)
    except OSError as e:
        raise FormatError(f"http://127.0.0.1:{port}", f"cannot be listened on: {e.strerror or e}; choose another --port") from e
    sockets = [first]
    with contextlib.suppress(OSError):
        sockets.append(_bound(socket.AF_INET6, "::1", int(first.getsockname()[1])))
    return sockets


def _bound(family: socket.AddressFamily, host: str, port: int) -> socket.socket:
    made = socket.socket(family, socket.SOCK_STREAM)
    try:
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if family == socket.AF_INET6:
            made.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
        made.bind((host, port))
        # Who reads the address may ask at once.
        made.listen()
    except OSError:
        made.close()
        raise
    return made


def _narrow(writer: asyncio.StreamWriter) -> None:
    """Let little wait in buffers that nobody sees."""
    writer.transport.set_write_buffer_limits(high=WRITE_HIGH)
    line = writer.get_extra_info("socket")
    line.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)
    line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    if hasattr(socket, "TCP_USER_TIMEOUT"):
        line.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, UNSENT_MS)
