"""The ICAO performance indicators of a series of errors and protection levels, whatever made them: SBAS, GBAS, ARAIM, a receiver.

Definitions follow docs/methods/kpi.md; the levels' numbers carry their own source and provenance.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound import _core
from navbound.errors import InputError
from navbound.kpi import records
from navbound.kpi.catalogue import level, levels, rnp, selected_levels
from navbound.kpi.slots import Slots
from navbound.kpi.stated import LEVELS, Counts, levels_that_count, with_least_errors
from navbound.kpi.subsets import RangeTable, StanfordEsa, SubsetOptions, n_bins, stanford_esa, with_subsets
from navbound.kpi.tables import FLOATS, Table, codes_of, frame_of, period_of
from navbound.records.performance import Level, Performance, StanfordBins, StanfordCounts
from navbound.table.arguments import checked
from navbound.table.arrays import flatten
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Campaign",
    "Continuity",
    "Level",
    "Performance",
    "Stanford",
    "StanfordEsa",
    "SubsetOptions",
    "continuity",
    "evaluate",
    "level",
    "levels",
    "rnp",
    "stanford",
    "stanford_esa",
    "with_subsets",
]

WINDOW_S = 15.0
"""Continuity window."""
MOST_EVENTS = 500
"""Events that a performance record lists; a campaign hands out all of them."""


@dataclass(frozen=True)
class Stanford:
    """One axis of a Stanford diagram: exact counts in its regions, and the histogram that is drawn."""

    counts: StanfordCounts
    bins: StanfordBins


@dataclass(frozen=True)
class Continuity:
    """Continuity of a pattern.

    Attributes
    ----------
    n_available : int
        Available epochs.
    n_at_risk : int
        Those with an epoch that is not available within the window after them.
    n_events : int
        Times the service was available and then was not.
    risk : float
        ``n_at_risk / n_available``; NaN where nothing was available.
    """

    n_available: int
    n_at_risk: int
    n_events: int
    risk: float


@checked
def continuity(available: ArrayLike | str, n_window_epochs: int) -> Continuity:
    """Continuity of a pattern of available epochs by the sliding window; the look-ahead is cut at the end of the data.

    Parameters
    ----------
    available : array_like of bool, shape (n,), or str
        Whether the service was available at each epoch of an even grid; as text ``X`` for available, ``O`` for not.
    n_window_epochs : int
        Epochs of the window.

    Raises
    ------
    InputError
        Another shape or kind, or an empty window.
    """
    if isinstance(available, str):
        if set(available) - set("XO"):
            raise InputError("available", available[:60], domain="letters X and O")
        available = np.array([letter == "X" for letter in available], dtype=np.bool_)
    pattern = np.asarray(available)
    if pattern.ndim != 1 or pattern.dtype != np.bool_:
        raise InputError("available", f"{pattern.dtype}, shape {pattern.shape}", domain="bool, shape (n,)")
    if n_window_epochs < 1:
        raise InputError("n_window_epochs", n_window_epochs, "1", "[1, inf)")
    n_events, n_at_risk = _core.kpi_continuity(np.ascontiguousarray(pattern), n_window_epochs)
    n_available = int(pattern.sum())
    return Continuity(n_available, n_at_risk, n_events, n_at_risk / n_available if n_available else float("nan"))


@checked
def stanford(
    error_m: ArrayLike, level_m: ArrayLike, alert_limit_m: float, *, axis: str = "v", bin_m: float = 0.1, limit_m: float = 50.0
) -> Stanford:
    """Stanford diagram of one axis.

    Parameters
    ----------
    error_m : array_like, shape (n,)
        Error; its magnitude counts. NaN where it is not known. [m]
    level_m : array_like, shape (n,)
        Protection level; NaN where there is none. [m]
    alert_limit_m : float
        Alert limit. [m]
    axis : {"h", "v"}
        Which axis these are.
    bin_m, limit_m : float
        Width of a bin, and where both axes of the diagram end. [m]

    Raises
    ------
    InputError
        Shapes that do not fit, or lengths that are not positive.
    """
    if axis not in records.AXES:
        raise InputError("axis", axis, domain="h, v")
    if not 0 < alert_limit_m < float("inf"):
        raise InputError("alert_limit_m", alert_limit_m, "m", "(0, inf)")
    shape, (error, bound) = flatten(error_m=(error_m, ()), level_m=(level_m, ()))
    if np.shape(error_m) != np.shape(level_m):
        raise InputError("level_m", f"shape {np.shape(level_m)}", domain=f"the shape of error_m, {np.shape(error_m)}")
    if len(shape) != 1:
        raise InputError("error_m", f"shape {shape}", domain="shape (n,)")
    counted = _core.kpi_stanford(np.abs(error), bound, alert_limit_m, bin_m, n_bins(bin_m, limit_m))
    which = records.AXES[records.AXES.index(axis)]
    counts = StanfordCounts(axis=which, alert_limit_m=alert_limit_m, **counted["regions"])
    bins = StanfordBins(axis=which, variant="stanford", bin_m=bin_m, limit_m=limit_m, n=counts.n, **counted["bins"])
    return Stanford(counts, bins)


@checked
def evaluate(
    table: Table | Sequence[Table],
    levels: str | Level | Sequence[str | Level],
    *,
    period_s: float | None = None,
    exclude_missing: bool = False,
    bin_m: float = 0.1,
    limit_m: float = 50.0,
    title: str = "",
    experimental: str = "",
    ranges: RangeTable | Sequence[RangeTable] | None = None,
    subsets: SubsetOptions | None = None,
) -> Performance:
    """Evaluate the indicators of one receiver's series.

    Parameters
    ----------
    table : DataFrame or mapping of columns, or a sequence of such tables that follow each other in time
        ``time_ns`` and ``hpl_m``; as far as known ``vpl_m``, errors ``nse_e_m nse_n_m nse_u_m`` (or ``hpe_m vpe_m``), ``status``,
        ``reason``, ``mode``, ``n_sv``. A row without ``hpl_m``, or with another ``status`` than ``ok``, is an epoch without a solution;
        a ``degraded`` one whose error is above its level has the level that it misleads by.
    levels : names or Level
        From :func:`levels`, or of your own; names may be joined by commas.
    period_s : float, optional
        Nominal sampling period; by default the median step of the first table. [s]
    exclude_missing : bool
        Absent epochs are not expected.
    bin_m, limit_m : float
        Stanford diagrams: width of a bin, and where their axes end. [m]
    title : str
        For the record.
    experimental : str
        Words that must stand beside every number where the levels are no integrity levels, such as ``experimental, not integrity``.
    ranges : DataFrame or mapping of columns, or a sequence of such tables, optional
        Ranges of the epochs, for the Stanford-ESA diagram; see :func:`stanford_esa`.
    subsets : SubsetOptions, optional
        How its subsets are made.

    Returns
    -------
    Performance

    Raises
    ------
    InputError
        A missing column, times that fall, an unknown level, a number outside its domain, a ``status`` that is none of the list.
    """
    tables = [table] if isinstance(table, (pl.DataFrame, Mapping)) else list(table)
    frames = [frame_of(t) for t in tables]
    if not frames:
        raise InputError("table", "nothing", domain="one table or more")
    campaign = Campaign(
        levels,
        first=frames[0],
        period_s=period_s,
        exclude_missing=exclude_missing,
        bin_m=bin_m,
        limit_m=limit_m,
        title=title,
        experimental=experimental,
    )
    for frame in frames:
        campaign.add(frame)
    result = campaign.finish(lambda: frames)
    if ranges is None:
        return result
    several = [ranges] if isinstance(ranges, (pl.DataFrame, Mapping)) else list(ranges)
    return with_subsets(result, stanford_esa(several, campaign.levels, subsets, bin_m=bin_m, limit_m=limit_m))


LONGEST_PERIOD_S = 1e9
"""Thirty years: in nanoseconds it has room in a time. [s]"""


class Campaign:
    """Tables one after the other, any number of them, in memory that depends on the levels alone.

    Parameters
    ----------
    levels : names or Level
        As in :func:`evaluate`.
    first : DataFrame or mapping
        The first table: its first epoch anchors the grid, its median step is the period if ``period_s`` is not given.
    period_s, exclude_missing, bin_m, limit_m, title, experimental
        As in :func:`evaluate`.
    """

    @checked
    def __init__(
        self,
        levels: str | Level | Sequence[str | Level],
        *,
        first: Table,
        period_s: float | None = None,
        exclude_missing: bool = False,
        bin_m: float = 0.1,
        limit_m: float = 50.0,
        title: str = "",
        experimental: str = "",
    ) -> None:
        self.levels = selected_levels(levels)
        times = frame_of(first)["time_ns"]
        self.period_s = period_of(times) if period_s is None else float(period_s)
        if not 1e-9 <= self.period_s <= LONGEST_PERIOD_S:
            raise InputError("period_s", self.period_s, "s", f"[1e-9, {LONGEST_PERIOD_S:g}]")
        self.window_s = WINDOW_S
        self.n_window_epochs = max(1, round(WINDOW_S / self.period_s))
        self._bins = (bin_m, limit_m)
        self._title, self._exclude_missing, self._experimental = title, exclude_missing, experimental
        self._modes: dict[str, int] = {}
        self._reasons: dict[str, int] = {}
        self._gravest = pl.DataFrame(schema=records.EVENT_SCHEMA)
        self._counts = Counts()
        self._n_shared = 0
        self._slots = Slots(int(times[0]), max(1, round(1e9 * self.period_s)), self.levels)
        self._core = _core.KpiCampaign(
            {
                "origin_ns": int(times[0]),
                "period_ns": round(1e9 * self.period_s),
                "demands": [(level.hal_m, level.val_m, level.tta_s) for level in self.levels],
                "window": self.n_window_epochs,
                "bin_m": bin_m,
                "n_bins": n_bins(bin_m, limit_m),
                "exclude_missing": exclude_missing,
            }
        )

    @checked
    def add(self, table: Table) -> pl.DataFrame:
        """Add the next table, later than those before.

        Returns
        -------
        DataFrame
            The events that are over with it, columns as :class:`navbound.records.performance.KpiEvent`.

        Raises
        ------
        InputError
            A missing column, times that fall, a number outside its domain.
        """
        columns, counts = self._columns(frame_of(table))
        self._slots.require_later(columns)
        one_each = self._slots.worst(columns)
        self._counts += counts
        kept = self._keep(self._core.add(one_each))
        self._n_shared += len(columns["time_ns"]) - len(one_each["time_ns"])
        return kept

    def finish(self, tables: Callable[[], Iterable[Table]], events: Callable[[pl.DataFrame], None] | None = None) -> Performance:
        """Select the percentiles and make the record.

        Parameters
        ----------
        tables : callable
            Gives the tables that were added, again and in the same order, once for each pass of the selection.
        events : callable, optional
            Is given the events that :meth:`add` had not yet returned.

        Raises
        ------
        InputError
            Nothing was added, or other tables than were added.
        """
        outcome = self._core.outcome()
        if outcome["span_ns"] is None:
            raise InputError("table", "no rows", domain="tables with at least one epoch")
        left = self._keep(outcome["events"])
        if events is not None:
            events(left)
        percentiles = self._percentiles(tables)
        both = records.axes(outcome["axes"], percentiles[:6])
        results = [
            records.level_result(level, each, whole=outcome, all_axes=both, percentiles=percentiles[6 * k + 6 : 6 * k + 12], grid=self)
            for k, (level, each) in enumerate(zip(self.levels, outcome["levels"], strict=True))
        ]
        totals = [sum(each["runs"][kind][0] for each in outcome["levels"]) for kind in range(3)]
        return Performance(
            title=self._title,
            truth_known=both[0].error_m is not None,
            period_s=self.period_s,
            first_ns=outcome["span_ns"][0],
            last_ns=outcome["span_ns"][1],
            exclude_missing=self._exclude_missing,
            **{name: outcome[name] for name in ("n_expected", "n_missing", "n_no_solution", "n_solution", "n_mi_epochs")},
            n_repeated=outcome["n_repeated"] + self._n_shared,
            axes=both,
            levels=results,
            stanford=records.stanford_bins(outcome["stanford"], *self._bins),
            series=records.series(outcome["series"], self.levels),
            n_events=dict(zip(("loss", "hazard", "mi"), totals, strict=True)),
            events=records.event_records(self._gravest),
            days=records.days(outcome["days"], self.levels),
            subsets=None,
            experimental=self._experimental,
            notes=self._notes(),
        )

    def _percentiles(self, tables: Callable[[], Iterable[Table]]) -> list[list[float]]:
        selector = self._core.selector()
        for _ in range(_core.KpiSelector.passes()):
            for table in tables():
                selector.scan(self._slots.worst(self._columns(frame_of(table))[0]))
            selector.narrow()
        values = selector.values()
        return [values[k : k + 4] for k in range(0, len(values), 4)]

    def _keep(self, events: dict[str, Any]) -> pl.DataFrame:
        table = records.events(events, self.levels, self._modes, self._reasons)
        self._gravest = records.gravest(pl.concat([self._gravest, table]), MOST_EVENTS)
        return table

    def _notes(self) -> list[str]:
        notes = self._counts.words()
        if self._n_shared:
            notes.append(
                f"{counted(self._n_shared, 'row shares', 'rows share')} an epoch of the grid, one every {self.period_s:g} s, with "
                "another: of each epoch the "
                "worst row counts (an error beyond the limits or above the level first, then one without a level, then the largest ratio)."
            )
        if self.period_s > self.window_s:
            notes.append(f"Sampled every {self.period_s:g} s: the {self.window_s:g} s continuity window is one epoch and not meaningful.")
        return notes

    def _columns(self, frame: pl.DataFrame) -> tuple[dict[str, NDArray[Any]], Counts]:
        numbers = frame.select(pl.col(name).fill_null(np.nan) for name in FLOATS)
        bad = {name: ~numbers[name].is_nan() & ~((numbers[name] > 0) & numbers[name].is_finite()) for name in LEVELS}
        columns: dict[str, NDArray[Any]] = {name: np.ascontiguousarray(numbers[name].to_numpy()) for name in FLOATS}
        for name, refused in bad.items():
            columns[name] = np.where(refused.to_numpy(), np.nan, columns[name])
        with_least_errors(columns)
        misleading = levels_that_count(columns, frame["status"], vertical=any(each.val_m is not None for each in self.levels))
        columns["time_ns"] = np.ascontiguousarray(frame["time_ns"].to_numpy())
        columns["n_sv"] = np.ascontiguousarray(frame["n_sv"].fill_null(-1).to_numpy())
        columns["mode"] = codes_of(frame["mode"], self._modes)
        columns["reason"] = codes_of(frame["reason"], self._reasons)
        return columns, Counts(n_bad_levels=int((bad["hpl_m"] | bad["vpl_m"]).sum()), n_degraded=int(misleading.sum()))
