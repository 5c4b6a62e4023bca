"""Can the recorded positions have been flown? Every recorded track is checked before any bound is formed."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import _core, status
from navbound.read.checks.limits import Limits
from navbound.read.quantities import POSITION_TIME
from navbound.table.columns import COVARIANCE
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from numpy.typing import NDArray

    _Reports = tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]


_UNDATED = -(2**63)

_REASON_ID = [None, "position_held", "position_stale", "position_jump", "position_not_settled", "position_late", "position_ahead"]
"""What the core found, by its codes."""
_JUMP = _REASON_ID.index("position_jump")
_LEAST_ALONE, _ALONE_SHARE = 10, 0.5
"""Number and share of positions that are alone, from which nothing is shown. Provenance: ours. [1]"""
_OLD_SHARE, _SILENT_SHARE = 0.5, 0.05
"""Shares of the rows that state an age, and of the rows that could, from which old positions and silence leave the others doubted. Ours."""


@dataclass(frozen=True)
class Plausibility:
    """Counts of what was found.

    Attributes
    ----------
    n_repeated, n_stale, n_jump, n_unsettled, n_late, n_ahead : int
        Epochs by finding.
    n_fast : int
        Steps faster than the aircraft's own speed allows in the time between the positions.
    fastest_mps : float
        The fastest of these.
    n_speed_doubted : int
        Reported speeds beyond what those beside them allow.
    n_steps_5km : int
        Steps between successive epochs of more than 5 km.
    largest_step_m : float
        The largest of all steps.
    words : str
        The same as a sentence.
    doubts : tuple of str
        Why no position is believed.
    """

    n_repeated: int
    n_stale: int
    n_jump: int
    n_unsettled: int
    n_late: int
    n_ahead: int
    n_fast: int
    fastest_mps: float
    n_speed_doubted: int
    n_steps_5km: int
    largest_step_m: float
    words: str
    doubts: tuple[str, ...] = ()


def plausible_rows(epochs: pl.DataFrame) -> pl.Expr:
    """Rows against whose positions nothing is known but their speeds, after :func:`check`; what is said of the others is not said again."""
    if "reason_id" not in epochs.columns:
        return pl.lit(value=True)
    return ~pl.col("reason_id").is_in([id_ for id_ in _REASON_ID if id_ not in {None, "position_ahead"}]).fill_null(value=False)


def unreachable(rows: pl.DataFrame, lat: str, lon: str, limits: Limits) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Where the positions of one track, in the order of time, jump; and where they jump or have not settled since."""
    time, lat_rad, lon_rad = (np.ascontiguousarray(rows[name].to_numpy()) for name in ("time_ns", lat, lon))
    undated, silent = np.full(rows.height, _UNDATED), np.full(rows.height, np.nan)
    track = _core.PlausibleTrack(asdict(limits), reports_speed=False)
    reports = (time, undated, lat_rad, lon_rad, silent)
    track.see(reports)
    code = track.judge(reports, [])["finding"]
    jump, unsettled, late = (code == _REASON_ID.index(id_) for id_ in ("position_jump", "position_not_settled", "position_late"))
    return jump | late, jump | late | unsettled


def check(epochs: pl.DataFrame, limits: Limits | None = None) -> tuple[pl.DataFrame, Plausibility]:
    """Give every epoch a status and a reason, and take the covariance from those whose position is not to be believed.

    Parameters
    ----------
    epochs : DataFrame
        Epoch table, sorted by track and time.
    limits : Limits, optional
        What an aircraft can do.

    Returns
    -------
    epochs : DataFrame
        With ``status``, ``reason_id`` and ``reason``; those that a solver gave before stand where nothing is implausible.
    plausibility : Plausibility
        What was found.
    """
    checker = Checker(limits or Limits())
    return checker.check(epochs), checker.plausibility()


