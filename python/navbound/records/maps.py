"""What a map leaves behind: summary.json and run.json."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from navbound.records.base import Record

if TYPE_CHECKING:
    from pathlib import Path

    import polars as pl


class MapColumn(Record):
    """A column of the map."""

    name: str
    title: str
    unit: Literal["1", "m"]
    typical: dict[str, float | None]
    """By percentile of the day: the number that half of the area is within; None where there is none on half of it."""


class MapLimit(Record):
    """What was required of a column."""

    column: str
    limit: float
    source: str
    provenance: str


class MapCoverage(Record):
    """Share of the area where the limits are met for at least a share of the time."""

    available: float
    """Share of the time required."""
    share: float
    """Share of the area, cells weighted by the cosine of their latitude."""


class MapOutcome(Record):
    """What became of users and instants: within the limits, beyond them, or without a number for one cause."""

    name: str
    """The column that holds its share of the instants at each point; ``beyond`` is what the others leave."""
    title: str
    share: float
    """Share of time and area; all outcomes make 1."""


class MapGrid(Record):
    """Cells of the map; the columns of map.parquet go row after row from the south-west."""

    step_rad: float
    south_rad: float
    north_rad: float
    west_rad: float
    east_rad: float
    n_lat: int
    n_lon: int


class MapWorst(Record):
    """The first point with the smallest availability."""

    lat_rad: float
    lon_rad: float
    available: float
    share: float
    """Share of the area that has no more."""


class MapSummary(Record):
    """summary.json of a map."""

    schema_id: Literal["navbound-map-1"] = "navbound-map-1"
    kind: str
    title: str
    words: str
    """What was found, as sentences."""
    source: str
    grid: MapGrid
    n_epochs: int
    percentiles: list[float]
    columns: list[MapColumn]
    limits: list[MapLimit]
    coverage: list[MapCoverage]
    available_mean: float
    """Share of time and area within the limits."""
    outcomes: list[MapOutcome]
    worst: MapWorst
    assumptions: list[str]


class MapRecord(Record):
    """run.json of a map: what it takes to do it again."""

    navbound_version: str
    command: str
    created_utc: str
    kind: str
    options: dict[str, str]
    inputs: dict[str, str]
    """Files by digest (SHA-256)."""
    backend: str
    n_tiles: int
    platform: str


@dataclass(frozen=True)
class Map:
    """A finished map.

    Attributes
    ----------
    summary, record : MapSummary, MapRecord
        What was found, and what it takes to do it again.
    points : DataFrame
        One row a grid point, columns of docs/notation.md, section "Maps".
    path : Path or None
        Where it lies, once written.
    """

    summary: MapSummary
    record: MapRecord
    points: pl.DataFrame
    path: Path | None = None
