"""One pseudorange or the ionosphere-free pair: which of two solutions of a file states the smaller covariance."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from navbound.table.columns import VARIANCES

if TYPE_CHECKING:
    from collections.abc import Callable

    import polars as pl
    from numpy.typing import NDArray

    from navbound.gnss.receivers import Positions

LEAST_SHARE = 0.95
"""Pairs must give this share of the positions that one pseudorange gives: a smaller covariance at a few epochs is no better solution.
Ours."""


OK_SHARE = 0.5
"""Pairs that are ok at this share of the epochs are taken before one pseudorange that is not. Ours."""


def smaller_covariance(solve: Callable[[str], Positions]) -> Positions:
    """The solution of the whole file whose declared covariance is the smaller; its models say which, and what it was compared with.

    Epochs are not mixed: positions of two kinds differ by what the ionosphere leaves in one of them, and would jump. Compared is the median
    trace of the covariance at the epochs that both solve.

    Parameters
    ----------
    solve : callable
        Gives the positions with ``single`` or ``dual`` signals.
    """
    single, dual = solve("single"), solve("dual")
    traces = [_trace(p.epochs) for p in (single, dual)]
    solved = [np.isfinite(t) for t in traces]
    both = solved[0] & solved[1]
    if not both.any() or both.sum() < LEAST_SHARE * solved[0].sum():
        words = f"one pseudorange; ionosphere-free pairs give {int(solved[1].sum())} of its {int(solved[0].sum())} positions"
        return _with_words(single if solved[0].any() else dual, words if solved[0].any() else "ionosphere-free pairs; no other position")
    usable = [float(np.mean(p.epochs["status"].to_numpy()[both] == "ok")) for p in (single, dual)]
    if usable[0] < OK_SHARE <= usable[1]:
        # A smaller covariance of positions that nobody vouches for is no better solution.
        return _with_words(dual, f"ionosphere-free pairs: ok at {usable[1]:.0%} of the epochs against {usable[0]:.0%} of one pseudorange")
    sigma = [float(np.sqrt(np.median(t[both]))) for t in traces]
    if sigma[1] < sigma[0]:
        return _with_words(dual, f"ionosphere-free pairs: median sigma {sigma[1]:.2f} m against {sigma[0]:.2f} m of one pseudorange")
    return _with_words(single, f"one pseudorange: median sigma {sigma[0]:.2f} m against {sigma[1]:.2f} m of ionosphere-free pairs")


def _trace(epochs: pl.DataFrame) -> NDArray[np.float64]:
    axes = epochs.select(VARIANCES).fill_null(np.nan).to_numpy()
    return np.asarray(axes.sum(axis=1), dtype=np.float64)


def _with_words(positions: Positions, words: str) -> Positions:
    return replace(positions, models={**positions.models, "signals": f"{words}; {positions.models['signals'].partition(': ')[2]}"})
