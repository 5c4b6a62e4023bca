"""What a table takes in memory, before it is taken apart: a process that the system ends says nothing."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from navbound.errors import FormatError

if TYPE_CHECKING:
    from navbound.read.source import Source

AT_ONCE = 7
"""Bytes of memory for each byte of a text table that is held whole, judged run and report included. Provenance: ours; 50 and 200 MB of
ADS-B reports took 545 and 1527 MB."""


def free_bytes() -> int | None:
    """Memory that is free; None where the system does not say. [B]."""
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        return next(int(line.split()[1]) << 10 for line in lines if line.startswith("MemAvailable:"))
    except (OSError, ValueError, StopIteration):
        return None


def require_free(source: Source) -> None:
    """Refuse a text table that cannot be held whole.

    Raises
    ------
    FormatError
        With what it takes, what is free, and what takes less.
    """
    needed, free = AT_ONCE * len(source.content), free_bytes()
    if free is not None and needed > free:
        text_mb, needed_mb, free_mb = (n / 1e6 for n in (len(source.content), needed, free))
        sizes = f"its {text_mb:.0f} MB of text take about {needed_mb:.0f} MB of memory, of which {free_mb:.0f} MB are free"
        less = "a plain CSV that is judged alone, without a path and a truth, is read in pieces and takes less"
        raise FormatError(source.path, f"{sizes}: cut it by track or by day; {less}")
