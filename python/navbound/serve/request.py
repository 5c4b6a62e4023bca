"""HTTP as far as pages of this host need it: one request a connection, everything bounded, and who may ask."""

from __future__ import annotations

import asyncio
import hmac
import json
import secrets
import time
from dataclasses import dataclass, replace
from http import HTTPStatus
from typing import Any

MOST_HEAD = 8 * 1024
MOST_BODY = 4 * 1024
MOST_DIGITS = 15
REQUEST_S = 5.0
"""Time that a request may take to arrive. [s]"""
RATE_PER_S, BURST = 20.0, 60.0
"""Requests of one address: so many a second, and so many at once."""
SESSION_S = 12 * 3600.0
MOST_SESSIONS = 256

HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; "
    "worker-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; require-trusted-types-for 'script'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}
"""With every answer."""


class RefusedError(Exception):
    """A request that is not answered with what it asks for."""

    def __init__(self, status: HTTPStatus) -> None:
        super().__init__(status.phrase)
        self.status = status


@dataclass(frozen=True)
class Request:
    """A request; `length` is that of its body, read or not."""

    method: str
    path: str
    query: str
    headers: dict[str, str]
    body: bytes
    length: int

    def cookie(self, name: str) -> str:
        """A cookie; empty where there is none."""
        for part in self.headers.get("cookie", "").split(";"):
            key, _, value = part.strip().partition("=")
            if key == name:
                return value
        return ""

    def json(self) -> dict[str, Any]:
        """The object of its body.

        Raises
        ------
        RefusedError
            Not a flat object.
        """
        try:
            value = json.loads(self.body)
        except (ValueError, RecursionError) as e:
            raise RefusedError(HTTPStatus.BAD_REQUEST) from e
        if not isinstance(value, dict):
            raise RefusedError(HTTPStatus.BAD_REQUEST)
        return value


async def read_head(reader: asyncio.StreamReader) -> Request:
    """A request as far as its body, which is still to be read.

    Raises
    ------
    RefusedError
        It is too long, too slow, or no request.
    """
    try:
        async with asyncio.timeout(REQUEST_S):
            head = await reader.readuntil(b"\r\n\r\n")
    except asyncio.LimitOverrunError as e:
        raise RefusedError(HTTPStatus.REQUEST_HEADER_FIELDS_TOO_LARGE) from e
    except TimeoutError as e:
        raise RefusedError(HTTPStatus.REQUEST_TIMEOUT) from e
    except asyncio.IncompleteReadError as e:
        raise RefusedError(HTTPStatus.BAD_REQUEST) from e
    if len(head) > MOST_HEAD:
        raise RefusedError(HTTPStatus.REQUEST_HEADER_FIELDS_TOO_LARGE)
    first, *lines = head.decode("latin-1").split("\r\n")[:-2]
    method, target, version = _first(first)
    headers = _headers(lines)
    length = headers.get("content-length", "0")
    if not version.startswith("HTTP/1.") or "transfer-encoding" in headers or not (length.isascii() and length.isdigit()):
        raise RefusedError(HTTPStatus.BAD_REQUEST)
    # A number of thousands of digits is none that a body could have.
    if len(length) > MOST_DIGITS:
        raise RefusedError(HTTPStatus.REQUEST_ENTITY_TOO_LARGE)
    path, _, query = target.partition("?")
    return Request(method, path, query, headers, b"", int(length))


async def with_body(request: Request, reader: asyncio.StreamReader, most: int = MOST_BODY) -> Request:
    """The same request with its body.

    Raises
    ------
    RefusedError
        It is longer than `most`, too slow, or cut.
    """
    if request.length > most:
        raise RefusedError(HTTPStatus.REQUEST_ENTITY_TOO_LARGE)
    try:
        async with asyncio.timeout(REQUEST_S):
            return replace(request, body=await reader.readexactly(request.length))
    except TimeoutError as e:
        raise RefusedError(HTTPStatus.REQUEST_TIMEOUT) from e
    except asyncio.IncompleteReadError as e:
        raise RefusedError(HTTPStatus.BAD_REQUEST) from e


