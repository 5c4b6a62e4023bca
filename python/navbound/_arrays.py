"""Array arguments: broadcast over leading axes, handed to the core flat, given back in shape."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from navbound.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

Floats = "NDArray[np.float64]"


def flatten(**arguments: tuple[ArrayLike, tuple[int, ...]]) -> tuple[tuple[int, ...], list[NDArray[np.float64]]]:
    """Broadcast the leading axes of named arguments against each other.

    Each argument comes with the shape of one item: ``()`` a number, ``(3,)`` a vector, ``(2, 2)`` a matrix.

    Returns
    -------
    shape : tuple of int
        The common leading shape.
    flat : list of ndarray
        Contiguous float64 arrays of shape ``(n, *item)``, in the order given.

    Raises
    ------
    InputError
        Not numbers, a wrong item shape, or leading shapes that do not broadcast.
    """
    arrays: list[tuple[NDArray[np.float64], tuple[int, ...]]] = []
    leading: tuple[int, ...] = ()
    for name, (value, item) in arguments.items():
        try:
            array = np.asarray(value, dtype=np.float64)
        except (TypeError, ValueError) as e:
            raise InputError(name, repr(value)[:60], domain="numbers") from e
        split = array.ndim - len(item)
        if split < 0 or array.shape[split:] != item:
            raise InputError(name, f"shape {array.shape}", domain=f"shape (..., {', '.join(map(str, item))})")
        try:
            leading = np.broadcast_shapes(leading, array.shape[:split])
        except ValueError as e:
            raise InputError(name, f"shape {array.shape}", domain=f"shapes that broadcast with {leading}") from e
        # Arrays that came in messages, as from a cluster, may start at any byte.
        arrays.append((array if array.flags.aligned else array.copy(), item))
    flat = [np.ascontiguousarray(np.broadcast_to(array, leading + item)).reshape(-1, *item) for array, item in arrays]
    return leading, flat


def unflatten(values: NDArray[np.float64], shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Give a flat result its leading shape; zero-dimensional results stay arrays of shape ``()``."""
    return values.reshape(shape + values.shape[1:])


def split_columns(table: NDArray[np.float64], shape: tuple[int, ...]) -> list[NDArray[np.float64]]:
    """Split a flat table into columns, each in the leading shape."""
    return [unflatten(np.ascontiguousarray(table[:, k]), shape) for k in range(table.shape[1])]
