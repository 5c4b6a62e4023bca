"""A performance run: any number of files, one part each, remembered in the run directory so that an interrupted run goes on."""

from __future__ import annotations

import platform
import sys
import tempfile
from contextlib import ExitStack
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

import polars as pl

from navbound import __version__, kpi
from navbound.errors import ConflictError, InputError
from navbound.read.source import load
from navbound.read.truth import TOLERANCE_S, Truth, truth_of
from navbound.records.run import CovarianceConsistency, InputFile, Rejection, RunRecord, Summary, Verdict
from navbound.records.verdict import LEAST_SHARE
from navbound.run import directory
from navbound.run.directory import Run
from navbound.run.evaluate import sky
from navbound.run.evaluate.monitored import CONTRADICTED, DECLARED_LEVELS, monitor_of, monitored
from navbound.run.evaluate.parts import Stored, finished_parts, heard_of_parts, ranges_of_parts, tables_of
from navbound.run.evaluate.service import service_of_files
from navbound.run.evaluate.words import levels_verdict, performance_words
from navbound.run.inputs.files import sort_out
from navbound.run.inputs.solving import Solving
from navbound.run.summary.consistency import consistency_of
from navbound.run.summary.satellites import satellites_of
from navbound.run.verdict import rule
from navbound.run.verdict.belief import copied, of_level
from navbound.run.verdict.results import beside_words, unread_words
from navbound.run.verdict.words import COPIED
from navbound.storage import folders
from navbound.table.columns import COVARIANCE
from navbound.words.plurals import counted
from navbound.write.field_csv import write_csv

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from navbound.records.performance import LevelResult, Performance, ServiceLog
    from navbound.run.inputs.files import Files

PARTS = "parts"
"""Folder of the run directory that remembers the finished parts."""
MOST_CONSISTENCY = 1_000_000
"""Epochs whose covariances are compared with their errors: eleven days at 1 Hz, 100 MB."""
CSV = "epochs.csv"
"""The epochs under the field's column names."""
_OWN = {directory.RECORD, directory.SUMMARY, directory.EPOCHS, directory.EVENTS, directory.REPORT, directory.SATELLITES, PARTS, CSV}


@dataclass(frozen=True)
class Options:
    """What changes the numbers.

    Attributes
    ----------
    levels : sequence of names or Level
        What is evaluated.
    truth : str or path, optional
        ``LAT,LON,H`` (degrees, metres above the WGS-84 ellipsoid), ``X,Y,Z`` (Earth-fixed, metres) or a recording.
    truth_tolerance_s : float
        How far apart in time an estimate and its truth may lie. [s]
    columns : mapping, optional
        What a column is, where its name does not say.
    prn : int, optional
        Which geostationary satellite's messages.
    period_s : float, optional
        Nominal sampling period. [s]
    exclude_missing : bool
        Absent epochs are not expected.
    stanford_esa : SubsetOptions, optional
        Solve every subset of satellites too, for the Stanford-ESA diagram; observations and truth are needed.
    experimental : str
        Words that must stand beside levels that no integrity rests on, where the files do not say so themselves.
    solve : bool
        Take the raw measurements and messages of receivers' logs, not their own positions and levels.
    protection : str
        What protection levels of observations come from: ``given`` (the files), ``raim``, ``araim`` (LPV-200 budgets) or
        ``araim-horizontal``.
    signals, systems, ionosphere : str, optional
        How measurements without a service are solved, see :func:`navbound.gnss.solve`; ``single``, ``G`` and ``auto`` where not named. A
        monitor on board takes signals and systems; its own are those of :func:`navbound.raim.watch` and :func:`navbound.araim.watch`.
    mask_rad : float, optional
        Lowest elevation of the satellites that they are solved from; :data:`navbound.gnss.MASK_RAD` where it is not named. [rad]
    """

    levels: Sequence[str | kpi.Level]
    truth: str | Path | None = None
    truth_tolerance_s: float = TOLERANCE_S
    columns: Mapping[str, str] | None = None
    prn: int | None = None
    period_s: float | None = None
    exclude_missing: bool = False
    stanford_esa: kpi.SubsetOptions | None = None
    experimental: str = ""
    solve: bool = False
    protection: str = DECLARED_LEVELS
    signals: str | None = None
    systems: str | None = None
    ionosphere: str | None = None
    mask_rad: float | None = None

    @property
    def solving(self) -> Solving:
        """How measurements are solved."""
        return Solving(self.signals, self.systems, self.ionosphere, self.mask_rad)


