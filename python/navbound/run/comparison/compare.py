"""Which numbers moved from one run to another, and which epochs changed their alert."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import polars as pl

from navbound.errors import ConflictError, InputError
from navbound.records.comparison import ComparedRun, Comparison
from navbound.run import directory
from navbound.run.comparison.epochs import changes, columns, joined
from navbound.run.comparison.numbers import moved_numbers, settings
from navbound.run.comparison.words import sentences

if TYPE_CHECKING:
    from navbound.run.directory import Run

LISTED_CHANGES = 500
"""Changes in the record; all of them are counted."""


def compare(a: str | Path, b: str | Path) -> Comparison:
    """Compare two run directories: A as it was, B as it is now.

    Parameters
    ----------
    a, b : path
        Run directories; both must be whole.

    Raises
    ------
    FormatError
        One is no run directory, did not finish, or was changed.
    InputError
        The two cannot be compared: one run twice, a run of levels and a run of tracks, or no epoch in common.
    """
    paths = Path(a), Path(b)
    if paths[0].resolve() == paths[1].resolve():
        raise InputError("b", str(b), domain=f"another run than {a}: a run is the same as itself")
    before, after = (directory.load(path) for path in paths)
    _require_one_kind(before, after)
    both = joined(before.epochs, after.epochs)
    if both.is_empty():
        domain = f"runs with an epoch in common (track and time): {_span(before)} in A, {_span(after)} in B"
        raise InputError("b", str(b), domain=domain)
    moved, n_same = columns(both, before.epochs, after.epochs)
    changed, counts = changes(both)
    numbers, of_settings = moved_numbers(before.summary, after.summary), settings(before.record, after.record)
    n_only = before.epochs.height - both.height, after.epochs.height - both.height
    same = not (moved or changed or numbers or any(n_only))
    return Comparison(
        a=_named(before, paths[0]),
        b=_named(after, paths[1]),
        words=sentences(both.height, n_only, numbers, moved, counts),
        same=same,
        n_common=both.height,
        n_only_a=n_only[0],
        n_only_b=n_only[1],
        settings=of_settings,
        numbers=numbers,
        columns=moved,
        n_columns_same=n_same,
        only_in_a=sorted(set(before.epochs.columns) - set(after.epochs.columns)),
        only_in_b=sorted(set(after.epochs.columns) - set(before.epochs.columns)),
        counts=counts,
        changes=changed[:LISTED_CHANGES],
        n_changes=len(changed),
    )


def _require_one_kind(a: Run, b: Run) -> None:
    kinds = ["levels" if run.summary.performance is not None else "tracks" for run in (a, b)]
    if kinds[0] != kinds[1]:
        because = f"A is a run of {kinds[0]} and B a run of {kinds[1]}; what one states the other does not"
        raise ConflictError("b", excludes=("a",), because=because)


def _span(run: Run) -> str:
    from navbound.time import utc_text  # noqa: PLC0415 - only for a refusal

    epochs = run.epochs
    if epochs.is_empty():
        return "no epoch"
    tracks = epochs["track"].unique().sort().to_list()
    named = ", ".join(map(str, tracks[:3])) + (f" and {len(tracks) - 3} more" if len(tracks) > 3 else "")
    first, last = epochs.select(first=pl.col("time_ns").min(), last=pl.col("time_ns").max()).row(0)
    return f"tracks {named} from {utc_text(first)} to {utc_text(last)}"


def _named(run: Run, path: Path) -> ComparedRun:
    return ComparedRun(
        path=str(path),
        title=run.summary.title,
        command=run.record.command,
        created_utc=run.record.created_utc,
        navbound_version=run.record.navbound_version,
        verdict=run.summary.verdict.id,
        words=run.summary.verdict.words,
        n_epochs=run.epochs.height,
    )
