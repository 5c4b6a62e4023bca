"""What can be mapped: each kind says what it takes, what it gives and what is asked of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, Protocol

from navbound.maps.ground import Dme
from navbound.maps.orbital import Araim, Dop, Raim
from navbound.maps.service import Sbas
from navbound.table.declare import unit_of

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

    from navbound.maps.limits import Limit

    Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Column:
    """A number of every user and instant."""

    name: str
    title: str

    @property
    def unit(self) -> Literal["1", "m"]:
        """Unit as the list of columns declares it."""
        return "m" if unit_of(self.name) == "m" else "1"


@dataclass(frozen=True)
class Cause:
    """Why a user has no number at an instant, or an infinite one; ``name`` is the column of its share of the instants."""

    name: str
    title: str


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
        """What is asked without a word of the caller."""
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


_HPL, _VPL = Column("hpl_m", "Horizontal protection level"), Column("vpl_m", "Vertical protection level")
_DOPS = tuple(
    Column(name, f"{title} dilution of precision")
    for name, title in (("pdop", "Position"), ("hdop", "Horizontal"), ("vdop", "Vertical"), ("gdop", "Geometric"))
)

_FEW = Cause("p_too_few", "Too few satellites, or badly placed ones")
_MONITORED = (
    _FEW,
    Cause("p_too_many", "More satellites or fault modes than are worked out"),
    Cause("p_not_monitored", "Faults that cannot be monitored take the whole integrity risk"),
)
_SERVED = (
    Cause("p_no_signal", "The service's satellite is too low"),
    Cause("p_no_service", "The service offers no usable satellite: no mask or corrections in force, no ionosphere there, or message 0"),
    Cause("p_too_few", "Too few usable satellites, or badly placed ones"),
)

KINDS: dict[str, Kind] = {
    kind.id: kind
    for kind in (
        Kind("dop", "Dilution of precision", "normal equation of ranges of equal weight", _DOPS, (_FEW,), Dop, 0.6e-6),
        Kind("raim", "RAIM protection level", "navbound.araim.predict, service raim", (_HPL,), _MONITORED, Raim, 8e-6),
        Kind(
            "araim",
            "ARAIM protection levels",
            "navbound.araim.predict",
            (_VPL, _HPL, Column("emt_m", "Effective monitor threshold")),
            _MONITORED,
            Araim,
            8e-6,
        ),
        Kind("sbas", "SBAS protection levels", "navbound.sbas.protection_levels", (_VPL, _HPL), _SERVED, Sbas, 4e-6),
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
}
"""Every kind by its name."""
