"""Positions solved from raw measurements, as one more file that was read."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import gnss
from navbound.errors import FormatError
from navbound.evaluation import sizes
from navbound.gnss.constellation_doubts import contradicting
from navbound.gnss.files import navigation_of, observations_of
from navbound.gnss.receivers import unused_words
from navbound.read import formats
from navbound.read.checks.places import east_north_m, header_against
from navbound.read.checks.refusals import of_navigation, of_observations, skipped_words, without_epochs
from navbound.read.checks.repeats import left_out, separate
from navbound.read.columns.place_names import PLACES_APART_M
from navbound.read.statements.kinds import STALE_AFTER_S
from navbound.read.tables.epochs import Reading
from navbound.records.material import LEFT_OUT
from navbound.records.run import Rejection
from navbound.run.inputs.solving import Solving, require_same_time
from navbound.status import REASONS
from navbound.time import utc_text
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from pathlib import Path

    from navbound.read.source import Source
    from navbound.run.inputs.files import Files


def solved(files: Files, solving: Solving | None = None) -> list[Reading]:
    """Solve every file of measurements with the orbits and clocks of all.

    Raises
    ------
    FormatError
        A file that cannot be read, or in which no position can be solved.
    """
    navigation = navigation_of([source.plain() for source in files.navigation])
    readings = [_reading(source, navigation, solving or Solving()) for source in files.observations]
    if readings:
        readings[0].rejected.extend(of_navigation(navigation))
        readings[0].notes.extend(skipped_words(", ".join(path.name for path in navigation.paths), navigation.skipped))
    return readings


OWN_APART_SHARE = 0.01
"""Share of epochs up to which the receiver may have been elsewhere: the first ones after a cold start. Provenance: ours. [1]"""


def _own(source: Source) -> pl.DataFrame | None:
    """The positions of the receiver itself, where its log holds any."""
    path, content = source.plain()
    read = formats.of(content, path.name).read
    if read is None:
        return None
    try:
        return read(replace(source, content=content)).epochs.drop_nulls("time_ns").sort("time_ns")
    except FormatError:
        return None


def _against_own(path: Path, known: pl.DataFrame, own: pl.DataFrame) -> list[str]:
    """A doubt where the receiver was somewhere else than the solved positions are."""
    of_own = own.select("time_ns", own_lat="est_lat_rad", own_lon="est_lon_rad").drop_nulls().unique("time_ns").sort("time_ns")
    nearest = known.select("time_ns", "est_lat_rad", "est_lon_rad").sort("time_ns")
    both = nearest.join_asof(of_own, on="time_ns", strategy="nearest", tolerance=_SAME_NS).drop_nulls()
    apart = east_north_m(both.select("est_lat_rad", "est_lon_rad").to_numpy(), both.select("own_lat", "own_lon").to_numpy())
    apart_m = sizes.horizontal(apart)
    n_far = int((apart_m > PLACES_APART_M).sum())
    if n_far <= OWN_APART_SHARE * both.height:
        return []
    return [
        f"{path.name}: at {n_far} of {counted(both.height, 'epoch')} the receiver's own position is more than {PLACES_APART_M:.0f} m "
        "from the solved "
        f"one, the furthest {apart_m.max():.0f} m: one of them is wrong, and a truth decides which"
    ]


_SAME_NS = 500_000_000
"""Positions so near in time are of one epoch. [ns]"""


def _unmeasured(source: Source, observations: gnss.Observations, own: pl.DataFrame | None) -> tuple[pl.DataFrame, list[str]]:
    """The times of a log at which its receiver had a position and left no measurements: an epoch that nothing can be solved at."""
    none: tuple[pl.DataFrame, list[str]] = (pl.DataFrame(schema=LEFT_OUT), [])
    if own is None:
        return none
    own_ns = own["time_ns"].unique().sort().to_numpy()
    measured_ns = np.unique(observations.time_ns)
    step_ns = float(np.median(np.diff(measured_ns))) if measured_ns.size > 1 else 0.0
    beside = np.searchsorted(measured_ns, own_ns)
    nearest = [measured_ns[np.clip(beside - k, 0, measured_ns.size - 1)] for k in (0, 1)]
    # A position as old as that is no position; of measurements that are further apart each is of its step.
    within_ns = max(STALE_AFTER_S * 1e9, 1.5 * step_ns)
    alone_ns = own_ns[np.minimum(*(np.abs(own_ns - each) for each in nearest)) > within_ns]
    if alone_ns.size == 0:
        return none
    times = " to ".join(utc_text(int(time_ns)) for time_ns in (alone_ns[0], alone_ns[-1]))
    words = (
        f"{source.path.name}: at {alone_ns.size} of the {own_ns.size} times at which the receiver itself had a position ({times} UTC) the "
        f"log holds no measurements within {within_ns * 1e-9:.3g} s: nothing is solved there, and they count as missing"
    )
    return left_out(pl.DataFrame({"track": [source.stem] * alone_ns.size, "time_ns": alone_ns})), [words]


def _reading(source: Source, navigation: gnss.Navigation, solving: Solving) -> Reading:
    observations = observations_of(*source.plain())
    if observations.n_epochs == 0:
        raise without_epochs(observations)
    require_same_time(observations, navigation)
    solution = solving.solve(observations, navigation, signals="auto", systems="GEC", track=source.stem, keep_ranges=True)
    absent = [f"it holds no ranges of {gnss.SYSTEMS[s]}" for s in solving.systems or "" if not observations.codes.get(s)]
    without = solution.epochs.filter(pl.col("est_lat_rad").is_null())
    repeats = separate(solution.epochs.filter(pl.col("est_lat_rad").is_not_null()).sort("time_ns", maintain_order=True))
    known = repeats.epochs
    if known.is_empty():
        why = [*absent, f"satellites not used: {unused_words(solution.unused)}"]
        raise FormatError(source.path, f"no position could be solved; {'; '.join(why)}")
    path = str(source.path)
    rejected = [
        Rejection(file=path, reason=f"no position: {REASONS[id_].words}", count=count, first_line=None, example="")
        for id_, count in without.group_by("reason_id").len().sort("reason_id").iter_rows()
    ]
    rejected += [
        Rejection(file=path, reason=f"time repeated{words}", count=rows.height, first_line=None, example="")
        for words, rows in repeats.kinds.items()
    ]
    rejected += of_observations(observations)
    notes = [f"{source.path.name}: {words}, which was to be used" for words in absent]
    notes += [f"{source.path.name}: {name}: {words}" for name, words in solution.models.items()]
    doubts = contradicting(
        solution, lambda systems: replace(solving, systems=systems).solve(observations, navigation, signals="auto", systems=systems)
    )
    header = header_against(known, observations)
    notes += [f"{source.path.name}: {words}" for words in header.notes]
    notes += skipped_words(source.path.name, observations.skipped)
    notes += [f"{source.path.name}: {count} satellite-epochs not used: {gnss.UNUSED[why]}" for why, count in solution.unused.items()]
    # Epochs that cannot be read were measured all the same; nobody knows when.
    unread = pl.DataFrame({"track": [source.stem] * observations.n_lost_epochs, "time_ns": None})
    own = _own(source)
    unmeasured, words = _unmeasured(source, observations, own)
    notes += words
    lost = pl.concat([left_out(without), left_out(repeats.unjudged), left_out(unread), unmeasured])
    columns = {"est_lat_rad": "solved from " + ", ".join(c for codes in solution.codes.values() for c in codes)}
    return Reading(
        known,
        source.record(observations.n_epochs),
        rejected,
        notes=notes,
        columns=columns,
        left_out=lost,
        position_doubts=doubts,
        place_doubts=[*header.doubts, *(() if own is None else _against_own(source.path, known, own))],
        satellites=solution.heard,
    )
