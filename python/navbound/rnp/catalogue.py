"""Navigation specifications as data; public in `navbound.rnp`."""

from __future__ import annotations

from dataclasses import dataclass

from navbound import _core
from navbound.errors import InputError
from navbound.table.arguments import checked


@dataclass(frozen=True)
class Specification:
    """What a navigation specification asks for in one phase of flight.

    Attributes
    ----------
    name, phase : str
        Row and column of the table.
    accuracy_m : float
        Lateral accuracy (95 %), the RNP value. Where the specification gives a range and none was chosen, the tightest. [m]
    accuracy_least_m, accuracy_most_m : float
        The range that may be chosen from. [m]
    containment_m : float or None
        Twice the accuracy; None for RNAV specifications, which ask for no monitoring on board. [m]
    accuracy_risk : float
        Risk that goes with the accuracy.
    containment_risk : float or None
        Risk that goes with the containment.
    source, provenance : str
        Where the row comes from and how we hold it.
    time_to_alert_s : float
        Default time to alert of the phase. [s]
    time_to_alert_source, time_to_alert_provenance : str
        The same for the time to alert.
    """

    name: str
    phase: str
    accuracy_m: float
    accuracy_least_m: float
    accuracy_most_m: float
    containment_m: float | None
    accuracy_risk: float
    containment_risk: float | None
    source: str
    provenance: str
    time_to_alert_s: float
    time_to_alert_source: str
    time_to_alert_provenance: str


def specifications() -> list[Specification]:
    """Every cell of the table of navigation specifications; ranges stand at their tightest value."""
    cells = []
    for row in _core.specifications():
        containment = row.pop("containment_least_m")
        row.pop("containment_most_m")
        cells.append(Specification(accuracy_m=row["accuracy_least_m"], containment_m=containment, **row))
    return cells


@checked
def specification(name: str, phase: str, accuracy_m: float | None = None) -> Specification:
    """One cell of the table of navigation specifications.

    Parameters
    ----------
    name : str
        The specification, e.g. ``"RNP APCH"``.
    phase : str
        The phase of flight, e.g. ``"final"``.
    accuracy_m : float, optional
        The value chosen from a range (RNP AR APCH, A-RNP); the tightest if not given. [m]

    Raises
    ------
    InputError
        An unknown name or phase, an empty cell, or an accuracy outside the range; the message lists what exists.
    """
    cells = specifications()
    if name not in (names := list(dict.fromkeys(c.name for c in cells))):
        raise InputError("name", repr(name), domain=", ".join(names))
    mine = {c.phase: c for c in cells if c.name == name}
    if phase not in mine:
        raise InputError("phase", repr(phase), domain=f"the phases of {name}: {', '.join(mine)}")
    cell = mine[phase]
    if accuracy_m is None:
        return cell
    if not cell.accuracy_least_m <= accuracy_m <= cell.accuracy_most_m:
        domain = f"[{cell.accuracy_least_m:g}, {cell.accuracy_most_m:g}] for {name}, {phase}"
        raise InputError("accuracy_m", accuracy_m, "m", domain)
    doubled = None if cell.containment_m is None else 2.0 * accuracy_m
    return Specification(**{**cell.__dict__, "accuracy_m": accuracy_m, "containment_m": doubled})
