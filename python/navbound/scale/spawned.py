"""Processes of our own: how they are started."""

from __future__ import annotations

import multiprocessing
import os
import signal
from concurrent.futures import ThreadPoolExecutor
from multiprocessing import resource_tracker
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable
    from multiprocessing.context import SpawnContext

    Started = TypeVar("Started")

CONTEXT: SpawnContext = multiprocessing.get_context("spawn")
"""A forked child would inherit the locks of the threads of this process; a fresh interpreter has none."""


def deaf_to_interrupts(start: Callable[[], Started]) -> Started:
    """What `start` returns. Processes that it starts do not hear Ctrl-C, which a terminal sends to them too: who started them ends them.

    A child that ignores the signal by itself is late: an interpreter that hears it while it begins ends with a fatal error.

    Parameters
    ----------
    start : callable
        It works in a thread of its own. Ctrl-C is raised in the main thread alone, wherever that is, even where the main thread blocks the
        signal and another thread takes it; raised between the birth of a child and its first data, it leaves a child that reads nothing.
    """
    with ThreadPoolExecutor(1) as alone:
        # Ctrl-C in the birth of the thread leaves one that nobody waits for: it has nothing to do yet.
        alone.submit(int).result()
        return alone.submit(_blocked, start).result()


def _blocked(start: Callable[[], Started]) -> Started:
    # It unblocks the signal when it starts: before the block.
    _track_quietly()
    # A child inherits the mask of the thread that starts it.
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    return start()


def _track_quietly() -> None:
    """Start what clears up semaphores after this process, without its word on them: one that Ctrl-C ends at once leaves them to it."""
    before = os.environ.get("PYTHONWARNINGS")
    os.environ["PYTHONWARNINGS"] = ",".join(filter(None, (before, "ignore:resource_tracker:UserWarning")))
    try:
        resource_tracker.ensure_running()
    finally:
        if before is None:
            del os.environ["PYTHONWARNINGS"]
        else:
            os.environ["PYTHONWARNINGS"] = before