def _first(line: str) -> tuple[str, str, str]:
    parts = line.split(" ")
    if len(parts) != 3 or not parts[1].startswith("/"):
        raise RefusedError(HTTPStatus.BAD_REQUEST)
    return parts[0], parts[1], parts[2]


def _headers(lines: list[str]) -> dict[str, str]:
    headers: dict[str, str] = {}
    for line in lines:
        name, colon, value = line.partition(":")
        key = name.lower()
        # One that stands twice is read differently by different programs.
        if not colon or not name or name != name.strip() or key in headers:
            raise RefusedError(HTTPStatus.BAD_REQUEST)
        headers[key] = value.strip()
    return headers


def head(status: HTTPStatus, kind: str, length: int | None, extra: dict[str, str] | None = None) -> bytes:
    """The begin of an answer; without a length it lasts until the connection ends."""
    lines = {**HEADERS, "Content-Type": kind, "Connection": "close", **(extra or {})}
    if length is not None:
        lines["Content-Length"] = str(length)
    text = "".join(f"{name}: {value}\r\n" for name, value in lines.items())
    return f"HTTP/1.1 {status.value} {status.phrase}\r\n{text}\r\n".encode("latin-1")


def answer(status: HTTPStatus, body: bytes = b"", kind: str = "text/plain; charset=utf-8", extra: dict[str, str] | None = None) -> bytes:
    """A whole answer; of one that refuses, the body is its name."""
    content = body or (b"" if status is HTTPStatus.NO_CONTENT else f"{status.phrase}\n".encode())
    return head(status, kind, len(content), extra) + content


class Door:
    """Who may come in.

    Parameters
    ----------
    port : int
        Of the server.

    Attributes
    ----------
    token : str
        What opens a session: 128 random bits of this start.
    """

    def __init__(self, port: int) -> None:
        self.token = secrets.token_hex(16)
        self._hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost", "[::1]")}
        self._cookie = f"navbound-{port}"
        self._sessions: dict[str, tuple[int, float]] = {}
        self._n_sessions = 0
        self._rates: dict[str, tuple[float, float]] = {}

    def check(self, request: Request, address: str) -> None:
        """Whether this request may ask anything here.

        Raises
        ------
        RefusedError
            Too many of its address, another host's name (a page of elsewhere that found its way to this address), or a page of elsewhere.
        """
        if not self._within_rate(address):
            raise RefusedError(HTTPStatus.TOO_MANY_REQUESTS)
        host = request.headers.get("host", "")
        if host not in self._hosts:
            raise RefusedError(HTTPStatus.MISDIRECTED_REQUEST)
        origin = request.headers.get("origin")
        # A page of ours states its origin with every POST; a GET without one is a person's.
        if (request.method == "POST" or origin is not None) and origin != f"http://{host}":
            raise RefusedError(HTTPStatus.FORBIDDEN)

    def _within_rate(self, address: str) -> bool:
        now = time.monotonic()
        left, since = self._rates.get(address, (BURST, now))
        left = min(BURST, left + (now - since) * RATE_PER_S)
        self._rates[address] = (max(0.0, left - 1.0), now)
        return left >= 1.0

    def open(self, token: str) -> dict[str, str]:
        """The header that begins a session.

        Raises
        ------
        RefusedError
            Another token.
        """
        if not hmac.compare_digest(token.encode("utf-8", "replace"), self.token.encode()):
            raise RefusedError(HTTPStatus.UNAUTHORIZED)
        if len(self._sessions) >= MOST_SESSIONS:
            self._sessions.pop(next(iter(self._sessions)))
        value = secrets.token_hex(16)
        self._n_sessions += 1
        self._sessions[value] = (self._n_sessions, time.monotonic() + SESSION_S)
        return {"Set-Cookie": f"{self._cookie}={value}; HttpOnly; SameSite=Strict; Path=/; Max-Age={SESSION_S:.0f}"}

    def session(self, request: Request) -> int:
        """Number of the session that a request belongs to.

        Raises
        ------
        RefusedError
            None.
        """
        received = request.cookie(self._cookie).encode("utf-8", "replace")
        for value, (number, until) in self._sessions.items():
            if hmac.compare_digest(received, value.encode()) and time.monotonic() < until:
                return number
        raise RefusedError(HTTPStatus.UNAUTHORIZED)