class Checker:
    """The same for a table that comes in pieces, each the continuation of the one before.

    A track that goes on in a later piece must have been seen before the first of its pieces is checked (:meth:`see`), whole or as far as
    its first reported speed: one that reports none is judged by the speed of all its steps.
    """

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._tracks: dict[str, _core.PlausibleTrack] = {}
        self._n = np.zeros(len(_REASON_ID), dtype=np.int64)
        self._n_steps = self._n_fast = self._n_dated = self._n_rows = self._n_doubted = self._n_twice = 0
        self._largest = self._fastest = self._oldest_s = self._furthest_m = 0.0
        self._n_unknown = 0
        self._ages: dict[str, NDArray[np.int64]] = {}
        self._n_of: Counter[str] = Counter()

    def see(self, epochs: pl.DataFrame) -> None:
        """See the next part of one track that goes on in other pieces."""
        (group,) = _columns(epochs).partition_by("track", maintain_order=True)
        self._track(group).see(_reports(group))

    def check(self, epochs: pl.DataFrame, after: pl.DataFrame | None = None) -> pl.DataFrame:
        """The next piece with status and reason of every epoch, as :func:`check` gives them; ``after`` begins with the rows after it."""
        columns = _columns(epochs)
        judged = []
        for group in columns.partition_by("track", maintain_order=True):
            name, seen = group["track"][0], group["track"][0] in self._tracks
            track, reports = self._track(group), _reports(group)
            if not seen:
                track.see(reports)
            findings = track.judge(reports, _speeds_after(name, after))
            self._n_of[name] += group.height
            self._see_ages(name, findings["finding"], reports)
            judged.append(findings)
            # Rows are in the order of tracks: only the last one may go on.
            self._tracks = {name: track} | {k: v for k, v in self._tracks.items() if k > name}
        names = ("finding", "step_m", "too_fast_mps", "speed_doubted")
        code, step, fast, doubted = (np.concatenate([one[name] for one in judged]) for name in names)
        self._n_doubted += int(doubted.sum())
        if "reason_id" in epochs.columns:
            jumps = (epochs["reason_id"] == "position_jump").fill_null(value=False).to_numpy()
            self._n_twice += int((jumps & (code != _JUMP)).sum())
        self._count(code, step, fast, columns)
        return _marked(epochs, code)

    def _see_ages(self, track: str, code: NDArray[np.uint8], reports: _Reports) -> None:
        """How old the positions are by their own rows, and how far the aircraft has moved since, where that is no finding."""
        time_ns, fixed_ns, _, _, speed_mps = reports
        dated = fixed_ns != _UNDATED
        age_s = (time_ns[dated] - fixed_ns[dated]) * 1e-9
        n_old, n_silent = (age_s > self._limits.fix_latency_s).sum(), (code[~dated] == 0).sum()
        self._ages[track] = self._ages.get(track, np.zeros(3, dtype=np.int64)) + np.array([dated.sum(), n_old, n_silent])
        plausible = code[dated] == 0
        self._oldest_s = max(self._oldest_s, float(age_s[plausible].max(initial=0.0)))
        moved_m = (age_s * speed_mps[dated])[plausible]
        self._n_unknown += int(np.isnan(moved_m).sum())
        self._furthest_m = max(self._furthest_m, float(np.nan_to_num(moved_m).max(initial=0.0)))

    def _track(self, group: pl.DataFrame) -> _core.PlausibleTrack:
        name = group["track"][0]
        if name not in self._tracks:
            self._tracks[name] = _core.PlausibleTrack(asdict(self._limits), reports_speed=False)
        return self._tracks[name]

    def _count(self, code: NDArray[np.uint8], step: NDArray[np.float64], fast: NDArray[np.float64], columns: pl.DataFrame) -> None:
        self._n += np.bincount(code, minlength=len(_REASON_ID))
        self._n_steps += int((step > 5000).sum())
        self._largest = max(self._largest, float(step.max(initial=0.0)))
        self._n_fast += int((fast > 0).sum())
        self._fastest = max(self._fastest, float(fast.max(initial=0.0)))
        self._n_dated += int((columns["fixed_ns"] != _UNDATED).sum())
        self._n_rows += columns.height

    def plausibility(self) -> Plausibility:
        """What was found in all pieces so far."""
        limits, n, n_steps, largest, fastest = self._limits, self._n, self._n_steps, self._largest, self._fastest
        twice = f"{self._n_twice} of them another position of the same time, " if self._n_twice else ""
        words = (
            f"Plausibility: {counted(n[_JUMP] + self._n_twice, 'position jump')} that cannot be flown "
            f"({twice}{counted(n[4], 'more epoch')} "
            f"not settled after them), {counted(n[2], 'epoch')} with a "
            f"position held for more than {limits.stale_after_s:g} s, {n[1]} with one held shorter; {counted(n_steps, 'step')} of "
            "more than 5 km "
            f"between successive epochs, the largest {largest / 1e3:.1f} km."
        )
        if self._n_fast:
            words += (
                f" {counted(self._n_fast, 'step is', 'steps are')} faster than the aircraft's own speed in the time between the "
                "positions, the fastest "
                f"{fastest:.0f} m/s; {n[5]} of them {agreeing(n[5], 'needs', 'need')} a position that was older than "
                f"{limits.stale_after_s:g} s and {agreeing(n[5], 'is', 'are')} marked."
            )
        if n[6]:
            words += f" {counted(n[6], 'position is', 'positions are')} further on than the speeds reported on the way to them lead."
        if self._n_doubted:
            words += (
                f" {counted(self._n_doubted, 'reported speed is', 'reported speeds are')} beyond what the speeds beside "
                f"{agreeing(self._n_doubted, 'it allow, and was', 'them allow, and were')} not used."
            )
        if self._n_dated:
            words += (
                f" {self._n_dated} of {counted(self._n_rows, 'row')} {agreeing(self._n_dated, 'says when its', 'say when their')} "
                "position was valid; between those, steps are judged by that time."
            )
            if n_old := sum(int(each[1]) for each in self._ages.values()):
                words += (
                    f" {counted(n_old, 'position that is', 'positions that are')} older than {limits.fix_latency_s:g} s "
                    f"{agreeing(n_old, 'counts', 'count')} as held."
                )
            if self._oldest_s > 0.0:
                moved = (
                    f"the aircraft moved up to {self._furthest_m:.0f} m" if self._furthest_m else "nobody knows how far the aircraft moved"
                )
                more = (
                    f" ({self._n_unknown} {agreeing(self._n_unknown, 'states', 'state')} no speed)"
                    if self._furthest_m and self._n_unknown
                    else ""
                )
                words += (
                    f" The others are up to {self._oldest_s:.2g} s old, in which {moved}{more}: a bound is of the time of the position, a "
                    "truth of the time of the row."
                )
        repeated, stale, jump, unsettled, late, ahead = (int(k) for k in n[1:])
        counts = (repeated, stale, jump + self._n_twice, unsettled, late, ahead)
        return Plausibility(*counts, self._n_fast, fastest, self._n_doubted, n_steps, largest, words, self._doubts())

    def _doubts(self) -> tuple[str, ...]:
        return self._doubts_of_ages() + self._doubts_of_lone_rows()

    def _doubts_of_lone_rows(self) -> tuple[str, ...]:
        """A column that is taken for names of tracks may number the rows."""
        n_alone = sum(n == 1 for n in self._n_of.values())
        if n_alone < _LEAST_ALONE or n_alone < _ALONE_SHARE * self._n_rows:
            return ()
        return (f"{n_alone} of {self._n_rows} positions are each the only one of its track: no motion can be compared with them",)

    def _doubts_of_ages(self) -> tuple[str, ...]:
        """Ages that a track states now and then say what the age of its other positions is."""
        old = {name: n for name, n in self._ages.items() if n[1] > _OLD_SHARE * n[0] and n[2] > _SILENT_SHARE * (n[0] + n[2])}
        if not old:
            return ()
        name, (n_dated, n_old, n_silent) = next(iter(old.items()))
        return (
            f"{n_old} of {counted(n_dated, 'row')} of track {name} that {agreeing(n_dated, 'says when its', 'say when their')} position "
            f"was valid {agreeing(n_old, 'says', 'say')} that it is older than "
            f"{self._limits.fix_latency_s:g} s, and {counted(n_silent, 'row says', 'rows say')} nothing of it: how old those "
            "positions are is not known",
        )


