"""Ctrl-C: every command ends within a second, and says what was kept and how to go on."""

from __future__ import annotations

import os
import signal
import sys
import threading

from navbound.exit_status import STOPPED

PATIENCE_S = 0.6
"""Time after Ctrl-C in which the work may end by itself: what is compiled looks for no signal. [s]"""
_kept: list[str] = []
_watching: list[threading.Thread] = []


def keep(sentence: str) -> None:
    """Say what a command that is stopped from now on leaves, and how to go on."""
    _kept.append(sentence)


def words() -> str:
    """What a stopped command says."""
    kept = " ".join(_kept) or "Nothing was kept: results appear whole at the end, and what stood there before still stands."
    return f"navbound: stopped. {kept}"


def threads() -> int:
    """Threads that watch; they are none of the work."""
    return sum(thread.is_alive() for thread in _watching)


def watch() -> None:
    """End the process a moment after Ctrl-C, wherever its work is; where it can, it ends by itself before."""
    if threading.current_thread() is not threading.main_thread() or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        return
    _kept.clear()
    ours, theirs = os.pipe()
    os.set_blocking(theirs, False)
    # The system's own handler writes here at once, whatever the interpreter is doing.
    signal.set_wakeup_fd(theirs, warn_on_full_buffer=False)
    thread = threading.Thread(target=_end_after, args=(ours,), daemon=True)
    _watching.append(thread)
    thread.start()


def unwatch() -> None:
    """A command that ends in an order of its own."""
    if _watching:
        signal.set_wakeup_fd(-1)


def _end_after(pipe: int) -> None:
    while os.read(pipe, 1) != bytes([signal.SIGINT]):
        pass
    threading.Event().wait(PATIENCE_S)
    sys.stderr.write(f"\r{words()}\n")
    sys.stderr.flush()
    os._exit(STOPPED)
