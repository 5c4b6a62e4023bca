"""What a fleet asks of Kafka: to write one record and hear where it stands, to look one up, and to follow partitions."""

from __future__ import annotations

import contextlib
import threading
import time
import uuid
from typing import TYPE_CHECKING, Any
from weakref import ref

from navbound.errors import FormatError, InputError
from navbound.live.fleet.brokers.numbered import MOST_WAITING
from navbound.live.fleet.brokers.shared import ANSWER_S
from navbound.live.fleet.transport import UnreachableError

try:
    from confluent_kafka import Consumer, KafkaError, KafkaException, Producer, TopicPartition
    from confluent_kafka.admin import AdminClient
    from confluent_kafka.cimpl import NewTopic
except ImportError as e:  # pragma: no cover - an environment without the extra
    raise InputError("to", "kafka://", domain="a folder, unless pip install 'navbound[kafka]' has brought the client of Kafka") from e

if TYPE_CHECKING:
    from collections.abc import Callable

    from confluent_kafka import Message as Record

    from navbound.live.fleet.brokers.partition import KafkaLog

MOST_RECORD = 8 << 20
"""Bytes of a record; the topics that are made here take it. [B]"""
AGAIN_S = 0.05
MAKE_S = 30.0
"""How long topics may take to be made: a broker that has just started is busy. [s]"""
FETCH_WAIT_MS = 100
"""How long a broker may hold back an empty answer; a partition that is added to others waits as long. [ms]"""
_POLL_S = 0.1
_AT_ONCE = 64


class Client:
    """A cluster, by one of its brokers.

    Parameters
    ----------
    address : str
        host:port.
    name : str
        For people.
    """

    def __init__(self, address: str, name: str) -> None:
        self.name = name
        # What fails is repeated, or is an error of the call that failed: the library's own lines about it say less.
        self._settings: dict[str, Any] = {
            "bootstrap.servers": address,
            "log_level": 0,
            "reconnect.backoff.ms": 50,
            "reconnect.backoff.max.ms": 500,
            "socket.timeout.ms": 10_000,
            "topic.metadata.refresh.fast.interval.ms": 50,
        }
        # One record of a log is in flight, and one that is written twice counts once: numbers of the broker's own would add nothing, and
        # end a producer for good where the broker has forgotten them.
        self._producer = Producer(
            self._settings | {"acks": "all", "linger.ms": 0, "message.timeout.ms": int(ANSWER_S * 1000), "message.max.bytes": MOST_RECORD}
        )
        self._looker = self.consumer(**{"fetch.wait.max.ms": 10, "fetch.message.max.bytes": 65_536})
        self._looking = threading.Lock()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._answer, daemon=True)
        self._thread.start()

    def _answer(self) -> None:
        while not self._stop.is_set():
            self._producer.poll(_POLL_S)

    def consumer(self, **options: Any) -> Consumer:
        """Reads partitions that are given to it; it is in no group, since what was read is known elsewhere."""
        fixed = {
            "group.id": uuid.uuid4().hex,
            "enable.auto.commit": False,
            "auto.offset.reset": "error",
            "fetch.error.backoff.ms": 50,
            "fetch.queue.backoff.ms": 10,
            "queued.max.messages.kbytes": 16_384,
            "fetch.wait.max.ms": FETCH_WAIT_MS,
        }
        return Consumer(self._settings | fixed | options)

    def topics(self) -> dict[str, int]:
        """Numbers of partitions of what is there."""
        there = self._answered(lambda: self._producer.list_topics(timeout=1.0))
        return {name: len(entry.partitions) for name, entry in there.topics.items()}

    def make(self, topics: dict[str, tuple[int, dict[str, object]]]) -> None:
        """Make topics of so many partitions with settings, and wait until they are there.

        Raises
        ------
        FormatError
            The cluster refuses.
        """
        admin = AdminClient(self._settings)
        made = [NewTopic(name, n, config={key: str(value) for key, value in settings.items()}) for name, (n, settings) in topics.items()]
        for name, done in (admin.create_topics(made, operation_timeout=MAKE_S, request_timeout=2 * MAKE_S) if made else {}).items():
            try:
                done.result(2 * MAKE_S)
            except TimeoutError as e:
                raise UnreachableError(f"{self.name} does not make the topic {name}") from e
            except KafkaException as e:
                # Another part of the fleet may have been faster.
                if e.args[0].code() != KafkaError.TOPIC_ALREADY_EXISTS:
                    raise FormatError(self.name, f"the topic {name} cannot be made: {e.args[0].str()}") from e
        until = time.monotonic() + MAKE_S
        while topics.keys() - self.topics().keys():
            if time.monotonic() > until:
                raise UnreachableError(f"{self.name} does not show the topics that were made")
            time.sleep(AGAIN_S)

    def _answered(self, question: Callable[[], Any]) -> Any:
        """Ask until there is an answer: a broker that has just started, or a topic, says at first that it is not there."""
        until = time.monotonic() + ANSWER_S
        while True:
            try:
                return question()
            except KafkaException as e:
                if time.monotonic() > until:
                    raise UnreachableError(f"{self.name} does not answer ({e.args[0].name()})") from e
                time.sleep(AGAIN_S)

    def bounds(self, topic: str, lane: int) -> tuple[int, int]:
        """Offset of the first record that is there, and the one behind the last."""
        low, high = self._answered(lambda: self._looker.get_watermark_offsets(TopicPartition(topic, lane), timeout=1.0))
        return int(low), int(high)

    def write(self, topic: str, lane: int, data: bytes | None, **options: Any) -> None:
        """Write a record, and do not wait for it.

        Raises
        ------
        FormatError
            It is too long.
        UnreachableError
            Too much waits already.
        """
        try:
            self._producer.produce(topic, data, partition=lane, **options)
        except BufferError as e:
            raise UnreachableError(f"{self.name} does not answer: too much waits for it") from e
        except KafkaException as e:
            raise self._refused(e.args[0], data) from e

    def send(self, topic: str, lane: int, data: bytes | None, **options: Any) -> int:
        """Write a record; its offset, once every copy that must have it has it."""
        heard, answer = threading.Event(), list[tuple[KafkaError | None, int]]()

        def done(error: KafkaError | None, record: Record) -> None:
            answer.append((error, -1 if error is not None else record.offset() or 0))
            heard.set()

        self.write(topic, lane, data, on_delivery=done, **options)
        # The library answers for itself when its own time is over.
        if not heard.wait(2 * ANSWER_S):
            raise UnreachableError(f"{self.name} does not answer")
        error, offset = answer[0]
        if error is not None:
            raise self._refused(error, data)
        return offset

    def _refused(self, error: KafkaError, data: bytes | None) -> Exception:
        if error.code() == KafkaError.MSG_SIZE_TOO_LARGE:
            return FormatError(
                self.name, f"a record of {len(data or b'')} B is too long; set max.message.bytes = {MOST_RECORD} of its topic"
            )
        if error.code() == KafkaError.TOPIC_AUTHORIZATION_FAILED:
            return FormatError(self.name, f"a record is refused: {error.str()}")
        return UnreachableError(f"{self.name} does not answer ({error.name()})")

    def records(self, topic: str, lane: int, begin: int, end: int) -> list[Record]:
        """Records from an offset to before another."""
        records, until = list[Any](), time.monotonic() + ANSWER_S
        with self._looking:
            self._looker.assign([TopicPartition(topic, lane, begin)])
            try:
                while begin < end:
                    record = self._looker.poll(_POLL_S)
                    if record is not None and record.error() is None and (offset := record.offset()) is not None:
                        # What is left of a place that was looked at before is passed over.
                        if (record.topic(), record.partition()) == (topic, lane) and begin <= offset < end:
                            records.append(record)
                            begin = offset + 1
                    elif record is not None and _is_removed(record.error()):
                        raise FormatError(
                            self.name, f"{topic}/{lane} does not hold record {begin} any more: let the broker keep more bytes"
                        )
                    elif time.monotonic() > until:
                        raise UnreachableError(f"{self.name} does not give record {begin} of {topic}/{lane}")
            finally:
                self._looker.unassign()
        return records

    def close(self) -> None:
        """End what was begun."""
        self._producer.flush(1.0)
        self._stop.set()
        self._thread.join(2.0)
        self._looker.close()


