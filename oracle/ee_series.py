"""The series of the Error Extraction reference, made again from their seeds: SplitMix64, Box-Muller, and the errors of each axis."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

_WORD = (1 << 64) - 1


def words(seed: int) -> Iterator[int]:
    """SplitMix64."""
    state = seed
    while True:
        state = (state + 0x9E3779B97F4A7C15) & _WORD
        x = ((state ^ (state >> 30)) * 0xBF58476D1CE4E5B9) & _WORD
        x = ((x ^ (x >> 27)) * 0x94D049BB133111EB) & _WORD
        yield x ^ (x >> 31)


def uniforms(seed: int) -> Iterator[float]:
    """Uniform numbers strictly between 0 and 1."""
    return (((x >> 11) + 0.5) * 2.0**-53 for x in words(seed))


def normals(seed: int) -> Iterator[float]:
    """Normal numbers in pairs, cosine first."""
    u = uniforms(seed)
    for first in u:
        radius, angle = math.sqrt(-2.0 * math.log(first)), 2.0 * math.pi * next(u)
        yield radius * math.cos(angle)
        yield radius * math.sin(angle)


@dataclass(frozen=True)
class Made:
    """Positions, velocities and true positions; shape (n, 3), east, north, up."""

    position_m: NDArray[np.float64]
    velocity_mps: NDArray[np.float64]
    truth_m: NDArray[np.float64]


def series(params: dict[str, Any]) -> Made:
    """Every epoch and axis draws white, Gauss-Markov and velocity noise, in this order."""
    n, period = params["n"], params["T"]
    z = normals(params["seed"])
    position, velocity, truth = (np.empty((n, 3)) for _ in range(3))
    slow = [0.0, 0.0, 0.0]
    for i in range(n):
        t = i * period
        for k, axis in enumerate("ENU"):
            p = params[axis]
            white, drive, speed_noise = next(z), next(z), next(z)
            phi = math.exp(-period / p["tau"])
            step = p["sigma_gm"] * drive
            slow[k] = step if i == 0 else phi * slow[k] + step * math.sqrt(1.0 - phi * phi)
            turn = 2.0 * math.pi / p["period"]
            error = p["bias"] + p["sigma_white"] * white + slow[k]
            error += p["step"] if i >= p["step_at"] else 0.0
            error += p["ramp"] * (t - p["ramp_at"] * period) if i > p["ramp_at"] else 0.0
            truth[i, k] = p["amp"] * math.sin(turn * t) + p["speed"] * t
            position[i, k] = truth[i, k] + error
            velocity[i, k] = p["amp"] * turn * math.cos(turn * t) + p["speed"] + p["sigma_v"] * speed_noise
    return Made(position, velocity, truth)
