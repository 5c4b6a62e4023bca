"""From the numbers of a user over a day to one row of the map."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

PERCENTILES = (50.0, 95.0, 99.0, 99.5, 99.9)
"""Share of the day that a percentile holds for. [%]"""


def percentile_name(column: str, percentile: float) -> str:
    """Name of a column's percentile: ``hpl_m`` and 99.5 give ``hpl_p995_m``."""
    stem, sign, unit = column.rpartition("_m")
    digits = f"p{percentile:g}".replace(".", "")
    return f"{stem}_{digits}_m" if sign and not unit else f"{column}_{digits}"


@dataclass(frozen=True)
class Tile:
    """Users worked off together. [rad]."""

    lat_rad: Floats
    lon_rad: Floats


@dataclass(frozen=True)
class Evaluate:
    """Rows of the map for a tile: percentiles of every column, the share of epochs that meets every limit, and that of every cause.

    A percentile is the smallest number found that is not exceeded in that share of the epochs (nearest rank); an epoch without a number
    counts as infinite, so that a percentile is infinite where there is none for longer than the rest.
    """

    levels: Callable[[Floats, Floats], dict[str, NDArray[Any]]]
    columns: tuple[str, ...]
    limits: tuple[tuple[str, float], ...]
    causes: tuple[str, ...] = ()

    def __call__(self, tile: Tile) -> dict[str, NDArray[np.generic]]:
        """Evaluate the users of a tile."""
        levels = self.levels(tile.lat_rad, tile.lon_rad)
        # NaN is not within a limit.
        met = np.logical_and.reduce([levels[column] <= limit for column, limit in self.limits])
        rows: dict[str, NDArray[np.generic]] = {"p_available": met.mean(axis=1)}
        if "n_sv" in levels:
            rows["n_sv_least"] = levels["n_sv"].min(axis=1).astype(np.int64)
        rows |= {cause: levels[cause].mean(axis=1) for cause in self.causes}
        for column in self.columns:
            rows |= _percentiles(column, levels[column])
        return rows


def _percentiles(column: str, values: Floats) -> dict[str, NDArray[np.generic]]:
    n = values.shape[1]
    # NaN is sorted to the end, where infinity stands.
    ordered = np.sort(values, axis=1)
    if n == 1:
        return {column: _infinite(ordered[:, 0])}
    # 99.5 % of 200 epochs is the 199th; the product must not miss it by a rounding.
    ranks = {p: min(n, math.ceil(p / 100 * n - 1e-9)) for p in PERCENTILES}
    return {percentile_name(column, p): _infinite(ordered[:, rank - 1]) for p, rank in ranks.items()}


def _infinite(values: Floats) -> Floats:
    return np.where(np.isnan(values), np.inf, values)
