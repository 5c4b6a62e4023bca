"""Two finished runs beside each other: what `navbound compare` finds."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from navbound.records.base import Record


class ComparedRun(Record):
    """One of the two."""

    path: str
    title: str
    command: str
    created_utc: str
    navbound_version: str
    verdict: str
    """Id of the verdict."""
    words: str
    """The verdict in sentences."""
    n_epochs: int


class Differs(Record):
    """Something that was set, or read, otherwise."""

    what: str
    a: str | None
    b: str | None


class MovedNumber(Record):
    """A number of the records that is not the same."""

    group: str
    """Which part of the records, and of which track, phase or method."""
    name: str
    """The field."""
    a: float | None
    b: float | None
    difference: float | None
    """B minus A; none where one of them does not exist."""


class MovedColumn(Record):
    """A column of numbers that is not the same at every common epoch."""

    column: str
    unit: str
    n_moved: int
    """Common epochs with two numbers that differ."""
    n_only_a: int
    """Common epochs with a number in A alone."""
    n_only_b: int
    largest: float | None
    """The difference of the largest size, B minus A."""
    track: str | None
    """Where it is."""
    time_ns: int | None


class ChangedWords(Record):
    """Common epochs that follow each other, with one word in A and another in B."""

    column: Literal["alert", "status", "state", "nav_mode"]
    track: str
    a: str | None
    b: str | None
    start_ns: int
    end_ns: int
    n_epochs: int


class ChangedCount(Record):
    """Common epochs with one word in A and another in B, all together."""

    column: Literal["alert", "status", "state", "nav_mode"]
    a: str | None
    b: str | None
    n_epochs: int


class Comparison(Record):
    """Two runs, A before and B after."""

    schema_id: Literal["navbound-comparison-1"] = "navbound-comparison-1"
    a: ComparedRun
    b: ComparedRun
    words: list[str]
    """What is the same and what moved, in sentences."""
    same: bool
    """No number, no word and no epoch is another one."""
    n_common: int
    """Epochs of both, by track and time."""
    n_only_a: int
    n_only_b: int
    settings: list[Differs]
    numbers: list[MovedNumber]
    columns: list[MovedColumn]
    n_columns_same: int
    only_in_a: list[str] = Field(default_factory=list)
    """Columns that the other run has not."""
    only_in_b: list[str] = Field(default_factory=list)
    counts: list[ChangedCount]
    changes: list[ChangedWords]
    """The first of them in the order of tracks and times."""
    n_changes: int
    """All of them."""
