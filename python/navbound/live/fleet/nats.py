"""NATS JetStream as a transport: one stream a log, and one that keeps the newest of everything else.

A message holds frames, and its position in the log in a header. Each is written with the number of the message before it, which the
server checks: of two writers one is refused, and a message that was written while its answer was lost is recognised. A reader takes
messages in the order of their numbers and compares the positions: what comes twice is dropped, what is missing is fetched.
"""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import json
import re
import struct
import threading
import time
import uuid
from collections import deque
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from navbound.errors import FormatError, InputError
from navbound.live.fleet.transport import WAIT_S, UnreachableError

try:
    import nats as client
    from nats.js import api, errors
except ImportError as e:  # pragma: no cover - an environment without the extra
    raise InputError("to", "nats://", domain="a folder, unless pip install 'navbound[nats]' has brought the client of NATS") from e

from navbound.live.fleet.stream_log import ANSWER_S, MOST_PAYLOAD, WRONG_SEQUENCE, NatsLog

if TYPE_CHECKING:
    from collections.abc import Coroutine

    from nats.aio.msg import Msg

CONNECT_S = 3.0
PORT = 4222
LEASE_S = 4.0
"""Time without a renewal after which a lane's worker counts as gone, by the clock of who looks. [s]"""
MOST_BYTES = 256 << 20
"""Bytes of a log that the server keeps; the oldest go first. [B]"""
MOST_SHOWN = 64
"""Messages of states of a lane that wait for who shows them."""
_LAST_OF_SUBJECT = "Nats-Expected-Last-Subject-Sequence"
_SLOTS = 2
_STATUS = struct.Struct("<I")


