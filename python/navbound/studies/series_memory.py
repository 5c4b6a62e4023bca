"""How long a series remembers: autocorrelation by FFT, and where it crosses a level."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound.errors import FormatError, InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

INVERSE_E = float(np.exp(-1.0))
SHORTEST = 16
"""Fewer samples have no autocorrelation worth the name."""


def autocorrelation(series: Floats, *, remove_mean: bool) -> Floats:
    """Biased autocorrelation of each row, 1 at lag 0; zero-padded, so that the ends do not meet.

    Parameters
    ----------
    series : ndarray, shape (..., n)
        Equally spaced samples.
    remove_mean : bool
        Whether each row is counted from its mean.

    Returns
    -------
    ndarray, shape (..., n)
        By lag; NaN for a row without variation.
    """
    x = series - series.mean(axis=-1, keepdims=True) if remove_mean else series
    n = x.shape[-1]
    spectrum = np.fft.rfft(x, 2 * n, axis=-1)
    raw = np.fft.irfft(np.abs(spectrum) ** 2, 2 * n, axis=-1)[..., :n]
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation: Floats = raw / raw[..., :1]
    return correlation


def first_crossing(values: Floats, level: float) -> Floats:
    """Lag, in samples, at which each row first is at or below a level, between samples by a line; NaN where it never is."""
    below = values <= level
    k = below.argmax(axis=-1)
    rows = values.reshape(-1, values.shape[-1])
    flat, any_below = k.ravel(), below.any(axis=-1).ravel()
    lag = np.full(flat.size, np.nan)
    for i in np.flatnonzero(any_below):
        j = flat[i]
        lag[i] = 0.0 if j == 0 else j - 1 + (rows[i, j - 1] - level) / (rows[i, j - 1] - rows[i, j])
    return lag.reshape(k.shape)


def read_series(path: str | Path) -> tuple[float, dict[str, Floats]]:
    """Read a table of series: ``time_s`` at equal steps, and one column for each satellite.

    Returns
    -------
    step_s : float
        Between samples. [s]
    series : dict of str to ndarray
        By column; a column with gaps is refused.

    Raises
    ------
    FormatError
        Not such a table.
    """
    path = Path(path)
    try:
        table = pl.read_csv(path, null_values=["nan", "NaN", ""])
    except (OSError, pl.exceptions.PolarsError) as e:
        raise FormatError(path, f"not a table of series: {e}") from e
    if "time_s" not in table.columns or table.width < 2 or table.height < SHORTEST:
        raise FormatError(path, f"a table needs time_s, at least one series and {SHORTEST} rows", field="time_s")
    columns: dict[str, Floats] = {}
    for name in table.columns:
        if not table[name].dtype.is_numeric():
            raise FormatError(path, f"{name} is not numbers", field=name)
        values = np.asarray(table[name].cast(pl.Float64).to_numpy(), dtype=np.float64)
        if not np.isfinite(values).all():
            line = int(np.flatnonzero(~np.isfinite(values))[0]) + 2
            raise FormatError(path, "a gap: the series must be complete", line=line, field=name)
        columns[name] = values
    time = columns.pop("time_s")
    steps = np.diff(time)
    step = float(np.median(steps))
    # A step may be written with few digits.
    if not (step > 0 and np.abs(steps - step).max() <= 1e-3 * step + 1e-6):
        line = int(np.argmax(np.abs(steps - step))) + 3
        raise FormatError(path, "time_s does not grow by equal steps", line=line, field="time_s")
    return step, columns


def one_or_none(files: Sequence[str | Path]) -> Path | None:
    """The one file of a study that takes one."""
    if len(files) > 1:
        raise InputError("files", len(files), "1", "{0, 1}: a table of series")
    return Path(files[0]) if files else None
