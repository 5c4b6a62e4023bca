"""The run directory: run.json, epochs.parquet, events.parquet, summary.json, report.html."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from navbound import _folder
from navbound.errors import FormatError

if TYPE_CHECKING:
    from contextlib import AbstractContextManager
    from pathlib import Path

    import polars as pl

    from navbound.run.records import RunRecord, Summary, Waypoint

RECORD = "run.json"
SUMMARY = "summary.json"
EPOCHS = "epochs.parquet"
EVENTS = "events.parquet"
REPORT = "report.html"


@dataclass(frozen=True)
class Run:
    """A finished run: its records, its epoch table and, once written, where it lies."""

    summary: Summary
    record: RunRecord
    epochs: pl.DataFrame
    events: pl.DataFrame
    waypoints: list[Waypoint]
    path: Path | None = None

    @property
    def report(self) -> Path:
        """The report of a run that was written.

        Raises
        ------
        FormatError
            The run was never written.
        """
        if self.path is None:
            raise FormatError("", "this run was not written to a directory; pass out=")
        return self.path / REPORT


def own(out: Path) -> AbstractContextManager[None]:
    """Make a run directory and write in it; one that holds something else is refused with a :class:`FormatError`."""
    return _folder.own(out, {RECORD, SUMMARY, EPOCHS, EVENTS, REPORT}, "a run's")


def write(run: Run, out: Path) -> Run:
    """Write every record and the report; a directory that holds something else is refused.

    Raises
    ------
    FormatError
        The directory cannot be written, or holds files that are not a run's.
    """
    from navbound.report import render  # noqa: PLC0415  (the report is only loaded when one is written)

    with own(out):
        (out / RECORD).write_text(run.record.model_dump_json(indent=1), encoding="utf-8")
        (out / SUMMARY).write_text(run.summary.model_dump_json(indent=1), encoding="utf-8")
        run.epochs.write_parquet(out / EPOCHS, compression="zstd")
        run.events.write_parquet(out / EVENTS, compression="zstd")
        render(run.summary, run.record, run.epochs, run.events, run.waypoints, out / REPORT)
    return Run(run.summary, run.record, run.epochs, run.events, run.waypoints, out)


def load(path: Path) -> Run:
    """Read a run directory back.

    Raises
    ------
    FormatError
        Not a run directory, or one of its files is damaged.
    """
    import polars as pl  # noqa: PLC0415
    from pydantic import ValidationError  # noqa: PLC0415

    from navbound.run.records import RunRecord, Summary  # noqa: PLC0415

    try:
        summary = Summary.model_validate_json((path / SUMMARY).read_bytes())
        record = RunRecord.model_validate_json((path / RECORD).read_bytes())
        epochs, events = pl.read_parquet(path / EPOCHS), pl.read_parquet(path / EVENTS)
    except OSError as e:
        raise FormatError(path, f"is not a run directory: {e}") from e
    except (ValidationError, pl.exceptions.PolarsError) as e:
        raise FormatError(path, f"holds a damaged record: {e}") from e
    return Run(summary, record, epochs, events, [], path)
