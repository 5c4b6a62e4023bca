"""Processes of our own: how they are started."""

from __future__ import annotations

import multiprocessing
import signal
from contextlib import contextmanager
from multiprocessing import resource_tracker
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator
    from multiprocessing.context import SpawnContext

CONTEXT: SpawnContext = multiprocessing.get_context("spawn")
"""A forked child would inherit the locks of the threads of this process; a fresh interpreter has none."""


@contextmanager
def deaf_to_interrupts() -> Iterator[None]:
    """Processes that start inside do not hear Ctrl-C, which a terminal sends to them too: who started them ends them.

    A child that ignores the signal by itself is late: an interpreter that hears it while it begins ends with a fatal error.
    """
    # It unblocks the signal when it starts: before the block.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