class Following:
    """Partitions whose records come as they are written, each for one log."""

    def __init__(self, client: Client) -> None:
        self._client, self._consumer = client, client.consumer()
        self._logs: dict[tuple[str, int], ref[KafkaLog]] = {}
        self._paused: set[tuple[str, int]] = set()
        self._lock = threading.Lock()

    def takes(self, log: KafkaLog) -> bool:
        """Whether no other log that is in use follows the same partition here."""
        other = self._logs.get(log.place, lambda: None)()
        return other is None or other is log

    def begin(self, log: KafkaLog, number: int) -> None:
        """Follow a partition from an offset on."""
        with self._lock:
            self._end(log.place)
            self._logs[log.place] = ref(log)
            self._consumer.incremental_assign([TopicPartition(*log.place, number)])

    def _end(self, place: tuple[str, int]) -> None:
        if self._logs.pop(place, None) is not None:
            self._paused.discard(place)
            self._consumer.incremental_unassign([TopicPartition(*place)])

    def pump(self, wait_s: float) -> None:
        """Hand out what has come; wait for the first where nothing has.

        Raises
        ------
        FormatError
            The broker has removed what was to come.
        """
        with self._lock:
            for place in [place for place in self._paused if len(self._log(place)) < MOST_WAITING // 2]:
                self._paused.remove(place)
                self._consumer.resume([TopicPartition(*place)])
            for _ in range(_AT_ONCE):
                if (record := self._consumer.poll(wait_s)) is None:
                    break
                wait_s = 0.0
                self._hand_out(record)

    def _log(self, place: tuple[str, int]) -> Any:
        log = self._logs[place]() if place in self._logs else None
        return () if log is None else log.waiting

    def _hand_out(self, record: Record) -> None:
        place = (str(record.topic()), int(record.partition() or 0))
        if record.error() is not None:
            if _is_removed(record.error()):
                raise FormatError(self._client.name, f"{place[0]}/{place[1]} was cut while it was read: let the broker keep more bytes")
            return
        log = self._logs[place]() if place in self._logs else None
        if log is None:
            # Who read there does so no more.
            self._end(place)
            return
        log.waiting.append(log.message(record))
        if len(log.waiting) >= MOST_WAITING and place not in self._paused:
            self._paused.add(place)
            self._consumer.pause([TopicPartition(*place)])

    def close(self) -> None:
        """End it."""
        with self._lock, contextlib.suppress(RuntimeError):
            self._consumer.close()


def _is_removed(error: KafkaError | None) -> bool:
    return error is not None and error.code() in {KafkaError._AUTO_OFFSET_RESET, KafkaError.OFFSET_OUT_OF_RANGE}


def header(record: Record, name: str) -> bytes | None:
    """A header of a record."""
    value = dict(record.headers() or ()).get(name)
    return value.encode() if isinstance(value, str) else value


def partitions(topic: str, offsets: list[int]) -> list[TopicPartition]:
    """All partitions of a topic, each from its offset on."""
    return [TopicPartition(topic, lane, offset) for lane, offset in enumerate(offsets)]
