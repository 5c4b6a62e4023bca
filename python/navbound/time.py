"""GPS time on the screen: as UTC."""

from __future__ import annotations

from datetime import UTC, datetime

import numpy as np

from navbound import _core
from navbound.errors import InputError
from navbound.table.arguments import checked

GPS_EPOCH_UNIX_NS = 315_964_800_000_000_000
"""Unix time of 1980-01-06 00:00:00 UTC."""


@checked
def utc_text(time_ns: int) -> str:
    """Date and time of day in UTC, to the second.

    Parameters
    ----------
    time_ns : int
        GPS time since 1980-01-06 00:00:00. [ns]
    """
    unix_ns = int(_core.unix_from_gps_ns(np.array([time_ns], dtype=np.int64))[0])
    return datetime.fromtimestamp(unix_ns // 1_000_000_000, tz=UTC).strftime("%Y-%m-%d %H:%M:%S")


@checked
def utc_offset_s(time_ns: int) -> int:
    """GPS time minus UTC at an instant of GPS time: the leap seconds so far. [s].

    Parameters
    ----------
    time_ns : int
        GPS time since 1980-01-06 00:00:00. [ns]
    """
    unix_ns = int(_core.unix_from_gps_ns(np.array([time_ns], dtype=np.int64))[0])
    return round((time_ns + GPS_EPOCH_UNIX_NS - unix_ns) * 1e-9)


_FIRST, _LAST = datetime(1680, 1, 1, tzinfo=UTC), datetime(2260, 1, 1, tzinfo=UTC)


@checked
def gps_ns(when: datetime) -> int:
    """GPS time of an instant of UTC, to the microsecond. [ns].

    Parameters
    ----------
    when : datetime
        With a time zone.

    Raises
    ------
    InputError
        An instant that 64 bits of nanoseconds do not hold.
    """
    since = when - datetime(1970, 1, 1, tzinfo=UTC)
    unix_ns = (since.days * 86_400 + since.seconds) * 1_000_000_000 + since.microseconds * 1000
    # Leap seconds are added: half of the range leaves room for them.
    if not _FIRST <= when < _LAST:
        raise InputError("when", when.isoformat(), domain=f"an instant of the years {_FIRST.year} to {_LAST.year - 1}")
    return int(_core.gps_from_unix_ns(np.array([unix_ns], dtype=np.int64))[0])
