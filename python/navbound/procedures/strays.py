"""Flights along a procedure from where they are established to its end, and the positions that stray from it in between."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.procedures.flight import Limits
    from navbound.procedures.legs import Followed, Procedure

    Floats = NDArray[np.float64]
    Flags = NDArray[np.bool_]
    Indices = NDArray[np.intp]

NEXT_FLIGHT_S = 600.0
"""After so long without a position on the path another flight begins, and one that left it is over (ours). [s]"""
SILENCE_S = 30.0
"""After such a gap, and the time that was left to the end of the procedure, an aircraft elsewhere has flown it in silence (ours). [s]"""

FEET = ("leg", "along_m", "along_leg_m", "cross_m", "course_rad", "foot_lat_rad", "foot_lon_rad")
"""Columns of feet."""
JUDGED = ("ok", "strayed")
"""Statuses of positions whose deviation counts."""
ASTRAY = ("off_path", "not_established", "outside")
"""Statuses of positions that are not judged where no flight is along the procedure; within one they stray."""
_DEFINED = ("full", "inferred_start")
_WITHOUT_AN_END = ("holding", "open_end")


@dataclass(frozen=True)
class Stretch:
    """One flight along a procedure, as positions of a track.

    Attributes
    ----------
    first, last : int
        The first established position; the last before the end of the procedure, of the flight or of the track.
    end : {"reached", "ends", "leaves"}
        Whether a position beyond the end of the procedure follows, the track ends before it, or the aircraft has left the path.
    short_m : float
        How far before the end of the procedure the last position near the path is, of a flight that leaves it the last established one;
        infinite or NaN where that is not defined. [m]
    begin_m : float
        How far after the begin of the procedure the first established position is; infinite or NaN where that is not defined. [m]
    due_s : float
        How long after the last position the end of the procedure was due, at the mean speed along it; 0 where it is not. [s]
    """

    first: int
    last: int
    end: Literal["reached", "ends", "leaves"]
    short_m: float
    begin_m: float
    due_s: float


def follow(
    procedure: Procedure, time_s: Floats, place_rad: tuple[Floats, Floats], limits: Limits | None = None
) -> tuple[Followed, list[Stretch]]:
    """Feet and statuses of the positions of one track, and its flights along the procedure.

    A flight begins where it is established. It ends with a position beyond the end of the last leg, with the track, or `NEXT_FLIGHT_S`
    after the last position on the path. All positions in between belong to it: those off the path, or not established again, have their
    distance from the nearest leg as deviation and the status ``strayed``, unless a leg without a defined path may be flown there.
    """
    followed = procedure.followed(time_s, *place_rad, limits)
    flights = _stretches(procedure, followed, time_s)
    for flight in flights:
        followed = _with_strays(procedure, followed, slice(flight.first, flight.last + 1), place_rad)
    return followed, flights


def _stretches(procedure: Procedure, followed: Followed, time_s: Floats) -> list[Stretch]:
    ok = np.flatnonzero(followed.status == "ok")
    if not ok.size:
        return []
    last_leg = max(k for k, leg in enumerate(procedure.legs) if leg.has_path)
    beyond = (followed.leg == last_leg) & (followed.along_leg_m > procedure.legs[last_leg].length_m) & (followed.status != "ok")
    again = (np.diff(np.cumsum(beyond)[ok]) > 0) | (np.diff(time_s[ok]) > NEXT_FLIGHT_S)
    pieces = np.split(ok, np.flatnonzero(again) + 1)
    nexts = [*(int(piece[0]) for piece in pieces[1:]), time_s.size]
    return [_stretch(procedure, followed, time_s, piece, _rows_to(beyond, piece, n)) for piece, n in zip(pieces, nexts, strict=True)]


def _rows_to(beyond: Flags, ok: Indices, following: int) -> tuple[int, bool]:
    """The row before which a flight is over, and whether that lies beyond the end of the procedure."""
    ends = np.flatnonzero(beyond[ok[-1] : following])
    return (int(ok[-1] + ends[0]), True) if ends.size else (following, False)


def _stretch(procedure: Procedure, followed: Followed, time_s: Floats, ok: Indices, until: tuple[int, bool]) -> Stretch:
    last_ok, (stop, reached) = int(ok[-1]), until
    left_m = _left(procedure, followed)
    speed = _speed((left_m[ok[0]], left_m[last_ok]), time_s[last_ok] - time_s[ok[0]])
    tail = np.arange(last_ok + 1, stop)
    tail = tail[time_s[tail] - time_s[last_ok] <= NEXT_FLIGHT_S]
    if not reached and tail.size and time_s[tail[0]] - time_s[last_ok] > left_m[last_ok] / speed + SILENCE_S:
        tail = tail[:0]
    rows = np.append(last_ok, tail)
    near, last = int(rows[followed.leg[rows] >= 0][-1]), int(rows[-1])
    leaves = not reached and near < last and bool((followed.status[rows] == "off_path").any())
    due_s = left_m[near] / speed - (time_s[last] - time_s[near])
    if reached:
        due_s = min(due_s, time_s[stop] - time_s[last])
    known = bool(np.isfinite(due_s)) and due_s > 0.0 and not leaves
    # An open end is nowhere.
    reached = reached or math.isinf(procedure.legs[followed.leg[near]].length_m)
    end: Literal["reached", "ends", "leaves"] = "reached" if reached else "leaves" if leaves else "ends"
    short_m = float(left_m[last_ok if leaves else near])
    begin_m = _before(procedure, followed, int(ok[0]))
    return Stretch(int(ok[0]), last, end, short_m, begin_m, float(due_s) if known else 0.0)


def _left(procedure: Procedure, followed: Followed) -> Floats:
    """Distance of every position to the end of the procedure along its legs; infinite or NaN where one of them has no length [m]."""
    lengths = np.array([0.0 if leg.state == "point" else leg.length_m for leg in procedure.legs])
    after = np.append(np.cumsum(lengths[::-1])[::-1], 0.0)
    left = after[followed.leg] - followed.along_leg_m
    return np.where(followed.leg < 0, np.nan, np.maximum(left, 0.0))


def _before(procedure: Procedure, followed: Followed, row: int) -> float:
    """Distance of a position from the begin of the procedure along its legs; infinite or NaN where one of them has no length [m]."""
    lengths = [0.0 if leg.state == "point" else leg.length_m for leg in procedure.legs[: followed.leg[row]]]
    return max(float(sum(lengths) + followed.along_leg_m[row]), 0.0)


def _speed(left_m: tuple[float, float], time_s: float) -> float:
    """Mean speed along the procedure; NaN where it is not known [m/s]."""
    before, after = left_m
    return float((before - after) / time_s) if math.isfinite(after) and before > after and time_s > 0.0 else math.nan


def _with_strays(procedure: Procedure, followed: Followed, rows: slice, place_rad: tuple[Floats, Floats]) -> Followed:
    """A flight whose positions astray have a deviation where their leg has one."""
    index = np.arange(rows.start, rows.stop)
    astray = index[np.isin(followed.status[rows], ASTRAY)]
    if not astray.size:
        return followed
    own = {name: getattr(followed, name)[astray] for name in FEET}
    feet = procedure.core.nearest(place_rad[0][astray], place_rad[1][astray])
    side, within = _side(procedure, own)
    side_of_nearest, near = _side(procedure, feet)
    # Within the RNP of a leg and not along it is a turn back: it has no leg to deviate from.
    strays = (within | ~near) & ~_between_paths(procedure, followed, index, astray)
    columns = {name: getattr(followed, name).copy() for name in FEET}
    for name in FEET:
        columns[name][astray[strays]] = np.where(within, own[name], feet[name])[strays]
    cross = np.where(within, np.copysign(side, own["cross_m"]), np.copysign(side_of_nearest, feet["cross_m"]))
    columns["cross_m"][astray[strays]] = cross[strays]
    status = followed.status.astype(object)
    status[astray[strays]] = "strayed"
    return replace(followed, status=status.astype(np.str_), **columns)


def _side(procedure: Procedure, feet: dict[str, Floats]) -> tuple[Floats, Flags]:
    """Distance of positions from the extent of their legs, and whether it is within the RNP; False where either is not known [m]."""
    length, rnp = (np.array([getattr(leg, name) for leg in procedure.legs])[feet["leg"]] for name in ("length_m", "rnp_m"))
    beyond = np.fmax(np.fmax(-feet["along_leg_m"], feet["along_leg_m"] - length), 0.0)
    side = np.hypot(feet["cross_m"], beyond)
    return side, (feet["leg"] >= 0) & (side <= rnp)


def _between_paths(procedure: Procedure, followed: Followed, index: Indices, astray: Indices) -> Flags:
    """Whether a leg without a path or without an end lies between the last established position and the next one."""
    states = np.array([leg.state for leg in procedure.legs])
    ok = index[followed.status[index] == "ok"]
    at = np.searchsorted(ok, astray)
    before, returns = followed.leg[ok[at - 1]], at < ok.size
    after = np.where(returns, followed.leg[ok[np.minimum(at, ok.size - 1)]], len(states))
    n_undefined = np.append(0, np.cumsum(~np.isin(states, _DEFINED)))
    low, high = np.minimum(before, after), np.maximum(before, after)
    within: Flags = n_undefined[high] > n_undefined[np.minimum(low + 1, high)]
    to_a_hold = returns & (states[np.minimum(after, len(states) - 1)] == "holding")
    unknown: Flags = within | np.isin(states[before], _WITHOUT_AN_END) | to_a_hold
    return unknown
