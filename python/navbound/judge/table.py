"""The judges of the tracks of an epoch table, at once or in pieces."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import _core
from navbound import status as status_list
from navbound.errors import InputError
from navbound.judge.settings import ALERTS
from navbound.methods import ERRORS_NEED, column_of
from navbound.rnp import Counters, events_table, track_index

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any

    from numpy.typing import NDArray

    from navbound.judge.settings import Settings

_COLUMNS = _core.judge_columns()
_STATUSES = list(status_list.STATUSES)
_RISKS = ("p_exceed_rnp", "p_exceed_2rnp")


def with_levels(epochs: pl.DataFrame) -> dict[str, bool]:
    """Every track of a table in the order of its first row, and whether it has a protection level (``hpl_m``) anywhere."""
    known = pl.col("hpl_m").cast(pl.Float64).is_not_nan().fill_null(value=False) if "hpl_m" in epochs.columns else pl.lit(value=False)
    tracks = epochs.group_by(pl.col("track").fill_null(""), maintain_order=True).agg(known.any().alias("has"))
    return dict(zip(tracks["track"].to_list(), tracks["has"].to_list(), strict=True))


class Judges:
    """One judge for each track of a table. The pieces of a table of any length give what the whole gives at once.

    Parameters
    ----------
    settings : Settings
        How they judge.
    tracks : mapping of str to bool
        Every track, and whether it has a protection level anywhere (:func:`with_levels`): every epoch of it whose status is ``ok`` should
        have one then.
    """

    def __init__(self, settings: Settings, tracks: Mapping[str, bool]) -> None:
        self.settings = settings
        self._names = tuple(tracks)
        self._with_levels = any(tracks.values())
        self._core = settings.plan.judges(list(tracks.values()))

    def judge(self, epochs: pl.DataFrame) -> pl.DataFrame:
        """Judge the next rows.

        Parameters
        ----------
        epochs : DataFrame
            Columns of docs/notation.md: ``track``, ``time_ns``, ``status``, and those that :meth:`navbound.judge.Judge.step` lists. [SI]

        Returns
        -------
        DataFrame
            With the errors that the columns allow, ``status``, ``reason_id`` and ``reason`` of epochs that cannot be judged, both bounds of
            every method, ``alert`` and, where the method bounds an error across the path, ``p_exceed_rnp``, ``p_exceed_2rnp``, ``state``
            and ``p_state_<i>``; ``integrity_compared_m`` where a track has a protection level. Null where there is no number. [m, 1]

        Raises
        ------
        InputError
            A missing column, a null time, a status that is none, or a track that was not named.
        """
        for name in ("track", "time_ns", "status"):
            if name not in epochs.columns:
                raise InputError("epochs", f"columns {', '.join(epochs.columns)}", domain=f"tables with {name}")
        if epochs["time_ns"].null_count():
            raise InputError("time_ns", "null", domain="times", index=epochs["time_ns"].is_null().arg_max())
        columns = {name: column_of(epochs, name) for name in _COLUMNS if name in epochs.columns}
        time_ns = np.ascontiguousarray(epochs["time_ns"].cast(pl.Int64).to_numpy())
        decided = self._core.judge(columns, time_ns, _status_codes(epochs), track_index(epochs, self._names))
        return self._with(epochs, decided)

    def _with(self, epochs: pl.DataFrame, decided: dict[str, Any]) -> pl.DataFrame:
        """The table with what was decided, in the order of its columns."""
        numbers: dict[str, NDArray[np.float64]] = decided["numbers"]
        errors = [name for name, needs in ERRORS_NEED.items() if needs <= set(epochs.columns)]
        across = self.settings.method.error_column == "tse_m" and "sigma_cross_m" in errors
        bounds = [name for m in (self.settings.method, *self.settings.beside) for name in (m.column, m.integrity_column)]
        states = [name for name in self.settings.columns if name.startswith("p_state_")] if across else []
        compared = ["integrity_compared_m"] if self._with_levels else []

        def series(names: list[str] | tuple[str, ...]) -> list[pl.Series]:
            return [pl.Series(name, numbers[name], nan_to_null=True) for name in names]

        judged = _with_status(epochs.with_columns(series(errors)), decided)
        judged = judged.with_columns(series([*bounds, *(_RISKS if across else ()), *compared]))
        judged = judged.with_columns(_words("alert", ALERTS, decided["alert"]))
        return judged.with_columns(_words("state", self.settings.state_names, decided["state"]), *series(states)) if states else judged

    def decided(self) -> tuple[pl.DataFrame, Counters, dict[str, Counters]]:
        """Events, counters of all tracks together and of each, of the rows so far."""
        rows, each, total = self._core.decided()
        counters = {name: Counters(**c) for name, c in zip(self._names, each, strict=True)}
        return events_table(list(self._names), rows), Counters(**total), counters


def _words(name: str, words: list[str], codes: NDArray[np.uint8]) -> pl.Series:
    """Words by their codes; null for a code beyond the list."""
    place = np.where(codes < len(words), codes, len(words)).astype(np.uint32)
    return pl.Series([*words, None], dtype=pl.String).gather(place).alias(name)


def _with_status(epochs: pl.DataFrame, decided: dict[str, Any]) -> pl.DataFrame:
    """An epoch that cannot be judged says why, unless its reader said so already."""
    code = decided["reason"]
    new = [pl.Series([None, *(r[k] for r in decided["reasons"])], dtype=pl.String).gather(code) for k in (0, 1)]
    there = pl.Series(code > 0)
    before = status_list.with_reason_id(epochs)
    declared = (
        pl.when(there).then(column).otherwise(pl.col(name)).alias(name) for name, column in zip(("reason_id", "reason"), new, strict=True)
    )
    return before.with_columns(_words("status", _STATUSES, decided["status"]), *declared)


def _status_codes(epochs: pl.DataFrame) -> NDArray[np.uint8]:
    status = epochs["status"].cast(pl.String)
    codes = status.replace_strict(_STATUSES, list(range(len(_STATUSES))), default=None, return_dtype=pl.UInt8)
    if codes.null_count():
        row = int(codes.is_null().arg_max() or 0)
        raise InputError("status", repr(status[row]), domain=", ".join(_STATUSES), index=row)
    return np.ascontiguousarray(codes.to_numpy())
