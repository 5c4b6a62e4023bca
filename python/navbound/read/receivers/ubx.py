"""u-blox: NAV-PVT with NAV-COV and NAV-PL of the same epoch.

Source: u-blox F9 HPG interface description (UBX protocol), standard. Positions are WGS-84, variances north-east-down in m².
"""

from __future__ import annotations

import io
import math
from datetime import UTC, datetime
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound.read.receivers.log import Log, messages, package
from navbound.table.columns import COVARIANCE

if TYPE_CHECKING:
    from navbound.read.source import Source

_WANTED = {b"\x01\x07": "pvt", b"\x01\x20": "gps", b"\x01\x36": "cov", b"\x01\x62": "pl", b"\x01\x04": "dop"}
_WEEK_NS = 604_800_000_000_000
_FIXES = {3, 4}
"""3-D, and 3-D with dead reckoning."""
_FRAME = 6
"""Bytes of a frame before its payload: sync, class and identifier, length."""


def read(source: Source) -> Log:
    """Decode a log of UBX frames; other frames between them are passed over."""
    pyubx2 = package("pyubx2", source.path)
    log = Log(source.path, "NAV-PVT")
    epoch: dict[str, Any] = {}
    for record, (raw, _) in messages(lambda stream, handler: _reader(pyubx2, stream, handler), source.content, log):
        if not _whole(raw):
            log.leave_out("damaged message", record, f"class and identifier {raw[2:4].hex(' ')}: wrong check sum", damaged=True)
            continue
        name = _WANTED.get(raw[2:4])
        if name is None:
            continue
        if name == "gps":
            epoch |= {"gps": raw} if epoch and epoch["itow"] == int.from_bytes(raw[_FRAME : _FRAME + 4], "little") else {}
            continue
        try:
            message = pyubx2.UBXReader.parse(raw)
        except (pyubx2.UBXParseError, pyubx2.UBXMessageError, pyubx2.UBXTypeError, ValueError, IndexError) as e:
            log.leave_out("damaged message", record, str(e), damaged=True)
            continue
        # Version 1 of NAV-PL keeps its time of week behind eight other bytes.
        start = _FRAME + (12 if name == "pl" else 0)
        itow = int.from_bytes(raw[start : start + 4], "little")
        if epoch and itow != epoch["itow"]:
            log.attempt(record, partial(_finish, epoch, log))
            epoch = {}
        epoch |= {"itow": itow, name: message}
        if name == "pvt":
            epoch["record"] = record
    if epoch:
        log.attempt(epoch.get("record", 0), partial(_finish, epoch, log))
    log.n_rows += len(log.rows)
    return log


def _reader(pyubx2: Any, stream: io.BytesIO, handler: Any) -> Any:
    """Frames, not yet taken apart: most are not wanted. Their check sums are not looked at either."""
    settings = {"protfilter": pyubx2.UBX_PROTOCOL, "parsing": pyubx2.PARSE_NONE, "quitonerror": pyubx2.ERR_LOG, "errorhandler": handler}
    return pyubx2.UBXReader(stream, **settings)


def _whole(raw: bytes) -> bool:
    """Whether the two sums at the end of a frame are right: of its bytes, and of the sums up to each."""
    body = np.frombuffer(raw[2:-2], dtype=np.uint8).astype(np.int64)
    return bytes([int(body.sum()) & 0xFF, int((body * np.arange(body.size, 0, -1)).sum()) & 0xFF]) == raw[-2:]


