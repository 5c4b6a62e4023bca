"""The run directory: run.json, epochs.parquet, events.parquet, summary.json, report.html."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from navbound.errors import FormatError
from navbound.storage import folders
from navbound.table import lookup
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    import polars as pl

    from navbound.read.pieces import Frames
    from navbound.records.run import RunRecord, Summary, Waypoint

RECORD = "run.json"
SUMMARY = "summary.json"
EPOCHS = "epochs.parquet"
EVENTS = "events.parquet"
REPORT = "report.html"
SATELLITES = "satellites.parquet"
"""Only where positions were solved."""


@dataclass(frozen=True, repr=False)
class Run:
    """A finished run: its records, its epoch table and, once written, where it lies. A large table is in pieces on the disk."""

    summary: Summary
    record: RunRecord
    table: pl.DataFrame | Frames
    events: pl.DataFrame
    waypoints: list[Waypoint]
    path: Path | None = None
    satellites: pl.DataFrame | None = None

    @property
    def epochs(self) -> pl.DataFrame:
        """The epoch table, in memory."""
        from navbound.read.pieces import Frames  # noqa: PLC0415

        return self.table.frame() if isinstance(self.table, Frames) else self.table

    def __repr__(self) -> str:
        """What it is, in a line."""
        verdict = self.summary.verdict
        where = "" if self.path is None else f", in {self.path}"
        return f"<Run: {self.summary.title}; {verdict.id.replace('_', ' ')}; {counted(self.table.height, 'epoch')}{where}>"

    def _repr_html_(self) -> str:
        """For notebooks: the verdict, and where the report is."""
        verdict = self.summary.verdict
        rows = [("epochs", str(self.table.height)), *((name, str(n)) for name, n in self.summary.n_status.items())]
        cells = "".join(f"<tr><td>{escape(name)}</td><td>{escape(n)}</td></tr>" for name, n in rows)
        report = "" if self.path is None else f"<p>Report: <code>{escape(str(self.path / REPORT))}</code></p>"
        first, *beside = verdict.sentences
        why = "".join(f"<li>{escape(sentence)}</li>" for sentence in beside)
        return f"<p><b>{escape(self.summary.title)}</b></p><p>{escape(first)}</p><ul>{why}</ul><table>{cells}</table>{report}"

    def save(self, out: str | Path) -> Run:
        """Write the run, with its report, to a folder of its own.

        Raises
        ------
        FormatError
            The folder cannot be written, or holds files that are not a run's.
        """
        with own(out) as folder:
            return write(self, folder)

    def show(self) -> Path:
        """Open the report in the browser of this machine; where it lies.

        Raises
        ------
        FormatError
            The run was never written.
        """
        import webbrowser  # noqa: PLC0415 - only where one is opened

        report = self.report
        webbrowser.open(report.resolve().as_uri())
        return report

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


def own(out: str | Path | None) -> AbstractContextManager[folders.Writer | None]:
    """Make a run directory before the work; none where `out` is None.

    Raises
    ------
    FormatError
        The directory cannot be written, holds files that are not a run's, or another job writes in it.
    """
    return nullcontext() if out is None else folders.own(Path(out), {RECORD, SUMMARY, EPOCHS, EVENTS, REPORT, SATELLITES}, "a run's")


def write(run: Run, folder: folders.Writer | None) -> Run:
    """Write every record and the report into a directory of :func:`own`; nothing where there is none."""
    if folder is None:
        return run
    from navbound.report import render  # noqa: PLC0415  (the report is only loaded when one is written)

    folder.text(RECORD, run.record.model_dump_json(indent=1))
    folder.text(SUMMARY, run.summary.model_dump_json(indent=1))
    units = lookup.metadata(run.table.columns, run.record.methods)
    folder.write(EPOCHS, lambda path: run.table.write_parquet(path, compression="zstd", metadata=units))
    folder.write(EVENTS, lambda path: run.events.write_parquet(path, compression="zstd"))
    heard = run.satellites
    if heard is not None:
        folder.write(SATELLITES, lambda path: heard.write_parquet(path, compression="zstd"))
    folder.write(REPORT, lambda path: render(run.summary, run.record, run.table, run.events, run.waypoints, path, satellites=heard))
    return replace(run, path=folder.folder)


def load(path: Path) -> Run:
    """Read a run directory back.

    Raises
    ------
    FormatError
        Not a run directory, a run that did not finish, or a file that is damaged or was changed.
    """
    import polars as pl  # noqa: PLC0415
    from pydantic import ValidationError  # noqa: PLC0415

    from navbound.records.run import RunRecord, Summary  # noqa: PLC0415

    folders.require_whole(path, (RECORD, SUMMARY, EPOCHS, EVENTS), "a run directory")
    try:
        summary = Summary.model_validate_json((path / SUMMARY).read_bytes())
        record = RunRecord.model_validate_json((path / RECORD).read_bytes())
        epochs, events = pl.read_parquet(path / EPOCHS), pl.read_parquet(path / EVENTS)
        satellites = pl.read_parquet(path / SATELLITES) if (path / SATELLITES).is_file() else None
    except OSError as e:
        raise FormatError(path, f"is not a run directory: {e}") from e
    except (ValidationError, pl.exceptions.PolarsError) as e:
        raise FormatError(path, f"holds a damaged record: {e}") from e
    return Run(summary, record, epochs, events, [], path, satellites)
