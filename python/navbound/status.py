"""Statuses and reasons of epochs: ids to decide by, and the sentences that people read. Read from the core; nothing is listed twice.

A table carries ``status`` and ``reason_id``. Its ``reason`` is a sentence for people: nothing compares, groups by or parses it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, cast

import polars as pl

from navbound import _core
from navbound.errors import InputError

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


def with_reason_id(epochs: pl.DataFrame) -> pl.DataFrame:
    """An epoch table whose ``reason_id`` exists: a sentence without an id is ``reported``."""
    given = pl.col("reason_id") if "reason_id" in epochs.columns else pl.lit(None, pl.String)
    if "reason" in epochs.columns:
        stated = pl.col("reason").is_not_null() & (pl.col("reason").str.len_chars() > 0)
        given = pl.when(stated & given.is_null()).then(pl.lit("reported")).otherwise(given)
    return epochs.with_columns(given.alias("reason_id"))
