"""What every picture shares: tables of whatever is given, colours of the report, times, and what is not there drawn as not there."""

from __future__ import annotations

import functools
import re
from dataclasses import dataclass
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound.errors import InputError, NotFoundError
from navbound.run.directory import Run
from navbound.status import USABLE
from navbound.time import utc_text

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

INSTALL = "pictures need matplotlib: pip install 'navbound[plot]'"
ALERTS = ("caution", "warning", "unavailable")
"""States of the monitor that are marked, by the names that the epochs have."""


def axes(ax: Axes | None, *, polar: bool = False) -> Axes:
    """The axes that were passed, or new ones.

    Raises
    ------
    ImportError
        There is no matplotlib.
    """
    if ax is not None:
        return ax
    try:
        from matplotlib import pyplot  # noqa: PLC0415 - an extra, loaded where a picture is drawn
    except ImportError as e:
        raise ImportError(INSTALL) from e
    _, made = pyplot.subplots(subplot_kw={"projection": "polar"} if polar else None, layout="constrained")
    return made


@functools.cache
def colours() -> dict[str, str]:
    """Colours of the report's light theme by their names: ``normal``, ``caution``, ``warning``, ``path``, ``limit``, ``ink``, ``muted``."""
    sheet = files("navbound").joinpath("_web").joinpath("report.css").read_text(encoding="utf-8")
    named: dict[str, str] = {}
    for name, value in re.findall(r"--([a-z-]+):\s*(#[0-9a-f]{3,8})", sheet):
        # The first theme of the sheet is the light one.
        named.setdefault(name, value)
    return named


def table(of: Any) -> pl.DataFrame:
    """Epochs of a run, a data frame of any library, or columns by name.

    Raises
    ------
    InputError
        Something else.
    """
    if isinstance(of, Run):
        return of.epochs
    if isinstance(of, pl.DataFrame):
        return of
    # Data frames of other libraries hand their columns over by the interface of Arrow.
    if isinstance(of, dict) or hasattr(of, "__arrow_c_stream__"):
        return pl.DataFrame(of)
    raise InputError("of", type(of).__name__, domain="a Run, a data frame, or columns by name")


def column(epochs: pl.DataFrame, name: str) -> Floats:
    """A column of numbers, NaN where there is none.

    Raises
    ------
    InputError
        The table does not have it.
    """
    if name not in epochs.columns:
        raise NotFoundError("column", name, "column of the table", epochs.columns)
    return epochs[name].cast(pl.Float64).fill_null(float("nan")).to_numpy()


@dataclass(frozen=True)
class Track:
    """Epochs of one track, with what the axis of time needs.

    Attributes
    ----------
    minutes : ndarray
        Since its first epoch. [min]
    usable : ndarray of bool
        Epochs that were judged.
    words : str
        Label of the axis of time.
    """

    epochs: pl.DataFrame
    name: str
    minutes: Floats
    usable: NDArray[np.bool_]
    words: str

    def numbers(self, name: str) -> Floats:
        """A column; NaN at epochs that are not usable, so that a line is broken there."""
        return np.where(self.usable, column(self.epochs, name), np.nan)


def track_of(of: Any, name: str | None) -> Track:
    """One track of a table: the one named, or the only one.

    Raises
    ------
    InputError
        Several tracks and no name, or one that is not there.
    """
    epochs = table(of)
    if epochs.is_empty():
        raise InputError("of", "0 epochs", domain="one epoch or more")
    names = epochs["track"].unique(maintain_order=True).to_list() if "track" in epochs.columns else []
    if name is None and len(names) > 1:
        raise InputError("track", "none", domain=f"one of {', '.join(map(str, names[:5]))}{' ...' if len(names) > 5 else ''}")
    if name is not None:
        if name not in names:
            raise NotFoundError("track", name, "track", [str(each) for each in names])
        epochs = epochs.filter(pl.col("track") == name)
    time_ns = epochs["time_ns"].to_numpy() if "time_ns" in epochs.columns else np.arange(epochs.height) * 10**9
    usable = epochs["status"].is_in(USABLE).to_numpy() if "status" in epochs.columns else np.ones(epochs.height, dtype=bool)
    begin = f"since {utc_text(int(time_ns[0]))} UTC" if "time_ns" in epochs.columns else "since the first epoch, one a second"
    return Track(epochs, str(name or (names[0] if names else "")), (time_ns - time_ns[0]) / 60e9, usable, f"time [min] {begin}")


def spans(minutes: Floats, where: NDArray[np.bool_]) -> list[tuple[float, float]]:
    """Begin and end of runs of epochs: from the first to the one behind the last. [min]."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], where, [False]]).astype(np.int8)))
    last = len(minutes) - 1
    return [(float(minutes[a]), float(minutes[min(b, last)])) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def mark_absent(ax: Axes, track: Track, known: NDArray[np.bool_]) -> None:
    """Hatch the times at which there is nothing to show."""
    label: str | None = "no bound"
    for begin, end in spans(track.minutes, ~known):
        ax.axvspan(begin, end, facecolor="none", edgecolor=colours()["muted"], hatch="//", alpha=0.4, linewidth=0, label=label)
        label = None


def mark_alerts(ax: Axes, track: Track) -> None:
    """Colour the times of cautions and warnings."""
    if "alert" not in track.epochs.columns:
        return
    alert = track.epochs["alert"].to_numpy()
    for kind in ("caution", "warning"):
        label: str | None = kind
        for begin, end in spans(track.minutes, alert == kind):
            ax.axvspan(begin, end, color=colours()[kind], alpha=0.18, linewidth=0, label=label)
            label = None


def finish(ax: Axes, title: str, x: str, y: str, *, legend: bool = True) -> Axes:
    """Title, labels, grid and legend."""
    ax.set(title=title, xlabel=x, ylabel=y)
    ax.grid(visible=True, color=colours()["rule"], linewidth=0.6)
    ax.set_axisbelow(b=True)
    if legend and ax.get_legend_handles_labels()[0]:
        ax.legend(framealpha=0.85, edgecolor="none", fontsize="small")
    return ax


def finite(*values: Iterable[float]) -> Floats:
    """All finite numbers of some arrays."""
    every = np.concatenate([np.ravel(np.asarray(v, dtype=np.float64)) for v in values])
    return np.asarray(every[np.isfinite(every)], dtype=np.float64)
