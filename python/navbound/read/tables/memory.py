"""What a table takes in memory, before it is taken apart: a process that the system ends says nothing."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from navbound.errors import FormatError

if TYPE_CHECKING:
    from navbound.read.source import Source

ROW_BYTES = 900
"""Memory for each row of a table that is held whole, judged run and report included. [B] Provenance: ours; 400 000 rows took 340 to 370 MB
as CSV, JSON and Parquet, two million 1400 MB."""


def free_bytes() -> int | None:
    """Memory that is free; None where the system does not say. [B]."""
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        return next(int(line.split()[1]) << 10 for line in lines if line.startswith("MemAvailable:"))
    except (OSError, ValueError, StopIteration):
        return None


def require_free(source: Source, n_rows: int) -> None:
    """Refuse a table that cannot be held whole.

    Raises
    ------
    FormatError
        With what it takes, what is free, and what takes less.
    """
    # The content itself, and its parts while it is taken apart.
    needed, free = ROW_BYTES * n_rows + 2 * len(source.content), free_bytes()
    if free is not None and needed > free:
        needed_mb, free_mb = (n / 1e6 for n in (needed, free))
        sizes = f"its {n_rows} rows take about {needed_mb:.0f} MB of memory, of which {free_mb:.0f} MB are free"
        less = "a large plain CSV or Parquet file that is judged alone, without a procedure, is read in pieces and takes less"
        raise FormatError(source.path, f"{sizes}: cut it by track or by day; {less}")
