"""One log in a stream of NATS JetStream: messages with their positions, in one order, from one writer."""

from __future__ import annotations

import asyncio
import contextlib
import time
from collections import deque
from typing import TYPE_CHECKING

import nats as client
from nats.js import api, errors

from navbound import _core
from navbound.errors import FormatError
from navbound.live.fleet.transport import FencedError, UnreachableError

if TYPE_CHECKING:
    from navbound.live.fleet.nats import Nats

AT = "Navbound-At"
EXPECTED = "Nats-Expected-Last-Sequence"
WRONG_SEQUENCE = 10071
"""The server's number for a message that is not the next one."""
MOST_PAYLOAD = 512 * 1024
"""Bytes of a message where one frame is not longer: servers take a megabyte unless they are set otherwise. [B]"""
ANSWER_S = 5.0
MOST_WAITING = 64
"""Messages of a log that wait in this process."""
MOST_READ = 1 << 20
FETCH, FETCH_S, IDLE_S = 32, 1.0, 5.0


class NatsLog:
    """A stream: as :class:`navbound.live.fleet.transport.Log` says."""

    def __init__(self, server: Nats, stream: str, subject: str) -> None:
        self._server, self._stream, self._subject = server, stream, subject
        self._written: tuple[int, int] | None = None
        self._next: tuple[int, int] | None = None
        self._waiting: deque[tuple[int, int, bytes]] = deque()
        self._reader: asyncio.Task[None] | None = None

    def end(self) -> int:
        """Position behind the last message."""
        if self._written is None:
            self._written = self._last()
        return self._written[1]

    def _last(self) -> tuple[int, int]:
        """Number of the last message, and the position behind it."""
        number = int(self._server.call(self._server.jetstream.stream_info(self._stream)).state.last_seq)
        if number == 0:
            return 0, 0
        at, data = self._message(number)
        return number, at + len(data)

    def _message(self, number: int) -> tuple[int, bytes]:
        """Position and content of a message."""
        try:
            entry = self._server.call(self._server.jetstream.get_msg(self._stream, number))
        except errors.NotFoundError as e:
            raise FormatError(
                self._server.name, f"message {number} of {self._stream} is not there any more: the server kept too little"
            ) from e
        return _at(entry.headers), bytes(entry.data or b"")

    def fence(self) -> None:
        """Shut every other writer out: the number that it expects is taken."""
        while True:
            number, end = self._last()
            if self._publish(b"", number, end) is not None:
                return

    def _publish(self, data: bytes, last: int, at: int) -> int | None:
        """Write a message behind the one with a number; None where that is not the last."""
        if len(data) > self._server.connection.max_payload:
            limit = self._server.connection.max_payload
            raise FormatError(
                self._server.name, f"a frame of {len(data)} B is longer than max_payload = {limit} B of the server; set it to 8MB there"
            )
        headers = {AT: str(at), EXPECTED: str(last)}
        try:
            done = self._server.call(self._server.jetstream.publish(self._subject, data, stream=self._stream, headers=headers))
        except errors.APIError as e:
            if e.err_code == WRONG_SEQUENCE:
                return None
            raise FormatError(self._server.name, f"a message is refused: {e.description}") from e
        return int(done.seq)

    def append(self, frames: bytes, at: int) -> None:
        """Write frames: as :class:`navbound.live.fleet.transport.Log` says."""
        end = self.end()
        if at > end:
            raise FencedError(f"{self._stream} ends at byte {end} and not at {at}: another process writes there")
        for data in _pieces(frames):
            self._append(data, at)
            at += len(data)

    def _append(self, data: bytes, at: int) -> None:
        if self._written is None or at < self._written[1]:
            self._require(data, at, self._place(at))
            return
        number, end = self._written
        done = self._publish(data, number, end)
        if done is None:
            # Either its answer was lost and it stands there, or another wrote.
            self._require(data, at, number + 1)
            done = number + 1
        self._written = (done, end + len(data))

    def _require(self, data: bytes, at: int, number: int) -> None:
        if self._message(number) != (at, data):
            raise FencedError(f"{self._stream} holds another message at byte {at}: another process writes there")

    def _place(self, begin: int) -> int:
        """Number of the first message that does not stand before a position."""
        state = self._server.call(self._server.jetstream.stream_info(self._stream)).state
        low, high = max(1, int(state.first_seq)), int(state.last_seq) + 1
        if low < high and self._message(low)[0] > begin:
            raise FormatError(
                self._server.name, f"{self._stream} begins behind byte {begin}: the server has removed what a worker still needs"
            )
        while low < high:
            middle = (low + high) // 2
            if self._message(middle)[0] < begin:
                low = middle + 1
            else:
                high = middle
        return low

    def read(self, begin: int) -> bytes:
        """Frames from a position on: as :class:`navbound.live.fleet.transport.Log` says."""
        try:
            if self._next is None or self._next[0] != begin:
                self._begin(begin, self._place(begin))
            return self._taken()
        except UnreachableError:
            return b""

    def _begin(self, position: int, number: int) -> None:
        self._end_reading()
        self._next, waiting = (position, number), self._waiting

        async def start() -> asyncio.Task[None]:
            return asyncio.create_task(self._follow(number, waiting))

        self._reader = self._server.call(start())

    def _taken(self) -> bytes:
        """Messages that wait, in order; what came before is dropped, and what is missing is fetched again."""
        assert self._next is not None
        (position, number), parts, n = self._next, list[bytes](), 0
        while self._waiting and n < MOST_READ:
            of, at, data = self._waiting.popleft()
            if of < number:
                continue
            if of > number or at != position:
                self._begin(position, number)
                break
            position, number = position + len(data), of + 1
            parts.append(data)
            n += len(data)
        self._next = (position, number)
        return b"".join(parts)

    async def _follow(self, number: int, waiting: deque[tuple[int, int, bytes]]) -> None:
        """Fetch messages from a number on, as long as there is room for them; what fails is begun again."""
        jetstream, seen = self._server.jetstream, number
        while True:
            config = api.ConsumerConfig(
                deliver_policy=api.DeliverPolicy.BY_START_SEQUENCE,
                opt_start_seq=seen,
                ack_policy=api.AckPolicy.NONE,
                mem_storage=True,
                inactive_threshold=30.0,
            )
            reconnects, heard = self._server.n_reconnects, time.monotonic()
            try:
                pulled = await jetstream.pull_subscribe(self._subject, stream=self._stream, config=config)
                while reconnects == self._server.n_reconnects:
                    while len(waiting) >= MOST_WAITING:
                        await asyncio.sleep(0.01)
                    try:
                        messages = await pulled.fetch(FETCH, timeout=FETCH_S)
                    except TimeoutError:
                        # A consumer that the server has forgotten is silent as well.
                        if time.monotonic() - heard > IDLE_S:
                            await pulled.consumer_info()
                            heard = time.monotonic()
                        continue
                    heard = time.monotonic()
                    for message in messages:
                        seen = message.metadata.sequence.stream + 1
                        waiting.append((seen - 1, _at(message.headers), message.data))
                    self._server.more.set()
            except (client.errors.Error, OSError, TimeoutError):
                await asyncio.sleep(0.25)
            finally:
                with contextlib.suppress(Exception):
                    await pulled.unsubscribe()

    def _end_reading(self) -> None:
        if self._reader is not None:
            self._server.drop(self._reader)
            self._reader = None
        self._waiting = deque()


def _at(headers: dict[str, str] | None) -> int:
    """Position of a message; one without was not written here."""
    text = (headers or {}).get(AT, "")
    return int(text) if text.isascii() and text.isdigit() else -1


def _pieces(frames: bytes) -> list[bytes]:
    """Whole frames together, as many as a message may hold."""
    ends, _ = _core.live_frames(frames)
    cuts, begin, last = list[bytes](), 0, 0
    for end in ends:
        if end - begin > MOST_PAYLOAD and last > begin:
            cuts.append(frames[begin:last])
            begin = last
        last = end
    return [*cuts, frames[begin:last]] if last > begin else cuts
