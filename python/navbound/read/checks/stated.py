"""What a recorded track states against its own positions: an error of its own reckoning, an alert that was in force."""

from __future__ import annotations

from typing import TYPE_CHECKING

import polars as pl

from navbound import _core, status
from navbound.read.statements.kinds import NO_ALERT

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from navbound.read.statements.kinds import Effect
    from navbound.read.statements.texts import Stated

ERROR, ALERT = "stated_error_m", "stated_alert"
"""The largest lateral or horizontal error that a row states [m]; the word of an alert that it states, null where it states none."""

WORSE = "stated_worse_m"
"""The 95 % radius that a row states (EPU, standard deviations, the lower limit of a NACp or NUCp), where it is larger than the covariance
of the row allows by any definition [m]."""

CONTAINMENT = "stated_rc_m"
"""The containment radius that a row states (Rc, or that of its NIC or NUCp); infinite where it states that none is known [m]."""

TWO_DRMS = 2.0
"""Times the root of the sum of both variances: no ellipse has a 95 % circle as large
(1.96 for a line, 1.73 for a circle). [1] Provenance: standard."""

LEVEL_SIGMAS = 6.0
"""Standard deviations in a protection level: 5.33 to 6 by the levels of SBAS (DO-229, standard). [1]"""

_LENGTHS = ("nse_h_m", "nse_cross_m", "nse_along_m", "tse_m", "fte_m")


def worse_than_covariance(epochs: pl.DataFrame, least_m: Sequence[pl.Series]) -> pl.DataFrame:
    """Add `WORSE` where the table states accuracies; ``least_m``: what each says that the 95 % radius is at least [m]."""
    if not least_m or not {"cov_ee_m2", "cov_nn_m2"} <= set(epochs.columns):
        return epochs
    largest_m = TWO_DRMS * (pl.col("cov_ee_m2") + pl.col("cov_nn_m2")).sqrt()
    stated_m = pl.max_horizontal(pl.lit(each) for each in least_m)
    return epochs.with_columns(pl.when(stated_m > largest_m).then(stated_m).alias(WORSE))


BESIDE_LEVEL = "beside_level_m"
"""The largest horizontal accuracy or error that a row of a table of levels states beside them, where it is above its level [m]."""


def worse_than_level(rows: pl.DataFrame) -> pl.DataFrame:
    """Add `BESIDE_LEVEL` where a table of levels states accuracies that the indicators do not use."""
    beside = [pl.col(name) for name in ("epu_m", "unread_accuracy_m") if name in rows.columns]
    axes = [pl.col(name) ** 2 for name in ("sigma_e_m", "sigma_n_m") if name in rows.columns]
    beside += [pl.sum_horizontal(axes).sqrt()] if axes else []
    if not beside or "hpl_m" not in rows.columns:
        return rows
    largest = pl.max_horizontal(beside)
    return rows.with_columns(pl.when(largest > pl.col("hpl_m")).then(largest).alias(BESIDE_LEVEL))


UNREAD_ERROR, NO_LEVEL = "unread_error", "no_level"
"""Whether a row of a table of levels states an error that is no finite number of its domain; and a level that is none, 0 or less or no
number. The columns are absent where no row does."""

_ERRORS, _LEVELS = ("nse_e_m", "nse_n_m", "nse_u_m", "hpe_m", "vpe_m"), ("hpl_m", "vpl_m")


def with_faulty_cells(rows: pl.DataFrame, reasons: Mapping[str, pl.Series], without: Mapping[str, pl.Series]) -> pl.DataFrame:
    """Add `UNREAD_ERROR` and `NO_LEVEL`.

    Parameters
    ----------
    rows : DataFrame
        As they are read.
    reasons : mapping of str to Series
        Why a value of a column was not used, null where it was; ``empty`` is no fault.
    without : mapping of str to Series
        Where a level is 0 or less.
    """
    # An infinite level bounds nothing and claims nothing.
    none = {name: ("empty", "not finite") if name in _LEVELS else ("empty",) for name in (*_ERRORS, *_LEVELS)}
    bad = {name: (~why.is_in(none[name])).fill_null(value=False) for name, why in reasons.items() if name in none}
    for added, names, more in ((UNREAD_ERROR, _ERRORS, {}), (NO_LEVEL, _LEVELS, without)):
        at = [bad[name] for name in names if name in bad] + list(more.values())
        if any(each.any() for each in at):
            rows = rows.with_columns(pl.select(pl.any_horizontal(at)).to_series().alias(added))
    return rows


