"""How epochs are judged."""

from __future__ import annotations

from typing import TYPE_CHECKING

from navbound import _core
from navbound.errors import InputError
from navbound.methods import method as method_of
from navbound.risks import checked_risk

if TYPE_CHECKING:
    from collections.abc import Sequence

    from navbound.rnp import Monitor, StateClassifier

ALERTS: list[str] = _core.alerts()
"""Words of the alerts, in the order of their codes."""


class Settings:
    """How epochs are judged: the method whose bounds are compared with RNP, its risks, the monitor, and what is stated beside.

    Parameters
    ----------
    monitor : navbound.rnp.Monitor
        Its settings; the integrity risk per epoch is the monitor's. What it has seen itself does not matter.
    method : str
        Id of a method that may feed an alert.
    beside : sequence of str
        Ids of other methods, whose bounds are stated for comparison.
    risk_accuracy : float
        Risk of the bound that is compared with RNP. [1]
    states : navbound.rnp.StateClassifier, optional
        Levels of the RNP state; nothing is classified without.

    Attributes
    ----------
    columns : list of str
        The numbers of a judged epoch: errors along the axes of the path, both bounds of `method` (accuracy, integrity), risks beyond RNP
        and twice RNP, ``integrity_compared_m``, ``p_state_<i>``, both bounds of each method beside. [m, 1]

    Raises
    ------
    InputError
        A method that may not feed an alert, an unknown method beside, a risk outside [1e-300, 0.5].
    """

    def __init__(
        self,
        monitor: Monitor,
        *,
        method: str = "tse-exact",
        beside: Sequence[str] = (),
        risk_accuracy: float = 0.05,
        states: StateClassifier | None = None,
    ) -> None:
        allowed = _core.alerting_methods()
        if method not in allowed:
            raise InputError("method", method, domain=f"a method that may feed an alert, of {', '.join(allowed)}")
        self.method = method_of(method)
        self.beside = tuple(method_of(id_) for id_ in dict.fromkeys(beside) if id_ != method)
        risks = [checked_risk("risk_accuracy", risk_accuracy), monitor.integrity_risk_per_epoch]
        core_states = None if states is None else states._core
        self.plan = _core.JudgePlan(method, risks, monitor._core, core_states, [m.id for m in self.beside])
        self.state_names: list[str] = [] if states is None else list(states.names)
        self.columns: list[str] = self.plan.names()

    def state(self, code: int) -> str | None:
        """Name of a state by its code; None for a code beyond the list."""
        return self.state_names[code] if code < len(self.state_names) else None
