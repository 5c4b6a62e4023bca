"""Columns of the epoch table as compact text: quantised, differenced, split into byte planes, deflated, base64.

A value is kept to its stated resolution, half of which is the largest error; the page reverses the steps (web/src/data/packing.ts).
"""

from __future__ import annotations

import base64
import zlib
from dataclasses import dataclass
from typing import Literal

import numpy as np
import polars as pl
from numpy.typing import NDArray

NULL = np.int64(-(2**31))
"""Quantised value that stands for "does not exist"."""
ZERO = NULL + 1
"""Quantised value that stands for a probability of exactly zero, whose logarithm does not exist."""
_LARGEST = 2**31 - 3
_WORD = np.int64(2**32)

RESOLUTION = {
    "_lat_rad": 1e-10,
    "_lon_rad": 1e-10,
    "az_rad": 1e-4,
    "el_rad": 1e-4,
    "_rad": 1e-7,
    "_radps": 1e-9,
    "_m2": 1e-4,
    "_m": 1e-3,
    "_mps": 1e-3,
    "_mps2": 1e-6,
    "_s": 1e-4,
    "_dbhz": 0.01,
    "innovation_": 1e-3,
    "dop": 1e-3,
    "n_": 1.0,
}
"""Finest resolution by name: ending, or beginning for counts; 1e-10 rad of latitude is 0.6 mm."""
LOG10_RESOLUTION = 1e-4
"""Resolution of log10 of a probability: 0.01 % of the value."""


@dataclass(frozen=True)
class Packed:
    """One column: how to read it, and its bytes before deflation."""

    name: str
    kind: Literal["linear", "log10"]
    resolution: float
    offset: float
    order: int
    """How many times neighbouring values were subtracted."""
    planes: bytes

    def head(self) -> dict[str, object]:
        """Return what the page needs to reverse the packing."""
        return {"name": self.name, "kind": self.kind, "resolution": self.resolution, "offset": self.offset, "order": self.order}


def resolution_of(name: str) -> float:
    """Finest resolution kept for a column, in the unit of its name."""
    for part, value in RESOLUTION.items():
        if name.endswith(part) or (part.endswith("_") and name.startswith(part)):
            return value
    return 1e-6


def pack(name: str, values: NDArray[np.float64]) -> Packed:
    """Quantise and difference one column.

    Parameters
    ----------
    name : str
        Column name of docs/notation.md; its suffix decides the resolution.
    values : ndarray, shape (n,)
        NaN where the value does not exist; infinities count as not existing.

    Returns
    -------
    Packed
        Resolution is the finest one whose range fits 32 bits.
    """
    probability = name.startswith("p_")
    good = np.isfinite(values)
    zero = good & (values <= 0) if probability else np.zeros_like(good)
    scaled = np.full(len(values), np.nan)
    usable = good & ~zero
    scaled[usable] = np.log10(values[usable]) if probability else values[usable]
    offset = float(scaled[usable][0]) if usable.any() else 0.0
    resolution = LOG10_RESOLUTION if probability else resolution_of(name)
    spread = float(np.max(np.abs(scaled[usable] - offset))) if usable.any() else 0.0
    while spread / resolution > _LARGEST:
        resolution *= 10
    quantised = np.full(len(values), NULL, dtype=np.int64)
    quantised[zero] = ZERO
    quantised[usable] = np.rint((scaled[usable] - offset) / resolution).astype(np.int64)
    order, words = _difference(quantised)
    planes = b"".join(((words >> shift) & 0xFF).astype(np.uint8).tobytes() for shift in (0, 8, 16, 24))
    return Packed(name, "log10" if probability else "linear", resolution, offset, order, planes)


def _difference(values: NDArray[np.int64]) -> tuple[int, NDArray[np.int64]]:
    """Difference 0, 1 or 2 times, whichever leaves the fewest bits, then fold the sign into the lowest bit."""
    best: tuple[float, int, NDArray[np.int64]] | None = None
    current = values
    for order in range(3):
        # Differences wrap modulo 2^32, so the markers NULL and ZERO survive them.
        wrapped = (current + _WORD // 2) % _WORD - _WORD // 2
        words = np.where(wrapped < 0, -2 * wrapped - 1, 2 * wrapped)
        bits = float(np.sum(np.log2(1.0 + words)))
        if best is None or bits < best[0]:
            best = (bits, order, words)
        current = np.diff(wrapped, prepend=0)
    assert best is not None
    return best[1], best[2]


def deflate(columns: list[Packed]) -> str:
    """All columns of one track in one deflated stream, as base64."""
    return base64.b64encode(zlib.compress(b"".join(column.planes for column in columns), 6)).decode("ascii")


def run_lengths(values: pl.Series) -> dict[str, object]:
    """Run lengths of a text column: distinct words in the order of their first, then (word index, count) pairs; -1 is null."""
    runs = values.rle().struct.unnest()
    place: dict[str | None, int] = {None: -1}
    for word in runs["value"]:
        place.setdefault(word, len(place) - 1)
    return {"words": list(place)[1:], "runs": [[place[word], n] for n, word in runs.select("len", "value").iter_rows()]}
