"""The clock of every bench: process CPU time, which other work on the machine stretches less than wall time; the best of some runs."""

from __future__ import annotations

import math
import os
import subprocess
import sys
import time
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable

# Before the extension is loaded: a bench that measures several threads starts a process of its own.
os.environ.setdefault("RAYON_NUM_THREADS", "1")
os.environ.setdefault("POLARS_MAX_THREADS", "1")


class Row(NamedTuple):
    """One figure: what was measured, seconds an item, how many items a run had, what an item is, and the goal where there is one."""

    name: str
    seconds_per_item: float
    n: int
    note: str
    goal_s: float | None = None

    @property
    def met(self) -> bool | None:
        """Whether the goal is met; None without a goal."""
        return None if self.goal_s is None else self.seconds_per_item <= self.goal_s


def seconds(call: Callable[[], object], repeats: int = 5) -> float:
    """Least CPU time of a call over some repeats, all threads together."""
    best = math.inf
    for _ in range(repeats):
        start = time.process_time()
        call()
        best = min(best, time.process_time() - start)
    return best


def wall(program: str, repeats: int = 3) -> tuple[float, float]:
    """Least wall-clock and least CPU time of the function `job` that a program defines, in a process of its own that may use every core."""
    measure = (
        "import time\nwall = spent = 1e9\n"
        f"for _ in range({repeats}):\n    start, begun = time.perf_counter(), time.process_time()\n    job()\n"
        "    wall, spent = min(wall, time.perf_counter() - start), min(spent, time.process_time() - begun)\nprint(wall, spent)"
    )
    environment = {k: v for k, v in os.environ.items() if k not in ("RAYON_NUM_THREADS", "POLARS_MAX_THREADS")}
    done = subprocess.run([sys.executable, "-c", program + measure], check=True, capture_output=True, text=True, env=environment)
    whole, spent = map(float, done.stdout.split())
    return whole, spent


def show(rows: list[Row]) -> None:
    """Print a bench's figures, each with its goal."""
    for row in rows:
        goal = "" if row.goal_s is None else f"  goal {span(row.goal_s)}: {'met' if row.met else 'NOT MET'}"
        print(f"{row.name:44} {span(row.seconds_per_item):>12}{goal}   {row.note}")


def span(value_s: float) -> str:
    """A time in the unit that suits it."""
    for unit, size in (("ns", 1e-9), ("µs", 1e-6), ("ms", 1e-3)):
        if value_s < 999.5 * size:
            return f"{value_s / size:.3g} {unit}"
    return f"{value_s:.3g} s"
