"""What moved, in sentences."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from navbound.records.comparison import ChangedCount, MovedColumn, MovedNumber


def sentences(
    n_common: int,
    n_only: tuple[int, int],
    numbers: Sequence[MovedNumber],
    columns: Sequence[MovedColumn],
    counts: Sequence[ChangedCount],
) -> list[str]:
    """What is the same first, then what is not."""
    alerts = [count for count in counts if count.column == "alert"]
    n_alerts = sum(count.n_epochs for count in alerts)
    words = [f"{_n(n_common, 'epoch')} of both runs are compared, by track and time."]
    if any(n_only):
        words.append(f"{_n(n_only[0], 'epoch')} of A {_are(n_only[0])} not in B, {n_only[1]} of B {_are(n_only[1])} not in A.")
    if alerts:
        each = "; ".join(f"{count.a or 'none'} to {count.b or 'none'} at {count.n_epochs}" for count in alerts)
        words.append(f"{_n(n_alerts, 'epoch')} changed the alert: {each}.")
    else:
        words.append("No epoch changed its alert.")
    others = {column: sum(count.n_epochs for count in counts if count.column == column) for column in ("status", "state", "nav_mode")}
    words += [f"{_n(n, 'epoch')} changed the {_COLUMNS[column]}." for column, n in others.items() if n]
    if numbers or columns:
        words.append(f"{_n(len(numbers), 'number')} of the records moved, and {_n(len(columns), 'column')} of the epoch table.")
    else:
        words.append("No number moved.")
    return words


_COLUMNS = {"status": "status", "state": "decided specification", "nav_mode": "mode of navigation"}


def _n(n: int, what: str) -> str:
    return f"{n} {what}{'' if n == 1 else 's'}"


def _are(n: int) -> str:
    return "is" if n == 1 else "are"
