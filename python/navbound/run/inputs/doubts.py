"""What a recording says against its own epochs, and what its times leave unknown: counts of the whole table, in pieces of any length."""

from __future__ import annotations

from typing import TYPE_CHECKING

import polars as pl

from navbound.read.checks.limits import Limits
from navbound.read.checks.neighbours import Neighbours
from navbound.read.checks.stated import ALERT, CONTAINMENT, ERROR, WORSE
from navbound.read.statements.texts import WORDS_SHOWN
from navbound.status import USABLE

if TYPE_CHECKING:
    from collections.abc import Container

    from navbound.read.checks.plausible import Plausibility
    from navbound.read.motion.axes import Axes
    from navbound.read.motion.speeds import Speeds


def of_motion(plausibility: Plausibility, speeds: Speeds, axes: Axes) -> list[str]:
    """Why the positions of a recording may not be what they are read as, by their motion, after all epochs."""
    return [*plausibility.doubts, *speeds.doubts(), *axes.words()]


class Doubts:
    """Counts over epochs in the order of track and time.

    Attributes
    ----------
    n_stated_beyond, n_stated_alert, n_stated_worse, n_stated_uncontained, n_stated_against : int
        Epochs with status ok or degraded where the recording itself states an error beyond RNP, an alert, an accuracy worse than its
        covariance, a containment radius beyond twice RNP, or any of these.
    stated_alerts : dict of str
        The first few alerts that it states; keys alone count.
    n_without_level : int
        Judged epochs of tracks whose column of horizontal protection levels holds none: no column of nothing may stand for a level.
    neighbours : Neighbours or None
        Positions that contradict those beside them; None for a flight that was simulated.
    n_long_steps : int
        Steps between successive epochs of a track that are longer than a position takes to become stale.
    longest_step_s : float or None
        The longest of all steps. [s]
    """

    def __init__(self, with_levels: Container[str], *, recorded: bool = True) -> None:
        self.neighbours = Neighbours() if recorded else None
        self._with_levels = with_levels
        self._last: tuple[str, int] | None = None
        self.n_stated_beyond = self.n_stated_worse = self.n_stated_alert = self.n_stated_uncontained = self.n_stated_against = 0
        self.stated_alerts: dict[str, None] = {}
        self.n_without_level = self.n_long_steps = 0
        self.longest_step_s: float | None = None

    def see(self, margins: pl.DataFrame) -> None:
        """The next epochs, with the margins of the judging method."""
        self._see_statements(margins)
        self._see_levels(margins)
        self._see_steps(margins)
        if self.neighbours is not None:
            self.neighbours.see(margins)

    def _see_statements(self, margins: pl.DataFrame) -> None:
        usable, never = pl.col("status").is_in(USABLE), pl.lit(value=False)
        beyond = usable & (pl.col(ERROR) > pl.col("rnp_m")) if ERROR in margins.columns else never
        alert = usable & pl.col(ALERT).is_not_null() if ALERT in margins.columns else never
        worse = usable & pl.col(WORSE).is_not_null() if WORSE in margins.columns else never
        uncontained = usable & (pl.col(CONTAINMENT) > 2.0 * pl.col("rnp_m")) if CONTAINMENT in margins.columns else never
        beyond, alert, uncontained = (each.fill_null(value=False) for each in (beyond, alert, uncontained))
        each = {"beyond": beyond, "alert": alert, "worse": worse, "uncontained": uncontained}
        counts = margins.select(usable.alias("_usable"), **each, any=beyond | alert | worse | uncontained)
        self.n_stated_beyond += int(counts["beyond"].sum())
        self.n_stated_alert += int(counts["alert"].sum())
        if counts["alert"].any() and len(self.stated_alerts) < WORDS_SHOWN:
            words = margins.filter(counts["alert"])[ALERT].unique(maintain_order=True).head(WORDS_SHOWN)
            self.stated_alerts = dict.fromkeys([*self.stated_alerts, *words][:WORDS_SHOWN])
        self.n_stated_worse += int(counts["worse"].sum())
        self.n_stated_uncontained += int(counts["uncontained"].sum())
        self.n_stated_against += int(counts["any"].sum())

    def _see_levels(self, margins: pl.DataFrame) -> None:
        if "hpl_m" not in margins.columns:
            return
        judged = margins.filter((pl.col("status") == "ok") & pl.col("_margin").is_not_null())
        per_track = judged.group_by("track").len()
        self.n_without_level += sum(n for track, n in per_track.iter_rows() if track not in self._with_levels)

    def _see_steps(self, margins: pl.DataFrame) -> None:
        track, time_ns = margins["track"], margins["time_ns"]
        steps = margins.select(pl.col("time_ns").diff().over("track"))["time_ns"].drop_nulls()
        if self._last is not None and self._last[0] == track[0]:
            steps = steps.append(pl.Series([time_ns[0] - self._last[1]], dtype=pl.Int64))
        self._last = (track[-1], time_ns[-1])
        if steps.is_empty():
            return
        seconds = steps.cast(pl.Float64) * 1e-9
        self.n_long_steps += int((seconds > Limits().stale_after_s).sum())
        self.longest_step_s = max(float(seconds.max()), self.longest_step_s or 0.0)  # type: ignore[arg-type]
