"""A broker that refuses nothing: of what several writers leave in a partition every reader takes the same, each byte once."""

from __future__ import annotations

import random

import pytest

from navbound import _core
from navbound.errors import FormatError
from navbound.live.fleet.brokers.numbered import Message, NumberedLog, position
from navbound.live.fleet.transport import FencedError, UnreachableError


class Partition:
    """What a partition holds, and how often an answer about it is lost."""

    def __init__(self, seed: int = 0, lost: float = 0.0) -> None:
        self.messages: list[Message] = []
        self.first = 0
        self._random, self._lost = random.Random(seed), lost

    def write(self, data: bytes, last: int, at: int) -> int:
        """As Kafka does: whatever comes is written."""
        before = self._random.random() < self._lost
        if before and self._random.random() < 0.5:
            raise UnreachableError("it was not written")
        self.messages.append(Message(len(self.messages), last, at, data))
        if before:
            raise UnreachableError("it was written, and nobody heard it")
        return len(self.messages) - 1


class Log(NumberedLog):
    """A log in a partition of this process."""

    def __init__(self, partition: Partition, written: tuple[int, int] | None = None) -> None:
        super().__init__("a test", "log", 0, written)
        self._partition = partition

    def _bounds(self) -> tuple[int, int]:
        return self._partition.first, len(self._partition.messages)

    def _message(self, number: int) -> Message:
        if number < self._partition.first:
            raise self._removed(f"record {number}")
        return self._partition.messages[number]

    def _publish(self, data: bytes, last: int, at: int) -> int | None:
        number = self._partition.write(data, last, at)
        return number if number == last + 1 or self._after(last).number == number else None

    def _refill(self) -> None:
        """All is there at once."""

    def _follow(self, number: int) -> None:
        self.waiting.extend(self._partition.messages[number:])


def frame(k: int) -> bytes:
    return _core.live_input("chunk", k, b"%d" % k)


def counted(partition: Partition) -> tuple[bytes, int]:
    """By the rule itself, from the first record on: what the log holds, and how many records do not count."""
    content, last, void = b"", -1, 0
    for message in partition.messages:
        if message.behind == last:
            assert message.at == len(content)
            content, last = content + message.data, message.number
        else:
            void += 1
    return content, void


def everything(log: Log, begin: int) -> bytes:
    content = b""
    while part := log.read(begin + len(content)):
        content += part
    return content


def fenced(partition: Partition) -> tuple[int, int]:
    """Shut others out, however often nobody answers."""
    while True:
        try:
            return Log(partition).fence()
        except UnreachableError:
            continue


def left_by_writers(seed: int) -> tuple[Partition, list[bytes]]:
    """A partition on which one takes the place of the other, and those who lost it go on for a while; the frames that were taken."""
    draw, partition, taken = random.Random(seed), Partition(seed, lost=0.2), list[bytes]()
    writers = list[Log]()
    for k in range(60):
        if k == 0 or draw.random() < 0.15:
            writers.append(Log(partition, fenced(partition)))
        # Mostly the newest writes; sometimes one that does not know yet that it is not.
        writer = writers[-1] if draw.random() < 0.8 else draw.choice(writers)
        data, at = frame(k), writer.end()
        for _ in range(20):
            try:
                writer.append(data, at)
                assert writer is writers[-1]
                taken.append(data)
                break
            except UnreachableError:
                continue
            except FencedError:
                assert writer is not writers[-1]
                break
    return partition, taken


def test_every_reader_takes_the_same_and_nothing_is_lost_or_doubled() -> None:
    n_void = 0
    for seed in range(40):
        partition, taken = left_by_writers(seed)
        content, void = counted(partition)
        n_void += void
        assert content == b"".join(taken)
        assert Log(partition).end() == len(content)
        for begin in [0, *(sum(map(len, taken[:k])) for k in range(1, len(taken) + 1))]:
            assert everything(Log(partition), begin) == content[begin:]
    assert n_void > 200


def test_a_reader_goes_on_where_the_oldest_were_removed_or_says_so() -> None:
    partition, taken = left_by_writers(3)
    content, _ = counted(partition)
    for first in range(len(partition.messages) - 5):
        partition.first = first
        # What stands before the first of which it is sure is gone for a reader.
        sure = next(m for m in partition.messages[first:] if m.counts_surely)
        assert everything(Log(partition), sure.at) == content[sure.at :]
        assert Log(partition).end() == len(content)
        if sure.at > 0:
            with pytest.raises(FormatError, match="let it keep more bytes"):
                Log(partition).read(sure.at - 1)
    assert len(taken) > 20


def test_a_log_of_which_nothing_tells_its_end_is_refused() -> None:
    partition = Partition()
    Log(partition).append(frame(1), 0)
    partition.first = 1
    with pytest.raises(FormatError, match="what tells where it ends"):
        Log(partition).end()


def test_what_is_missing_or_was_not_written_by_a_fleet_is_refused_aloud() -> None:
    partition = Partition()
    Log(partition).append(frame(1), 0)
    partition.messages.append(Message(1, 0, 1000, frame(2)))
    with pytest.raises(FormatError, match="stands at byte 1000, behind byte"):
        everything(Log(partition), 0)
    partition.messages[1] = Message(1, 0, position("x"), frame(2))
    for refused in (lambda: everything(Log(partition), 0), Log(partition).end):
        with pytest.raises(FormatError, match="states no position"):
            refused()


WRONG = (None, "", "-2", b"\xff", "1.0", "\u00b2")


@pytest.mark.parametrize(("text", "number"), [("0", 0), (b"17", 17), ("-1", -1), *((text, -2) for text in WRONG)])
def test_a_number_of_a_header_is_one_or_none(text: str | bytes | None, number: int) -> None:
    assert position(text) == number