def _finish(epoch: dict[str, Any], log: Log) -> None:
    """One navigation epoch to one row."""
    pvt = epoch.get("pvt")
    if pvt is None:
        return
    record = epoch["record"]
    time = _gps_time(epoch.get("gps")) or _time(pvt)
    reason = (
        "time not valid" if time is None
        else "no 3-D fix" if pvt.fixType not in _FIXES or not pvt.gnssFixOk
        else "position marked invalid" if getattr(pvt, "invalidLlh", 0)
        else None
    )  # fmt: skip
    if reason is not None or time is None:
        log.n_rows += 1
        log.leave_out(str(reason), record, f"fixType {pvt.fixType}, gnssFixOk {pvt.gnssFixOk}, validTime {pvt.validTime}")
        return
    log.columns |= {
        "est_lat_rad": "NAV-PVT lat",
        "est_lon_rad": "NAV-PVT lon",
        "est_h_m": "NAV-PVT height",
        "time": "NAV-TIMEGPS or NAV-PVT",
    }
    row = {
        "record": record,
        **time,
        "est_lat_rad": math.radians(pvt.lat),
        "est_lon_rad": math.radians(pvt.lon),
        "est_h_m": pvt.height * 1e-3,
        "n_sv": int(pvt.numSV),
        "ground_speed_mps": pvt.gSpeed * 1e-3,
        "ground_track_rad": math.radians(pvt.headMot),
        "vertical_rate_mps": -pvt.velD * 1e-3,
    }
    row |= _covariance(epoch.get("cov"), pvt, log)
    if "dop" in epoch:
        row |= {"hdop": epoch["dop"].hDOP, "vdop": epoch["dop"].vDOP}
    if "pl" in epoch:
        row |= _levels(epoch["pl"], log)
    log.rows.append(row)


def _gps_time(raw: bytes | None) -> dict[str, int] | None:
    """GPS time from NAV-TIMEGPS; None where it is absent or week and time of week are not both valid."""
    if raw is None or raw[_FRAME + 11] & 0b11 != 0b11:
        return None
    itow_ms, ftow_ns = (
        int.from_bytes(raw[_FRAME : _FRAME + 4], "little"),
        int.from_bytes(raw[_FRAME + 4 : _FRAME + 8], "little", signed=True),
    )
    week = int.from_bytes(raw[_FRAME + 8 : _FRAME + 10], "little", signed=True)
    return {"time_ns": week * _WEEK_NS + itow_ms * 1_000_000 + ftow_ns}


def _time(pvt: Any) -> dict[str, int] | None:
    """UTC from NAV-PVT as Unix time; None until date, time and leap seconds are known."""
    if not (pvt.validDate and pvt.validTime and pvt.fullyResolved):
        return None
    try:
        # Second 60 is a leap second: it has no Unix time of its own.
        whole = datetime(pvt.year, pvt.month, pvt.day, pvt.hour, pvt.min, pvt.second, tzinfo=UTC)
    except ValueError:
        return None
    return {"unix_ns": int(whole.timestamp()) * 1_000_000_000 + int(pvt.nano)}


def _covariance(cov: Any, pvt: Any, log: Log) -> dict[str, float]:
    if cov is not None and cov.posCovValid:
        log.columns["covariance"] = "NAV-COV"
        values = (cov.posCovEE, cov.posCovNE, cov.posCovNN, -cov.posCovED, -cov.posCovND, cov.posCovDD)
        return dict(zip(COVARIANCE, map(float, values), strict=True))
    log.columns.setdefault("covariance", "NAV-PVT hAcc, vAcc")
    log.note(f"{log.path.name}: without NAV-COV the covariance is circular, of hAcc (root of both horizontal variances) and vAcc")
    h, v = (pvt.hAcc * 1e-3) ** 2 / 2, (pvt.vAcc * 1e-3) ** 2
    return dict(zip(COVARIANCE, (h, 0.0, h, 0.0, 0.0, v), strict=True))


def _levels(pl: Any, log: Log) -> dict[str, float]:
    """Protection levels, where they are valid; along the axes of an ellipse the larger is horizontal, along others their root sum."""
    if not pl.plPosValid:
        return {}
    one, two, three = (p * 1e-3 for p in (pl.plPos1, pl.plPos2, pl.plPos3))
    horizontal = max(one, two) if pl.plPosFrame == _ELLIPSE else math.hypot(one, two)
    log.columns |= {"hpl_m": "NAV-PL", "vpl_m": "NAV-PL"}
    log.note(f"{log.path.name}: protection levels of NAV-PL, for a misleading-information risk of {pl.tmirCoeff}e{pl.tmirExp} an hour")
    return {"hpl_m": horizontal, "vpl_m": three}


_ELLIPSE = 3
"""Frame of NAV-PL: semi-major and semi-minor axis of the horizontal ellipse, and vertical."""
