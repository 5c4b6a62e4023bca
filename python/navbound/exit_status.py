"""How a command ends: the one list of exit statuses, for the command line, its help and the documentation."""

from __future__ import annotations

DONE, USAGE, UNREADABLE, NO_VERDICT, OUR_BUG, STOPPED = 0, 2, 3, 4, 70, 130

MEANINGS = {
    DONE: "done; a verdict that was reached (inside, outside, not shown) is part of the output",
    USAGE: "wrong use",
    UNREADABLE: "unreadable data, or a place that cannot be written (a disk that is full)",
    NO_VERDICT: "no verdict: truth contradicts a bound of the run, or no epoch could be judged; the output is complete",
    OUR_BUG: "a bug of navbound",
    STOPPED: "stopped by Ctrl-C",
}

WITHOUT_VERDICT = frozenset({"not_believable", "nothing_judged"})
"""Verdict ids on which nothing may be built."""


CONTRADICTED = frozenset({"refuted", "contradicted"})
"""Beliefs of a run of whose bounds truth contradicts one, of whatever axis (docs/decisions/0029)."""


def of_verdict(verdict_id: str, belief: str | None = None) -> int:
    """Exit status of a command that ends with a verdict (`fly`, `analyze`, `show`, also with ``--json``)."""
    return NO_VERDICT if verdict_id in WITHOUT_VERDICT or belief in CONTRADICTED else DONE


def listed() -> str:
    """All statuses in one line, for the help."""
    return "; ".join(f"{status}: {words}" for status, words in MEANINGS.items())
