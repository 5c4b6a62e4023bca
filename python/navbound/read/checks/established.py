"""Which part of a truth can be one: a truth that contradicts its own motion, or stands while the positions travel, is no reference."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound.read.checks.limits import Limits
from navbound.read.checks.places import east_north_m
from navbound.read.checks.plausible import unreachable
from navbound.records.truth import TruthDoubts

if TYPE_CHECKING:
    from numpy.typing import NDArray

TRUTH = Limits(moving_mps=math.inf, noise_m=20.0)
"""A true position may stand still, and is more precise than those that it judges. Provenance: ours."""

ESTABLISHED = 0.75
"""Least share of a track's truth that the largest consistent part must have: three times all others together. Provenance: ours. [1]"""

_STANDS_M = 1.0
"""A truth that stays within this does not move. Provenance: ours. [m]"""
_LEGS_S = (5.0, 20.0, 60.0)
"""Spans over which positions are seen to travel. Provenance: ours. [s]"""
_LEAST_LEGS = 4
"""Fewer say nothing of a course. [1]"""
_RADII = math.sqrt(-2.0 * math.log(1e-5))
"""Radius of a circular covariance that the error exceeds with a risk of 1e-5, in standard deviations. [1]"""
_LEAST_COSINE = 0.5
"""Median cosine between successive legs from which they make a course: independent errors have -0.5 in mean, a random walk 0. Derived."""


_TRUE_PLACE = ("truth_lat_rad", "truth_lon_rad")


def established(epochs: pl.DataFrame) -> tuple[pl.DataFrame, TruthDoubts]:
    """Take the truth from epochs at which it cannot be one.

    A track's truth is split where it jumps, by the rule of recorded positions. Parts that follow each other within the settling time
    and can be reached from each other are one. The largest is the reference where it has at least `ESTABLISHED` of the track's truth;
    otherwise nobody knows which part is true, and none is. Epochs that have not settled after a jump have none either.

    Parameters
    ----------
    epochs : DataFrame
        Epoch table with ``truth_lat_rad``, ``truth_lon_rad``, sorted by track and time.

    Returns
    -------
    epochs : DataFrame
        Without the truth that is not believed.
    doubts : TruthDoubts
        How many epochs lost it, and why.
    """
    known = pl.all_horizontal(pl.col(name).is_finite() for name in _TRUE_PLACE).fill_null(value=False)
    rows = epochs.with_row_index("__row").filter(known)
    jumping, standing = list[pl.Series](), list[pl.Series]()
    jumps, longest_m = list[int](), 0.0
    for group in rows.partition_by("track", maintain_order=True):
        lost, at = _contradicting(group)
        stands = pl.Series(np.zeros(group.height, dtype=np.bool_))
        for part in _standing_parts(group):
            travelled_m = _travelled_m(group[part])
            if travelled_m is not None:
                stands |= pl.int_range(group.height, eager=True).is_between(part.start, part.stop - 1)
                longest_m = max(longest_m, travelled_m)
        standing.append(group["__row"].filter(stands))
        if (lost & ~stands).any():
            jumping.append(group["__row"].filter(lost & ~stands))
            jumps += at
    doubts = TruthDoubts(sum(map(len, jumping)), tuple(sorted(set(jumps))), sum(map(len, standing)), longest_m)
    if not doubts.n:
        return epochs, doubts
    without = pl.int_range(pl.len()).is_in(pl.concat([*jumping, *standing]).implode())
    names = [name for name in (*_TRUE_PLACE, "truth_h_m") if name in epochs.columns]
    return epochs.with_columns(pl.when(~without).then(pl.col(name)).alias(name) for name in names), doubts


def contradicting(truth: pl.DataFrame) -> tuple[pl.DataFrame, list[int]]:
    """Rows of a recorded truth that are no reference, by the motion of all its rows: also of those that no estimate is joined to.

    Parameters
    ----------
    truth : DataFrame
        ``track``, ``time_ns``, ``truth_lat_rad``, ``truth_lon_rad``, in the order of track and time.

    Returns
    -------
    truth : DataFrame
        With ``contradicted``.
    jumps_ns : list of int
        GPS times of its jumps. [ns]
    """
    parts, jumps = list[pl.DataFrame](), list[int]()
    for group in truth.partition_by("track", maintain_order=True):
        lost, at = _contradicting(group)
        parts.append(group.with_columns(contradicted=lost))
        jumps += at
    return pl.concat(parts), sorted(jumps)


