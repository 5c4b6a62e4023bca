"""Kinds of files that navbound knows and does not read: named, so that nobody looks for a table in them.

Frames as their interface documents and public decoders describe them (provenance: standard, from knowledge of the formats).
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from navbound.read import receivers

if TYPE_CHECKING:
    from collections.abc import Callable

_LOOK_AT = 1 << 16
_MOST_TRIES = 64
_FRAMES = 3
"""Frames one behind the other that make a stream of a kind: a single one may stand in other data by chance."""

_ULOG = b"ULog\x01\x12\x35"
_TSIP = re.compile(rb"(?:\x10[^\x03\x10](?:[^\x10]|\x10\x10){1,300}?\x10\x03){3}", re.DOTALL)

RTCM3 = "a stream of RTCM 3 messages, which is not read: convert it to RINEX observations and navigation data"
SIRF = "a log of a SiRF receiver, which is not read: convert it to NMEA or RINEX"
TSIP = "a log in Trimble's TSIP, which is not read: convert it to NMEA or RINEX"
ULOG = "a ULog of an autopilot, which is not read: export the positions with their UTC time as a table"


def kind(content: bytes) -> str | None:
    """What the content is, as the words of a refusal; None where it may be something that is read."""
    if content.startswith(_ULOG):
        return ULOG
    # The logs that are read may carry corrections in such frames between their own.
    if content.startswith(b"PAR1") or receivers.kind(content) is not None:
        return None
    start = content[:_LOOK_AT]
    if _stream(start, b"\xd3", _rtcm3):
        return RTCM3
    if _stream(start, b"\xa0\xa2", _sirf):
        return SIRF
    return TSIP if _TSIP.search(start[: _LONGEST * _FRAMES]) else None


def _stream(start: bytes, sync: bytes, frame_end: Callable[[bytes, int], int]) -> bool:
    """Whether whole frames stand one behind the other from the first on; a stream may begin in the middle of one."""
    at = start.find(sync)
    for _ in range(_MOST_TRIES):
        if not 0 <= at <= _LONGEST:
            return False
        n, end = 0, at
        while n < _FRAMES and (found := frame_end(start, end)) > 0:
            n, end = n + 1, found
        # A short file may hold fewer, and nothing else.
        if n == _FRAMES or (n > 0 and end == len(start)):
            return True
        at = start.find(sync, at + 1)
    return False


_LONGEST = 1100
"""More than the longest frame."""


def _rtcm3(content: bytes, at: int) -> int:
    """End of the frame at a place, 0 where there is none: D3, six zero bits, ten of length, the message, CRC-24Q."""
    if len(content) < at + 6 or content[at] != 0xD3 or content[at + 1] & 0xFC:
        return 0
    end = at + 3 + ((content[at + 1] & 3) << 8 | content[at + 2]) + 3
    return end if end <= len(content) and _crc24q(content[at:end]) == 0 else 0


def _crc24q(frame: bytes) -> int:
    crc = 0
    for byte in frame:
        crc ^= byte << 16
        for _ in range(8):
            crc <<= 1
            if crc & 0x1000000:
                crc ^= 0x1864CFB
    return crc


def _sirf(content: bytes, at: int) -> int:
    """End of the frame at a place, 0 where there is none: A0 A2, length, the message, its sum of fifteen bits, B0 B3."""
    if content[at : at + 2] != b"\xa0\xa2" or len(content) < at + 8:
        return 0
    length = int.from_bytes(content[at + 2 : at + 4]) & 0x7FFF
    end = at + 4 + length + 4
    sum_ = sum(content[at + 4 : at + 4 + length]) & 0x7FFF
    right = content[end - 2 : end] == b"\xb0\xb3" and int.from_bytes(content[end - 4 : end - 2]) == sum_
    return end if right and end <= len(content) else 0
