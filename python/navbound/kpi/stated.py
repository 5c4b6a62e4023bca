"""Which levels and errors of a row count: an error above a level that the row states is never lost."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound.words.plurals import counted

if TYPE_CHECKING:
    import polars as pl
    from numpy.typing import NDArray

LEVELS = ("hpl_m", "vpl_m")


@dataclass(frozen=True)
class Counts:
    """Rows of which something is to be said.

    Attributes
    ----------
    n_bad_levels : int
        With a level that is not positive and finite.
    n_degraded : int
        Degraded, with an error above the level that they state.
    """

    n_bad_levels: int = 0
    n_degraded: int = 0

    def __add__(self, other: Counts) -> Counts:
        """Of two tables together."""
        return Counts(self.n_bad_levels + other.n_bad_levels, self.n_degraded + other.n_degraded)

    def words(self) -> list[str]:
        """A sentence each."""
        words = []
        if self.n_bad_levels:
            words.append(
                f"{counted(self.n_bad_levels, 'row holds', 'rows hold')} a protection level that is not positive and finite; it "
                "counts as none."
            )
        if self.n_degraded:
            rows = counted(self.n_degraded, "row is degraded and states", "rows are degraded and state")
            words.append(f"{rows} a protection level that its error exceeds: the level counts, and so do the errors above it.")
        return words


def with_least_errors(columns: dict[str, NDArray[Any]]) -> None:
    """Of half a horizontal error that is above the level, the other half counts as zero: the error is no smaller.

    Half an error within the level says nothing, and stays unknown.

    Parameters
    ----------
    columns : dict of ndarray, shape (n,)
        As in :func:`levels_that_count`; errors are changed in place. [m]
    """
    east, north = columns["nse_e_m"], columns["nse_n_m"]
    half = np.isnan(east) != np.isnan(north)
    above = half & (np.fmax(np.abs(east), np.abs(north)) > columns["hpl_m"])
    for name, part in (("nse_e_m", east), ("nse_n_m", north)):
        columns[name] = np.where(above & np.isnan(part), 0.0, part)


def levels_that_count(columns: dict[str, NDArray[Any]], status: pl.Series, *, vertical: bool) -> NDArray[np.bool_]:
    """Leave out the levels of rows that have none, and return which rows are degraded and mislead.

    A row that is ``ok`` has the levels that it states. So has one that is ``degraded`` where its error is above one of them: whoever read
    that level was misled. A ``degraded`` row whose error is within its levels, or is not known, is not available and has none. The other
    statuses say that there is no level.

    Parameters
    ----------
    columns : dict of ndarray, shape (n,)
        ``nse_e_m nse_n_m nse_u_m hpl_m vpl_m``, NaN for what is not known; levels are changed in place. [m]
    status : Series
        Ids of :data:`navbound.status.STATUSES`.
    vertical : bool
        Whether one of the service levels limits the vertical: without a limit nobody is misled there.
    """
    above = np.hypot(columns["nse_e_m"], columns["nse_n_m"]) > columns["hpl_m"]
    if vertical:
        above |= np.abs(columns["nse_u_m"]) > columns["vpl_m"]
    misleading: NDArray[np.bool_] = (status == "degraded").to_numpy() & above & ~np.isnan(columns["hpl_m"])
    has = (status == "ok").to_numpy() | misleading
    for name in LEVELS:
        columns[name] = np.where(has, columns[name], np.nan)
    return misleading