def _contradicting(group: pl.DataFrame) -> tuple[pl.Series, list[int]]:
    """Which true positions of a track are no reference, and the times of its jumps."""
    jump, unsettled = unreachable(group, *_TRUE_PLACE, TRUTH)
    if not jump.any():
        return pl.Series(unsettled), []
    time_s = group["time_ns"].to_numpy() * 1e-9
    place = group.select(_TRUE_PLACE).to_numpy()
    starts = np.concatenate([[0], np.flatnonzero(jump)])
    ends = np.concatenate([starts[1:], [group.height]])
    speed_mps = _own_speed(time_s, place)
    parts = [slice(start, end) for start, end in zip(starts.tolist(), ends.tolist(), strict=True) if end > start]
    joined = list[list[slice]]()
    for part in parts:
        before = [each for each in joined if _follows(time_s, place, each[-1].stop - 1, part.start, speed_mps)]
        if before:
            max(before, key=_size).append(part)
        else:
            joined.append([part])
    largest = max(joined, key=_size)
    lost = np.ones(group.height, dtype=np.bool_)
    if _size(largest) >= ESTABLISHED * group.height:
        for part in largest:
            lost[part] = unsettled[part]
    return pl.Series(lost), group["time_ns"].filter(pl.Series(jump)).to_list()


def _size(parts: list[slice]) -> int:
    return sum(part.stop - part.start for part in parts)


def _follows(time_s: NDArray[np.float64], place: NDArray[np.float64], end: int, start: int, speed_mps: float) -> bool:
    """Whether a part goes on where another ended; after the settling time too much could be reached to tell."""
    passed_s = float(time_s[start] - time_s[end])
    way_m = float(np.hypot(*east_north_m(place[[end]], place[[start]])[0]))
    return passed_s <= TRUTH.settle_s and way_m <= speed_mps * passed_s + TRUTH.noise_m


def _own_speed(time_s: NDArray[np.float64], place: NDArray[np.float64]) -> float:
    """The fastest speed of a track, of 95 % of its own steps with factor and margin, as the rule of recorded positions has it. [m/s]."""
    passed_s = np.diff(time_s)
    way_m = np.hypot(*east_north_m(place[:-1], place[1:]).T)
    own_mps = float(np.quantile(way_m[passed_s > 0] / passed_s[passed_s > 0], 0.95)) if (passed_s > 0).any() else math.inf
    return min(TRUTH.speed_factor * own_mps + TRUTH.speed_margin_mps, TRUTH.max_speed_mps)


def _standing_parts(group: pl.DataFrame) -> list[slice]:
    """Rows over which the truth does not move from one to the next."""
    true = group.select(_TRUE_PLACE).to_numpy()
    moves = np.flatnonzero(np.hypot(*east_north_m(true[:-1], true[1:]).T) > _STANDS_M) + 1
    edges = [0, *moves.tolist(), group.height]
    return [slice(start, end) for start, end in pairwise(edges) if end - start > _LEAST_LEGS]


def _travelled_m(group: pl.DataFrame) -> float | None:
    """How far positions travel on a steady course, beyond their bounds, while their truth stands; None where they do not. [m]."""
    names = ("est_lat_rad", "est_lon_rad", "cov_ee_m2", "cov_nn_m2")
    true = group.select(_TRUE_PLACE).to_numpy()
    if not set(names) <= set(group.columns) or np.hypot(*east_north_m(true[[0]], true).T).max() > _STANDS_M:
        return None
    rows = group.filter(pl.all_horizontal(pl.col(name).is_finite() for name in names))
    time_s = rows["time_ns"].to_numpy() * 1e-9
    place = rows.select(names[:2]).to_numpy()
    radius_m = _RADII * np.sqrt(rows.select(pl.max_horizontal(names[2:])).to_series().to_numpy())
    for leg_s in _LEGS_S:
        ends = _spaced(time_s, leg_s)
        legs_m = east_north_m(place[ends[:-1]], place[ends[1:]])
        if len(legs_m) < _LEAST_LEGS:
            return None
        length_m = np.hypot(*legs_m.T)
        beyond = length_m > radius_m[ends[:-1]] + radius_m[ends[1:]]
        with np.errstate(invalid="ignore"):
            cosine = (legs_m[:-1] * legs_m[1:]).sum(axis=1) / (length_m[:-1] * length_m[1:])
        if beyond.mean() > 0.5 and np.median(np.nan_to_num(cosine)) > _LEAST_COSINE:
            return float(np.hypot(*east_north_m(place[[0]], place).T).max())
    return None


def _spaced(time_s: NDArray[np.float64], least_s: float) -> NDArray[np.intp]:
    """Rows at least so far apart in time."""
    if not len(time_s):
        return np.empty(0, dtype=np.intp)
    slot = np.floor((time_s - time_s[0]) / least_s)
    return np.flatnonzero(np.diff(slot, prepend=-1.0) > 0)
