"""Statuses and reasons of epochs: ids to decide by, and the sentences that people read. Read from the core; nothing is listed twice.

A table carries ``status`` and ``reason_id``. Its ``reason`` is a sentence for people: nothing compares, groups by or parses it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, cast

import numpy as np
import polars as pl

from navbound import _core
from navbound.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

StatusId = Literal["ok", "degraded", "not_available", "invalid_input"]


@dataclass(frozen=True)
class Reason:
    """One entry of the core's list.

    Attributes
    ----------
    id : str
        What tables carry and decisions use; it never changes.
    status : str
        What the reason makes of an epoch's position. ``ok`` means that the position stands and only its level does not exist.
    words : str
        One English sentence, for people.
    """

    id: str
    status: StatusId
    words: str


STATUSES: dict[str, str] = {status: words for status, _, words in _core.statuses()}
"""Every status in words."""

USABLE: tuple[str, ...] = tuple(status for status, usable, _ in _core.statuses() if usable)
"""Statuses of epochs whose position may be used."""

UNUSABLE: tuple[str, ...] = tuple(status for status, usable, _ in _core.statuses() if not usable)

REASONS: dict[str, Reason] = {id_: Reason(id_, cast("StatusId", status), words) for id_, status, words in _core.reasons()}
"""Every reason by its id."""


def reason(reason_id: str) -> Reason:
    """One reason.

    Raises
    ------
    InputError
        No such id.
    """
    if reason_id not in REASONS:
        raise InputError("reason_id", reason_id, domain=f"one of {', '.join(REASONS)}")
    return REASONS[reason_id]


def words(reason_id: pl.Expr) -> pl.Expr:
    """The sentences of a column of ids; null where there is no reason."""
    return reason_id.replace_strict({id_: entry.words for id_, entry in REASONS.items()}, default=None, return_dtype=pl.String)


def status_of(reason_id: pl.Expr) -> pl.Expr:
    """The statuses that a column of ids makes; ``ok`` where there is no reason."""
    table = {id_: entry.status for id_, entry in REASONS.items()}
    return reason_id.replace_strict(table, default="ok", return_dtype=pl.String)


def reasons_of(states: dict[str, Any], shape: tuple[int, ...]) -> tuple[NDArray[np.str_], NDArray[np.str_]]:
    """Sentences and ids of results of the core, taken out of them."""
    sentences, ids = (np.array(states.pop(name), dtype=np.str_).reshape(shape) for name in ("reason", "reason_id"))
    return sentences, ids


def statuses(reason_id: NDArray[np.str_]) -> NDArray[np.str_]:
    """The statuses that ids make; ``ok`` where there is no reason."""
    return _each(reason_id, {"": "ok", **{id_: entry.status for id_, entry in REASONS.items()}})


def sentences(reason_id: NDArray[np.str_]) -> NDArray[np.str_]:
    """The sentences of ids; empty where there is no reason."""
    return _each(reason_id, {"": "", **{id_: entry.words for id_, entry in REASONS.items()}})


def _each(reason_id: NDArray[np.str_], table: dict[str, str]) -> NDArray[np.str_]:
    names, place = np.unique(reason_id, return_inverse=True)
    return np.array([table[str(name)] for name in names], dtype=np.str_)[place].reshape(reason_id.shape)


def availability(reason_id: NDArray[np.str_]) -> NDArray[np.str_]:
    """The status of results that exist, or do not for a reason."""
    return np.where(reason_id == "", "ok", "not_available")


COLUMNS = ("status", "reason_id", "reason")
"""What an epoch table says of each epoch."""


def with_reason(epochs: pl.DataFrame, reason_id: pl.Series) -> pl.DataFrame:
    """An epoch table with the status, the id and the sentence of a reason each; null where there is none."""
    ids = epochs.with_columns(reason_id.alias("reason_id"))
    return ids.with_columns(status_of(pl.col("reason_id")).alias("status"), words(pl.col("reason_id")).alias("reason"))


def overridden(epochs: pl.DataFrame, reason_id: pl.Series, sentence: pl.Series | None = None) -> pl.DataFrame:
    """An epoch table that says a new reason where there is one, in a sentence of its own or that of the list; elsewhere what it said."""
    new = with_reason(epochs.select("status"), reason_id)
    if sentence is not None:
        new = new.with_columns(pl.coalesce(sentence, pl.col("reason")).alias("reason"))
    there = reason_id.is_not_null()
    before = with_reason_id(epochs)
    return before.with_columns(pl.when(there).then(new[c]).otherwise(pl.col(c)).alias(c) for c in COLUMNS)


def worse(one: pl.Expr, other: pl.Expr) -> pl.Expr:
    """The graver of two statuses of each epoch, in the order of the core's list; null where either is none of them."""
    place = [each.replace_strict({id_: k for k, id_ in enumerate(STATUSES)}, default=None, return_dtype=pl.Int64) for each in (one, other)]
    return pl.when(place[0] >= place[1]).then(one).when(place[0] < place[1]).then(other)


def recorded(epochs: pl.DataFrame) -> pl.DataFrame:
    """An epoch table whose recorded ``status`` and ``reason_id`` are those of the list, where it has such columns.

    The graver of the recorded status and that of the recorded reason counts. What the list does not know, and an empty status, is no
    ``ok``: the epoch becomes ``not_available`` for the reason ``reported``.
    """
    if not {"status", "reason_id"} & set(epochs.columns):
        return epochs
    stated, named = (_text(c) if c in epochs.columns else pl.lit(None, pl.String) for c in COLUMNS[:2])
    named = pl.when(named != "").then(named)
    by_reason = (
        pl.when(named.is_null())
        .then(pl.lit("ok"))
        .otherwise(named.replace_strict({id_: entry.status for id_, entry in REASONS.items()}, default=None, return_dtype=pl.String))
    )
    worst = epochs.select(status=worse(stated if "status" in epochs.columns else pl.lit("ok"), by_reason), reason_id=named)
    unknown = pl.col("status").is_null() | ((pl.col("status") != "ok") & pl.col("reason_id").is_null())
    return epochs.with_columns(
        worst.select(
            pl.col("status").fill_null(reason("reported").status),
            pl.when(unknown).then(pl.lit("reported")).otherwise("reason_id").alias("reason_id"),
        )
    )


def _text(name: str) -> pl.Expr:
    return pl.col(name).str.strip_chars().str.to_lowercase()


def with_reason_id(epochs: pl.DataFrame) -> pl.DataFrame:
    """An epoch table whose ``reason_id`` exists: a sentence without an id is ``reported``."""
    declared = pl.col("reason_id") if "reason_id" in epochs.columns else pl.lit(None, pl.String)
    if "reason" in epochs.columns:
        stated = pl.col("reason").is_not_null() & (pl.col("reason").str.len_chars() > 0)
        declared = pl.when(stated & declared.is_null()).then(pl.lit("reported")).otherwise(declared)
    sentence = [] if "reason" in epochs.columns else [pl.lit(None, pl.String).alias("reason")]
    return epochs.with_columns(declared.alias("reason_id"), *sentence)
