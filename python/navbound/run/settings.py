"""How epochs are judged: which bounds, at which risks."""

from __future__ import annotations

from dataclasses import dataclass

from navbound.methods import method
from navbound.risks import checked_risk

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
"""Shown unless others are requested: the exact bounds, and the published approximations beside them."""


@dataclass(frozen=True)
class Settings:
    """How to judge."""

    methods: tuple[str, ...] = DEFAULT_METHODS
    risk_accuracy: float = 0.05
    risk_integrity: float = 1e-5

    def __post_init__(self) -> None:
        """Refuse what is no method and what is no risk, before anything is worked out.

        Raises
        ------
        InputError
            A method that does not exist, or a risk outside its domain.
        """
        for each in self.methods:
            method(each)
        checked_risk("risk_accuracy", self.risk_accuracy)
        checked_risk("risk_integrity", self.risk_integrity)
