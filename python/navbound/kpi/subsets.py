"""The Stanford-ESA diagram: every subset of an epoch's satellites is a point with an error and a protection level of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound import _core
from navbound.errors import InputError
from navbound.kpi import records
from navbound.records.performance import Level, ListedSubset, Performance, StanfordBins, StanfordCounts, Subsets
from navbound.table.arguments import checked, checked_fields
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from numpy.typing import NDArray

RangeTable = pl.DataFrame | Mapping[str, Any]
MOST_LISTED = 500
"""Subsets that a record lists."""
MOST_SATELLITES = 24
"""2^24 subsets of one epoch are seconds of work."""

_FLOATS = ("az_rad", "el_rad", "sigma_m", "range_error_m")
_SHARED = ("shared_1_m", "shared_2_m", "shared_3_m", "shared_4_m")


@checked_fields
@dataclass(frozen=True)
class SubsetOptions:
    """How the subsets of the Stanford-ESA diagram are made.

    Attributes
    ----------
    min_satellites : int
        Fewest satellites of a subset, 4 or more; 5 where the solution must be tested. [1]
    max_satellites : int
        Epochs with more satellites are cut to the subsets that leave out so few that there are no more than 2 to this power. [1]
    listed_from : float
        Safety index from which a subset is listed. [1]
    """

    min_satellites: int = 4
    max_satellites: int = 14
    listed_from: float = 0.7

    def __post_init__(self) -> None:
        """Refuse what no subset meets."""
        if not 4 <= self.min_satellites <= 64:
            raise InputError("min_satellites", self.min_satellites, "1", "[4, 64]")
        if not 4 <= self.max_satellites <= MOST_SATELLITES:
            raise InputError("max_satellites", self.max_satellites, "1", f"[4, {MOST_SATELLITES}]")
        if not 0 < self.listed_from < float("inf"):
            raise InputError("listed_from", self.listed_from, "1", "(0, inf)")


@dataclass(frozen=True)
class StanfordEsa:
    """Every subset of every epoch: counts with the gravest subsets, and the histograms of both axes that are drawn."""

    subsets: Subsets
    bins: list[StanfordBins]


def n_bins(bin_m: float, limit_m: float) -> int:
    """Bins of an axis of a Stanford diagram, or a refusal."""
    if not 0 < bin_m < float("inf"):
        raise InputError("bin_m", bin_m, "m", "(0, inf)")
    if not bin_m <= limit_m <= 10_000 * bin_m:
        raise InputError("limit_m", limit_m, "m", f"[{bin_m:g}, {10_000 * bin_m:g}]")
    return round(limit_m / bin_m)


@checked
def stanford_esa(
    ranges: RangeTable | Sequence[RangeTable] | Callable[[], Iterable[RangeTable]],
    levels: Sequence[Level],
    options: SubsetOptions | None = None,
    *,
    bin_m: float = 0.1,
    limit_m: float = 50.0,
) -> StanfordEsa:
    """Stanford-ESA diagram: each subset of an epoch's satellites solved, its error set against its own protection level.

    Every subset is a weighted least-squares solution of its ranges' errors; its levels are HPL = 6.0 d_major and VPL = 5.33 d_U of its
    covariance (DO-229D J.2), to which errors that the ranges share add what they do to the position.

    Parameters
    ----------
    ranges : DataFrame or mapping of columns, a sequence of such, or a callable that gives them again
        One row a range; rows of one epoch stand together. ``time_ns`` [ns]; ``sv``, the satellite's name; ``az_rad``, ``el_rad`` [rad];
        ``sigma_m``, its standard deviation in the solution [m]; ``range_error_m``, measured less true range, of which what is common to
        an epoch's rows counts as the receiver's clock [m]; optionally ``shared_1_m`` to ``shared_4_m``, standard
        deviations of errors that all ranges share, signed [m]. Satellites of one constellation.
    levels : sequence of Level
        Whose limits divide the diagram.
    options : SubsetOptions, optional
        Which subsets, and which are listed.
    bin_m, limit_m : float
        Width of a bin, and where both axes of the diagram end. [m]

    Returns
    -------
    StanfordEsa

    Raises
    ------
    InputError
        A missing column, satellites of several constellations, a number outside its domain.
    """
    settings = options or SubsetOptions()
    core = _core.KpiSubsets(
        {
            "approach": True,
            "least": settings.min_satellites,
            "most_satellites": settings.max_satellites,
            "limits_m": [(level.hal_m, level.val_m) for level in levels],
            "bin_m": bin_m,
            "n_bins": n_bins(bin_m, limit_m),
            "listed_from": settings.listed_from,
            "most_listed": MOST_LISTED,
        }
    )
    tables = _again(ranges)
    for table in tables():
        core.add(_columns(_frame(table)))
    outcome = core.outcome()
    listed = _listed(outcome["listed"], tables)
    counts = {level.id: _counts(level, both) for level, both in zip(levels, outcome["regions"], strict=True)}
    subsets = Subsets(
        **{name: outcome[name] for name in ("n_epochs", "n_unsolved", "n_cut", "n_subsets", "n_singular", "n_mi", "n_listed")},
        min_satellites=settings.min_satellites,
        max_satellites=settings.max_satellites,
        safety_index_h_max=outcome["largest_index"][0],
        safety_index_v_max=outcome["largest_index"][1],
        listed_from=settings.listed_from,
        listed=listed,
        stanford=counts,
    )
    return StanfordEsa(subsets, records.stanford_bins(outcome["bins"], bin_m, limit_m, variant="stanford-esa"))


@checked
def with_subsets(result: Performance, diagram: StanfordEsa) -> Performance:
    """The indicators with the subsets beside them."""
    notes = []
    if diagram.subsets.n_cut:
        notes.append(
            f"Stanford-ESA: {counted(diagram.subsets.n_cut, 'epoch has', 'epochs have')} so many satellites that only subsets that "
            "leave out a few were looked at, "
            f"at most 2^{diagram.subsets.max_satellites} an epoch."
        )
    changes = {"stanford": [*result.stanford, *diagram.bins], "subsets": diagram.subsets, "notes": [*result.notes, *notes]}
    return result.model_copy(update=changes)


def _counts(level: Level, both: list[dict[str, int]]) -> list[StanfordCounts]:
    limits = [level.hal_m] if level.val_m is None else [level.hal_m, level.val_m]
    rows = zip(records.AXES, limits, both, strict=False)
    return [StanfordCounts(axis=axis, alert_limit_m=limit, **regions) for axis, limit, regions in rows]


def _again(ranges: RangeTable | Sequence[RangeTable] | Callable[[], Iterable[RangeTable]]) -> Callable[[], Iterable[RangeTable]]:
    if callable(ranges):
        return ranges
    several = [ranges] if isinstance(ranges, (pl.DataFrame, Mapping)) else list(ranges)
    return lambda: several


def _frame(table: RangeTable) -> pl.DataFrame:
    try:
        frame = table if isinstance(table, pl.DataFrame) else pl.DataFrame(dict(table))
    except (pl.exceptions.PolarsError, TypeError, ValueError) as e:
        raise InputError("ranges", str(e).splitlines()[0][:120], domain="columns of equal length") from e
    for name in ("time_ns", "sv", *_FLOATS):
        if name not in frame.columns:
            raise InputError("ranges", f"columns {', '.join(frame.columns[:12])}", domain=f"a table with a column {name}")
    if not frame["time_ns"].dtype.is_integer() or frame["time_ns"].null_count():
        raise InputError("time_ns", f"{frame['time_ns'].dtype}", "ns", "whole nanoseconds in every row")
    if not frame["time_ns"].is_sorted():
        raise InputError("time_ns", "times that fall", "ns", "ranges in the order of time")
    systems = frame["sv"].cast(pl.String).str.slice(0, 1).unique().drop_nulls().sort().to_list()
    if len(systems) > 1:
        raise InputError("sv", ", ".join(systems), domain="satellites of one constellation, whose clock the ranges share")
    return frame


def _columns(frame: pl.DataFrame) -> dict[str, Any]:
    time_ns = frame["time_ns"].to_numpy()
    first = np.flatnonzero(np.r_[True, np.diff(time_ns) != 0]) if len(time_ns) else np.zeros(0, dtype=np.int64)
    try:
        columns: dict[str, Any] = {
            name: np.ascontiguousarray(frame[name].cast(pl.Float64).fill_null(np.nan).to_numpy()) for name in _FLOATS
        }
        shared: NDArray[np.float64] = np.zeros((frame.height, len(_SHARED)))
        for k, name in enumerate(_SHARED):
            if name in frame.columns:
                shared[:, k] = frame[name].cast(pl.Float64).fill_null(np.nan).to_numpy()
    except pl.exceptions.PolarsError as e:
        raise InputError("ranges", str(e).splitlines()[0][:120], domain="numbers in the columns that hold numbers") from e
    return {"time_ns": time_ns[first].tolist(), "first": [*first.tolist(), frame.height], "shared_m": shared, **columns}


def _listed(columns: dict[str, NDArray[Any]], tables: Callable[[], Iterable[RangeTable]]) -> list[ListedSubset]:
    """The gravest subsets with the names of their satellites, for which the tables are looked through again."""
    times = np.unique(columns["time_ns"]).tolist()
    names: dict[int, list[str]] = {}
    for table in tables() if times else []:
        near = _frame(table).filter(pl.col("time_ns").is_in(times)).group_by("time_ns", maintain_order=True).agg("sv")
        names.update((int(time_ns), list(sv)) for time_ns, sv in near.iter_rows())
    rows = []
    for k, time_ns in enumerate(columns["time_ns"].tolist()):
        used, satellites = int(columns["used"][k]), names[time_ns]
        hpe, hpl, vpe, vpl = (float(columns[name][k]) for name in ("hpe_m", "hpl_m", "vpe_m", "vpl_m"))
        no_vertical = np.isnan(vpl)
        rows.append(
            ListedSubset(
                time_ns=time_ns,
                satellites=[sv for i, sv in enumerate(satellites) if used >> i & 1],
                left_out=[sv for i, sv in enumerate(satellites) if not used >> i & 1],
                hpe_m=hpe,
                hpl_m=hpl,
                vpe_m=vpe,
                vpl_m=None if no_vertical else vpl,
                safety_index=hpe / hpl if no_vertical else max(hpe / hpl, vpe / vpl),
            )
        )
    return rows
