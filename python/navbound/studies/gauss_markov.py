"""Random series that several studies draw."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]


def gauss_markov(draws: ArrayLike, time_s: ArrayLike) -> Floats:
    """First-order Gauss-Markov series of unit variance at 1 Hz, stationary from the begin.

    Parameters
    ----------
    draws : array_like, shape (..., n)
        Independent standard normal numbers.
    time_s : array_like, shape (...) or ()
        Time constant of each row. [s]

    Returns
    -------
    ndarray, shape (..., n)
        A sample a second.
    """
    series = np.array(draws, dtype=np.float64)
    kept = np.exp(-1.0 / np.asarray(time_s, dtype=np.float64))
    fresh = np.sqrt(1.0 - kept * kept)
    for k in range(1, series.shape[-1]):
        series[..., k] = kept * series[..., k - 1] + fresh * series[..., k]
    return series
