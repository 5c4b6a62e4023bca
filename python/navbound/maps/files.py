"""The folder of a map: run.json, summary.json, map.parquet, map.nc, report.html."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

from navbound.errors import FormatError
from navbound.maps import netcdf
from navbound.records import maps as map_records
from navbound.records.maps import Map
from navbound.storage import folders

if TYPE_CHECKING:
    from contextlib import AbstractContextManager


RECORD, SUMMARY, POINTS, ARRAYS, REPORT = "run.json", "summary.json", "map.parquet", "map.nc", "report.html"


def own(out: str | Path | None) -> AbstractContextManager[folders.Writer | None]:
    """Make the folder of a map before the work; none where `out` is None.

    Raises
    ------
    FormatError
        The folder cannot be written, holds files that are not a map's, or another job writes in it.
    """
    return nullcontext() if out is None else folders.own(Path(out), {RECORD, SUMMARY, POINTS, ARRAYS, REPORT}, "a map's")


def write(made: Map, folder: folders.Writer | None) -> Map:
    """Write every record, the points as Parquet and NetCDF, and the report into a folder of :func:`own`; nothing where there is none."""
    if folder is None:
        return made
    from navbound.report.world import render  # noqa: PLC0415  (the report is only loaded when one is written)

    folder.text(RECORD, made.record.model_dump_json(indent=1))
    folder.text(SUMMARY, made.summary.model_dump_json(indent=1))
    folder.write(POINTS, lambda path: made.points.write_parquet(path, compression="zstd"))
    folder.write(ARRAYS, lambda path: path.write_bytes(netcdf.of_map(made.summary, made.points)))
    folder.write(REPORT, lambda path: render(made, path))
    return Map(made.summary, made.record, made.points, folder.folder)


def load(path: str | Path) -> Map:
    """Read a map back.

    Raises
    ------
    FormatError
        Not the folder of a map, a map that did not finish, or a file that is damaged or was changed.
    """
    import polars as pl  # noqa: PLC0415
    from pydantic import ValidationError  # noqa: PLC0415

    folder = Path(path)
    folders.require_whole(folder, (RECORD, SUMMARY, POINTS), "the folder of a map")
    try:
        summary = map_records.MapSummary.model_validate_json((folder / SUMMARY).read_bytes())
        record = map_records.MapRecord.model_validate_json((folder / RECORD).read_bytes())
        return Map(summary, record, pl.read_parquet(folder / POINTS), folder)
    except OSError as e:
        raise FormatError(folder, f"is not the folder of a map: {e}") from e
    except (ValidationError, pl.exceptions.PolarsError) as e:
        raise FormatError(folder, f"holds a damaged record: {e}") from e
