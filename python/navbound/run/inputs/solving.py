"""How positions are solved from raw measurements, as the command line and the run record state it."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from navbound.errors import ConflictError, InputError
from navbound.time import utc_text

if TYPE_CHECKING:
    from navbound.gnss import Navigation, Observations, Positions


LONGEST_NS = 86_400_000_000_000
"""Further from every broadcast record than a day there is no orbit: the longest fit interval is 26 h about its middle. Provenance: ours."""


def require_same_time(observations: Observations, navigation: Navigation) -> None:
    """Refuse broadcast messages of another time than the measurements.

    Raises
    ------
    InputError
        Naming both dates: no record lies within `LONGEST_NS` of the measurements.
    """
    if not navigation.n_ephemerides or not observations.n_epochs:
        return
    first, last = int(observations.time_ns.min()), int(observations.time_ns.max())
    times = navigation.records()["orbit_time_ns"].drop_nulls()
    if times.is_empty() or not times.filter(times.is_between(first - LONGEST_NS, last + LONGEST_NS)).is_empty():
        return
    of, needed = _dates(int(times.min()), int(times.max())), _dates(first, last)  # type: ignore[arg-type]
    what = f"ephemerides of {of} for observations of {needed}"
    raise InputError("files", what, domain=f"navigation files of the time of {observations.path.name}")


def _dates(first_ns: int, last_ns: int) -> str:
    first, last = (utc_text(t)[:10] for t in (first_ns, last_ns))
    return first if first == last else f"{first} to {last}"


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
        for name in self.named:
            raise ConflictError(name, because=why)

    def solve(self, observations: Observations, navigation: Navigation, *, signals: str, systems: str, **more: Any) -> Positions:
        """Positions by what is named, by the defaults elsewhere."""
        named: dict[str, Any] = {"signals": signals, "systems": systems, **self.named}
        from navbound import gnss  # noqa: PLC0415  (only with measurements)

        return gnss.solve(observations, navigation, **named, **more)
