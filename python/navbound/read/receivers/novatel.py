"""NovAtel OEM4 and later: BESTPOS.

Source: NovAtel OEM commands and logs reference manual, standard. Times are GPS weeks, not rolled over, and milliseconds; heights are above
the geoid with its undulation beside them; the receiver states standard deviations and no correlations.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from navbound.read.receivers.log import Log, diagonal, package

if TYPE_CHECKING:
    from navbound.read.source import Source

_CHUNK = 8192
_WEEK_NS = 604_800_000_000_000
_TIME_UNKNOWN = 20
"""Time status "unknown"."""


def read(source: Source) -> Log:
    """Decode a log of NovAtel messages, binary or ASCII."""
    oem = package("novatel_edie.oem", source.path)
    log = Log(source.path, "BESTPOS")
    parser = oem.Parser()
    at, record = 0, 0
    while at < len(source.content):
        taken = parser.write(source.content[at : at + _CHUNK])
        if taken == 0:
            break
        at += taken
        # The parser ends by itself when it has taken what was written; `messages` would take that for the end of the log.
        while True:
            record += 1
            try:
                message = next(iter(parser))
            except StopIteration:
                break
            except Exception as e:
                # A decoder of others, fed with damaged bytes, may raise anything; what it stumbled over is behind it.
                log.leave_out("damaged message", record, f"{type(e).__name__}: {e}", damaged=True)
                continue
            if getattr(message, "name", "") == "BESTPOS":
                _row(message, record, log)
    if at < len(source.content):
        log.leave_out("frames that the decoder could not take", record, f"{len(source.content) - at} bytes", damaged=True)
    log.n_rows += len(log.rows)
    return log


def _row(message: Any, record: int, log: Log) -> None:
    status, header = message.solution_status, message.header
    unknown = int(header.time_status) <= _TIME_UNKNOWN
    numbers = [float(getattr(message, name)) for name in _NUMBERS]
    if int(status) != 0 or unknown or not all(map(math.isfinite, numbers)):
        log.n_rows += 1
        reason = "time not known" if unknown else "no position"
        log.leave_out(reason, record, f"solution status {getattr(status, 'name', status)}, time status {int(header.time_status)}")
        return
    lat, lon, height, undulation, sigma_n, sigma_e, sigma_u = numbers
    log.columns |= {"est_lat_rad": "BESTPOS", "est_lon_rad": "BESTPOS", "est_h_m": "BESTPOS", "time": "header:gps", "covariance": "BESTPOS"}
    log.note(f"{log.path.name}: BESTPOS states standard deviations; axes taken as uncorrelated, which the file does not say")
    place = {"est_lat_rad": math.radians(lat), "est_lon_rad": math.radians(lon), "est_h_m": height + undulation}
    time_ns = int(header.week) * _WEEK_NS + round(float(header.milliseconds) * 1e6)
    log.rows.append(
        {"record": record, "time_ns": time_ns, "n_sv": int(message.num_soln_svs), **place, **diagonal(sigma_e, sigma_n, sigma_u)}
    )


_NUMBERS = ("latitude", "longitude", "orthometric_height", "undulation", "latitude_std_dev", "longitude_std_dev", "height_std_dev")
