"""SBAS L1 messages as a service sends them, and logs of them in the EMS format.

Field layout: RTCA DO-229D, appendix A (standard), as `navbound_core::signal::sbas` reads it. The parity is worked out here once more: a
writer that took it from the reader could not show that the reader is right.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path

from navbound.errors import InputError
from navbound.table.arguments import checked, whole
from navbound.table.arrays import shown

Fields = Sequence[tuple[int, int]]
"""Values and their numbers of bits; a negative value is of two's complement."""

PREAMBLES = (0x53, 0x9A, 0xC6)
"""Sent in turn, the first at the begin of every GPS time that is a multiple of three seconds."""
_DATA_BITS, _BLOCK_BITS, _BLOCK_BYTES = 226, 250, 32
_FIELDS_BITS = _DATA_BITS - 14
_CRC24Q = 0x1864CFB
_PRNS = (120, 158)
_GPS_EPOCH = datetime(1980, 1, 6, tzinfo=UTC)
_LAST_S = int((datetime(2080, 1, 1, tzinfo=UTC) - _GPS_EPOCH).total_seconds()) - 2
"""The last begin whose end has a year that two digits name: 1980 to 2079. [s]"""


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


@checked
def block(message: Sent) -> bytes:
    """The 250 bits of a message with its preamble and parity, filled up to 32 bytes.

    Raises
    ------
    InputError
        A time before 1980-01-06 or after 2079, a type or a field that is no whole number, a value that its bits cannot hold, or more than
        212 bits of fields.
    """
    begin_s, kind = whole("begin_s", message.begin_s, 0, _LAST_S, "s"), whole("kind", message.kind, 0, 63)
    bits = ""
    for value, n in ((PREAMBLES[begin_s % 3], 8), (kind, 6), *_values(message.fields)):
        bits += format(value % (1 << n), f"0{n}b")
    if len(bits) > _DATA_BITS:
        raise InputError("fields", f"{len(bits) - 14} bits", domain=f"at most {_FIELDS_BITS} bits")
    data = bits.ljust(_DATA_BITS, "0")
    whole_block = data + format(_parity(data), "024b")
    return int(whole_block.ljust(8 * _BLOCK_BYTES, "0"), 2).to_bytes(_BLOCK_BYTES, "big")


def _values(fields: Fields) -> Iterator[tuple[int, int]]:
    """Each value and its number of bits, as whole numbers."""
    if not isinstance(fields, Sequence) or isinstance(fields, str | bytes):
        raise InputError("fields", shown(fields), domain="a sequence of pairs: a value and its number of bits")
    for at, pair in enumerate(fields):
        if not isinstance(pair, tuple | list) or len(pair) != 2:
            raise InputError("fields", shown(pair), domain="a pair: a value and its number of bits", index=at)
        n = whole(f"bits of fields[{at}]", pair[1], 1, _FIELDS_BITS)
        yield whole(f"fields[{at}]", pair[0], -(1 << (n - 1)), (1 << n) - 1), n


def _parity(bits: str) -> int:
    """CRC-24Q: the remainder of the bits, 24 zeros behind them, over the generator."""
    remainder = int(bits, 2) << 24
    for at in range(len(bits) + 23, 23, -1):
        if remainder >> at & 1:
            remainder ^= _CRC24Q << at - 24
    return remainder


@checked
def ems(messages: Iterable[Sent], prn: int, path: str | Path) -> Path:
    """Write messages of a satellite as ``PRN YY MM DD hh mm ss type block``, tagged with the end of each message in GPS time.

    Parameters
    ----------
    messages : iterable of Sent
        In the order of time, at most one a second.
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
        A PRN that is none, no message, one that does not begin after the one before, or as :func:`block`.
    """
    prn = whole("prn", prn, *_PRNS)
    lines, before_s = list[str](), -1
    for at, message in enumerate(messages):
        if not isinstance(message, Sent):
            raise InputError("messages", shown(message), domain="an object of class Sent", index=at)
        digits = block(message).hex().upper()
        if message.begin_s <= before_s:
            raise InputError("messages", f"a begin at {message.begin_s} s", domain=f"one after {before_s} s", index=at)
        before_s = int(message.begin_s)
        end = _GPS_EPOCH + timedelta(seconds=before_s + 1)
        lines.append(f"{prn} {end:%y %m %d %H %M %S} {int(message.kind)} {digits}\n")
    if not lines:
        raise InputError("messages", "none", domain="one message at least")
    place = Path(path)
    place.write_text("".join(lines), encoding="ascii", newline="\n")
    return place
