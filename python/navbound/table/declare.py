"""How a column is declared: its type and unit follow from its name; what the name does not say is stated."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from collections.abc import Iterable

    import polars as pl

Kind = Literal["text", "number", "count", "time", "flag"]
"""Type of the values; in Parquet: string, 64-bit float, 64-bit integer, 64-bit integer of nanoseconds, boolean."""

UNITS = {
    "m": "m",
    "m2": "m²",
    "s": "s",
    "ns": "ns",
    "rad": "rad",
    "mps": "m/s",
    "mps2": "m/s²",
    "radps": "rad/s",
    "hpa": "hPa",
    "dbhz": "dB-Hz",
    "1": "1",
    "text": "text",
}
"""Units as a name ends in them, and as people write them."""

STAGES = {
    "source": "the recording or the simulation",
    "path": "the path that the aircraft should follow",
    "solution": "the position, its covariance, and what formed them",
    "bound": "methods and protection levels",
    "judge": "what is stated of an epoch: errors, risks, status, state, alert",
    "summary": "what is stated of many epochs",
}
"""What adds a column, in the order of the flow."""


@dataclass(frozen=True)
class Drawn:
    """A line in a chart that the report draws from this declaration alone.

    Attributes
    ----------
    chart : str
        Title of the chart. Columns with the same title and unit are lines of one chart.
    label : str
        Name of the line.
    limit : bool
        Whether the line is a limit of the others.
    """

    chart: str
    label: str
    limit: bool = False


@dataclass(frozen=True)
class Column:
    """One column.

    Attributes
    ----------
    name : str
        Its name. ``<method>`` stands for a method's id with underscores, ``<i>`` for a number from 1.
    kind : str
        Type of its values.
    unit : str
        A key of `UNITS`.
    meaning : str
        What the value is, in Markdown.
    stage : str
        A key of `STAGES`.
    shown : bool or Drawn
        Whether a report carries the column. `Drawn`: it also draws it, without code for this column.
    """

    name: str
    kind: Kind
    unit: str
    meaning: str
    stage: str
    shown: bool | Drawn = False

    @property
    def plain(self) -> str:
        """The meaning without marks of Markdown."""
        return self.meaning.replace("`", "").replace("*", "")


@dataclass(frozen=True)
class Table:
    """The columns of one table. `id` is the mark of its place in docs/notation.md."""

    id: str
    columns: tuple[Column, ...]


def row(names: str, meaning: str, stage: str, *, kind: Kind | None = None, shown: bool | Drawn = False) -> tuple[Column, ...]:
    """Declare columns of one meaning, their names separated by spaces.

    The unit is that of the name's ending. The type follows from the name, except where `kind` states it: words are "text", a number whose
    name has no ending is "number".

    Raises
    ------
    ValueError
        A name without a unit and without a kind, or an unknown stage.
    """
    if stage not in STAGES:
        raise ValueError(f"{names}: stage {stage} is none of {', '.join(STAGES)}")
    return tuple(
        Column(name, of := kind or _kind(name), "text" if of == "text" else unit_of(name), meaning, stage, shown) for name in names.split()
    )


def unit_of(name: str) -> str:
    """Unit of a number by the ending of its name; "1" where there is none: probabilities, counts, ratios."""
    ending = name.rpartition("_")[2]
    return ending if "_" in name and ending in UNITS and not name.startswith(("p_", "n_")) else "1"


def _kind(name: str) -> Kind:
    if name.endswith("_ns"):
        return "time"
    if name.startswith("n_"):
        return "count"
    if name.startswith("p_") or unit_of(name) != "1":
        return "number"
    raise ValueError(f"{name} ends in no unit: state its kind")


def schema(columns: Iterable[Column]) -> pl.Schema:
    """Types of a table with these columns, as Polars and Parquet have them."""
    import polars as pl  # noqa: PLC0415  (the list of columns is read without tables too)

    types = {"text": pl.String, "number": pl.Float64, "count": pl.Int64, "time": pl.Int64, "flag": pl.Boolean}
    return pl.Schema({column.name: types[column.kind] for column in columns})
