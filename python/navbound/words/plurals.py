"""Counts as words: the noun, and a verb behind it, agree with the number."""

from __future__ import annotations


def counted(n: float, one: str, many: str = "") -> str:
    """``1 epoch``, ``2 epochs``: a number before its noun.

    Parameters
    ----------
    n : float
        The number.
    one : str
        What stands behind 1: a noun, perhaps with a verb (``epoch is``).
    many : str
        What stands behind any other number; `one` with an s where it is empty.
    """
    return f"{n:.15g} {agreeing(n, one, many)}"


def agreeing(n: float, one: str, many: str = "") -> str:
    """The noun or the verb alone."""
    return one if n == 1 else many or f"{one}s"
