"""Array arguments: broadcast over leading axes, handed to the core flat, given back in shape."""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING

import numpy as np

from navbound import _core
from navbound.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

Floats = "NDArray[np.float64]"

MOST_AXES = 32
"""Axes of an array argument; what broadcasts shapes takes no more. [1]"""
MOST_BYTES = 16 << 30
"""What the broadcast copy of one array argument may need: a day of 1 Hz epochs needs less than a megabyte per number. [B]"""


_PLAIN = (np.ndarray, np.float64, int, list, tuple)
"""Classes whose objects have no mask."""


def numbers(name: str, value: object, expected: str = "numbers") -> NDArray[np.generic]:
    """See a named argument as an array of real numbers.

    Raises
    ------
    InputError
        Text, times, complex numbers, masked entries (whose values would be taken for good ones), integers that no double holds, lists of
        different lengths, other objects, more than :data:`MOST_AXES` axes, or more than :data:`MOST_BYTES`.
    """
    if type(value) is float:
        return np.asarray(value)
    if type(value) is np.ndarray and value.dtype == np.float64 and value.ndim <= MOST_AXES and value.nbytes <= MOST_BYTES:
        return value
    if value is None:
        raise InputError(name, None, domain=expected)
    if _is_masked(value):
        raise InputError(name, "an array with masked entries", domain="an array without a mask; NaN stands for an absent number")
    try:
        array = np.asarray(value)
        if array.dtype.kind == "O":
            array = array.astype(np.float64)
    except (TypeError, ValueError, OverflowError) as e:
        raise InputError(name, shown(value), domain=expected) from e
    if array.dtype.kind not in "biuf":
        raise InputError(name, shown(value), domain=expected)
    if array.ndim > MOST_AXES:
        raise InputError(name, f"{array.ndim} axes", domain=f"an array of at most {MOST_AXES} axes")
    _require_room(name, array.size * 8)
    return array


def _is_masked(value: object) -> bool:
    """Whether entries are masked; `numpy.ma` is loaded where somebody has made such an array, not here."""
    if type(value) in _PLAIN or "numpy.ma" not in sys.modules:
        return False
    return isinstance(value, np.ma.MaskedArray) and bool(np.ma.getmaskarray(value).any())


def whole_numbers(name: str, value: object, expected: str = "whole numbers") -> NDArray[np.int64]:
    """See a named argument as whole numbers of 63 bits: times in nanoseconds, indices.

    Raises
    ------
    InputError
        As :func:`numbers`; or numbers with a fraction, or that are no numbers (they would become others without a word), or too large.
    """
    array = numbers(name, value, expected)
    if array.size and array.dtype.kind != "b":
        limit = 2.0**63 if array.dtype.kind == "f" else 2**63 - 1
        if array.dtype.kind == "f" and not (
            np.isfinite(array).all() and (array == np.floor(array)).all() and (np.abs(array) < limit).all()
        ):
            raise InputError(name, shown(value), domain=f"{expected} of at most 63 bits")
        if array.dtype.kind == "u" and int(array.max()) > limit:
            raise InputError(name, shown(value), domain=f"{expected} of at most 63 bits")
    return np.ascontiguousarray(array.astype(np.int64)).reshape(array.shape)


def _require_room(name: str, needed: int) -> None:
    if needed > MOST_BYTES:
        raise InputError(name, f"{needed / 2**30:.1f} GiB when broadcast", domain=f"arrays of at most {MOST_BYTES >> 30} GiB; cut them")


def shown(value: object) -> str:
    """What a value is, in few characters, for a message."""
    try:
        return repr(value)[:60]
    except ValueError:
        # An integer of thousands of digits has no text.
        return type(value).__name__


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
    # One number, or arrays that fit as they are, is what is called most: nothing is left to do or to refuse.
    plain = _core.flatten_plain(arguments)
    if plain is not None:
        return plain
    arrays: list[tuple[NDArray[np.float64], tuple[int, ...]]] = []
    leading: tuple[int, ...] = ()
    for name, (value, item) in arguments.items():
        array = np.asarray(numbers(name, value), dtype=np.float64)
        split = array.ndim - len(item)
        if split < 0 or array.shape[split:] != item:
            raise InputError(name, f"shape {array.shape}", domain=f"shape (..., {', '.join(map(str, item))})")
        try:
            leading = np.broadcast_shapes(leading, array.shape[:split])
        except ValueError as e:
            raise InputError(name, f"shape {array.shape}", domain=f"shapes that broadcast with {leading}") from e
        # Arrays that came in messages, as from a cluster, may start at any byte.
        arrays.append((array if array.flags.aligned else array.copy(), item))
    for name, (_, item) in arguments.items():
        _require_room(name, 8 * math.prod(leading + item))
    flat = [np.ascontiguousarray(np.broadcast_to(array, leading + item)).reshape(-1, *item) for array, item in arrays]
    return leading, flat


def unflatten(values: NDArray[np.float64], shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Give a flat result its leading shape; zero-dimensional results stay arrays of shape ``()``."""
    return values if values.shape == shape else values.reshape(shape + values.shape[1:])


def split_columns(table: NDArray[np.float64], shape: tuple[int, ...]) -> list[NDArray[np.float64]]:
    """Split a flat table into columns, each in the leading shape."""
    return [unflatten(np.ascontiguousarray(table[:, k]), shape) for k in range(table.shape[1])]
