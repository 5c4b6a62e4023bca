"""The process of the command line: how it starts and how it ends; what it does in between is `main`."""

from __future__ import annotations

import atexit
import gc
import os
import sys
import threading

from navbound.exit_status import STOPPED


def process() -> None:
    """Run `main` in a process of its own, without work that nobody waits for.

    - What is loaded stays: looking again and again which of its 200,000 objects could go takes an eighth of the start.
    - NumPy's linear algebra starts a thread for every core, 0.05 s of a command that has a few small products to form. A study has large
      ones, whose last bits depend on how they are shared out; there nothing changes. `OPENBLAS_NUM_THREADS` set outside stays.
    - Before it ends, Python gives back every object by itself: a fifth of a short command, and the system takes the memory back anyway.
      What is registered for the end is done. With other threads, or where the last output cannot be written, the end is Python's own.
    """
    gc.set_threshold(100_000, 20, 20)
    if "study" not in sys.argv[1:2]:
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        from navbound.cli import interrupt  # noqa: PLC0415 - NumPy reads the setting when it is loaded
        from navbound.cli.main import main  # noqa: PLC0415

        main()
    except KeyboardInterrupt:
        # While it loads, or while it ends.
        sys.stderr.write("\rnavbound: stopped.\n")
        os._exit(STOPPED)
    except SystemExit as end:
        if threading.active_count() - interrupt.threads() > 1 or not isinstance(end.code, int):
            raise
        atexit._run_exitfuncs()
        try:
            sys.stdout.flush()
            sys.stderr.flush()
        except OSError:
            raise end from None
        os._exit(end.code)
