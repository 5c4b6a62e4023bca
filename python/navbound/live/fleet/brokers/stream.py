"""One log in a stream of NATS JetStream: messages with their positions, in one order, from one writer."""

from __future__ import annotations

import asyncio
import contextlib
import time
from collections import deque
from typing import TYPE_CHECKING

import nats as client
from nats.js import api, errors

from navbound.errors import FormatError
from navbound.live.fleet.brokers.numbered import AT, MOST_WAITING, Message, NumberedLog, position

if TYPE_CHECKING:
    from navbound.live.fleet.brokers.nats import Nats

EXPECTED = "Nats-Expected-Last-Sequence"
WRONG_SEQUENCE = 10071
"""The server's number for a message that is not the next one."""
FETCH, FETCH_S, IDLE_S = 32, 1.0, 5.0


class NatsLog(NumberedLog):
    """A stream, whose server refuses every message that does not count."""

    def __init__(self, server: Nats, stream: str, subject: str, written: tuple[int, int] | None) -> None:
        super().__init__(server.name, stream, 1, written)
        self._server, self._stream, self._subject = server, stream, subject
        self._reader: asyncio.Task[None] | None = None

    def _bounds(self) -> tuple[int, int]:
        state = self._server.call(self._server.jetstream.stream_info(self._stream)).state
        return max(1, int(state.first_seq)), int(state.last_seq) + 1

    def _message(self, number: int) -> Message:
        try:
            entry = self._server.call(self._server.jetstream.get_msg(self._stream, number))
        except errors.NotFoundError as e:
            raise self._removed(f"message {number}") from e
        return Message(number, number - 1, _at(entry.headers), bytes(entry.data or b""))

    def _publish(self, data: bytes, last: int, at: int) -> int | None:
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

    def _follow(self, number: int) -> None:
        if self._reader is not None:
            self._server.drop(self._reader)
        waiting = self.waiting

        async def start() -> asyncio.Task[None]:
            return asyncio.create_task(self._fetch(number, waiting))

        self._reader = self._server.call(start())

    def _refill(self) -> None:
        """The thread that speaks with the server takes what comes."""

    async def _fetch(self, number: int, waiting: deque[Message]) -> None:
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
                        of = message.metadata.sequence.stream
                        seen = of + 1
                        waiting.append(Message(of, of - 1, _at(message.headers), message.data))
                    self._server.more.set()
            except (client.errors.Error, OSError, TimeoutError):
                await asyncio.sleep(0.25)
            finally:
                with contextlib.suppress(Exception):
                    await pulled.unsubscribe()


def _at(headers: dict[str, str] | None) -> int:
    """Position of a message."""
    return position((headers or {}).get(AT))
