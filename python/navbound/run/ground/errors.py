"""Random streams and errors of ranges on the way to the stand, and lines of sight."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike, NDArray

    from navbound.scenario.taxi import Fault

    Floats = NDArray[np.float64]

CODE, PHASE, DRIFT, BIAS, STEERING, MONITOR, CLOCK, DOPPLER, START = range(9)
"""What a stream of random numbers is for."""
_STREAMS_PER_TRACK = 1 << 16
_STREAMS_PER_USE = 1 << 10


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


def stream(seed: int, track: int, use: int, number: int = 0) -> np.random.Generator:
    """Philox stream of its own for a track, a use and a satellite: nothing drawn elsewhere changes it."""
    place = track * _STREAMS_PER_TRACK + use * _STREAMS_PER_USE + number
    return np.random.Generator(np.random.Philox(key=np.array([seed, place], dtype=np.uint64)))


def normals(seed: int, track: int, use: int, numbers: Iterable[int], n: int) -> Floats:
    """Standard normal numbers, a column for each satellite's stream; shape (n, satellites)."""
    return np.stack([stream(seed, track, use, k).standard_normal(n) for k in numbers], axis=-1)


def slow(seed: int, track: int, use: int, *, wide: int, n: int, time_s: float) -> Floats:
    """Gauss-Markov series of unit variance, one row a second and a column a satellite."""
    return gauss_markov(normals(seed, track, use, range(wide), n).T, time_s).T


def size(fault: Fault, seconds: Floats) -> Floats:
    """Range error of a fault at seconds since the start [m]."""
    acts = (seconds >= fault.start_s) & (seconds < fault.start_s + fault.duration_s)
    grown = fault.size_m if fault.kind == "range-step" else fault.rate_mps * (seconds - fault.start_s)
    return np.where(acts, grown, 0.0)


def line(az_rad: Floats, el_rad: Floats) -> Floats:
    """Unit vectors to satellites, east, north, up; shape (..., 3)."""
    return np.stack([np.cos(el_rad) * np.sin(az_rad), np.cos(el_rad) * np.cos(az_rad), np.sin(el_rad)], axis=-1)
