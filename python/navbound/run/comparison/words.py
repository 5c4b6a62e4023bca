"""What moved, in sentences."""

from __future__ import annotations

from typing import TYPE_CHECKING

from navbound.words.plurals import agreeing, counted

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
    words = [f"{counted(n_common, 'epoch')} of both runs are compared, by track and time."]
    if any(n_only):
        words.append(
            f"{counted(n_only[0], 'epoch')} of A {agreeing(n_only[0], 'is', 'are')} not in B, {n_only[1]} of B "
            f"{agreeing(n_only[1], 'is', 'are')} not in A."
        )
    if alerts:
        each = "; ".join(f"{count.a or 'none'} to {count.b or 'none'} at {count.n_epochs}" for count in alerts)
        words.append(f"{counted(n_alerts, 'epoch')} changed the alert: {each}.")
    else:
        words.append("No epoch changed its alert.")
    others = {column: sum(count.n_epochs for count in counts if count.column == column) for column in ("status", "state", "nav_mode")}
    words += [f"{counted(n, 'epoch')} changed the {_COLUMNS[column]}." for column, n in others.items() if n]
    if numbers or columns:
        words.append(f"{counted(len(numbers), 'number')} of the records moved, and {counted(len(columns), 'column')} of the epoch table.")
    else:
        words.append("No number moved.")
    return words


_COLUMNS = {"status": "status", "state": "decided specification", "nav_mode": "mode of navigation"}