def evaluate_files(
    files: str | Path | Sequence[str | Path],
    options: Options,
    *,
    out: str | Path | None = None,
    command: str = "",
    progress: Callable[[int, int], None] | None = None,
) -> Run:
    """Evaluate the indicators of one receiver over any number of files.

    Parameters
    ----------
    files : path or sequence of paths
        Tables with protection levels (CSV, JSON, Parquet, RTKLIB solutions), in any order; or RINEX observations with navigation files and
        SBAS message logs.
    options : Options
        What changes the numbers.
    out : path, optional
        Run directory. Parts that it remembers are not computed again, so a run that was interrupted goes on.
    command : str
        For the run record.
    progress : callable, optional
        Called with (done, all) parts.

    Returns
    -------
    Run
        With ``out`` the epochs stay on the disk (``epochs.parquet``) and the run's table holds the first alone; without, it holds all.

    Raises
    ------
    InputError, FormatError
        As the readers; a directory that holds something else.
    """
    names = [files] if isinstance(files, (str, Path)) else list(files)
    if not names:
        raise InputError("files", "nothing", domain="one file or more")
    levels = [kpi.level(each) if isinstance(each, kpi.Level) else each for each in options.levels]
    truth = truth_of(options.truth, options.truth_tolerance_s, options.columns)
    if monitor_of(options.protection) is not None and options.stanford_esa is not None:
        raise ConflictError("protection", excludes=("stanford_esa",), because="subsets of satellites are solved without monitoring")
    sources = sort_out(names, solve=options.solve)
    if monitor_of(options.protection) is not None:
        monitored(options.solving)
    if not sources.observations or sources.messages:
        options.solving.refuse("only observations that no service corrects are solved")
    sources.require_navigation()
    if options.stanford_esa is not None and (sources.tables or sources.messages):
        because = "a table holds no ranges" if sources.tables else "subsets are solved without the corrections of SBAS messages"
        named = str((sources.tables or sources.messages)[0].path)
        raise ConflictError("stanford_esa", because=f"{because} ({named}); observations and navigation data are enough", value=named)
    with ExitStack() as stack:
        writer = None if out is None else stack.enter_context(folders.own(Path(out), _OWN, "an evaluation's"))
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory())) if writer is None else writer.folder
        parts = finished_parts(sources, options, truth, folder / PARTS, progress)
        campaign, events = _add_all(parts, levels, options)
        result = campaign.finish(lambda: tables_of(parts), events.append)
        if options.stanford_esa is not None:
            ranges = kpi.stanford_esa(lambda: ranges_of_parts(parts), campaign.levels, options.stanford_esa)
            result = kpi.with_subsets(result, ranges)
        log = _service(sources, options, result)
        words = sources.cut_words() + ([] if log is None else log.words)
        result = result.model_copy(update={"notes": [*result.notes, *words], "service": log})
        run = _run(result, parts, events, inputs=_inputs(sources, truth, parts), options=options, command=command)
        if writer is None:
            return replace(run, table=pl.concat(tables_of(parts)))
        return _write(run, parts, writer)


def _service(sources: Files, options: Options, result: Performance) -> ServiceLog | None:
    """What the messages were that corrected the positions; none where a monitor on board made the levels."""
    if not sources.messages or not sources.observations or monitor_of(options.protection) is not None:
        return None
    return service_of_files([source.path for source in sources.messages], options.prn, result.first_ns, result.last_ns)


def _experimental(parts: list[Stored], options: Options) -> str:
    """What must stand beside the levels: one experimental part marks the whole."""
    return next((words for words in (options.experimental, *(part.experimental for part in parts)) if words), "")


def _add_all(parts: list[Stored], levels: Sequence[str | kpi.Level], options: Options) -> tuple[kpi.Campaign, list[pl.DataFrame]]:
    tables = tables_of(parts)
    first = next(tables)
    campaign = kpi.Campaign(
        levels,
        first=first,
        period_s=options.period_s,
        exclude_missing=options.exclude_missing,
        title=_title(parts),
        experimental=_experimental(parts, options),
    )
    events = [campaign.add(first)]
    events.extend(campaign.add(table) for table in tables)
    return campaign, events


