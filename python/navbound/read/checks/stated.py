"""What a recorded track states against its own positions: an error of its own reckoning, an alert that was in force."""

from __future__ import annotations

import polars as pl

ERROR, ALERT = "stated_error_m", "stated_alert"
"""The largest lateral or horizontal error that a row states [m]; the word of an alert that it states, null where it states none."""

WORSE = "stated_worse_m"
"""The 95 % radius (EPU) that a row states, where it is larger than the covariance of the row allows by any definition [m]."""

TWO_DRMS = 2.0
"""Times the root of the sum of both variances: no ellipse has a 95 % circle as large
(1.96 for a line, 1.73 for a circle). [1] Provenance: standard."""

_LENGTHS = ("nse_h_m", "nse_cross_m", "nse_along_m", "tse_m", "fte_m")
_NO_ALERT = ("", "normal", "none", "no", "ok", "off", "false", "0", "0.0", "nan", "null")
"""Words that say that there is no alert. Any other is one: nobody knows what it means, and it is not "normal"."""


def worse_than_covariance(epochs: pl.DataFrame) -> pl.DataFrame:
    """Add `WORSE` where the table has both an EPU and a covariance."""
    if not {"epu_m", "cov_ee_m2", "cov_nn_m2"} <= set(epochs.columns):
        return epochs
    largest_m = TWO_DRMS * (pl.col("cov_ee_m2") + pl.col("cov_nn_m2")).sqrt()
    return epochs.with_columns(pl.when(pl.col("epu_m") > largest_m).then("epu_m").alias(WORSE))


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
        added.append(pl.when(word.is_in(_NO_ALERT).not_()).then(word).alias(ALERT))
    return rows.with_columns(added).drop(*_LENGTHS, "nse_e_m", "nse_n_m", "alert", strict=False)
