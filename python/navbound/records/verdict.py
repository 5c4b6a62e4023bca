"""The ids of a verdict and of what truth says of a bound, and the share of epochs that a verdict needs. run/verdict/rule.py decides."""

from __future__ import annotations

from typing import Literal

VerdictId = Literal["inside", "outside", "not_shown", "not_believable", "nothing_judged"]
BeliefState = Literal["unchecked", "supported", "partial", "few", "small", "copied", "short", "contradicted", "refuted"]

LEAST_SHARE = 0.95
"""Least share of all expected epochs that must be judged with status ok before "inside" may be said.

RNP asks for a total system error within the RNP value during at least 95 % of the total flight time (ICAO Doc 9613); time that could not
be judged is time that was not shown to be inside. Provenance: re-derived (docs/decisions/0020)."""
