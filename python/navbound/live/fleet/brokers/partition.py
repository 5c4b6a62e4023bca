"""One log in a partition of Kafka, and the topic whose newest records by key count."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, NamedTuple

from confluent_kafka import KafkaError, TopicPartition

from navbound.live.fleet.brokers.cluster import Client, header
from navbound.live.fleet.brokers.numbered import AT, Message, NumberedLog, position
from navbound.live.fleet.brokers.shared import ANSWER_S
from navbound.live.fleet.transport import UnreachableError

if TYPE_CHECKING:
    from collections.abc import Callable

    from confluent_kafka import Message as Record

    from navbound.live.fleet.brokers.kafka import Kafka

BEHIND = "Navbound-Behind"
NUMBER = "Navbound-Number"
DEAF_S = 2.0
"""Time without an answer after which what others did is seen anew: they may not have been heard either. [s]"""


class KafkaLog(NumberedLog):
    """A partition, which takes every record: readers pass over those that do not count."""

    def __init__(self, server: Kafka, topic: str, lane: int, written: tuple[int, int] | None) -> None:
        super().__init__(server.name, f"{topic}/{lane}", 0, written)
        self._server, self.place = server, (topic, lane)

    def _bounds(self) -> tuple[int, int]:
        return self._server.client.bounds(*self.place)

    def _message(self, number: int) -> Message:
        records = self._server.client.records(*self.place, number, number + 1)
        if not records:
            raise self._removed(f"record {number}")
        return self.message(records[0])

    @staticmethod
    def message(record: Record) -> Message:
        """What a record says; one that was not written here is behind nothing, and so does not count."""
        at, behind = position(header(record, AT)), position(header(record, BEHIND))
        return Message(int(record.offset() or 0), behind if at >= 0 else -2, at, bytes(record.value() or b""))

    def _publish(self, data: bytes, last: int, at: int) -> int | None:
        number = self._server.client.send(*self.place, data, headers={AT: str(at), BEHIND: str(last)})
        # The broker has refused nothing: of those behind the same one the first counts.
        return number if number == last + 1 or self._after(last).number == number else None

    def _follow(self, number: int) -> None:
        self._server.follow(self, number)

    def _refill(self) -> None:
        if not self.waiting:
            self._server.pump(0.0)


class _Entry(NamedTuple):
    content: bytes
    number: int


class Kept:
    """Newest contents by key, in a topic of one partition that every part of a fleet reads in the same order.

    A record names the number of what it takes the place of, plus one. It counts where that is more than the number of what is there: of
    two writers who knew the same, the first counts, and all who read see which it was. A reader that comes when older records have been
    compacted away may believe one that did not count; the next one that counts has a number above it.
    """

    def __init__(self, client: Client, topic: str, anew: Callable[[], None]) -> None:
        self._client, self._topic, self._anew = client, topic, anew
        self._consumer = client.consumer(**{"enable.partition.eof": True, "auto.offset.reset": "earliest"})
        # To ask for the beginning by its own name costs half a second.
        self._next = client.bounds(topic, 0)[0]
        self._consumer.assign([TopicPartition(topic, 0, self._next)])
        self._entries: dict[str, _Entry] = {}
        self._heard_s = time.monotonic()
        self._lock = threading.Lock()

    def newest(self, key: str) -> tuple[bytes, int] | None:
        """Content and number of now."""
        self._catch_up(self._client.bounds(self._topic, 0)[1])
        return self._entries.get(key)

    def names(self) -> list[str]:
        """Those under which something is kept."""
        self._catch_up(self._client.bounds(self._topic, 0)[1])
        return list(self._entries)

    def put(self, key: str, content: bytes, last: int | None) -> int | None:
        """Write; with `last` only where it is still the number there."""
        while True:
            known = self._entries.get(key, _Entry(b"", 0)).number
            number = 1 + (known if last is None else last)
            offset = self._client.send(self._topic, 0, content, key=key, headers={NUMBER: str(number)})
            with self._lock:
                if offset == self._next:
                    # Nobody wrote between: what comes back later says nothing new.
                    self._take(key, number, content, offset)
            self._catch_up(offset + 1)
            if self._entries.get(key) == (content, number):
                return number
            if last is not None:
                return None

    def remove(self, key: str) -> None:
        """Keep nothing under a key."""
        self._catch_up(self._client.send(self._topic, 0, None, key=key) + 1)

    def _catch_up(self, to: int) -> None:
        """Read until an offset."""
        until = time.monotonic() + ANSWER_S
        with self._lock:
            while self._next < to:
                record = self._consumer.poll(0.1)
                if record is None:
                    if time.monotonic() > until:
                        raise UnreachableError(f"{self._client.name} does not give what is kept")
                elif record.error() is None:
                    self._hear(record)
                elif record.error().code() == KafkaError._PARTITION_EOF:  # type: ignore[union-attr]
                    # The last records before it may have been compacted away.
                    self._next = max(self._next, int(record.offset() or 0))
            now = time.monotonic()
            if now - self._heard_s > DEAF_S:
                self._anew()
            self._heard_s = now

    def _hear(self, record: Record) -> None:
        key, content = record.key() or b"", record.value()
        name = key.decode(errors="replace") if isinstance(key, bytes) else key
        self._take(name, position(header(record, NUMBER)), None if content is None else bytes(content), int(record.offset() or 0))

    def _take(self, key: str, number: int, content: bytes | None, offset: int) -> None:
        if offset < self._next:
            return
        self._next = offset + 1
        if content is None:
            self._entries.pop(key, None)
        elif number > (self._entries[key].number if key in self._entries else 0):
            self._entries[key] = _Entry(content, number)

    def close(self) -> None:
        """End it."""
        self._consumer.close()