def _title(parts: list[Stored]) -> str:
    names = [part.source.path.name for part in parts]
    return ", ".join(names) if len(names) <= 3 else f"{names[0]} and {counted(len(names) - 1, 'more file')}"


def _inputs(sources: Files, truth: Truth, parts: list[Stored]) -> list[InputFile]:
    """Every file that went in, a recorded truth among them."""
    n_rows = {part.source.path: part.n_rows for part in parts}
    files = sources.tables + sources.observations + sources.navigation + sources.messages
    recorded = [load(truth.stated)] if truth.stated is not None and truth.ecef_m is None else []
    return [source.record(n_rows.get(source.path)) for source in files + recorded]


def _run(
    result: Performance, parts: list[Stored], events: list[pl.DataFrame], *, inputs: list[InputFile], options: Options, command: str
) -> Run:
    notes = list(dict.fromkeys(note for part in parts for note in part.notes))
    result = result.model_copy(update={"notes": [*result.notes, *notes]})
    record = RunRecord(
        navbound_version=__version__,
        command=command,
        created_utc=datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ"),
        kind="analyze",
        scenario=None,
        seed=None,
        inputs=inputs,
        methods=[],
        risk_accuracy=None,
        risk_integrity=None,
        settings={
            "levels": [each.level.id for each in result.levels],
            "truth": None if options.truth is None else str(options.truth),
            "truth_tolerance_s": options.truth_tolerance_s,
            "columns": dict(options.columns or {}),
            "prn": options.prn,
            "protection": options.protection,
            "period_s": result.period_s,
            "exclude_missing": options.exclude_missing,
            "stanford_esa": None if options.stanford_esa is None else asdict(options.stanford_esa),
            "experimental": result.experimental,
        },
        platform=f"Python {platform.python_version()}, {sys.platform} {platform.machine()}",
    )
    joined = pl.concat(events).sort("onset_ns", "level", "kind", maintain_order=True)
    first = next(tables_of(parts)).head(1)
    honesty, notes = _consistency(parts)
    heard, words = sky.together(heard_of_parts(parts))
    summary = _summary(result.model_copy(update={"notes": [*result.notes, *notes, *words]}), parts, honesty)
    summary = summary.model_copy(update={"satellites": satellites_of(heard)})
    return Run(summary, record, first, joined, [], satellites=heard)


def _consistency(parts: list[Stored]) -> tuple[CovarianceConsistency | None, list[str]]:
    """Whether the covariances agree with the errors, where the files hold both; of the first epochs, so that memory has a limit."""
    columns = ["track", "time_ns", "status", "nse_e_m", "nse_n_m", "nse_u_m", *COVARIANCE]
    kept: list[pl.DataFrame] = []
    for table in tables_of(parts):
        known = table.select(columns).drop_nulls(["nse_e_m", "cov_ee_m2"])
        kept.append(known.with_columns(pl.col("status").fill_null("ok")))
        if sum(part.height for part in kept) > MOST_CONSISTENCY:
            break
    together = pl.concat(kept)
    note = (
        f"The covariances were compared with the errors at the first {MOST_CONSISTENCY} epochs."
        if together.height > MOST_CONSISTENCY
        else ""
    )
    return consistency_of(together.head(MOST_CONSISTENCY)), [note] if note else []


