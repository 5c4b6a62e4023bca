"""Septentrio: PVTGeodetic or PVTCartesian with PosCovGeodetic or PosCovCartesian and DOP of the same epoch.

Source: Septentrio SBF reference guide, standard. Times are GPS weeks, not rolled over, and milliseconds.
"""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound import _core
from navbound.read.receivers.log import Log, messages, package
from navbound.table.columns import COVARIANCE

if TYPE_CHECKING:
    from navbound.read.source import Source

_WANTED = {"PVTGeodetic": "pvt", "PVTCartesian": "pvt", "PosCovGeodetic": "cov", "PosCovCartesian": "cov", "DOP": "dop"}
_ABSENT = -2e10
"""Value that means "do not use"."""
_DEEPEST_M, _HIGHEST_M = 5e4, 1e9
"""From the Earth's centre: nearer, latitude has no meaning; farther, no receiver is."""
_TOW, _WEEK = 8, 12
"""Offsets of time of week [ms] and week in a block."""
_UNKNOWN_TOW, _UNKNOWN_WEEK = 0xFFFFFFFF, 0xFFFF
_WEEK_NS = 604_800_000_000_000
_WGS84_LIKE = {0, 255}


def read(source: Source) -> Log:
    """Decode a log of SBF blocks; other frames between them are passed over."""
    pysbf2 = package("pysbf2", source.path)
    log = Log(source.path, "PVTGeodetic or PVTCartesian")
    settings = {"protfilter": pysbf2.SBF_PROTOCOL, "quitonerror": pysbf2.ERR_LOG}
    epoch: dict[str, Any] = {}
    for record, (raw, block) in messages(lambda s, handler: pysbf2.SBFReader(s, errorhandler=handler, **settings), source.content, log):
        name = _WANTED.get(getattr(block, "identity", ""))
        if name is None:
            continue
        at = (int.from_bytes(raw[_WEEK : _WEEK + 2], "little"), int.from_bytes(raw[_TOW : _TOW + 4], "little"))
        if epoch and at != epoch["at"]:
            log.attempt(record, partial(_finish, epoch, log))
            epoch = {}
        # Of the two forms of a block in one epoch the geodetic one is kept: it needs no conversion.
        if name not in epoch or "Geodetic" in block.identity:
            epoch |= {"at": at, name: block}
        epoch.setdefault("record", record)
    if epoch:
        log.attempt(epoch["record"], partial(_finish, epoch, log))
    log.n_rows += len(log.rows)
    return log


def _finish(epoch: dict[str, Any], log: Log) -> None:
    """One epoch to one row."""
    pvt = epoch.get("pvt")
    if pvt is None:
        return
    week, tow_ms = epoch["at"]
    place = _place(pvt)
    unknown = week == _UNKNOWN_WEEK or tow_ms == _UNKNOWN_TOW
    reason = "time not known" if unknown else "no position" if pvt.Type not in _core.SBF_MODES or pvt.Error != 0 or place is None else None
    if reason is not None or place is None:
        log.n_rows += 1
        log.leave_out(str(reason), epoch["record"], f"mode {pvt.Type}, error {pvt.Error}")
        return
    if pvt.Datum not in _WGS84_LIKE:
        log.note(f"{log.path.name}: datum {pvt.Datum} of the receiver is not WGS-84; positions are taken as they stand")
    log.columns |= {"est_lat_rad": pvt.identity, "est_lon_rad": pvt.identity, "est_h_m": pvt.identity, "time": "WNc, TOW:gps"}
    row = {"record": epoch["record"], "time_ns": week * _WEEK_NS + tow_ms * 1_000_000, "n_sv": int(pvt.NrSV)}
    row |= dict(zip(("est_lat_rad", "est_lon_rad", "est_h_m"), map(float, place), strict=True))
    if pvt.identity == "PVTGeodetic" and min(pvt.Vn, pvt.Ve, pvt.Vu) > _ABSENT:
        row |= {"ground_speed_mps": math.hypot(pvt.Vn, pvt.Ve), "vertical_rate_mps": float(pvt.Vu)}
    row |= _covariance(epoch.get("cov"), place, log)
    dop = epoch.get("dop")
    if dop is not None:
        row |= {"hdop": dop.HDOP, "vdop": dop.VDOP}
        if min(dop.HPL, dop.VPL) > _ABSENT:
            row |= {"hpl_m": float(dop.HPL), "vpl_m": float(dop.VPL)}
            log.columns |= {"hpl_m": "DOP HPL", "vpl_m": "DOP VPL"}
    log.rows.append(row)


def _place(pvt: Any) -> Any:
    """Latitude, longitude [rad], height [m]; None where the block holds none, or no place."""
    if pvt.identity == "PVTGeodetic":
        found = (pvt.Latitude, pvt.Longitude, pvt.Height)
        return found if abs(found[0]) <= math.pi / 2 and abs(found[1]) <= math.tau and math.isfinite(found[2]) else None
    if min(pvt.X, pvt.Y, pvt.Z) <= _ABSENT or not _DEEPEST_M <= math.hypot(pvt.X, pvt.Y, pvt.Z) < _HIGHEST_M:
        return None
    return _core.geodetic_from_ecef(np.array([[pvt.X, pvt.Y, pvt.Z]]))[0]


def _covariance(cov: Any, place: Any, log: Log) -> dict[str, float]:
    if cov is None or cov.Error != 0:
        return {}
    log.columns["covariance"] = cov.identity
    if cov.identity == "PosCovGeodetic":
        values = [cov.Cov_lonlon, cov.Cov_latlon, cov.Cov_latlat, cov.Cov_lonhgt, cov.Cov_lathgt, cov.Cov_hgthgt]
    else:
        axes = [cov.Cov_xx, cov.Cov_xy, cov.Cov_yy, cov.Cov_xz, cov.Cov_yz, cov.Cov_zz]
        if min(axes) <= _ABSENT:
            return {}
        values = list(_core.enu_covariance(np.array([axes], dtype=np.float64), np.array([place], dtype=np.float64))[0])
    if min(values) <= _ABSENT:
        return {}
    return dict(zip(COVARIANCE, map(float, values), strict=True))
