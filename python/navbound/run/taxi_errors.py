"""Errors of ranges and of carrier phase on the way to the stand, and the position errors that follow when they are solved."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from navbound.scenario.taxi import Fault

    Floats = NDArray[np.float64]
    Flags = NDArray[np.bool_]

CODE, PHASE, DRIFT, BIAS, STEERING, MONITOR = range(6)
"""What a stream of random numbers is for."""
_STREAMS_PER_TRACK = 1 << 16
_STREAMS_PER_USE = 1 << 10


def stream(seed: int, track: int, use: int, number: int = 0) -> np.random.Generator:
    """Philox stream of its own for a track, a use and a satellite: nothing drawn elsewhere changes it."""
    place = track * _STREAMS_PER_TRACK + use * _STREAMS_PER_USE + number
    return np.random.Generator(np.random.Philox(key=np.array([seed, place], dtype=np.uint64)))


def gauss_markov(generator: np.random.Generator, n: int, time_s: float) -> Floats:
    """First-order Gauss-Markov series of unit variance, one element a second."""
    draws = generator.standard_normal(n)
    keep = np.exp(-1.0 / time_s)
    for k in range(1, n):
        draws[k] = keep * draws[k - 1] + np.sqrt(1.0 - keep**2) * draws[k]
    return draws


def size(fault: Fault, seconds: Floats) -> Floats:
    """Range error of a fault at seconds since the start [m]."""
    acts = (seconds >= fault.start_s) & (seconds < fault.start_s + fault.duration_s)
    grown = fault.size_m if fault.kind == "range-step" else fault.rate_mps * (seconds - fault.start_s)
    return np.where(acts, grown, 0.0)


@dataclass(frozen=True)
class Sight:
    """Lines of sight with a clock for each constellation.

    Attributes
    ----------
    rows : ndarray, shape (..., n, m)
        Metres of range for a metre of position (east, north, up) and of each clock; 0 for a satellite that is not used.
    used : ndarray of bool, shape (..., n)
        Which satellites are.
    """

    rows: Floats
    used: Flags

    @classmethod
    def of(cls, az_rad: Floats, el_rad: Floats, systems: NDArray[np.int64]) -> Sight:
        """From directions; both angles NaN for a satellite that is not used."""
        used = ~np.isnan(el_rad)
        az, el = np.where(used, az_rad, 0.0), np.where(used, el_rad, 0.0)
        line = np.stack([np.cos(el) * np.sin(az), np.cos(el) * np.cos(az), np.sin(el)], axis=-1)
        clocks = np.broadcast_to(systems[:, None] == np.unique(systems), (*az.shape, len(np.unique(systems))))
        rows = np.concatenate([-line, clocks.astype(float)], axis=-1)
        return cls(np.where(used[..., None], rows, 0.0), used)

    def solve(self, sigma_m: Floats, range_m: Floats) -> Floats:
        """Position that range errors make in a weighted solution, east, north, up [m]; shape (..., 3)."""
        weight = np.where(self.used, 1.0 / np.square(np.where(self.used, sigma_m, 1.0)), 0.0)
        weighted = np.swapaxes(self.rows * weight[..., None], -1, -2)
        right = weighted @ np.where(self.used, range_m, 0.0)[..., None]
        return np.asarray(np.linalg.solve(weighted @ self.rows, right)[..., :3, 0], dtype=np.float64)

    def without(self, number: int) -> Sight:
        """With one satellite left out."""
        used = self.used.copy()
        used[..., number] = False
        return Sight(np.where(used[..., None], self.rows, 0.0), used)


def scaled_to(error_m: Floats, own_m2: Floats, wanted_m2: Floats) -> Floats:
    """Errors of one covariance turned into errors of another: L' L^-1 e with V = L Lᵀ, V' = L' L'ᵀ."""
    whitened = np.linalg.solve(np.linalg.cholesky(own_m2), error_m[..., None])
    return np.asarray((np.linalg.cholesky(wanted_m2) @ whitened)[..., 0], dtype=np.float64)
