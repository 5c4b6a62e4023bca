"""Arguments that GBAS and RRAIM functions share: satellites in rows, optional arrays, choices by name."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from navbound.errors import InputError
from navbound.table.arrays import flatten

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray


def systems(width: int, constellation: Sequence[int] | NDArray[np.int64] | None) -> list[int]:
    """Index of each satellite's system."""
    indices = np.zeros(width, dtype=np.int64) if constellation is None else np.asarray(constellation)
    if indices.shape != (width,) or not np.issubdtype(indices.dtype, np.integer) or indices.min() < 0:
        raise InputError("constellation", f"shape {indices.shape}", domain=f"{width} indices of gnss.CONSTELLATIONS")
    return [int(c) for c in indices]


def spread(name: str, value: ArrayLike | None, leading: tuple[int, ...], item: tuple[int, ...]) -> NDArray[np.float64] | None:
    """An optional argument broadcast to the leading shape, flat; None where it was not given."""
    if value is None:
        return None
    array = numbers(name, value)
    try:
        return np.ascontiguousarray(np.broadcast_to(array, leading + item)).reshape(-1)
    except ValueError as e:
        raise InputError(name, f"shape {array.shape}", domain=f"shapes that broadcast to {leading + item}") from e


def width_of(shape: tuple[int, ...]) -> int:
    """Number of satellites, the last axis."""
    if not shape or shape[-1] == 0:
        raise InputError("az_rad", f"shape {shape}", domain="shape (..., n), n at least 1")
    return shape[-1]


def numbers(name: str, value: ArrayLike) -> NDArray[np.float64]:
    """An argument as numbers in its own shape."""
    _, (flat,) = flatten(**{name: (value, ())})
    return flat.reshape(np.shape(value))


def named(argument: str, value: str, allowed: tuple[str, ...]) -> str:
    """A choice among names."""
    if value not in allowed:
        raise InputError(argument, value, domain=", ".join(allowed))
    return value
