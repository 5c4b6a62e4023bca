"""NMEA 0183: GGA with GST (or GBS) of the same time of day, dated by RMC or ZDA.

Source: NMEA 0183 version 4 as receivers' manuals give it, standard. GGA has no date and its height stands above the geoid.
"""

from __future__ import annotations

import functools
import math
import operator
import re
from dataclasses import dataclass
from datetime import UTC, date, datetime, time, timedelta
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound import _core
from navbound.errors import FormatError
from navbound.read.receivers.log import Log, diagonal, messages, package

if TYPE_CHECKING:
    from navbound.read.source import Source

_HALF_DAY_S = 43_200

_WITH_ARRIVAL = re.compile(rb"^(?:NMEA,)?(\$[^\r\n*]*\*[0-9A-Fa-f]{2}),\d+(?=\r?$)", re.MULTILINE)
"""A sentence as the loggers of telephones write it: a word before it, the time of arrival behind its checksum."""


@dataclass
class _Fix:
    """A GGA sentence and what belongs to it."""

    record: int
    gga: Any
    gst: Any = None
    gbs: Any = None


def read(source: Source) -> Log:
    """Decode a log of NMEA sentences; other frames between them are passed over."""
    pynmeagps = package("pynmeagps", source.path)
    log = Log(source.path, "GGA")
    settings = {"quitonerror": pynmeagps.ERR_LOG}
    fixes, dates, last = list[_Fix](), list[tuple[int, date, time]](), None
    content = _WITH_ARRIVAL.sub(rb"\1", source.content)
    for record, (raw, sentence) in messages(lambda s, handler: pynmeagps.NMEAReader(s, errorhandler=handler, **settings), content, log):
        # The decoder passes over what it has no name for, and over a sentence with a byte that is no letter: only the first is whole.
        if sentence is None and not _whole(raw):
            log.leave_out("damaged message", record, repr(raw[:60]), damaged=True)
        name = getattr(sentence, "msgID", "")
        if name == "GGA":
            last = _Fix(record, sentence)
            fixes.append(last)
        elif name in {"GST", "GBS"} and last is not None and _field(sentence, "time") == _field(last.gga, "time"):
            setattr(last, name.lower(), sentence)
        elif name in {"RMC", "ZDA"}:
            day = _day(sentence)
            of_day = _field(sentence, "time")
            if day is not None and isinstance(of_day, time):
                dates.append((record, day, of_day))
    if fixes and not dates:
        log.n_rows = len(fixes)
        raise FormatError(source.path, _undated(len(fixes), log), fixes[0].record, "date")
    place = 0
    for fix in fixes:
        # The nearest dated sentence before or after, by its number in the log.
        while place + 1 < len(dates) and abs(dates[place + 1][0] - fix.record) <= abs(dates[place][0] - fix.record):
            place += 1
        _row(fix, dates[place], log)
    log.n_rows += len(log.rows)
    return log


def _whole(raw: bytes) -> bool:
    """Whether the check sum of a sentence is right."""
    body, star, stated = raw.strip().removeprefix(b"$").partition(b"*")
    return bool(star) and stated.upper() == b"%02X" % functools.reduce(operator.xor, body, 0)


def _undated(n_fixes: int, log: Log) -> str:
    """GGA holds a time of day only: what is lacking, and what to do."""
    bad = sum(count for count, _, _, damaged in log.left_out.values() if damaged)
    damaged = f" ({bad} sentences are damaged, perhaps those with the date: a wrong checksum refuses one)" if bad else ""
    return (
        f"{n_fixes} GGA sentences hold a time of day and no date, and no sound RMC or ZDA sentence gives one{damaged}; log RMC or ZDA "
        "beside GGA, take out or mend damaged sentences and add one ZDA sentence of the day at the beginning "
        "($GPZDA,hhmmss,dd,mm,yyyy,00,00*checksum), or convert the log to a table with a time"
    )


def _day(sentence: Any) -> date | None:
    if sentence.msgID == "RMC":
        day = _field(sentence, "date")
        return day if isinstance(day, date) and _field(sentence, "status") == "A" else None
    try:
        return date(*(int(_field(sentence, name)) for name in ("year", "month", "day")))
    except (TypeError, ValueError):
        return None


