"""Time constants of smoothed multipath: appendix A of Song, Milner and No 2024 (navi.673) done again, or the same on a series of one's own.

Multipath is drawn as first-order noise with time constants of a law fitted to published percentiles, smoothed by the carrier over 30 and
100 s, and its time constant read off the autocorrelation. The smallest comes out with as many draws as the paper has;
the largest is a single sample of a heavy tail.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from navbound import _core
from navbound.errors import InputError
from navbound.records.base import Record
from navbound.studies.gauss_markov import gauss_markov
from navbound.studies.series_memory import INVERSE_E, autocorrelation, first_crossing, one_or_none, read_series

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray
    from rich.console import RenderableType

    Floats = NDArray[np.float64]

PERCENTILES_S = (7.0, 14.0, 170.0)
"""5, 50 and 95 % of the time constants of raw multipath (printed)."""
LONGEST_S, SHORTEST_S = 900.0, 5.0
"""Above the 95th percentile uniform up to the first; none below the second (printed)."""
SAMPLES, RUN_IN = 7200, 600
PUBLISHED_S = {30.0: (26.0, 2315.0), 100.0: (54.0, 2894.0)}
CHUNK = 250
FROM_ZERO = "First lag at which the autocorrelation, not counted from the mean, is 1/e."
Z95 = float(_core.chi_factor(1, np.array([0.10]))[0])
"""Exceeded with 5 %: on both sides together with 10 %."""


class Smoothed(Record):
    """One smoothing."""

    smoothing_s: float
    least_s: float
    p5_s: float
    median_s: float
    p95_s: float
    most_s: float
    published_least_s: float
    published_most_s: float
    variance_ratio: list[float]
    """Variance left of multipath of 5 and 170 s, simulated."""
    variance_ratio_exact: list[float]
    """The same, tau / (tau + smoothing)."""


class Series(Record):
    """One series of a file."""

    name: str
    time_constant_s: float | None
    """None: the autocorrelation does not fall to 1/e."""


class Study(Record):
    """Both smoothings, or the series of a file."""

    draws: int
    smoothed: list[Smoothed]
    series: list[Series]
    words: list[str]

    def table(self) -> RenderableType:
        """Lay the study out for a terminal."""
        return _render(self)


def run(files: Sequence[str | Path] = (), *, draws: int = 1000, seed: int = 673) -> Study:
    """Draw, smooth, and read time constants; or read those of a file.

    Parameters
    ----------
    files : sequence of path
        None, or one table with ``time_s`` and a column for each satellite.
    draws : int
        Time constants drawn; the paper has 100 000. [1]
    seed : int
        Of the draws.

    Raises
    ------
    InputError
        More than one file, fewer than 20 draws.
    FormatError
        A file that is no such table.
    """
    path = one_or_none(files)
    if path is not None:
        step, columns = read_series(path)
        own = {name: float(first_crossing(autocorrelation(x, remove_mean=False), INVERSE_E)) * step for name, x in columns.items()}
        series = [Series(name=name, time_constant_s=None if np.isnan(lag) else lag) for name, lag in own.items()]
        return Study(draws=0, smoothed=[], series=series, words=[FROM_ZERO])
    if draws < 20:
        raise InputError("draws", draws, "1", "[20, inf)")
    generator = np.random.Generator(np.random.Philox(seed))
    tau = time_constants(generator, draws)
    by_interval: dict[float, list[Floats]] = {ts: [] for ts in PUBLISHED_S}
    for first in range(0, draws, CHUNK):
        raw = markov(generator, tau[first : first + CHUNK])
        for ts, some in by_interval.items():
            some.append(first_crossing(autocorrelation(smooth(raw, ts)[:, RUN_IN:], remove_mean=False), INVERSE_E))
    checks = markov(generator, np.repeat([SHORTEST_S, PERCENTILES_S[2]], 100))
    return Study(
        draws=draws,
        smoothed=[_smoothed(ts, np.concatenate(lags), checks) for ts, lags in by_interval.items()],
        series=[],
        words=[
            "Least and most are extremes of estimates from two hours of samples: the least falls slowly with the number of draws (for "
            "100 s of smoothing 65 s at 1000, 51 s at 10 000), the most is one sample of a heavy tail and moves by a factor of two.",
            "The law between the percentiles is inferred: two half log-normals that meet all three.",
        ],
    )


def time_constants(generator: np.random.Generator, n: int) -> Floats:
    """Time constants of raw multipath: two half log-normals, uniform above the 95th percentile, floored [s]."""
    low, middle, high = PERCENTILES_S
    z = np.asarray(generator.standard_normal(n))
    below, above = float(np.log(middle / low)) / Z95, float(np.log(high / middle)) / Z95
    spread = np.where(z < 0, below, above)
    tail = generator.uniform(high, LONGEST_S, n)
    return np.maximum(SHORTEST_S, np.where(z > Z95, tail, middle * np.exp(spread * z)))


def markov(generator: np.random.Generator, tau_s: Floats) -> Floats:
    """First-order noise of unit variance at 1 Hz, one row a time constant, with its run-in."""
    return gauss_markov(generator.standard_normal((SAMPLES + RUN_IN, tau_s.size)).T, tau_s)


def smooth(series: Floats, window_s: float) -> Floats:
    """Smoothing by the carrier at 1 Hz: y(k) = x(k)/w + (1 - 1/w) y(k-1)."""
    out = np.empty_like(series)
    weight = 1.0 / window_s
    y = np.zeros(series.shape[0])
    for k in range(series.shape[1]):
        y = weight * series[:, k] + (1.0 - weight) * y
        out[:, k] = y
    return out


def _smoothed(ts: float, lags: Floats, checks: Floats) -> Smoothed:
    lags = lags[~np.isnan(lags)]
    p5, median, p95 = np.percentile(lags, [5, 50, 95])
    ratio = smooth(checks, ts)[:, RUN_IN:].var(axis=1) / 1.0
    exact = [tau / (tau + ts) for tau in (SHORTEST_S, PERCENTILES_S[2])]
    least, most = PUBLISHED_S[ts]
    return Smoothed(
        smoothing_s=ts,
        least_s=float(lags.min()),
        p5_s=float(p5),
        median_s=float(median),
        p95_s=float(p95),
        most_s=float(lags.max()),
        published_least_s=least,
        published_most_s=most,
        variance_ratio=[float(ratio[:100].mean()), float(ratio[100:].mean())],
        variance_ratio_exact=exact,
    )


def _render(study: Study) -> RenderableType:
    from rich.console import Group  # noqa: PLC0415
    from rich.table import Table  # noqa: PLC0415

    if study.series:
        table = Table(title="Time constants")
        table.add_column("series")
        table.add_column("time constant, s", justify="right")
        for own in study.series:
            table.add_row(own.name, "-" if own.time_constant_s is None else f"{own.time_constant_s:.1f}")
        return Group(table, *study.words)
    table = Table(title=f"Time constants of smoothed multipath, {study.draws} draws [s]")
    for heading in ("smoothing", "least", "5 %", "median", "95 %", "most", "published least", "published most", "variance left, 5 / 170 s"):
        table.add_column(heading, justify="right")
    for s in study.smoothed:
        shares = " / ".join(f"{a:.3f} ({b:.3f})" for a, b in zip(s.variance_ratio, s.variance_ratio_exact, strict=True))
        numbers = (s.least_s, s.p5_s, s.median_s, s.p95_s, s.most_s, s.published_least_s, s.published_most_s)
        table.add_row(f"{s.smoothing_s:g}", *(f"{v:.1f}" for v in numbers), shares)
    return Group(table, *study.words)
