"""The parts of a performance run, one a file: worked out once, remembered in a folder, read one at a time."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import polars as pl

from navbound import __version__
from navbound.errors import FormatError
from navbound.kpi.catalogue import selected_levels
from navbound.run.evaluate.levels import SCHEMA, Part, Service, from_observations, from_table
from navbound.run.evaluate.monitored import from_monitor, monitor_of
from navbound.table.columns import HEARD
from navbound.table.declare import schema

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from navbound.read.source import Source
    from navbound.read.truth import Truth
    from navbound.run.evaluate.performance import Options
    from navbound.run.inputs.files import Files


@dataclass(frozen=True)
class Stored:
    """A finished part on the disk."""

    table: Path
    first_ns: int
    n_rows: int
    n_epochs: int
    rejected: list[dict[str, Any]]
    notes: list[str]
    experimental: str
    unread: list[str]
    n_stated_worse: int
    position_doubts: list[str]
    digests: dict[str, str]
    source: Source


def finished_parts(
    sources: Files, options: Options, truth: Truth, folder: Path, progress: Callable[[int, int], None] | None
) -> list[Stored]:
    """Every part, computed or remembered, in the order of time."""
    jobs = sources.tables + sources.observations
    shared = _shared_key(sources, options, truth)
    service = Service([s.path for s in sources.navigation], [s.path for s in sources.messages], options.prn)
    stored = []
    for done, source in enumerate(jobs):
        key = hashlib.sha256(f"{source.sha256} {shared}".encode()).hexdigest()[:24]
        finished = _remembered(folder, key, source)
        if finished is None:
            finished = _remember(folder, key, source, _compute(source, sources, options, truth, service))
        stored.append(finished)
        if progress is not None:
            progress(done + 1, len(jobs))
    filled = [part for part in stored if part.n_epochs]
    if not filled:
        raise FormatError(jobs[0].path, "no row holds a time")
    return sorted(filled, key=lambda part: (part.first_ns, str(part.source.path)))


def _shared_key(sources: Files, options: Options, truth: Truth) -> str:
    """What a part's numbers depend on beside its own file."""
    recorded = None
    if truth.stated is not None and truth.ecef_m is None:
        try:
            recorded = hashlib.sha256(Path(truth.stated).read_bytes()).hexdigest()
        except OSError as e:
            raise FormatError(truth.stated, e.strerror or str(e)) from e
    inputs = [
        __version__,
        truth.stated,
        recorded,
        truth.tolerance_s,
        dict(options.columns or {}),
        options.prn,
        options.solve,
        options.protection,
        _needs(options),
        options.solving.named,
    ]
    beside = sorted(s.sha256 for s in sources.navigation + sources.messages)
    return json.dumps([inputs, options.stanford_esa is not None, SCHEMA.names(), schema(HEARD).names(), beside])


def _compute(source: Source, sources: Files, options: Options, truth: Truth, service: Service) -> Part:
    if source in sources.tables:
        return from_table(source.path, truth, _needs(options))
    monitor = monitor_of(options.protection)
    if monitor is not None:
        return from_monitor(source.path, service.navigation, truth, monitor, options.solving)
    return from_observations(source.path, service, truth, keep_ranges=options.stanford_esa is not None, solving=options.solving)


def _needs(options: Options) -> list[str]:
    """The protection levels that the levels to be judged have limits for."""
    vertical = any(level.val_m is not None for level in selected_levels(options.levels))
    return ["hpl_m", "vpl_m"] if vertical else ["hpl_m"]


def _remember(folder: Path, key: str, source: Source, part: Part) -> Stored:
    """Write a part so that it is there whole or not at all: the table first, then the record that makes it count."""
    table, record = folder / f"{key}.parquet", folder / f"{key}.json"
    facts: dict[str, Any] = {
        "first_ns": part.epochs["time_ns"][0] if part.epochs.height else 0,
        "n_rows": part.n_rows,
        "n_epochs": part.epochs.height,
        "rejected": part.rejected,
        "notes": part.notes,
        "experimental": part.experimental,
        "unread": part.unread,
        "n_stated_worse": part.n_stated_worse,
        "position_doubts": part.position_doubts,
    }
    try:
        # Not before: a run that is refused at its first file leaves nothing behind.
        folder.mkdir(exist_ok=True)
        for beside, path in ((part.ranges, _ranges_of(table)), (part.heard, _heard_of(table))):
            if beside is not None:
                beside.write_parquet(partial := path.with_suffix(".partial"), compression="zstd")
                partial.replace(path)
        part.epochs.write_parquet(partial := table.with_suffix(".partial"), compression="zstd")
        partial.replace(table)
        facts["digests"] = {path.name: _digest(path) for path in _files_of(table) if path.is_file()}
        partial = record.with_suffix(".partial")
        partial.write_text(json.dumps({"facts": facts, "sha256": _digest_of(facts)}), encoding="utf-8")
        partial.replace(record)
    except OSError as e:
        for remains in (*_files_of(table), record):
            remains.with_suffix(".partial").unlink(missing_ok=True)
        raise FormatError(folder, f"cannot be written: {e.strerror}") from e
    return Stored(table=table, source=source, **facts)


def _remembered(folder: Path, key: str, source: Source) -> Stored | None:
    record, table = folder / f"{key}.json", folder / f"{key}.parquet"
    if not (record.is_file() and table.is_file()):
        return None
    try:
        kept = json.loads(record.read_text(encoding="utf-8"))
        facts, digest = kept["facts"], kept["sha256"]
        if _digest_of(facts) != digest:
            raise FormatError(record, "is not what was kept: its digest differs; delete it to compute this part again")
        for name, expected in facts["digests"].items():
            if _digest(folder / name) != expected:
                raise FormatError(
                    folder / name, f"is not what was kept: its digest differs; delete {record.name} to compute this part again"
                )
        return Stored(table=table, source=source, **facts)
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError) as e:
        if isinstance(e, FormatError):
            raise
        raise FormatError(record, f"is damaged ({e}); delete it to compute this part again") from e


def _digest_of(facts: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(facts, sort_keys=True).encode()).hexdigest()


def _digest(path: Path) -> str:
    with path.open("rb") as content:
        return hashlib.file_digest(content, "sha256").hexdigest()


def _ranges_of(table: Path) -> Path:
    return table.with_suffix(".ranges.parquet")


def _heard_of(table: Path) -> Path:
    return table.with_suffix(".heard.parquet")


def _files_of(table: Path) -> tuple[Path, ...]:
    """Where a part's tables are; not every part has each."""
    return table, _ranges_of(table), _heard_of(table)


def tables_of(parts: list[Stored]) -> Iterator[pl.DataFrame]:
    """One part in memory at a time."""
    return (_read(part.table) for part in parts)


def ranges_of_parts(parts: list[Stored]) -> Iterator[pl.DataFrame]:
    """The ranges of one part in memory at a time."""
    return (_read(_ranges_of(part.table)) for part in parts)


def heard_of_parts(parts: list[Stored]) -> Iterator[pl.DataFrame | None]:
    """The satellites of one part in memory at a time; none where it has none."""
    return (_read(path) if (path := _heard_of(part.table)).name in part.digests else None for part in parts)


def _read(table: Path) -> pl.DataFrame:
    try:
        return pl.read_parquet(table)
    except (OSError, pl.exceptions.PolarsError) as e:
        raise FormatError(table, f"is damaged ({e}); delete its part to compute it again") from e