class Nats:
    """Streams of a server: as :class:`navbound.live.fleet.transport.Transport` says."""

    def __init__(self, name: str) -> None:
        self._server, self._fleet, self.name = _parts(name)
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        self.record: dict[str, Any] = {}
        self.n_lanes = 0
        self.more = threading.Event()
        self.n_reconnects = 0
        self._me = uuid.uuid4().hex
        self._leases: dict[int, int] = {}
        self._seen: dict[str, tuple[int, float]] = {}
        self._slots: dict[int, int] = {}
        self._counted = False
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

    @classmethod
    def create(cls, name: str, record: dict[str, Any], n_lanes: int) -> Nats:
        """Begin a fleet on a server."""
        made = cls(name)
        with made._opened():
            made._stream("kept", [made._subject("kept", ">")], max_msgs_per_subject=1, max_bytes=MOST_BYTES)
            for lane in range(n_lanes):
                for log in ("in", "out"):
                    made._stream(f"{log}-{lane}", [made._subject(log, str(lane))], max_bytes=MOST_BYTES)
            entry, known = made._newest("fleet"), {"record": record, "n_lanes": n_lanes}
            if entry is None:
                made._put(("fleet",), json.dumps(known).encode())
            elif (current := json.loads(entry[0]))["record"]["settings"] != record["settings"] or current["n_lanes"] != n_lanes:
                raise FormatError(made.name, "holds a fleet of other settings or another number of lanes; choose another NAME")
            made.record, made.n_lanes = record, n_lanes
        return made

    @classmethod
    def connect(cls, name: str, patience_s: float) -> Nats:
        """Open a fleet on a server."""
        until = time.monotonic() + patience_s
        while True:
            try:
                return cls._joined(name)
            except FormatError:
                if time.monotonic() >= until:
                    raise
                time.sleep(WAIT_S)

    @classmethod
    def _joined(cls, name: str) -> Nats:
        made = cls(name)
        with made._opened():
            entry = made._newest("fleet")
            if entry is None:
                raise FormatError(made.name, f"there is no such fleet; begin one with navbound live feed SOURCE --to {made.name}")
            current = json.loads(entry[0])
            made.record, made.n_lanes = current["record"], current["n_lanes"]
        return made

    @contextlib.contextmanager
    def _opened(self) -> Any:
        """Close what cannot be used, and say why."""
        try:
            yield
        except UnreachableError as e:
            self.close()
            raise FormatError(self.name, f"{e}; does the server run with JetStream (nats-server -js)?") from e
        except FormatError:
            self.close()
            raise

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
        """What is kept under a key, and the number of its message."""
        subject = self._subject("kept", *map(str, key))
        try:
            entry = self.call(self.jetstream.get_last_msg(f"{self._fleet}-kept", subject))
        except errors.NotFoundError:
            return None
        return bytes(entry.data or b""), int(entry.seq or 0)

    def _put(self, key: tuple[object, ...], content: bytes, last: int | None = None) -> int | None:
        """Keep something under a key; with `last` only where its newest message has that number, else None."""
        headers = None if last is None else {_LAST_OF_SUBJECT: str(last)}
        try:
            done = self.call(self.jetstream.publish(self._subject("kept", *map(str, key)), content, headers=headers))
        except errors.APIError as e:
            if e.err_code == WRONG_SEQUENCE:
                return None
            raise
        return int(done.seq)

    def came_in(self, lane: int) -> NatsLog:
        """What the feeder wrote."""
        return NatsLog(self, f"{self._fleet}-in-{lane}", self._subject("in", str(lane)))

    def went_out(self, lane: int) -> NatsLog:
        """What the worker wrote."""
        return NatsLog(self, f"{self._fleet}-out-{lane}", self._subject("out", str(lane)))

    def keep(self, lane: int, snapshot: bytes) -> None:
        """Keep a snapshot in one of two places by turns; its parts know the whole that they are of."""
        slot = self._slots[lane] = (self._slots.get(lane, 0) + 1) % _SLOTS
        parts = [snapshot[k : k + MOST_PAYLOAD] for k in range(0, len(snapshot), MOST_PAYLOAD)] or [b""]
        head = hashlib.sha256(snapshot).digest() + _STATUS.pack(len(parts))
        for k, part in enumerate(parts):
            self._put(("snapshot", lane, slot, k), head + part)

    def kept(self, lane: int) -> list[bytes]:
        """Snapshots whose parts are all there, the newest first."""
        snapshots = []
        for slot in range(_SLOTS):
            if (first := self._newest("snapshot", lane, slot, 0)) is None:
                continue
            digest, n_parts = first[0][:32], _STATUS.unpack(first[0][32:36])[0]
            rest = [self._newest("snapshot", lane, slot, k) for k in range(1, n_parts)]
            whole = b"".join(part[0][36:] for part in (first, *rest) if part is not None)
            if hashlib.sha256(whole).digest() == digest:
                snapshots.append((first[1], slot, whole))
        snapshots.sort(reverse=True)
        if snapshots:
            self._slots[lane] = snapshots[0][1]
        return [whole for _, _, whole in snapshots]

    def show(self, lane: int, status: bytes, states: list[bytes]) -> None:
        """Newest states, to whoever listens: none of it is kept."""
        parts, subject = _grouped(states) or [b""], self._subject("shown", str(lane))
        with contextlib.suppress(UnreachableError):
            for part in parts:
                self.call(self.connection.publish(subject, _STATUS.pack(len(status)) + status + part))

    def shown(self, lane: int) -> list[tuple[bytes, bytes]]:
        """Status and states that came since the last call."""
        if self._shown is None:
            self._shown = {k: deque(maxlen=MOST_SHOWN) for k in range(self.n_lanes)}
            self.call(self.connection.subscribe(self._subject("shown", "*"), cb=self._see))
        waiting, taken = self._shown[lane], list[tuple[bytes, bytes]]()
        while waiting:
            taken.append(waiting.popleft())
        return taken

    async def _see(self, message: Msg) -> None:
        lane, data = message.subject.rpartition(".")[2], message.data
        if self._shown is None or not lane.isdigit() or int(lane) not in self._shown or len(data) < _STATUS.size:
            return
        length = _STATUS.size + _STATUS.unpack_from(data)[0]
        self._shown[int(lane)].append((data[_STATUS.size : length], data[length:]))

    def _unchanged_s(self, key: str, number: int) -> float:
        """For how long the newest message under a key has had its number, as far as this process has seen. [s]."""
        before = self._seen.get(key)
        if before is None or before[0] != number:
            self._seen[key] = (number, time.monotonic())
            return 0.0
        return time.monotonic() - before[1]

    def claim(self, lane: int) -> bool:
        """Take the lease of a lane that is free or was not renewed, and shut who had it out of the log."""
        try:
            entry = self._newest("lease", lane)
            current, number = entry or (b"", 0)
            if current and self._unchanged_s(f"lease.{lane}", number) < LEASE_S:
                return False
            taken = self._put(("lease", lane), self._me.encode(), last=number)
            if taken is None:
                return False
            self._leases[lane] = taken
            self.went_out(lane).fence()
        except UnreachableError:
            return False
        return True

    def renew(self) -> list[int]:
        """Renew leases; those that another has taken."""
        lost = []
        with contextlib.suppress(UnreachableError):
            self._put(("worker", self._me), b"1")
            self._counted = True
            for lane, number in list(self._leases.items()):
                renewed = self._put(("lease", lane), self._me.encode(), last=number)
                if renewed is not None:
                    self._leases[lane] = renewed
                    continue
                # It may be this worker's own renewal whose answer was lost.
                current = self._newest("lease", lane)
                if current is not None and current[0] == self._me.encode():
                    self._leases[lane] = current[1]
                else:
                    lost.append(lane)
                    del self._leases[lane]
        return lost

    def release(self, lane: int) -> None:
        """Give a lane back."""
        number = self._leases.pop(lane)
        with contextlib.suppress(UnreachableError):
            self._put(("lease", lane), b"", last=number)

    def n_workers(self) -> int:
        """Workers that said lately that they live; what another left long ago is removed."""
        prefix = self._subject("kept", "worker", "")
        try:
            info = self.call(self.jetstream.stream_info(f"{self._fleet}-kept", subjects_filter=f"{prefix}*"))
            n = 0
            for subject in info.state.subjects or {}:
                name = subject.removeprefix(prefix)
                entry = self._newest("worker", name)
                alive = entry is not None and (name == self._me or self._unchanged_s(f"worker.{name}", entry[1]) < LEASE_S)
                n += alive
                if not alive:
                    self.call(self.jetstream.purge_stream(f"{self._fleet}-kept", subject=subject))
        except UnreachableError:
            return max(1, self.n_lanes)
        return n

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
        with contextlib.suppress(UnreachableError, errors.APIError):
            for lane in list(self._leases):
                self.release(lane)
            if self._counted:
                self.call(self.jetstream.purge_stream(f"{self._fleet}-kept", subject=self._subject("kept", "worker", self._me)))
        with contextlib.suppress(UnreachableError):
            self.call(self.connection.close())
        self._end()


def _parts(name: str) -> tuple[str, str, str]:
    """Address of the server, name of the fleet, and the whole without secrets."""
    try:
        parts = urlsplit(name)
        host, port = parts.hostname, parts.port or PORT
    except ValueError as e:
        raise InputError("to", name, domain="nats://host:port/NAME") from e
    fleet = parts.path.strip("/")
    if not host or not re.fullmatch(r"[A-Za-z0-9_-]{1,32}", fleet):
        raise InputError("to", name, domain="nats://host:port/NAME, the name of 1 to 32 letters, digits, - and _")
    return f"{parts.scheme}://{parts.netloc}", fleet, f"{parts.scheme}://{host}:{port}/{fleet}"


def _grouped(frames: list[bytes]) -> list[bytes]:
    """Frames together, as many as a message may hold."""
    parts = list[bytes]()
    for frame in frames:
        if parts and len(parts[-1]) + len(frame) <= MOST_PAYLOAD:
            parts[-1] += frame
        else:
            parts.append(frame)
    return parts
