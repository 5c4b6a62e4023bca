"""What each page has still to receive: every alert; of epochs the newest where it is slow, and how many it missed."""

from __future__ import annotations

import asyncio
import json
from collections import deque
from typing import Any

MOST_CLIENTS = 64
MOST_ALERTS = 1000
"""Alerts that wait for a page; one that has not taken so many is closed, and may come again."""
MOST_ROWS = 100
"""Epochs that wait for a page."""
SILENT_S = 15.0
"""Time without a sign of life from a page after which its stream is closed. [s]

What the server could write says nothing of it: buffers take megabytes."""


def event(name: str, data: dict[str, Any]) -> bytes:
    """One server-sent event. What JSON has no number for is an error here, not on the page."""
    return f"event: {name}\ndata: {json.dumps(data, separators=(',', ':'), allow_nan=False)}\n\n".encode()


class Client:
    """One page.

    Attributes
    ----------
    n_skipped : int
        Epochs that it missed.
    """

    def __init__(self, number: int, track: str | None, now_s: float) -> None:
        self.number, self.track, self.alive_s = number, track, now_s
        self.n_skipped = 0
        self.closed = False
        self._alerts: deque[bytes] = deque()
        self._rows: deque[list[Any]] = deque()
        self._states: dict[str, list[Any]] = {}
        self._status: dict[str, Any] | None = None
        self._wake = asyncio.Event()

    def tell(self, name: str, data: dict[str, Any]) -> None:
        """Keep what must not be lost."""
        if len(self._alerts) >= MOST_ALERTS:
            self.close()
            return
        self._alerts.append(event(name, data))
        self._wake.set()

    def show(self, rows: list[list[Any]], status: dict[str, Any]) -> None:
        """Keep the newest epochs and the newest status."""
        for row in rows:
            if len(self._rows) >= MOST_ROWS:
                self._rows.popleft()
                self.n_skipped += 1
            self._rows.append(row)
        self._status = status
        self._wake.set()

    def merge(self, states: dict[str, list[Any]], status: dict[str, Any]) -> None:
        """Keep the newest state of each track of a fleet, and the newest status."""
        self._states |= states
        self._status = status
        self._wake.set()

    def close(self) -> None:
        """Nothing more is sent."""
        self.closed = True
        self._wake.set()

    @property
    def n_waiting(self) -> int:
        """Alerts and epochs that wait."""
        return len(self._alerts) + len(self._rows)

    async def take(self) -> bytes:
        """What is to be written next, alerts first; b"" when it is closed."""
        await self._wake.wait()
        self._wake.clear()
        if self.closed:
            return b""
        out = b"".join(self._alerts)
        self._alerts.clear()
        if self._status is not None:
            rows = [*self._rows, *self._states.values()]
            out += event("state", {"rows": rows, "n_skipped": self.n_skipped, "status": self._status})
            self._rows.clear()
            self._states.clear()
            self._status = None
        return out


class Hub:
    """All pages."""

    def __init__(self) -> None:
        self.clients: dict[int, Client] = {}
        self._next = 1

    def enter(self, track: str | None, now_s: float) -> Client | None:
        """A new page; None where there are too many."""
        if len(self.clients) >= MOST_CLIENTS:
            return None
        client = Client(self._next, track, now_s)
        self.clients[self._next] = client
        self._next += 1
        return client

    def leave(self, client: Client) -> None:
        """A page that is gone."""
        client.close()
        self.clients.pop(client.number, None)

    def tell(self, name: str, data: dict[str, Any]) -> None:
        """To every page."""
        for client in self.clients.values():
            client.tell(name, data)

    def drop_silent(self, now_s: float) -> int:
        """Close pages that gave no sign of life; how many."""
        silent = [client for client in self.clients.values() if now_s - client.alive_s > SILENT_S]
        for client in silent:
            client.close()
        return len(silent)
