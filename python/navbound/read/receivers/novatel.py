"""NovAtel OEM4 and later: BESTPOS, binary (BESTPOSB) or ASCII (BESTPOSA).

Source: NovAtel OEM commands and logs reference manual, standard. Times are GPS weeks, not rolled over, and milliseconds; heights are above
the geoid with its undulation beside them; the receiver states standard deviations and no correlations. The frames are taken apart here: the
one decoder at hand (novatel-edie 3.0) ends the whole process on some damaged ones.
"""

from __future__ import annotations

import math
import re
import struct
import zlib
from dataclasses import dataclass
from typing import TYPE_CHECKING

from navbound import _core
from navbound.read.receivers.log import Log, diagonal, note_passed_over

if TYPE_CHECKING:
    from collections.abc import Iterator

    from navbound.read.source import Source

_WEEK_NS = 604_800_000_000_000
_BESTPOS = 42
_TIME_UNKNOWN = 20
"""Time status "unknown" of a binary header."""
_BEGIN = re.compile(rb"\xaa\x44\x12|#BESTPOSA,")
_HEADER = struct.Struct("<3sBHBBHHBBHi")
"""Sync, length of the header, message, type, port, length of the body, sequence, idle time, time status, week, milliseconds."""
_BODY = struct.Struct("<II3dfI3f12xBB")
"""Solution status and type, latitude, longitude, height, undulation, datum, three deviations, (station, ages), satellites, those used."""
_ASCII = re.compile(rb"#([^#*\r\n]*)\*([0-9a-fA-F]{8})")
_CRC_BYTES = 4
_TYPES, _WORDS = dict(_core.NOVATEL_TYPES), {word for _, word in _core.NOVATEL_TYPES}
"""Position types that are measured."""


@dataclass(frozen=True)
class _Position:
    computed: bool
    time_known: bool
    week: int
    milliseconds: float
    numbers: tuple[float, ...]
    """Latitude, longitude [deg], height, undulation, standard deviations north, east, up [m]."""
    n_sv: int
    status: str


def read(source: Source) -> Log:
    """Decode a log of NovAtel messages; other frames between them are passed over."""
    log = Log(source.path, "BESTPOS")
    for record, found in _frames(source.content, log):
        _row(found, record, log)
    log.n_rows += len(log.rows)
    return log


def _frames(content: bytes, log: Log) -> Iterator[tuple[int, _Position]]:
    """Positions whose check sum is right, with the number of their frame; frames whose is wrong are counted."""
    at, record, in_frames = 0, 0, 0
    while (begin := _BEGIN.search(content, at)) is not None:
        record += 1
        end, body = _ascii(content, begin.start()) if content[begin.start()] == ord("#") else _binary(content, begin.start())
        at = begin.end() if end is None else end
        in_frames += 0 if end is None else end - begin.start()
        if end is None:
            log.leave_out("damaged message", record, f"frame at byte {begin.start()}: cut short or its check sum wrong", damaged=True)
        elif isinstance(body, _Position):
            yield record, body
        elif body is not None:
            log.leave_out("damaged message", record, f"frame at byte {begin.start()}: {body}", damaged=True)
    note_passed_over(log, len(content) - in_frames, len(content))


def _crc(frame: bytes) -> int:
    """CRC-32 without the inversions of the common one."""
    return zlib.crc32(frame, 0xFFFFFFFF) ^ 0xFFFFFFFF


def _binary(content: bytes, at: int) -> tuple[int | None, _Position | str | None]:
    """End of a frame, or None for a damaged one; and its position, why there is none, or None for another message."""
    if at + _HEADER.size > len(content):
        return None, None
    _, head, message, kind, _, length, _, _, time_status, week, milliseconds = _HEADER.unpack_from(content, at)
    end = at + head + length
    if head < _HEADER.size or end + _CRC_BYTES > len(content):
        return None, None
    if _crc(content[at:end]) != int.from_bytes(content[end : end + _CRC_BYTES], "little"):
        return None, None
    end += _CRC_BYTES
    # Bit 7 of the type marks an answer to a command, bits 5 and 6 another form.
    if message != _BESTPOS or kind & 0xE0:
        return end, None
    if length < _BODY.size:
        return end, f"BESTPOS of {length} bytes"
    status, kind_of_position, lat, lon, height, undulation, _, north, east, up, _, n_sv = _BODY.unpack_from(content, at + head)
    numbers = (lat, lon, height, undulation, north, east, up)
    return end, _Position(
        status == 0 and kind_of_position in _TYPES,
        time_status > _TIME_UNKNOWN,
        week,
        milliseconds,
        numbers,
        n_sv,
        f"{status}, position type {kind_of_position}, time status {time_status}",
    )


def _ascii(content: bytes, at: int) -> tuple[int | None, _Position | str | None]:
    """As `_binary`."""
    frame = _ASCII.match(content, at)
    if frame is None or _crc(frame[1]) != int(frame[2], 16):
        return None, None
    head, _, body = frame[1].decode("ascii", "replace").partition(";")
    names, fields = head.split(","), body.split(",")
    try:
        numbers = tuple(float(fields[k]) for k in (2, 3, 4, 5, 7, 8, 9))
        week, milliseconds, n_sv = int(names[5]), float(names[6]) * 1e3, int(fields[14])
    except (IndexError, ValueError) as e:
        return frame.end(), f"BESTPOSA: {e}"
    known = names[4] != "UNKNOWN"
    return frame.end(), _Position(
        fields[0] == "SOL_COMPUTED" and fields[1] in _WORDS,
        known,
        week,
        milliseconds,
        numbers,
        n_sv,
        f"{fields[0]}, position type {fields[1]}, time status {names[4]}",
    )


def _row(found: _Position, record: int, log: Log) -> None:
    if not (found.computed and found.time_known and all(map(math.isfinite, (*found.numbers, found.milliseconds)))):
        log.n_rows += 1
        reason = "no position" if found.time_known else "time not known"
        log.leave_out(reason, record, f"solution status {found.status}")
        return
    lat, lon, height, undulation, sigma_n, sigma_e, sigma_u = found.numbers
    log.columns |= {"est_lat_rad": "BESTPOS", "est_lon_rad": "BESTPOS", "est_h_m": "BESTPOS", "time": "header:gps", "covariance": "BESTPOS"}
    log.note(f"{log.path.name}: BESTPOS states standard deviations; axes taken as uncorrelated, which the file does not say")
    place = {"est_lat_rad": math.radians(lat), "est_lon_rad": math.radians(lon), "est_h_m": height + undulation}
    time_ns = found.week * _WEEK_NS + round(found.milliseconds * 1e6)
    log.rows.append({"record": record, "time_ns": time_ns, "n_sv": found.n_sv, **place, **diagonal(sigma_e, sigma_n, sigma_u)})
