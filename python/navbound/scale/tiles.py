"""Tiles of a job: cutting it, and putting the results together in order."""

from __future__ import annotations

from contextlib import closing
from itertools import pairwise
from typing import TYPE_CHECKING, TypedDict, TypeVar

import numpy as np

from navbound.errors import InputError, NotFoundError
from navbound.scale.backends import BACKENDS, Workers
from navbound.scale.checkpoint import Folder, Nothing

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

LEAST_S = 0.2
"""Work that a tile should hold at least: handing it over and keeping its result costs some milliseconds. [s]"""
USUAL_S = 1.0
"""Work that a tile holds where there is enough: little is lost when a worker is. [s]"""

Tile = TypeVar("Tile")


class Work(TypedDict, total=False):
    """How tiles are worked off: the keyword arguments of :func:`map_tiles` that every job on tiles takes and hands on."""

    backend: str
    checkpoint: str | Path | None
    progress: Callable[[int, int], None] | None
    workers: Workers | None


def cut(n: int, seconds_each: float, bytes_each: float = 0.0, *, most_bytes: float = 2e8) -> list[slice]:
    """Cut items into tiles of about a second, of at least :data:`LEAST_S`, whose memory is bounded.

    The cut depends on the arguments alone, not on the machine: tiles that were kept fit again.

    Parameters
    ----------
    n : int
        Items. [1]
    seconds_each : float
        What an item costs, about. [s]
    bytes_each : float, optional
        Memory that an item needs, about. [B]
    most_bytes : float, optional
        Memory that a tile may need; it goes before time. [B]

    Returns
    -------
    list of slice
        All items, in order.

    Raises
    ------
    InputError
        No item, or a cost that is not positive.
    """
    if n < 1:
        raise InputError("n", n, "1", "[1, inf)")
    if not (seconds_each > 0 and np.isfinite(seconds_each)):
        raise InputError("seconds_each", seconds_each, "s", "(0, inf)")
    size = max(1, round(USUAL_S / seconds_each))
    if bytes_each > 0:
        size = min(size, max(1, int(most_bytes / bytes_each)))
    pieces = max(1, -(-n // size))
    # Rounding up may leave tiles below the least; one piece fewer brings them above.
    if pieces > 1 and n * seconds_each / pieces < LEAST_S:
        pieces -= 1
    edges = [n * k // pieces for k in range(pieces + 1)]
    return [slice(a, b) for a, b in pairwise(edges)]


def in_order(
    function: Callable[[Tile], dict[str, NDArray[np.generic]]],
    tiles: Sequence[Tile],
    *,
    backend: str = "serial",
    checkpoint: str | Path | None = None,
    progress: Callable[[int, int], None] | None = None,
    workers: Workers | None = None,
) -> Iterator[dict[str, NDArray[np.generic]]]:
    """Results of :func:`map_tiles` one after the other, in the order of the tiles: those that were taken are not kept in memory.

    Arguments and errors are those of :func:`map_tiles`. Processes are a few tiles ahead of the one that is due, not more.
    """
    if backend not in BACKENDS:
        raise NotFoundError("backend", backend, "back end", BACKENDS)
    kept = Nothing() if checkpoint is None else Folder(checkpoint, function)
    stored = {index for index, tile in enumerate(tiles) if kept.load(index, tile) is not None}
    tell = progress or (lambda _done, _all: None)
    n_done = len(stored)
    tell(n_done, len(tiles))
    pending = [(index, tile) for index, tile in enumerate(tiles) if index not in stored]
    early: dict[int, dict[str, NDArray[np.generic]]] = {}
    with closing(BACKENDS[backend](function, pending, workers or Workers())) as worked:
        for due, tile in enumerate(tiles):
            if due in stored:
                # What was there a moment ago and is not any more is worked off again.
                yield kept.load(due, tile) or _checked(due, function(tile))
                continue
            while due not in early:
                index, result = next(worked)
                early[index] = _checked(index, result)
                del result
                kept.store(index, tiles[index], early[index])
                n_done += 1
                tell(n_done, len(tiles))
            yield early.pop(due)


def map_tiles(
    function: Callable[[Tile], dict[str, NDArray[np.generic]]],
    tiles: Sequence[Tile],
    *,
    backend: str = "serial",
    checkpoint: str | Path | None = None,
    progress: Callable[[int, int], None] | None = None,
    workers: Workers | None = None,
) -> list[dict[str, NDArray[np.generic]]]:
    """Work off every tile; the results are the same, bit for bit, whoever does it.

    Parameters
    ----------
    function : callable
        Makes of a tile a dictionary of arrays, and depends on nothing else. With processes and Dask it is sent by pickle: a function of a
        module, a `functools.partial` of one, or an instance of a class of a module.
    tiles : sequence
        What is worked off; anything that pickle takes.
    backend : {"serial", "processes", "dask"}, optional
        This process, processes of this machine, or a Dask cluster (extra ``dask``).
    checkpoint : str or Path, optional
        Folder that keeps finished tiles. A job that was interrupted goes on with what is there; a tile of another function, tile or version
        is not taken for one of this job, nor is a damaged one.
    progress : callable, optional
        Called with (done, all) tiles, from the start: tiles found in the folder count as done.
    workers : Workers, optional
        How many, or the cluster to use; without it one a core.

    Returns
    -------
    list of dict of ndarray
        In the order of the tiles.

    Raises
    ------
    InputError
        No such backend, or results that are no dictionaries of arrays.
    NavboundError
        Workers are lost again and again without a tile being finished.
    Exception
        What ``function`` raised, of the first tile that failed; finished tiles are kept.
    """
    return list(in_order(function, tiles, backend=backend, checkpoint=checkpoint, progress=progress, workers=workers))


def _checked(index: int, result: object) -> dict[str, NDArray[np.generic]]:
    good = isinstance(result, dict) and all(isinstance(v, np.ndarray) and not v.dtype.hasobject for v in result.values())
    if not (good and isinstance(result, dict)):
        raise InputError(f"function(tiles[{index}])", type(result).__name__, domain="a dictionary of arrays")
    return result
