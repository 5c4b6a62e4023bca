"""Pictures of errors against what was stated of them: Stanford diagrams, survival of errors, coverage of bounds."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from navbound import kpi
from navbound.errors import InputError
from navbound.plot.parts import axes, colours, finish, finite

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

CELLS = 120


def stanford(error_m: ArrayLike, level_m: ArrayLike, limit_m: float, *, ax: Axes | None = None) -> Axes:
    """Error against protection level: counts of epochs, the diagonal, the alert limit, and how many are in each region.

    Regions and counts are those of :func:`navbound.kpi.stanford`.

    Parameters
    ----------
    error_m, level_m : array_like, shape (n,)
        Errors and levels; what has no number is counted and not drawn. What is beyond the axes is in the last row and column. [m]
    limit_m : float
        Alert limit. [m]
    """
    most = 1.5 * limit_m
    error, level = _pair(error_m, level_m)
    counted = kpi.stanford(error, level, limit_m, bin_m=most / CELLS, limit_m=most)
    counts, bins = counted.counts, counted.bins
    ax, palette = axes(ax), colours()
    cells = np.zeros((CELLS + 1, CELLS + 1))
    cells[bins.level_bin, bins.error_bin] = bins.count
    edges = np.arange(CELLS + 2) * bins.bin_m
    mesh = ax.pcolormesh(edges, edges, np.ma.masked_equal(cells, 0), cmap="viridis", norm="log", zorder=2)
    ax.figure.colorbar(mesh, ax=ax, label="epochs a cell; the last row and column hold what is beyond")
    ax.plot([0, edges[-1]], [0, edges[-1]], color=palette["ink"], zorder=3)
    ax.axhline(limit_m, color=palette["limit"], linestyle="--", zorder=3)
    ax.axvline(limit_m, color=palette["limit"], linestyle="--", zorder=3)
    ax.fill([limit_m, edges[-1], edges[-1], limit_m], [0, 0, limit_m, limit_m], color=palette["warning"], alpha=0.18, linewidth=0)
    ax.fill([0, limit_m, limit_m], [0, 0, limit_m], color=palette["caution"], alpha=0.15, linewidth=0)
    words = (
        ("nominal", counts.n_nominal, 0.3, 0.85),
        ("unavailable", counts.n_unavailable, 0.5, 1.3),
        ("misleading", counts.n_mi, 0.68, 0.15),
        ("hazardous", counts.n_hmi, 1.27, 0.5),
        ("unavailable,\nmisleading", counts.n_unavailable_mi, 1.36, 1.12),
    )
    for name, n, x, y in words:
        plate = {"facecolor": palette["ground"], "alpha": 0.75, "linewidth": 0, "pad": 2}
        text = f"{name}\n{n}"
        ax.text(x * limit_m, y * limit_m, text, ha="center", va="center", fontsize="small", color=palette["ink"], zorder=4, bbox=plate)
    ax.set(xlim=(0, edges[-1]), ylim=(0, edges[-1]), aspect="equal")
    title = f"{len(error)} epochs, {len(error) - counts.n} without a level or an error"
    return finish(ax, title, "error [m]", "protection level [m]", legend=False)


def survival(error_m: ArrayLike, bound_m: ArrayLike, risk: float, *, ax: Axes | None = None) -> Axes:
    """How often errors are larger than some multiple of their bound; the bound is consistent where the line passes below its risk at one.

    Parameters
    ----------
    error_m, bound_m : array_like, shape (n,)
        Absolute errors, and what was stated of each. [m]
    risk : float
        That an error is beyond its bound, as stated. [1]
    """
    if not 0 < risk < 1:
        raise InputError("risk", risk, "1", "(0, 1)")
    error, bound = _pair(error_m, bound_m)
    ratio = np.sort(finite(error / bound))
    if not len(ratio):
        raise InputError("error_m", "no error with a bound", domain="one or more")
    ax, palette = axes(ax), colours()
    larger = 1.0 - np.arange(len(ratio)) / len(ratio)
    beyond = float((ratio > 1).mean())
    ax.step(ratio, larger, where="post", color=palette["path"], label=f"{len(ratio)} errors, {100 * beyond:.3g} % beyond")
    ax.axvline(1.0, color=palette["limit"], linestyle="--")
    ax.axhline(risk, color=palette["limit"], linestyle=":", label=f"stated risk, {risk:g}")
    ax.plot([1.0], [risk], "o", color=palette["warning"] if beyond > risk else palette["normal"])
    ax.set_yscale("log")
    ax.set_xlim(left=0)
    return finish(ax, "Errors against their bound", "error / bound [1]", "share of the errors that are larger [1]")


def histogram(error_m: ArrayLike, *, sigma_m: ArrayLike | None = None, ax: Axes | None = None) -> Axes:
    """Signed errors; with the standard deviations that were stated, errors over these beside the normal law."""
    error = np.ravel(np.asarray(error_m, dtype=np.float64))
    label = "error [m]"
    if sigma_m is not None:
        error, label = error / np.broadcast_to(np.asarray(sigma_m, dtype=np.float64), error.shape), "error / stated standard deviation [1]"
    known = finite(error)
    if not len(known):
        raise InputError("error_m", "no error", domain="one or more")
    ax, palette = axes(ax), colours()
    ax.hist(
        known,
        bins=min(100, max(10, round(math.sqrt(len(known))))),
        density=True,
        color=palette["path"],
        alpha=0.6,
        label=f"{len(known)} errors",
    )
    if sigma_m is not None:
        x = np.linspace(*ax.get_xlim(), 200)
        ax.plot(x, np.exp(-0.5 * x**2) / math.sqrt(math.tau), color=palette["ink"], label="normal, deviation 1")
    return finish(ax, f"Mean {known.mean():.3g}, deviation {known.std():.3g}", label, "density")


def _pair(a: ArrayLike, b: ArrayLike) -> tuple[Floats, Floats]:
    first, second = (np.ravel(np.asarray(v, dtype=np.float64)) for v in (a, b))
    if first.shape != second.shape:
        raise InputError("error_m", f"{len(first)} errors", domain=f"as many as levels or bounds, {len(second)}")
    return np.abs(first), second
