"""Who works the tiles off."""

from __future__ import annotations

import multiprocessing
import os
import threading
from collections import deque
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from navbound.errors import ConflictError, InputError, NavboundError
from navbound.scale.spawned import CONTEXT, deaf_to_interrupts

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence
    from multiprocessing.process import BaseProcess

    Function = Callable[[Any], Any]
    Pending = Sequence[tuple[int, Any]]

LOOK_S = 5.0
"""How often a cluster is looked at whether it has workers. [s]"""
ALONE_S = 60.0
"""A cluster that has had no worker for this long is not waited for. [s]"""
AHEAD = 4
"""Tiles for each worker that may be worked off before the first one that is not finished: so many results wait in memory. [1]"""
HEARD_S = 0.1
"""The longest wait for a tile before Ctrl-C is looked for: the handler that polars sets lets a wait without an end go on. [s]"""
MOST_LOSSES = 3
"""Losses of a worker in a row, without one tile finished in between, after which it is the tile's fault. [1]"""


@dataclass(frozen=True)
class Workers:
    """Who there is.

    Attributes
    ----------
    count : int, optional
        Worker processes; one a core without it. [1]
    cluster : str or distributed.Client, optional
        Dask: the address of a scheduler, or a client. Without it a cluster on this machine is started, and stopped at the end.
    """

    count: int | None = None
    cluster: Any = None

    def __post_init__(self) -> None:
        if self.count is not None and not self.count >= 1:
            raise InputError("count", self.count, "1", "[1, inf)")

    @property
    def processes(self) -> int:
        """How many processes. [1]."""
        return self.count or os.cpu_count() or 1


def begin_worker() -> None:
    """One thread, as the workers are as many as the cores already (what the user has set stands), and no longer life than the parent's."""
    os.environ.setdefault("RAYON_NUM_THREADS", "1")
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent,), daemon=True).start()


def _end_with(parent: BaseProcess) -> None:
    # A pool's worker waits for work from a parent that was killed for ever.
    parent.join()
    os._exit(1)


def serial(function: Function, pending: Pending, _workers: Workers) -> Generator[tuple[int, Any], None, None]:
    """One tile after the other; a tile may use every core."""
    for index, tile in pending:
        yield index, function(tile)


def processes(function: Function, pending: Pending, workers: Workers) -> Generator[tuple[int, Any], None, None]:
    """Processes of this machine. When one is lost the others are given up as well, and what is unfinished starts again."""
    left = dict(pending)
    losses = 0
    while left:
        try:
            for index, result in _pool(function, left, workers.processes):
                del left[index]
                losses = 0
                yield index, result
        except BrokenProcessPool as e:
            losses += 1
            if losses >= MOST_LOSSES:
                first = min(left)
                words = f"{losses} worker processes in a row were lost before tile {first} or a later one was finished"
                advice = "a program of your own needs `if __name__ == '__main__':` around its work, and a file that it is read from"
                raise NavboundError(f"{words}; {advice}") from e


def _pool(function: Function, left: dict[int, Any], count: int) -> Generator[tuple[int, Any], None, None]:
    others = set(multiprocessing.active_children())
    begin = partial(ProcessPoolExecutor, min(count, len(left)), mp_context=CONTEXT, initializer=begin_worker)
    with deaf_to_interrupts(begin) as pool:
        waiting, running = deque(sorted(left)), dict[Future[Any], int]()
        try:
            while waiting or running:
                # A result waits here until those before it are taken: no worker is far ahead of the slowest.
                while waiting and waiting[0] < min(running.values(), default=waiting[0]) + AHEAD * count:
                    index = waiting.popleft()
                    # Workers start with the tiles that they are for.
                    running[deaf_to_interrupts(partial(pool.submit, function, left[index]))] = index
                for future in wait(running, HEARD_S, FIRST_COMPLETED).done:
                    yield running.pop(future), future.result()
        except BaseException:
            # Nobody wants the tiles that are being worked off any more.
            for worker in set(multiprocessing.active_children()) - others:
                worker.kill()
            raise
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def dask(function: Function, pending: Pending, workers: Workers) -> Generator[tuple[int, Any], None, None]:
    """Processes of a Dask cluster. What a lost worker had is done again by another."""
    distributed = _distributed()
    if isinstance(workers.cluster, distributed.Client):
        yield from _gather(distributed, workers.cluster, function, pending)
        return
    if workers.cluster is not None:
        with _client(distributed, workers.cluster) as client:
            yield from _gather(distributed, client, function, pending)
        return
    with (
        distributed.LocalCluster(
            n_workers=workers.processes, threads_per_worker=1, processes=True, dashboard_address=":0", env={"RAYON_NUM_THREADS": "1"}
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield from _gather(distributed, client, function, pending)


def _client(distributed: Any, address: str) -> Any:
    try:
        return distributed.Client(address)
    except (OSError, ValueError) as e:
        raise InputError("cluster", address, domain=f"the address of a Dask scheduler that answers: {e}") from e


def _gather(distributed: Any, client: Any, function: Function, pending: Pending) -> Generator[tuple[int, Any], None, None]:
    futures = {client.submit(function, tile, pure=False): index for index, tile in pending}
    alone_s = 0.0
    try:
        while futures:
            try:
                for future, result in distributed.as_completed(list(futures), loop=client.loop, with_results=True, timeout=LOOK_S):
                    yield futures.pop(future), result
            except TimeoutError:
                # A scheduler without workers waits for ever for one to come.
                alone_s = 0.0 if client.ncores() else alone_s + LOOK_S
                if alone_s >= ALONE_S:
                    raise NavboundError(f"the cluster has had no worker for {alone_s:g} s; {len(futures)} tiles are not done") from None
    except distributed.KilledWorker as e:
        raise NavboundError(f"the cluster lost worker after worker over a tile: {e}") from e
    finally:
        client.cancel(list(futures))


def _distributed() -> Any:
    try:
        import distributed  # noqa: PLC0415
    except ImportError as e:
        raise ConflictError("backend", because="Dask is not installed (pip install 'navbound[dask]')", value="dask") from e
    return distributed


BACKENDS: dict[str, Callable[[Function, Pending, Workers], Generator[tuple[int, Any], None, None]]] = {
    "serial": serial,
    "processes": processes,
    "dask": dask,
}
"""Every back end by its name."""
