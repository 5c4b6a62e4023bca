"""NATS JetStream as a transport: one stream a log, and one that keeps the newest of everything else.

A message holds frames, and its position in the log in a header. Each is written with the number of the message before it, which the
server checks: of two writers one is refused, and a message that was written while its answer was lost is recognised. A reader takes
messages in the order of their numbers and compares the positions: what comes twice is dropped, what is missing is fetched.
"""

from __future__ import annotations

import asyncio
import contextlib
import threading
from collections import deque
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from navbound.errors import FormatError, InputError
from navbound.live.fleet.brokers import shared
from navbound.live.fleet.brokers.shared import ANSWER_S, CONNECT_S, Broker
from navbound.live.fleet.transport import WAIT_S, UnreachableError

try:
    import nats as client
    from nats.js import api, errors
except ImportError as e:  # pragma: no cover - an environment without the extra
    raise InputError("to", "nats://", domain="a folder, unless pip install 'navbound[nats]' has brought the client of NATS") from e

from navbound.live.fleet.brokers.stream import WRONG_SEQUENCE, NatsLog

if TYPE_CHECKING:
    from collections.abc import Coroutine

    from nats.aio.msg import Msg

PORT = 4222
_LAST_OF_SUBJECT = "Nats-Expected-Last-Subject-Sequence"
_SLOTS = 2