def _columns(epochs: pl.DataFrame) -> pl.DataFrame:
    speed = pl.col("ground_speed_mps") if "ground_speed_mps" in epochs.columns else pl.lit(None, pl.Float64)
    fixed = pl.col(POSITION_TIME) if POSITION_TIME in epochs.columns else pl.lit(None, pl.Int64)
    return epochs.select(
        "track",
        "time_ns",
        fixed.fill_null(_UNDATED).alias("fixed_ns"),
        "est_lat_rad",
        "est_lon_rad",
        speed.fill_null(np.nan).alias("speed"),
    )


def _speeds_after(track: str, after: pl.DataFrame | None) -> list[tuple[int, float]]:
    """Times [ns] and speeds [m/s] of the first rows after a piece, of the track that goes on."""
    if after is None or after.is_empty():
        return []
    rows = _columns(after.head(_core.SPEEDS_BESIDE))
    return rows.filter(pl.col("track") == track).select("time_ns", "speed").rows()


def _reports(group: pl.DataFrame) -> _Reports:
    time, valid, lat, lon, speed = (np.ascontiguousarray(group[c].to_numpy()) for c in group.columns[1:])
    return time, valid, lat, lon, speed


def _marked(epochs: pl.DataFrame, code: NDArray[np.uint8]) -> pl.DataFrame:
    """Status and reason by the core's codes, and no covariance where the position is not believed."""
    marked = status.with_reason(epochs, pl.Series("reason_id", _REASON_ID, dtype=pl.String).gather(code))
    if "status" in epochs.columns:
        solved = status.with_reason_id(epochs)
        # The graver stands; of two alike, what was said before.
        both = marked.select("status").with_columns(before=solved["status"])
        stands = both.select((status.worse(pl.col("before"), pl.col("status")) == pl.col("before")).alias("stands"))["stands"]
        marked = marked.with_columns(pl.when(stands).then(solved[c]).otherwise(pl.col(c)).alias(c) for c in status.COLUMNS)
    believed = pl.col("status").is_in(status.USABLE)
    marked = marked.with_columns(pl.when(believed).then(pl.col(c)).alias(c) for c in COVARIANCE if c in epochs.columns)
    # One order of columns, whether the recording had a status or not.
    columns = ("reason_id", "status", "reason")
    return marked.select(pl.exclude(*columns), *columns)
