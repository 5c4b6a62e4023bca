"""One part of a campaign: a receiver's observations with the positions and protection levels of a monitor on board (RAIM, ARAIM)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import polars as pl

from navbound import gnss
from navbound.algorithms import Recorded, entries
from navbound.errors import ConflictError, InputError, NotFoundError
from navbound.gnss.monitor_fit import DISBELIEF
from navbound.read.checks.refusals import of_navigation, of_observations, require_most_epochs, skipped_words
from navbound.read.truth import with_truth
from navbound.run.evaluate.levels import Part, place_doubts, uniform
from navbound.run.inputs.solving import Solving, require_same_time
from navbound.run.verdict.numbers import share
from navbound.status import REASONS
from navbound.units import METRES_PER_NM
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from pathlib import Path

    from navbound.read.truth import Truth

DECLARED_LEVELS = "given"
"""Protection levels of the files: a table's, those of an augmentation service's messages."""

RNP_NM = (0.3, 1.0, 2.0)
"""Limits that detection and exclusion are counted against: those of non-precision approach, terminal area and en route."""

WITHIN = {
    "hpl_m": "detection (HPL)",
    "hel_m": "detection and exclusion (HEL)",
    "hpl_slope_m": "published level, which is not used",
}
"""Columns of a monitor that says how often it can detect and exclude."""


OF_FILE = {"satellites used", "smoothing", "satellites not used (satellite-epochs)", "fit of the error model"}
"""Entries of a monitor's models that are counts of one file."""

CONTRADICTED = f"{DISBELIEF} (the residuals or the detections contradict the error model)"
"""Stands beside every number of levels whose error model does not fit the ranges."""


def monitor_of(protection: str) -> Recorded | None:
    """The monitor of a source of protection levels; None for those of the files.

    Raises
    ------
    InputError
        No such source.
    """
    known = entries(Recorded)
    if protection != DECLARED_LEVELS and protection not in known:
        of_service = f"{DECLARED_LEVELS} takes a table's levels, or repeats those of an SBAS service from its messages among the files"
        raise NotFoundError("protection", protection, "algorithm", [DECLARED_LEVELS, *known], more=of_service)
    return known.get(protection)


def monitored(solving: Solving) -> dict[str, str | float]:
    """What a monitor on board takes of the options of solving.

    Raises
    ------
    InputError
        What no monitor has: a model of the ionosphere other than the broadcast one, signals chosen epoch by epoch.
    """
    if solving.ionosphere is not None:
        because = "single signals take the broadcast message, and dual signals need no model"
        raise ConflictError("ionosphere", excludes=("protection",), because=because, value=solving.ionosphere)
    if solving.signals == "auto":
        domain = "single or dual with --protection: the error model of a level is that of one of them"
        raise InputError("signals", "auto", domain=domain)
    return solving.named


def from_monitor(path: Path, records: gnss.Navigation, truth: Truth, monitor: Recorded, solving: Solving | None = None) -> Part:
    """Positions, tests and levels of every epoch of an observation file; signals and systems that are not named are the monitor's own.

    Raises
    ------
    FormatError
        A file that cannot be read, or without epochs.
    """
    observations = gnss.read_observations(path)
    require_most_epochs(observations)
    require_same_time(observations, records)
    kept = {"keep_ranges": True} if monitor.keeps_ranges else {}
    monitored_epochs = monitor(observations, records, truth_ecef_m=truth.ecef_m, **kept, **monitored(solving or Solving()))
    notes = [f"{path.name}: {words}" for words in decisions(monitored_epochs.epochs)]
    notes += [f"{path.name}: {name}: {words}" if name in OF_FILE else f"{name}: {words}" for name, words in monitored_epochs.models.items()]
    refused = [*of_observations(observations), *of_navigation(records)]
    notes += [*skipped_words(path.name, observations.skipped), *skipped_words("navigation data", records.skipped)]
    epochs = monitored_epochs.epochs
    if truth.stated is not None and truth.ecef_m is None:
        epochs, words, other, _ = with_truth(epochs, truth)
        refused += [] if other is None else other.rejected
        notes.append(words)
    return Part(
        uniform(epochs),
        observations.n_epochs,
        [one.model_dump() for one in refused],
        notes,
        "" if monitored_epochs.fit.believable else CONTRADICTED,
        heard=monitored_epochs.heard,
        position_doubts=place_doubts(epochs, observations, truth),
    )


def decisions(epochs: pl.DataFrame) -> list[str]:
    """What the monitor decided, counted; and how often it could detect and exclude within the limits of operations, where it says so."""
    n = epochs.height
    lost = epochs.filter(pl.col("reason_id") == "fault_not_excluded").height
    excluded = epochs.filter(pl.col("n_excluded") > 0)
    without = epochs.filter(pl.col("hpl_m").is_null() & pl.col("est_lat_rad").is_not_null()).height - lost
    none = epochs.filter(pl.col("est_lat_rad").is_null())
    each = excluded["excluded_sv"].value_counts(sort=True).iter_rows()
    named = ", ".join(f"{satellites} at {count}" for satellites, count in each)
    which = f" ({named})" if named else ""
    words = [
        f"{counted(n, 'epoch')}: a fault detected at {lost + excluded.height}, excluded at {excluded.height}{which}, not to be "
        f"excluded at {lost}; a "
        f"position but no way to detect a fault at {without}."
    ]
    if none.height:
        why = none["reason_id"].value_counts(sort=True).head(3).iter_rows()
        causes = "; ".join(f"{REASONS[id_].words if id_ else 'without a reason'} at {count}" for id_, count in why)
        words.append(f"No position at {counted(none.height, 'epoch')}: {causes}.")
    if "hel_m" in epochs.columns:
        limits = ", ".join(f"{rnp:g}" for rnp in RNP_NM)
        shares = "; ".join(f"{what} {_within(epochs[column])}" for column, what in WITHIN.items())
        words.append(f"Share of the epochs within {limits} NM: {shares}.")
    return words


def _within(level_m: pl.Series) -> str:
    """Shares of all epochs; one without a level is not within."""
    return ", ".join(share(int((level_m <= rnp * METRES_PER_NM).sum()) / len(level_m)) for rnp in RNP_NM)
