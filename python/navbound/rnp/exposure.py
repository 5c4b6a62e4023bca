"""What an integrity risk is counted over: an epoch or an hour of flight; public in `navbound.rnp`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from navbound import _core
from navbound.table.arguments import checked, checked_fields

LONGEST_STEP_S = 3600.0
"""Longest time between epochs that an hour's risk can be shared over: of a longer one each epoch carries the risk of its own hour. [s]"""


@checked
def per_epoch_risk(risk_per_hour: float, tau_s: float, sample_period_s: float = 0.0) -> float:
    """Risk per epoch whose hour carries a risk: what the bounds must be evaluated at.

    The lateral error is taken as a Gauss-Markov process, centred, of one variance. Below 20 samples in a correlation time, where
    the crossing rate falls short of the true risk, the independent epochs' risk is used, which no Gaussian dependence exceeds.

    Parameters
    ----------
    risk_per_hour : float
        Risk to be outside at least once in an hour.
    tau_s : float
        Correlation time of the error. [s]
    sample_period_s : float
        Time between epochs; 0 for continuous monitoring. [s]

    Returns
    -------
    float
        ``2 Q(u)`` of the level ``u`` that carries it.

    Raises
    ------
    InputError
        An argument outside its domain, or a risk no level above one sigma carries.
    """
    return _core.per_epoch_risk(risk_per_hour, tau_s, sample_period_s)


@checked
def per_hour_risk(risk_per_epoch: float, tau_s: float, sample_period_s: float = 0.0) -> float:
    """Risk to be outside at least once in an hour; the inverse of `per_epoch_risk`, with the same arguments."""
    return _core.per_hour_risk(risk_per_epoch, tau_s, sample_period_s)


@runtime_checkable
class ExposureBasis(Protocol):
    """What the integrity risk is counted over."""

    def per_epoch(self, risk: float, sample_period_s: float) -> float:
        """Give the risk at which each epoch's bound is evaluated."""
        ...

    def words(self, risk: float, sample_period_s: float) -> str:
        """Say the basis and what the risk is in the other one, for reports."""
        ...


@checked_fields
@dataclass(frozen=True)
class PerEpoch:
    """The risk is each epoch's own, as in the source; how often it is met in an hour is not said."""

    tau_s: float = 60.0
    """Correlation time for which the report prints the risk per hour. [s]"""

    def per_epoch(self, risk: float, sample_period_s: float) -> float:  # noqa: ARG002 (the other basis needs it)
        """Give the risk itself."""
        return risk

    def words(self, risk: float, sample_period_s: float) -> str:
        """Say the risk per epoch, and what it is over an hour."""
        hour = per_hour_risk(risk, self.tau_s, sample_period_s)
        return f"{risk:.3g} per epoch, which is {hour:.2g} per hour for an error that forgets in {self.tau_s:g} s"


@checked_fields
@dataclass(frozen=True)
class PerHour:
    """The risk is that of being outside at least once in an hour of flight."""

    tau_s: float
    """Correlation time of the lateral error. [s]"""

    def per_epoch(self, risk: float, sample_period_s: float) -> float:
        """Give the equivalent risk of one epoch."""
        return per_epoch_risk(risk, self.tau_s, sample_period_s)

    def words(self, risk: float, sample_period_s: float) -> str:
        """Say the risk per hour, and what it is per epoch."""
        epoch = self.per_epoch(risk, sample_period_s)
        return f"{risk:.3g} per hour, which is {epoch:.2g} per epoch for an error that forgets in {self.tau_s:g} s"


PER_EPOCH = PerEpoch()
"""The basis of the source."""
