"""What the columns of a table state of the positions of its rows, over all pieces of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import polars as pl

from navbound import status
from navbound.read.columns.assign import kinds_within
from navbound.read.statements.texts import WORDS_SHOWN, Stated, alarming, alarms, stated_in
from navbound.read.tables.cells import no_field
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from navbound.read.columns.column import Assignment
    from navbound.read.statements.kinds import Effect


class Stating:
    """Reads columns of statements and keeps the words that are not understood."""

    def __init__(self, mapping: Assignment) -> None:
        self._mapping = mapping
        self._n_unknown = 0
        self._unknown_statuses: dict[str, None] = {}
        self._unknown: dict[str, dict[str, None]] = {}

    def of(self, frame: pl.DataFrame, within: pl.DataFrame) -> list[tuple[str, Effect, Stated]]:
        """Columns, what a word against a position in them does, and what they state: of the next rows, and of objects in their fields."""
        return [*self._in_columns(frame), *self._within(within)]

    def with_statuses(self, part: pl.DataFrame) -> pl.DataFrame:
        """What a recording says of its own epochs, in words of the list; words that are none of it are counted."""
        if "status" in part.columns:
            known = pl.col("status").str.to_lowercase().is_in(list(status.STATUSES)).fill_null(value=False)
            unknown = part.filter(~known)["status"]
            self._n_unknown += unknown.len()
            words = unknown.fill_null("empty").replace("", "empty").unique(maintain_order=True).head(WORDS_SHOWN)
            self._unknown_statuses |= dict.fromkeys(words)
        return status.recorded(part)

    def _in_columns(self, frame: pl.DataFrame) -> list[tuple[str, Effect, Stated]]:
        """What columns of validity and of alerts state."""
        stated = [(name, kind.effect, stated_in(kind, frame[name])) for name, kind in self._mapping.statements]
        kinds = frame.schema
        unused = [name for name in self._mapping.unused if kinds.get(name) in (pl.String, pl.List(pl.String))]
        # Words in a list are one text of several.
        texts = frame.select(pl.col(name).list.join("; ") if kinds[name] == pl.List(pl.String) else pl.col(name) for name in unused)
        stated += [(name, "alert", alarms(texts[name])) for name in alarming(texts)]
        read = {column.name for column in self._mapping.columns.values()}
        for name, _, each in stated:
            if name in read:
                continue
            self._unknown.setdefault(name, {}).update(dict.fromkeys(each.unknown))
        return stated

    def _within(self, within: pl.DataFrame) -> list[tuple[str, Effect, Stated]]:
        """What objects in fields state, key by key: no good word of one takes back an alarm of another."""
        kinds = kinds_within(name for name, dtype in within.schema.items() if not no_field(dtype))
        stated: list[tuple[str, Effect, Stated]] = [(name, kind.effect, stated_in(kind, within[name])) for name, kind in kinds.items()]
        texts = within.select(name for name, dtype in within.schema.items() if dtype == pl.String and name not in kinds)
        stated += [(name, "alert", alarms(texts[name])) for name in alarming(texts)]
        for name, _, each in stated:
            self._unknown.setdefault(name, {}).update(dict.fromkeys(word for word in each.unknown if word != "empty"))
        return stated

    def statuses(self) -> list[str]:
        """A note of statuses that are none, after all rows."""
        if not self._n_unknown:
            return []
        words = ", ".join(list(self._unknown_statuses)[:WORDS_SHOWN])
        return [
            f"{counted(self._n_unknown, 'epoch has', 'epochs have')} a status that is none of {', '.join(status.STATUSES)} ({words}); "
            f"{agreeing(self._n_unknown, 'it is', 'they are')} not judged"
        ]

    @property
    def unread(self) -> list[str]:
        """Columns, or words of columns, that speak of integrity by their name and are not understood."""
        words = {name: ", ".join(list(each)[:WORDS_SHOWN]) for name, each in self._unknown.items() if each}
        return [*(f"{name} ({each})" for name, each in words.items()), *self._mapping.unread]
