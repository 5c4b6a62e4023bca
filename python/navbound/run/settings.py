"""How epochs are judged: which bounds, at which risks."""

from __future__ import annotations

from dataclasses import dataclass

DEFAULT_METHODS = (
    "tse-exact",
    "tse-ltem",
    "tse-ctem-foot",
    "tse-sqsm",
    "tse-vertical",
    "anp-circle",
    "anp-sphere",
    "anp-along",
    "anp-cross",
    "anp-vertical",
)
"""Shown unless others are asked for: the exact bounds, and the published approximations beside them."""


@dataclass(frozen=True)
class Settings:
    """How to judge."""

    methods: tuple[str, ...] = DEFAULT_METHODS
    risk_accuracy: float = 0.05
    risk_integrity: float = 1e-5
