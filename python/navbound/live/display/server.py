"""The server of the display: what its pages ask and receive beyond any other page of this host; nothing of it reaches the monitor."""

from __future__ import annotations

import asyncio
import json
import time
from http import HTTPStatus
from typing import TYPE_CHECKING, Any
from urllib.parse import parse_qs

from navbound.live import journal
from navbound.live.display.watch import Watch
from navbound.live.session import now_ns
from navbound.live.sinks import metrics
from navbound.serve import request
from navbound.serve.request import RefusedError
from navbound.serve.service import Options, Service, pages, shell

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from navbound.serve import hub

STATUS_S = 0.5
"""Longest time between two words to a page: it takes two seconds of silence for a lost link. [s]"""
WITHOUT_SCRIPTS = "This page shows nothing without scripts. Nothing is monitored on this screen."


class Server(Service):
    """The display of one session.

    Parameters
    ----------
    watch : Watch
        Its journals.
    options : Options
        How.
    """

    def __init__(self, watch: Watch, options: Options) -> None:
        super().__init__(options, bundle())
        self.watch = watch
        self._reported_s = 0.0
        self.handlers |= {
            ("POST", "/acknowledge"): self._acknowledge,
            ("GET", "/health"): self._health,
            ("GET", "/metrics"): self._metrics,
        }

    def turn(self, now_s: float) -> bool:
        """Tell the pages what the journals have."""
        news = self.watch.poll()
        if news or now_s - self._reported_s >= STATUS_S:
            self._reported_s = now_s
            self._tell(news.rows, news.transitions)
        return bool(self.watch.behind)

    def _tell(self, rows: dict[str, list[Any]], transitions: list[dict[str, Any]]) -> None:
        for each in transitions:
            self.hub.tell("alert", each)
        status = self.watch.status() | {"tracks": list(self.watch.tracks)}
        for client in self.hub.clients.values():
            if client.track is None:
                client.track = next(iter(self.watch.tracks), None)
            client.show(rows.get(client.track or "", []), status | {"track": client.track})

    def _acknowledge(self, query: request.Request) -> bytes:
        number = self.door.session(query)
        alert = query.json().get("alert")
        if not isinstance(alert, str) or alert not in self.watch.open:
            raise RefusedError(HTTPStatus.NOT_FOUND)
        if alert not in self.watch.acknowledged:
            record = {"alert": alert, "acknowledged_ns": now_ns(), "session": number}
            try:
                with (self.watch.folder / journal.ACKNOWLEDGED).open("a", encoding="utf-8") as file:
                    file.write(json.dumps(record, separators=(",", ":")) + "\n")
            except OSError as e:
                raise RefusedError(HTTPStatus.INSUFFICIENT_STORAGE) from e
            self.watch.acknowledged.add(alert)
            self.hub.tell("acknowledged", {"alert": alert})
        return request.answer(HTTPStatus.NO_CONTENT)

    def _health(self, _query: request.Request) -> bytes:
        lost, record = self.watch.health()
        code = HTTPStatus.SERVICE_UNAVAILABLE if lost else HTTPStatus.OK
        return request.answer(code, json.dumps(record).encode(), "application/json")

    def _metrics(self, _query: request.Request) -> bytes:
        return request.answer(HTTPStatus.OK, self.watch.metrics(len(self.hub.clients)).encode(), metrics.KIND)

    def enter(self, query: request.Request) -> hub.Client | None:
        """A page with the track that it asks for, where there is such a one."""
        try:
            requested = parse_qs(query.query, max_num_fields=4).get("track", [None])[0]
        except ValueError as e:
            raise RefusedError(HTTPStatus.BAD_REQUEST) from e
        return self.hub.enter(requested if requested in self.watch.tracks else None, time.monotonic())

    def snapshot(self, client: hub.Client) -> dict[str, Any]:
        """All of the track until now."""
        snapshot = self.watch.snapshot(client.track)
        client.track = snapshot["track"]
        return snapshot


def bundle() -> dict[str, tuple[bytes, str]]:
    """Everything that is served."""
    page = shell("navbound live", "live", WITHOUT_SCRIPTS, "display")
    return pages(page, "live.js", "clock.js", "live.css")


def serve(folder: Path, options: Options, *, ready: Callable[[Server], None], stop: Callable[[], bool]) -> None:
    """Show the session in a folder until `stop`.

    Parameters
    ----------
    folder : Path
        Of a session that runs, or ran.
    options : Options
        How.
    ready : callable
        Takes the server once it listens.
    stop : callable
        Called every tenth of a second.

    Raises
    ------
    FormatError
        Not the folder of a session, or the port is taken.
    """
    server = Server(Watch(folder), options)
    ready(server)
    asyncio.run(server.run(stop))


def beside(folder: Path, options: Options, ready: Callable[[str], None], say: Callable[[str], None], stop: Callable[[], bool]) -> None:
    """:func:`serve` in a process beside a session."""
    del say  # a display speaks on its pages
    serve(folder, options, ready=lambda server: ready(server.address), stop=stop)
