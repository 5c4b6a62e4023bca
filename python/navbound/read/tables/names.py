"""Who a row is of: names in one writing, and callsigns where nothing else names the aircraft."""

from __future__ import annotations

import polars as pl

from navbound.read.tables.table import LINE

_ADDRESS = r"^(?:0[xX])?([0-9A-Fa-f]{6})$"
"""An aircraft's address of 24 bits."""


def one_writing(quantity: str, text: pl.Series) -> pl.Series:
    """Names that differ in writing alone are one: addresses in small letters, callsigns in capitals without padding."""
    if quantity == "track":
        address = text.str.extract(_ADDRESS).str.to_lowercase()
        return pl.select(pl.coalesce(address, text)).to_series().alias(text.name)
    return text.str.strip_chars("_ ").str.to_uppercase() if quantity == "callsign" else text


class Callsigns:
    """Tracks by callsign, of the rows of a table in the order of the file; the rows come once to be timed and once to be read."""

    def __init__(self) -> None:
        self._last: str | None = None
        self._last_line = 0
        self._names = dict[str, None]()

    def as_tracks(self, part: pl.DataFrame) -> pl.DataFrame:
        """The next rows, with a track of their callsigns where no column names the aircraft: what one states is none of the next one's."""
        if "track" in part.columns or "callsign" not in part.columns or part.is_empty():
            return part
        before = None if part[LINE][0] <= self._last_line else self._last
        self._last_line = int(part[LINE][-1])
        named = part["callsign"].replace("", None)
        known = pl.concat([pl.Series("callsign", [before], pl.String), named]).fill_null(strategy="forward")[1:]
        if before is None:
            known = known.fill_null(strategy="backward")
        self._last = known[-1]
        self._names.update(dict.fromkeys(named.drop_nulls().unique(maintain_order=True)))
        return part.with_columns(known.alias("track"))

    def words(self, file: str) -> list[str]:
        """That tracks are callsigns, where there are several."""
        n = len(self._names)
        return [f"{file}: no column names the aircraft; each of {n} callsigns is a track of its own"] if n > 1 else []
