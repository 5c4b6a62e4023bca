"""What the readers of observations, navigation data and messages refused, as the rejections of a run."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from navbound.errors import FormatError
from navbound.read.checks.rejections import MAX_BAD_SHARE
from navbound.records.run import Rejection
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from navbound import gnss, sbas

    Refused = gnss.Refused | sbas.Refused

_VARYING = re.compile(r"0x[0-9a-fA-F]+|'[^']*'|\"[^\"]*\"|\d+")
"""Parts of a reason that differ from line to line."""


def rejections(path: str | Path, refused: Iterable[Refused], count: int | None = None) -> list[Rejection]:
    """Refusals of one file, those of one kind together.

    Parameters
    ----------
    path : path
        The file at fault.
    refused : iterable
        Refusals in full, in the order of the file.
    count : int, optional
        All of them, where not each is there in full.

    Returns
    -------
    list of Rejection
        Each with the words, the line and the text of the first of its kind. [1]
    """
    kinds: dict[tuple[str, str], list[Refused]] = {}
    for one in refused:
        kinds.setdefault((_VARYING.sub("", one.field), _VARYING.sub("", one.reason)), []).append(one)
    rejected = [_of_kind(path, alike) for alike in kinds.values()]
    n = sum(one.count for one in rejected)
    if count is not None and count > n:
        rejected.append(Rejection(file=str(path), reason="refusals beyond those listed", count=count - n, first_line=None, example=""))
    return rejected


def _of_kind(path: str | Path, alike: list[Refused]) -> Rejection:
    first = alike[0]
    reason, example = f"{first.field}: {first.reason}", first.text.strip()[:120]
    return Rejection(file=str(path), reason=reason, count=len(alike), first_line=first.line or None, example=example)


def of_navigation(navigation: gnss.Navigation) -> list[Rejection]:
    """Records of navigation files that were refused, each with its own file."""
    paths = dict.fromkeys(one.path for one in navigation.refused)
    return [rejection for path in paths for rejection in rejections(path, [one for one in navigation.refused if one.path == path])]


def of_observations(observations: gnss.Observations) -> list[Rejection]:
    """What an observation file or a raw log held that was refused."""
    return rejections(observations.path, observations.refused, observations.n_refused)


def without_epochs(observations: gnss.Observations) -> FormatError:
    """Why a file of measurements gives none, naming the first thing that was refused."""
    if not observations.n_refused:
        return FormatError(observations.path, "holds no epoch of measurements")
    first = observations.refused[0]
    what = (
        f"no epoch can be used: {counted(observations.n_refused, 'record is', 'records are')} refused, the first for "
        f"{first.reason}: “{first.text.strip()[:80]}”"
    )
    return FormatError(observations.path, what, first.line, first.field)


def require_most_epochs(observations: gnss.Observations) -> None:
    """Refuse measurements for indicators over time where too many of their epochs cannot be read.

    Raises
    ------
    FormatError
        No epoch, or more than `MAX_BAD_SHARE` of them lost: nobody knows when they were, so no availability can be stated.
    """
    n_lost, n = observations.n_lost_epochs, observations.n_epochs + observations.n_lost_epochs
    if not observations.n_epochs:
        raise without_epochs(observations)
    if n_lost > MAX_BAD_SHARE * n:
        first = observations.refused[0]
        what = f"{n_lost} of {n} epochs cannot be read, more than the {MAX_BAD_SHARE:.0%} that may be lost; the first: {first.reason}"
        raise FormatError(observations.path, what, first.line, first.field)


def skipped_words(name: str, skipped: Mapping[str, int]) -> list[str]:
    """A note on what a reader left aside because navbound does not use it; none where there is nothing."""
    each = ", ".join(f"{kind} ({count})" for kind, count in sorted(skipped.items()))
    return [f"{name}: left aside, as navbound does not use it: {each}."] if skipped else []
