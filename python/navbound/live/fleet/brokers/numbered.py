"""A log of a broker: messages with numbers, each with its position and with the number of the message that it was written behind.

A message counts only where it was written behind the last one that counts: of two writers the second is refused, and a message that was
written while its answer was lost is recognised. The broker may refuse the others itself, or keep them: then every reader passes them over
by the same rule. A message that was written behind the one right before it always counts, since nobody writes behind one that does not.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import deque
from typing import NamedTuple

from navbound import _core
from navbound.errors import FormatError
from navbound.live.fleet.transport import FencedError, UnreachableError

AT = "Navbound-At"
MOST_PAYLOAD = 512 * 1024
"""Bytes of a message where one frame is not longer: brokers take a megabyte unless they are set otherwise. [B]"""
MOST_WAITING = 64
"""Messages of a log that wait in this process."""
MOST_READ = 1 << 20


class Message(NamedTuple):
    """One message: its number, the one that it was written behind, its position and its frames."""

    number: int
    behind: int
    at: int
    data: bytes

    @property
    def end(self) -> int:
        """Position behind it."""
        return self.at + len(self.data)

    @property
    def counts_surely(self) -> bool:
        """Whether it counts whatever stands before it."""
        return self.behind == self.number - 1


class NumberedLog(ABC):
    """A log of a broker: as :class:`navbound.live.fleet.transport.Log` says.

    Parameters
    ----------
    broker : str
        Name of the fleet, for people.
    title : str
        Of the log.
    first : int
        Number of the first message of a new log.
    written : tuple of int, optional
        Number of a message of this process that shut others out, and the position behind it.
    """

    def __init__(self, broker: str, title: str, first: int, written: tuple[int, int] | None = None) -> None:
        self._broker, self._title, self._first = broker, title, first
        self._written = written
        self._next: tuple[int, int, int] | None = None
        self.waiting: deque[Message] = deque()

    @abstractmethod
    def _bounds(self) -> tuple[int, int]:
        """Number of the first message that is there, and the number behind the last."""

    @abstractmethod
    def _message(self, number: int) -> Message:
        """A message, whether it counts or not."""

    @abstractmethod
    def _publish(self, data: bytes, last: int, at: int) -> int | None:
        """Write a message behind the one with a number; None where that is not the last that counts."""

    @abstractmethod
    def _follow(self, number: int) -> None:
        """Let messages from a number on come to a new `waiting`."""

    @abstractmethod
    def _refill(self) -> None:
        """Take what has come, where nobody else does."""

    def end(self) -> int:
        """Position behind the last message that counts."""
        return self._last()[1] if self._written is None else self._written[1]

    def _last(self) -> tuple[int, int]:
        """Number of the last message that counts, and the position behind it."""
        first, behind = self._bounds()
        if behind == self._first:
            return self._first - 1, 0
        if (last := self._sure(first, behind - 1)) is None:
            raise self._removed("what tells where it ends")
        for number in range(last.number + 1, behind):
            message = self._message(number)
            last = message if message.behind == last.number else last
        self._require_place(last, last.at)
        return last.number, last.end

    def _sure(self, low: int, high: int) -> Message | None:
        """The newest message of some that surely counts."""
        for number in range(high, low - 1, -1):
            message = self._message(number)
            if message.counts_surely:
                return message
        return None

    def _after(self, last: int) -> Message:
        """The message that counts behind another."""
        number = last + 1
        while (message := self._message(number)).behind != last:
            number += 1
        return message

    def _require_place(self, message: Message, position: int) -> None:
        """Refuse a message that leaves bytes out, or that no part of a fleet wrote."""
        if not 0 <= message.at <= position:
            stands = f"stands at byte {message.at}, behind byte {position}" if message.at >= 0 else "states no position"
            raise FormatError(
                self._broker, f"{self._title}: message {message.number} {stands}: something else wrote it; begin another fleet"
            )

    def _removed(self, what: str) -> FormatError:
        return FormatError(self._broker, f"{self._title} does not hold {what} any more: the broker kept too little; let it keep more bytes")

    def fence(self) -> tuple[int, int]:
        """Shut every other writer out: the place behind the last message is taken by an empty one. What the next `written` is."""
        while True:
            number, end = self._last()
            if (done := self._publish(b"", number, end)) is not None:
                return done, end

    def append(self, frames: bytes, at: int) -> None:
        """Write frames: as :class:`navbound.live.fleet.transport.Log` says."""
        if self._written is None:
            self._written = self._last()
        if at > self._written[1]:
            raise FencedError(f"{self._title} ends at byte {self._written[1]} and not at {at}: another process writes there")
        for data in _pieces(frames):
            self._append(data, at)
            at += len(data)

    def _append(self, data: bytes, at: int) -> None:
        while data:
            assert self._written is not None
            # The number stays what this writer knows: one that looked for the last anew would pass over what shut it out.
            number, end = self._written
            if at < end:
                message = self._place(at)
            elif (done := self._publish(data, number, end)) is not None:
                self._written = (done, end + len(data))
                return
            else:
                # Either its answer was lost and it stands there, perhaps with less than is to be written now, or another wrote.
                message = self._after(number)
            stands = b"" if message is None else message.data[at - message.at :]
            n = min(len(stands), len(data))
            if message is None or n == 0 or stands[:n] != data[:n]:
                raise FencedError(f"{self._title} holds something else at byte {at}: another process writes there")
            if at == end:
                self._written = (message.number, message.end)
            data, at = data[n:], at + n

    def _place(self, begin: int) -> Message | None:
        """The last message that counts and stands at a position or before it; None in an empty log."""
        first, behind = self._bounds()
        low, high, place = first, behind, None
        while low < high:
            middle = (low + high) // 2
            message = self._sure(low, middle)
            if message is not None and message.at > begin:
                high = message.number
                continue
            place, low = message or place, middle + 1
        if place is None:
            if behind == self._first:
                return None
            raise self._removed(f"what stands at byte {begin}")
        # Those that only the ones before them decide on.
        for number in range(place.number + 1, high):
            message = self._message(number)
            if message.behind == place.number and message.at <= begin:
                place = message
        return place

    def read(self, begin: int) -> bytes:
        """Frames from a position on: as :class:`navbound.live.fleet.transport.Log` says."""
        try:
            if self._next is None or self._next[0] != begin:
                place = self._place(begin)
                self._begin(begin, *((self._first, self._first - 1) if place is None else (place.number, place.behind)))
            self._refill()
            return self._taken()
        except UnreachableError:
            return b""

    def _begin(self, position: int, number: int, last: int) -> None:
        self._next, self.waiting = None, deque()
        self._follow(number)
        self._next = (position, number, last)

    def _taken(self) -> bytes:
        """Frames that wait, in order; what came before or does not count is passed over, and what is missing is fetched again."""
        assert self._next is not None
        (position, number, last), parts, n = self._next, list[bytes](), 0
        while self.waiting and n < MOST_READ:
            message = self.waiting.popleft()
            if message.number < number:
                continue
            if message.number > number:
                self._begin(position, number, last)
                break
            number += 1
            if message.behind != last:
                continue
            last = message.number
            self._require_place(message, position)
            part = message.data[position - message.at :]
            position += len(part)
            n += len(part)
            parts.append(part)
        self._next = (position, number, last)
        return b"".join(parts)


def position(text: str | bytes | None) -> int:
    """A number of a header; -2 where none was written here, which is behind nothing and stands nowhere."""
    digits = text.decode("ascii", "replace") if isinstance(text, bytes) else text or ""
    return int(digits) if digits == "-1" or (digits.isascii() and digits.isdigit()) else -2


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
