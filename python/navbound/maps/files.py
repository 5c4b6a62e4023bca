"""The folder of a map: run.json, summary.json, map.parquet, map.nc, report.html."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from navbound import _folder
from navbound.errors import FormatError
from navbound.maps import netcdf, records

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    import polars as pl

RECORD, SUMMARY, POINTS, ARRAYS, REPORT = "run.json", "summary.json", "map.parquet", "map.nc", "report.html"


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

    summary: records.MapSummary
    record: records.MapRecord
    points: pl.DataFrame
    path: Path | None = None


def own(out: Path) -> AbstractContextManager[None]:
    """Make the folder of a map and write in it; one that holds something else is refused with a :class:`FormatError`."""
    return _folder.own(out, {RECORD, SUMMARY, POINTS, ARRAYS, REPORT}, "a map's")


def write(made: Map, out: Path) -> Map:
    """Write every record, the points as Parquet and NetCDF, and the report; a folder that holds something else is refused.

    Raises
    ------
    FormatError
        The folder cannot be written, or holds files that are not a map's.
    """
    from navbound.report.world import render  # noqa: PLC0415  (the report is only loaded when one is written)

    with own(out):
        (out / RECORD).write_text(made.record.model_dump_json(indent=1), encoding="utf-8")
        (out / SUMMARY).write_text(made.summary.model_dump_json(indent=1), encoding="utf-8")
        made.points.write_parquet(out / POINTS, compression="zstd")
        (out / ARRAYS).write_bytes(netcdf.of_map(made.summary, made.points))
        render(made, out / REPORT)
    return Map(made.summary, made.record, made.points, out)


def load(path: str | Path) -> Map:
    """Read a map back.

    Raises
    ------
    FormatError
        Not the folder of a map, or one of its files is damaged.
    """
    import polars as pl  # noqa: PLC0415
    from pydantic import ValidationError  # noqa: PLC0415

    folder = Path(path)
    try:
        summary = records.MapSummary.model_validate_json((folder / SUMMARY).read_bytes())
        record = records.MapRecord.model_validate_json((folder / RECORD).read_bytes())
        return Map(summary, record, pl.read_parquet(folder / POINTS), folder)
    except OSError as e:
        raise FormatError(folder, f"is not the folder of a map: {e}") from e
    except (ValidationError, pl.exceptions.PolarsError) as e:
        raise FormatError(folder, f"holds a damaged record: {e}") from e