class Nats(Broker):
    """Streams of a server: as :class:`navbound.live.fleet.transport.Transport` says."""

    hint = "does the server run with JetStream (nats-server -js)?"

    def __init__(self, name: str) -> None:
        super().__init__(name, PORT)
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        self.more = threading.Event()
        self.n_reconnects = 0
        self._slots: dict[int, int] = {}
        self._shown: dict[int, deque[tuple[bytes, bytes]]] | None = None
        try:
            self.connection = self.call(self._connect())
        except UnreachableError as e:
            self._end()
            raise FormatError(self.name, f"{e}; start a server (nats-server -js), or check host and port") from e
        self.jetstream = self.connection.jetstream(timeout=ANSWER_S)

    async def _connect(self) -> Any:
        async def quiet(_: Exception) -> None:
            """What fails is repeated, or is an error of the call that failed."""

        async def back() -> None:
            # What others did while nobody could be heard is seen anew from here on.
            self.n_reconnects += 1
            self._seen.clear()

        options: dict[str, Any] = {
            "connect_timeout": CONNECT_S,
            "reconnect_time_wait": 0.25,
            "ping_interval": 5,
            "max_outstanding_pings": 2,
        }
        # The client would look for a server that was never there for ever.
        parts = urlsplit(self._server)
        _, writer = await asyncio.wait_for(asyncio.open_connection(parts.hostname, parts.port or PORT), CONNECT_S)
        writer.close()
        return await client.connect(self._server, max_reconnect_attempts=-1, error_cb=quiet, reconnected_cb=back, **options)

    def _make(self, n_lanes: int) -> None:
        self._stream("kept", [self._subject("kept", ">")], max_msgs_per_subject=1, max_bytes=shared.MOST_BYTES)
        for lane in range(n_lanes):
            for log in ("in", "out"):
                self._stream(f"{log}-{lane}", [self._subject(log, str(lane))], max_bytes=shared.MOST_BYTES)

    def call(self, work: Coroutine[Any, Any, Any]) -> Any:
        """Do something in the thread that speaks with the server.

        Raises
        ------
        UnreachableError
            There was no answer.
        nats.js.errors.APIError
            The server refuses.
        """
        future = asyncio.run_coroutine_threadsafe(asyncio.wait_for(work, 2 * ANSWER_S), self._loop)
        try:
            return future.result()
        except errors.APIError as e:
            # A server that has just started says so of a stream that it has not found yet.
            if e.code == 503:
                raise UnreachableError(f"{self.name} does not answer yet") from e
            raise
        except (client.errors.Error, OSError, TimeoutError) as e:
            raise UnreachableError(f"{self.name} does not answer ({type(e).__name__})") from e

    def _subject(self, *parts: str) -> str:
        return ".".join((self._fleet, *parts))

    def _stream(self, name: str, subjects: list[str], **limits: Any) -> None:
        config = api.StreamConfig(name=f"{self._fleet}-{name}", subjects=subjects, storage=api.StorageType.FILE, **limits)
        try:
            self.call(self.jetstream.add_stream(config))
        except errors.APIError as e:
            raise FormatError(self.name, f"the stream {config.name} cannot be made: {e.description}") from e

    def _newest(self, *key: object) -> tuple[bytes, int] | None:
        subject = self._subject("kept", *map(str, key))
        try:
            entry = self.call(self.jetstream.get_last_msg(f"{self._fleet}-kept", subject))
        except errors.NotFoundError:
            return None
        return bytes(entry.data or b""), int(entry.seq or 0)

    def _put(self, key: tuple[object, ...], content: bytes, last: int | None = None) -> int | None:
        headers = None if last is None else {_LAST_OF_SUBJECT: str(last)}
        try:
            done = self.call(self.jetstream.publish(self._subject("kept", *map(str, key)), content, headers=headers))
        except errors.APIError as e:
            if e.err_code == WRONG_SEQUENCE:
                return None
            raise
        return int(done.seq)

    def _members(self) -> list[str]:
        prefix = self._subject("kept", "worker", "")
        info = self.call(self.jetstream.stream_info(f"{self._fleet}-kept", subjects_filter=f"{prefix}*"))
        return [subject.removeprefix(prefix) for subject in info.state.subjects or {}]

    def _remove(self, *key: object) -> None:
        self.call(self.jetstream.purge_stream(f"{self._fleet}-kept", subject=self._subject("kept", *map(str, key))))

    def _log(self, kind: str, lane: int, written: tuple[int, int] | None = None) -> NatsLog:
        return NatsLog(self, f"{self._fleet}-{kind}-{lane}", self._subject(kind, str(lane)), written)

    def keep(self, lane: int, snapshot: bytes) -> None:
        """Keep a snapshot in one of two places by turns; its parts know the whole that they are of."""
        slot = self._slots[lane] = (self._slots.get(lane, 0) + 1) % _SLOTS
        for k, part in enumerate(shared.cut(snapshot)):
            self._put(("snapshot", lane, slot, k), part)

    def kept(self, lane: int) -> list[bytes]:
        """Snapshots whose parts are all there, the newest first."""
        snapshots = []
        for slot in range(_SLOTS):
            if (first := self._newest("snapshot", lane, slot, 0)) is None:
                continue
            rest = [self._newest("snapshot", lane, slot, k) for k in range(1, shared.n_parts(first[0]))]
            whole = shared.joined(part and part[0] for part in (first, *rest))
            if whole is not None:
                snapshots.append((first[1], slot, whole))
        snapshots.sort(reverse=True)
        if snapshots:
            self._slots[lane] = snapshots[0][1]
        return [whole for _, _, whole in snapshots]

    def show(self, lane: int, status: bytes, states: list[bytes]) -> None:
        """Newest states, to whoever listens: none of it is kept."""
        with contextlib.suppress(UnreachableError):
            for part in shared.shown_parts(status, states):
                self.call(self.connection.publish(self._subject("shown", str(lane)), part))

    def shown(self, lane: int) -> list[tuple[bytes, bytes]]:
        """Status and states that came since the last call."""
        if self._shown is None:
            self._shown = {k: deque(maxlen=shared.MOST_SHOWN) for k in range(self.n_lanes)}
            self.call(self.connection.subscribe(self._subject("shown", "*"), cb=self._see))
        waiting, taken = self._shown[lane], list[tuple[bytes, bytes]]()
        while waiting:
            taken.append(waiting.popleft())
        return taken

    async def _see(self, message: Msg) -> None:
        lane, shown = message.subject.rpartition(".")[2], shared.shown_of(message.data)
        if self._shown is not None and shown is not None and lane.isdigit() and int(lane) in self._shown:
            self._shown[int(lane)].append(shown)

    def wait(self) -> None:
        """Until a message came, or for a while."""
        self.more.wait(WAIT_S)
        self.more.clear()

    def drop(self, task: asyncio.Task[None]) -> None:
        """End a task of the thread that speaks with the server."""
        self._loop.call_soon_threadsafe(task.cancel)

    def _end(self) -> None:
        async def cancelled() -> None:
            others = asyncio.all_tasks() - {asyncio.current_task()}
            for task in others:
                task.cancel()
            await asyncio.wait_for(asyncio.gather(*others, return_exceptions=True), CONNECT_S)

        with contextlib.suppress(TimeoutError):
            asyncio.run_coroutine_threadsafe(cancelled(), self._loop).result(2 * CONNECT_S)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(2.0)
        self._loop.close()

    def close(self) -> None:
        """Give everything back."""
        with contextlib.suppress(errors.APIError):
            self._give_back()
        with contextlib.suppress(UnreachableError):
            self.call(self.connection.close())
        self._end()
