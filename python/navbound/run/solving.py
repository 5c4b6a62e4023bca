"""How positions are solved from raw measurements, as the command line and the run record state it."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from navbound import gnss
from navbound.errors import InputError

if TYPE_CHECKING:
    from navbound.gnss import Navigation, Observations, Positions


@dataclass(frozen=True)
class Solving:
    """What of the measurements is used; ``None`` is the default of the kind of run.

    Attributes
    ----------
    signals : str, optional
        ``auto``, ``single`` or ``dual``; see :func:`navbound.gnss.solve`.
    systems : str, optional
        Letters of :data:`navbound.gnss.SYSTEMS`.
    ionosphere : str, optional
        Model of single pseudoranges: ``auto``, ``broadcast``, ``galileo``, ``climatology`` or ``none``.
    mask_rad : float, optional
        Lowest elevation. [rad]
    """

    signals: str | None = None
    systems: str | None = None
    ionosphere: str | None = None
    mask_rad: float | None = None

    @property
    def named(self) -> dict[str, str | float]:
        """What was named by the caller."""
        return {name: value for name, value in asdict(self).items() if value is not None}

    def refuse(self, why: str) -> None:
        """Refuse what would change nothing.

        Raises
        ------
        InputError
            Something is named; ``why`` says what it goes with.
        """
        for name, value in self.named.items():
            raise InputError(name, value, domain=why)

    def solve(self, observations: Observations, navigation: Navigation, *, signals: str, systems: str, **more: Any) -> Positions:
        """Positions by what is named, by the defaults elsewhere."""
        named: dict[str, Any] = {"signals": signals, "systems": systems, **self.named}
        return gnss.solve(observations, navigation, **named, **more)
