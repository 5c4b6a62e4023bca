"""Decorrelation time of ground monitors: appendix B of Song, Milner and No 2024 (navi.673) done again, or the same on series of one's own.

A fault may act until a monitor's statistic has forgotten its past. For each kind of statistic the median autocorrelation over satellites is
followed to its first zero (code-carrier divergence, acceleration) or to 1/e (signal quality).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from navbound.records.base import Record
from navbound.studies.gauss_markov import gauss_markov
from navbound.studies.series_memory import INVERSE_E, autocorrelation, first_crossing, one_or_none, read_series

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray
    from rich.console import RenderableType

    Floats = NDArray[np.float64]

FILTER_S = 30.0
"""Each of the two first-order filters behind a divergence monitor (printed)."""
CHECKED_S = {0.5: 31.0, 14.0: 39.0, 30.0: 49.0, 50.0: 58.0, 100.0: 74.0}
"""Zero of the statistic's autocorrelation by the time constant of the multipath behind it (our specification)."""
PUBLISHED_S = {"code-carrier divergence": 60.0, "excessive acceleration": 2.0, "signal quality": 100.0}
SATELLITES, SAMPLES = 16, 14_400


class Divergence(Record):
    """Statistic of a divergence monitor behind multipath of one time constant."""

    multipath_s: float
    zero_s: float
    """First zero of its autocorrelation, from the spectrum."""
    expected_s: float
    simulated_s: float
    """The same by the algorithm from drawn series."""


class Measured(Record):
    """Series of a file."""

    n_series: int
    step_s: float
    zero_s: float | None
    inverse_e_s: float | None


class Study(Record):
    """Synthetic statistics, or those of a file."""

    divergence: list[Divergence]
    measured: Measured | None
    effective_s: float
    """The largest published decorrelation time, which the study of surface movement uses."""
    words: list[str]

    def table(self) -> RenderableType:
        """Lay the study out for a terminal."""
        return _render(self)


def run(files: Sequence[str | Path] = (), *, seed: int = 673) -> Study:
    """Work out decorrelation times.

    Parameters
    ----------
    files : sequence of path
        None, or one table with ``time_s`` and a column for each satellite.
    seed : int
        Of the drawn series.

    Raises
    ------
    InputError
        More than one file.
    FormatError
        A file that is no such table.
    """
    path = one_or_none(files)
    effective = max(PUBLISHED_S.values())
    if path is not None:
        step, columns = read_series(path)
        zero, inverse = (decorrelation(np.stack(list(columns.values())), level) * step for level in (0.0, INVERSE_E))
        shown = [None if np.isnan(lag) else float(lag) for lag in (zero, inverse)]
        measured = Measured(n_series=len(columns), step_s=step, zero_s=shown[0], inverse_e_s=shown[1])
        return Study(divergence=[], measured=measured, effective_s=effective, words=["Median over the series at each lag."])
    generator = np.random.Generator(np.random.Philox(seed))
    rows = [
        Divergence(multipath_s=tau, zero_s=spectral_zero(tau), expected_s=expected, simulated_s=_simulated(generator, tau))
        for tau, expected in CHECKED_S.items()
    ]
    words = [f"{name}: {seconds:g} s published" for name, seconds in PUBLISHED_S.items()]
    words.append("A divergence of 60 s belongs to multipath of about 50 s; the largest of the three is used: 100 s.")
    return Study(divergence=rows, measured=None, effective_s=effective, words=words)


def decorrelation(series: Floats, level: float) -> float:
    """Lag, in samples, at which the median autocorrelation over rows, counted from their means, first is at or below a level."""
    return float(first_crossing(np.nanmedian(autocorrelation(series, remove_mean=True), axis=0), level))


def spectral_zero(multipath_s: float) -> float:
    """First zero of the autocorrelation whose spectrum is w² / ((1 + 900 w²)² (1 + w² tau²)) [s]."""
    step, n = 0.05, 1 << 19
    w = 2 * np.pi * np.fft.rfftfreq(n, step)
    power = w**2 / ((1 + FILTER_S**2 * w**2) ** 2 * (1 + multipath_s**2 * w**2))
    values = np.fft.irfft(power)
    return float(first_crossing(values / values[0], 0.0)) * step


def _simulated(generator: np.random.Generator, multipath_s: float) -> float:
    """The same from series: multipath, its rate, and two first-order filters in cascade."""
    x = gauss_markov(generator.standard_normal((SATELLITES, SAMPLES)), multipath_s)
    rate = np.diff(x, prepend=x[:, :1])
    first, second = np.zeros(SATELLITES), np.zeros(SATELLITES)
    out = np.empty((SATELLITES, SAMPLES))
    weight = 1.0 - np.exp(-1.0 / FILTER_S)
    for k in range(SAMPLES):
        first = first + weight * (rate[:, k] - first)
        second = second + weight * (first - second)
        out[:, k] = second
    return decorrelation(out[:, 600:], 0.0)


def _render(study: Study) -> RenderableType:
    from rich.console import Group  # noqa: PLC0415
    from rich.table import Table  # noqa: PLC0415

    if study.measured is not None:
        m = study.measured
        table = Table(title=f"Decorrelation of {m.n_series} series, step {m.step_s:g} s")
        table.add_column("first zero, s", justify="right")
        table.add_column("first 1/e, s", justify="right")
        table.add_row(*("-" if v is None else f"{v:.1f}" for v in (m.zero_s, m.inverse_e_s)))
        return Group(table, *study.words)
    table = Table(title="Statistic of a divergence monitor: first zero of its autocorrelation [s]")
    for heading in ("multipath", "from the spectrum", "specification", "from series"):
        table.add_column(heading, justify="right")
    for d in study.divergence:
        table.add_row(f"{d.multipath_s:g}", f"{d.zero_s:.1f}", f"{d.expected_s:g}", f"{d.simulated_s:.1f}")
    return Group(table, *study.words)