def _row(fix: _Fix, dated: tuple[int, date, time], log: Log) -> None:
    gga = fix.gga
    of_day, quality = _field(gga, "time"), _field(gga, "quality")
    leap = _leap_second(gga)
    of_day = leap or of_day
    numbers = [_number(gga, name) for name in ("lat", "lon", "alt")]
    if quality not in _core.GGA_QUALITIES or not isinstance(of_day, time) or numbers[0] is None or numbers[1] is None:
        log.n_rows += 1
        log.leave_out("no fix", fix.record, f"quality {quality}, latitude {_field(gga, 'lat')!r}")
        return
    undulation, n_sv = _number(gga, "sep"), _number(gga, "numSV")
    if numbers[2] is not None and undulation is None:
        log.note(f"{log.path.name}: GGA without the separation of the geoid: heights are left out")
    height = None if numbers[2] is None or undulation is None else numbers[2] + undulation
    log.columns |= {
        "est_lat_rad": "GGA",
        "est_lon_rad": "GGA",
        "est_h_m": "GGA altitude + separation",
        "time": "GGA, dated by RMC or ZDA:utc",
    }
    row = {
        "record": fix.record,
        "est_lat_rad": math.radians(numbers[0]),
        "est_lon_rad": math.radians(numbers[1]),
        "est_h_m": height,
        "n_sv": None if n_sv is None else int(n_sv),
        "hdop": _number(gga, "HDOP"),
    }
    unix_ns = _unix_ns(of_day, dated[1], dated[2])
    when = {"unix_ns": unix_ns}
    if leap is not None:
        time_ns, exists = _core.gps_of_leap_second_ns(np.array([unix_ns], dtype=np.int64))
        if not exists[0]:
            log.n_rows += 1
            log.leave_out("second 60 on a day that had none", fix.record, str(gga.payload[0]), damaged=True)
            return
        when = {"time_ns": int(time_ns[0])}
    log.rows.append(row | when | _covariance(fix, log))


def _field(sentence: Any, name: str) -> Any:
    """Field of a sentence; None where the sentence ends before it."""
    return getattr(sentence, name, None)


_SECOND_60 = re.compile(r"(\d\d)(\d\d)60(?:\.(\d{1,6})\d*)?")


def _leap_second(sentence: Any) -> time | None:
    """The time of day one second before a written second 60, which no time of day holds; None for every other."""
    written = _SECOND_60.fullmatch(str(sentence.payload[0])) if getattr(sentence, "payload", None) else None
    if written is None or int(written[1]) > 23 or int(written[2]) > 59:
        return None
    return time(int(written[1]), int(written[2]), 59, int((written[3] or "0").ljust(6, "0")))


def _number(sentence: Any, name: str) -> float | None:
    """Number in a field; None where it is empty, absent or something else."""
    value = _field(sentence, name)
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value) else None


def _unix_ns(of_day: time, day: date, dated_at: time) -> int:
    """Unix time [ns] of a time of day near a dated one; midnight may lie between them."""
    apart = _seconds(of_day) - _seconds(dated_at)
    day += timedelta(days=int(apart < -_HALF_DAY_S) - int(apart > _HALF_DAY_S))
    midnight = int(datetime(day.year, day.month, day.day, tzinfo=UTC).timestamp())
    whole = (of_day.hour * 60 + of_day.minute) * 60 + of_day.second
    return (midnight + whole) * 1_000_000_000 + of_day.microsecond * 1000


def _seconds(t: time) -> float:
    return (t.hour * 60 + t.minute) * 60 + t.second + t.microsecond * 1e-6


def _covariance(fix: _Fix, log: Log) -> dict[str, float]:
    """From GST; else from the expected errors of GBS; else nothing."""
    for sentence, names in ((fix.gst, ("stdLong", "stdLat", "stdAlt")), (fix.gbs, ("errLon", "errLat", "errAlt"))):
        if sentence is None:
            continue
        sigma = [_number(sentence, name) for name in names]
        if sigma[0] is None or sigma[1] is None or sigma[2] is None:
            continue
        log.columns["covariance"] = sentence.msgID
        found = diagonal(sigma[0], sigma[1], sigma[2])
        if sentence is fix.gst:
            found["cov_en_m2"] = _correlated(sentence, found["cov_ee_m2"] + found["cov_nn_m2"])
        else:
            log.note(f"{log.path.name}: without GST the expected errors of GBS stand for standard deviations")
        return found
    return {}


def _correlated(gst: Any, trace_m2: float) -> float:
    """East-north covariance from the ellipse of GST.

    Its axes are scaled to the standard deviations beside them: the standard calls them standard deviations, some makers write 95 % axes.
    """
    major, minor, orient = (_number(gst, name) for name in ("stdMajor", "stdMinor", "orient"))
    if major is None or minor is None or orient is None or major**2 + minor**2 == 0:
        return 0.0
    turn = math.radians(orient)
    share = (major**2 - minor**2) / (major**2 + minor**2)
    return trace_m2 * share * math.sin(turn) * math.cos(turn)