def against_itself(rows: pl.DataFrame) -> pl.DataFrame:
    """Replace the columns of errors and of the alert by `ERROR` and `ALERT`; they are absent where the table has none of these."""
    errors = [pl.col(name).abs() for name in _LENGTHS if name in rows.columns]
    axes = [pl.col(name) for name in ("nse_e_m", "nse_n_m") if name in rows.columns]
    if axes:
        known = pl.any_horizontal(axis.is_not_null() for axis in axes)
        errors.append(pl.when(known).then(pl.sum_horizontal(axis**2 for axis in axes).sqrt()))
    added = [pl.max_horizontal(errors).alias(ERROR)] if errors else []
    if "alert" in rows.columns:
        word = pl.col("alert").str.to_lowercase()
        added.append(pl.when(word.is_in(sorted(NO_ALERT | {"", "0.0"})).not_()).then(word).alias(ALERT))
    return rows.with_columns(added).drop(*_LENGTHS, "nse_e_m", "nse_n_m", "alert", strict=False)


def with_statements(rows: pl.DataFrame, statements: Sequence[tuple[str, Effect, Stated]]) -> pl.DataFrame:
    """Add what columns of validity and of alerts state: a row without a valid position is `reported`, an alert stands in `ALERT`.

    Parameters
    ----------
    rows : DataFrame
        After :func:`against_itself` and :func:`navbound.status.recorded`.
    statements : sequence of (str, Effect, Stated)
        Name of each column, what its words do, and what it states.
    """
    words = {
        effect: [pl.lit(f"{name} = ") + pl.lit(each.against) for name, kind, each in statements if kind == effect]
        for effect in ("invalid", "alert")
    }
    if words["alert"]:
        before = [pl.col(ALERT)] if ALERT in rows.columns else []
        rows = rows.with_columns(pl.coalesce(*before, *words["alert"]).alias(ALERT))
    if not words["invalid"]:
        return rows
    if "status" not in rows.columns:
        rows = rows.with_columns(pl.lit("ok").alias("status"))
    sentence = rows.select(pl.coalesce(pl.lit("the recording states ") + each for each in words["invalid"]).alias("sentence"))["sentence"]
    # What the recording states already stays where it is as grave.
    fault = pl.select(pl.when(sentence.is_not_null() & rows["status"].is_in(status.USABLE)).then(pl.lit("reported"))).to_series()
    return status.overridden(rows, fault, sentence)


def of_satellites(rows: pl.DataFrame) -> pl.DataFrame:
    """Positions on fewer satellites than determine one are kept by something else, where the recording states no status of its own."""
    if "n_sv" not in rows.columns or "status" in rows.columns:
        return rows
    few = (rows["n_sv"] < _core.DETERMINING_SATELLITES).fill_null(value=False)
    if not few.any():
        return rows
    rows = rows.with_columns(pl.lit("ok").alias("status"))
    return status.overridden(rows, pl.select(pl.when(few).then(pl.lit("few_satellites"))).to_series())


def of_counted_satellites(rows: pl.DataFrame, unusable: pl.Series | None = None) -> tuple[pl.DataFrame, int]:
    """Positions of a receiver's log beside a count of satellites that determines none: which of the two is wrong nobody knows.

    ``unusable``: the count in words where the decoder of the log, which streams use too, takes the position for none.
    """
    few = (rows["n_sv"] < _core.DETERMINING_SATELLITES).fill_null(value=False) if "n_sv" in rows.columns else pl.Series([False])
    if not few.any():
        return rows, 0
    rows = rows.with_columns(pl.lit("ok").alias("status"))
    rows = status.overridden(rows, pl.select(pl.when(few).then(pl.lit("few_satellites"))).to_series())
    if unusable is not None and unusable.is_not_null().any():
        sentence = pl.select(pl.lit("the recording states ") + pl.lit(unusable)).to_series()
        rows = status.overridden(rows, pl.select(pl.when(sentence.is_not_null()).then(pl.lit("reported"))).to_series(), sentence)
    return rows, int(few.sum())
