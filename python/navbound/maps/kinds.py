"""What can be mapped: each kind says what it takes, what it gives and what is required of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from navbound.algorithms import ARAIM_CAUSES, Cause, Column, Grid, Sent, entries
from navbound.maps.ground import Dme
from navbound.maps.orbital import Dop, options_of
from navbound.maps.service import service_of

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

    from navbound.maps.limits import Limit

    Floats = NDArray[np.float64]


class Levels(Protocol):
    """Numbers of users: latitudes and longitudes [rad] to columns of shape (users, instants), NaN where there is none.

    The causes of the kind are columns of the same shape, true where the cause holds; at most one holds for a user at an instant.
    """

    def __call__(self, lat_rad: Floats, lon_rad: Floats) -> dict[str, NDArray[Any]]:
        """Work out the users of a tile."""
        ...


class Options(Protocol):
    """The arguments of one kind."""

    def levels(self) -> Levels:
        """What works out the numbers, to be sent to workers."""
        ...

    def n_epochs(self) -> int:
        """Instants."""
        ...

    def limits(self) -> list[Limit]:
        """What is required without a word of the caller."""
        ...

    def assumptions(self) -> list[str]:
        """What the numbers rest on, as sentences."""
        ...


@dataclass(frozen=True)
class Kind:
    """One thing that can be mapped.

    Attributes
    ----------
    id, title, source : str
        Its name, what it is, and where its numbers come from.
    columns : tuple of Column
        What it gives; the first is shown first.
    causes : tuple of Cause
        Why a user may have none of it.
    options : callable
        Its arguments.
    user_epoch_s : float
        What a user costs at one instant on one core, about: tiles are cut by it. [s]
    """

    id: str
    title: str
    source: str
    columns: tuple[Column, ...]
    causes: tuple[Cause, ...]
    options: Callable[..., Any]
    user_epoch_s: float


_DOPS = tuple(
    Column(name, f"{title} dilution of precision")
    for name, title in (("pdop", "Position"), ("hdop", "Horizontal"), ("vdop", "Vertical"), ("gdop", "Geometric"))
)

_SERVED = (
    Cause("p_no_signal", "The service's satellite is too low"),
    Cause("p_no_service", "The service offers no usable satellite: no mask or corrections in force, no ionosphere there, or message 0"),
    Cause("p_too_few", "Too few usable satellites, or badly placed ones"),
)

_OWN = (
    Kind("dop", "Dilution of precision", "normal equation of ranges of equal weight", _DOPS, ARAIM_CAUSES[:1], Dop, 0.6e-6),
    Kind(
        "dme",
        "DME/DME coverage",
        "navbound.dme.coverage",
        (
            Column("nse_best_m", "95 % navigation error of the best pair"),
            Column("nse_all_m", "95 % navigation error of all stations"),
        ),
        (Cause("p_too_few", "No pair of stations in sight that serves"),),
        Dme,
        200e-6,
    ),
)


def kinds() -> dict[str, Kind]:
    """Every kind by its name: dilution, the algorithms of :mod:`navbound.algorithms` that take orbits or messages, and stations."""
    of_orbits = [
        Kind(one.name, one.title, one.source, one.columns, one.causes, options_of(one), one.user_epoch_s) for one in entries(Grid).values()
    ]
    of_messages = [
        Kind(one.name, one.title, one.source, one.columns, _SERVED, service_of(one), one.user_epoch_s) for one in entries(Sent).values()
    ]
    return {kind.id: kind for kind in (_OWN[0], *of_orbits, *of_messages, *_OWN[1:])}
