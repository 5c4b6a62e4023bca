"""Rows that share an epoch of the even grid: the worst of them stands for it, so that no misleading information is left out."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from navbound.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from navbound.records.performance import Level

Columns = dict[str, "NDArray[Any]"]


class Slots:
    """Choice of the row that stands for each epoch of a grid.

    Parameters
    ----------
    origin_ns, period_ns : int
        First epoch of the grid and time between epochs. [ns]
    levels : sequence of Level
        Service levels to be judged.
    """

    def __init__(self, origin_ns: int, period_ns: int, levels: Sequence[Level]) -> None:
        self._origin_ns, self._period_ns, self._levels = origin_ns, period_ns, levels
        self._last: int | None = None
        self._misleading: set[int] = set()

    def worst(self, columns: Columns) -> Columns:
        """One row an epoch: the most levels hazardous, then misleading, then without a solution, then the largest error/level.

        Times that fall are returned as they are: the core refuses them.
        """
        time_ns = columns["time_ns"]
        slots = self._slots(time_ns)
        if not (np.diff(slots) == 0).any() or (np.diff(time_ns) < 0).any():
            return columns
        # The last key sorts first; of equal rows the later index sorts last, so that the index is turned round to keep the first.
        order = np.lexsort((-np.arange(len(slots)), *reversed(self._ranks(columns)), slots))
        last = np.flatnonzero(np.diff(slots[order], append=slots[order][-1] + 1))
        kept = order[last]
        return {name: np.ascontiguousarray(values[kept]) for name, values in columns.items()}

    def require_later(self, columns: Columns) -> None:
        """Remember a table that is added; refuse misleading information at epochs that earlier tables already fill.

        Raises
        ------
        InputError
            An epoch of an earlier table again, now with an error above the protection level, which the earlier one does not show.
        """
        slots = self._slots(columns["time_ns"])
        misleading = slots[self._ranks(columns)[1] > 0]
        if self._last is not None:
            unseen = [slot for slot in misleading[misleading <= self._last].tolist() if slot not in self._misleading]
            if unseen:
                domain = (
                    "tables that do not share an epoch, or agree about it: here an error is above the protection level, earlier it is not"
                )
                raise InputError("time_ns", self._origin_ns + unseen[0] * self._period_ns, "ns", domain)
        self._misleading.update(misleading.tolist())
        if slots.size:
            self._last = max(int(slots[-1]), self._last if self._last is not None else int(slots[-1]))

    def _slots(self, time_ns: NDArray[np.int64]) -> NDArray[np.int64]:
        """The nearest epoch of the grid, as the core rounds."""
        slots: NDArray[np.int64] = (time_ns - self._origin_ns + self._period_ns // 2) // self._period_ns
        return slots

    def _ranks(self, columns: Mapping[str, NDArray[Any]]) -> list[NDArray[Any]]:
        """How bad each row is, the gravest measure first; an unknown error or level is in none of them."""
        horizontal, vertical = np.hypot(columns["nse_e_m"], columns["nse_n_m"]), np.abs(columns["nse_u_m"])
        hpl, vpl = columns["hpl_m"], columns["vpl_m"]
        n_hazards, n_misleading_runs = np.zeros(len(hpl), np.int64), np.zeros(len(hpl), np.int64)
        ratio = np.nan_to_num(horizontal / hpl, nan=0.0)
        for each in self._levels:
            val_m = each.val_m
            limited = val_m is not None
            available = (hpl < each.hal_m) & ((vpl < val_m) if limited else True)
            n_hazards += available & ((horizontal > each.hal_m) | ((vertical > val_m) if limited else False))
            n_misleading_runs += ~np.isnan(hpl) & ((horizontal > hpl) | ((vertical > vpl) if limited else False))
            if limited:
                ratio = np.fmax(ratio, np.nan_to_num(vertical / vpl, nan=0.0))
        return [n_hazards, n_misleading_runs, np.isnan(hpl), ratio]