def _summary(result: Performance, parts: list[Stored], honesty: CovarianceConsistency | None) -> Summary:
    names = ", ".join(each.level.id for each in result.levels)
    is_copied = _copied(parts)
    n_worse = sum(part.n_stated_worse for part in parts)
    unread = list(dict.fromkeys(each for part in parts for each in part.unread))
    # Levels whose error model the residuals contradict show nothing.
    doubts = [doubt for part in parts for doubt in part.position_doubts]
    doubted = is_copied or n_worse > 0 or bool(doubts) or result.experimental == CONTRADICTED
    decided = rule.of_levels([_facts(each, result, doubted=doubted) for each in result.levels])
    sentences = [
        *levels_verdict(decided, result),
        *([COPIED] if is_copied else []),
        *(f"{doubt}." for doubt in doubts),
        *beside_words(n_worse, unread),
        *performance_words(result),
        *unread_words(unread),
    ]
    verdict = Verdict(
        id=decided,
        # A service level is no RNP: what its id says stands in the words.
        inside=None,
        words="",
        requirement=names,
        method="performance",
        share_inside=None,
        share_contained=None,
        n_epochs=result.n_expected,
        n_judged=result.n_solution,
        n_unjudged=result.n_expected - result.n_solution,
        n_missing=result.n_missing,
        n_implausible=0,
        n_stated_worse=n_worse,
        position_doubts=doubts,
        unread=unread,
        worst_accuracy=None,
        worst_integrity=None,
        truth_known=result.truth_known,
        experimental=result.experimental != "",
    ).stating(sentences, [])
    by_source: dict[str, list[str]] = {}
    for each in result.levels:
        by_source.setdefault(each.level.source, []).append(each.level.id)
    sources = [f"{', '.join(ids)}: {source}." for source, ids in by_source.items()]
    return Summary(
        kind="analyze",
        title=f"{names}: {result.title}",
        verdict=verdict,
        coverage_kind="",
        assumptions=[*result.notes, *sources],
        phases=[],
        tracks=[],
        accuracy=[],
        integrity=[],
        honesty=honesty,
        states=[],
        events=[],
        cross_track=[],
        rejected=_rejected(parts),
        n_status={"solution": result.n_solution, "no_solution": result.n_no_solution, "missing": result.n_missing},
        performance=result,
    )


def _rejected(parts: list[Stored]) -> list[Rejection]:
    """Of all parts; what they have in common, navigation data and messages, once."""
    rejections: list[Rejection] = []
    for fields in (fields for part in parts for fields in part.rejected):
        one = Rejection(**fields)
        if one not in rejections:
            rejections.append(one)
    return rejections


def _copied(parts: list[Stored]) -> bool:
    """Whether the truth is the estimate at so many epochs that it is none."""
    n_same, n_known = (sum(each) for each in zip(*map(copied, tables_of(parts)), strict=True))
    return bool(n_known > 0 and n_same >= rule.COPIED_SHARE * n_known)


def _facts(level: LevelResult, result: Performance, *, doubted: bool) -> rule.LevelFacts:
    return rule.LevelFacts(
        n_expected=level.n_expected,
        n_solution=level.n_solution,
        n_available=level.n_available,
        n_misleading_events=level.n_mi_events + level.n_hazard_events,
        p_misleading=of_level(level, result.period_s),
        truth_known=_errors_known(level, result),
        doubted=doubted,
    )


def _errors_known(level: LevelResult, result: Performance) -> bool:
    """Whether the errors are known in every axis that the level limits, at enough epochs with a protection level to speak of all."""
    axes = result.axes[: 1 if level.level.val_m is None else 2]
    n = [0 if axis.error_m is None else axis.error_m.n for axis in axes]
    return level.truth_known and min(n) >= LEAST_SHARE * level.n_solution


def _write(run: Run, parts: list[Stored], folder: folders.Writer) -> Run:
    from navbound.report import render  # noqa: PLC0415  (the report is only loaded when one is written)

    epochs = pl.scan_parquet([part.table for part in parts])
    folder.write(directory.EPOCHS, lambda path: epochs.sink_parquet(path, compression="zstd", maintain_order=True))
    folder.write(CSV, lambda path: write_csv(tables_of(parts), path, _marked(run)))
    folder.write(directory.EVENTS, lambda path: run.events.write_parquet(path, compression="zstd"))
    folder.text(directory.RECORD, run.record.model_dump_json(indent=1))
    heard = run.satellites
    if heard is not None:
        folder.write(directory.SATELLITES, lambda path: heard.write_parquet(path, compression="zstd"))
    folder.write(directory.REPORT, lambda path: render(run.summary, run.record, run.epochs, run.events.clear(), [], path, satellites=heard))
    folder.text(directory.SUMMARY, run.summary.model_dump_json(indent=1))
    return replace(run, path=folder.folder)


def _marked(run: Run) -> str:
    return run.summary.performance.experimental if run.summary.performance is not None else ""
