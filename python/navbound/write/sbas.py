"""SBAS L1 messages as a service sends them, and logs of them in the EMS format.

Field layout: RTCA DO-229D, appendix A (standard), as `navbound_core::signal::sbas` reads it. The parity is worked out here once more: a
writer that took it from the reader could not show that the reader is right.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING

from navbound.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    Fields = Sequence[tuple[int, int]]
    """Values and their numbers of bits; a negative value is of two's complement."""

PREAMBLES = (0x53, 0x9A, 0xC6)
"""Sent in turn, the first at the begin of every GPS time that is a multiple of three seconds."""
_DATA_BITS, _BLOCK_BITS, _BLOCK_BYTES = 226, 250, 32
_CRC24Q = 0x1864CFB
_GPS_EPOCH = datetime(1980, 1, 6, tzinfo=UTC)


@dataclass(frozen=True)
class Sent:
    """A message and when it was sent.

    Attributes
    ----------
    begin_s : int
        GPS time at which its first bit was sent. [s]
    kind : int
        Type, 0 to 63.
    fields : sequence of (int, int)
        Values and their numbers of bits, from bit 14 on; what is left is zero.
    """

    begin_s: int
    kind: int
    fields: Fields


def block(message: Sent) -> bytes:
    """The 250 bits of a message with its preamble and parity, filled up to 32 bytes.

    Raises
    ------
    InputError
        A value that its bits cannot hold, or more than 212 bits of fields.
    """
    bits = ""
    for value, n in ((PREAMBLES[message.begin_s % 3], 8), (message.kind, 6), *message.fields):
        if not -(1 << (n - 1)) <= value < 1 << n:
            raise InputError("fields", value, domain=f"values of {n} bits")
        bits += format(value % (1 << n), f"0{n}b")
    if len(bits) > _DATA_BITS:
        raise InputError("fields", f"{len(bits) - 14} bits", domain="at most 212 bits")
    data = bits.ljust(_DATA_BITS, "0")
    whole = data + format(_parity(data), "024b")
    return int(whole.ljust(8 * _BLOCK_BYTES, "0"), 2).to_bytes(_BLOCK_BYTES, "big")


def _parity(bits: str) -> int:
    """CRC-24Q: the remainder of the bits, 24 zeros behind them, over the generator."""
    remainder = int(bits, 2) << 24
    for at in range(len(bits) + 23, 23, -1):
        if remainder >> at & 1:
            remainder ^= _CRC24Q << at - 24
    return remainder


def ems(messages: Iterable[Sent], prn: int, path: str | Path) -> Path:
    """Write messages of a satellite as ``PRN YY MM DD hh mm ss type block``, tagged with the end of each message in GPS time.

    Parameters
    ----------
    messages : iterable of Sent
        In the order of time.
    prn : int
        The satellite, 120 to 158.
    path : str or Path
        The log.

    Returns
    -------
    Path
        The log.

    Raises
    ------
    InputError
        A PRN that is none, or as :func:`block`.
    """
    if not 120 <= prn <= 158:
        raise InputError("prn", prn, domain="120 to 158")
    lines = []
    for message in messages:
        end = _GPS_EPOCH + timedelta(seconds=message.begin_s + 1)
        lines.append(f"{prn} {end:%y %m %d %H %M %S} {message.kind} {block(message).hex().upper()}\n")
    place = Path(path)
    place.write_text("".join(lines), encoding="ascii", newline="\n")
    return place
