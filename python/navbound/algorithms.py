"""The list of algorithms of protection levels: what each promises, and which jobs can call it.

The core declares every algorithm (:func:`navbound.methods.protection_methods`). One that needs nothing but orbits can be mapped
(``navbound map``) and predicted (``navbound predict``) by its id: nothing is entered for it here. ``_FUNCTIONS`` has what needs a function
of the package: settings of a family, recorded observations (``--protection``), messages of a service. Commands, their help, the pages and
the contract tests read this list. An algorithm of a caller's own joins it for a session by :func:`register`.
"""

from __future__ import annotations

import inspect
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from importlib import import_module
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from navbound.errors import InputError, NotFoundError
from navbound.methods import ProtectionMethod, protection_methods
from navbound.table.declare import unit_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

__all__ = [
    "ARAIM_CAUSES",
    "Algorithm",
    "Cause",
    "Column",
    "Entry",
    "Grid",
    "Place",
    "Recorded",
    "Sent",
    "algorithms",
    "entries",
    "entry",
    "register",
]


@dataclass(frozen=True)
class Column:
    """A number of every user and instant."""

    name: str
    title: str

    @property
    def unit(self) -> Literal["1", "m"]:
        """Unit by the ending of the name."""
        return "m" if unit_of(self.name) == "m" else "1"


@dataclass(frozen=True)
class Cause:
    """Why a user has no number at an instant, or an infinite one.

    Attributes
    ----------
    name : str
        Column of its share of the instants.
    statuses : tuple of str
        Values of ``status`` of the levels that mean it.
    """

    name: str
    title: str
    statuses: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True, eq=False)
class Entry:
    """One way to call an algorithm.

    Attributes
    ----------
    name : str
        What a person types.
    call : str or callable
        The function, or where it is (``navbound.raim.watch``): subjects are loaded when they are used.
    settings : mapping
        Arguments that are the same for every call.
    """

    name: str
    call: str | Callable[..., Any]
    settings: Mapping[str, Any] = field(default_factory=dict)

    @property
    def source(self) -> str:
        """The function and what is fixed of it, for a person."""
        name = self.call if isinstance(self.call, str) else f"{self.call.__module__}.{self.call.__qualname__}"
        return ", ".join([name, *(f"{key} {value}" for key, value in self.settings.items())])

    def __call__(self, *args: Any, **more: Any) -> Any:
        """Call the function with the settings and more."""
        return _loaded(self.call)(*args, **self.settings, **more)


@dataclass(frozen=True, kw_only=True, eq=False)
class Recorded(Entry):
    """Tested positions with levels from a receiver's observations: (observations, navigation, ``truth_ecef_m``, ...) -> ``Watched``.

    One that takes ``keep_ranges`` is called with it, for the pictures of the sky.
    """

    @property
    def keeps_ranges(self) -> bool:
        """Whether it can say what became of every satellite."""
        taken = inspect.signature(_loaded(self.call)).parameters
        return "keep_ranges" in taken or any(each.kind is each.VAR_KEYWORD for each in taken.values())


@dataclass(frozen=True, kw_only=True, eq=False)
class Place(Entry):
    """Levels at a place or along a route: (orbits, lat_rad, lon_rad, h_m, time_s, ``mask_rad``, ``model``) -> levels.

    The levels have ``hpl_m`` and ``n_sv``, and may have ``hel_m`` (after exclusion) and ``hpl_slope_m`` (a published form beside it).

    Attributes
    ----------
    assumptions : str or callable
        (model) -> sentences on what the levels rest on.
    """

    assumptions: str | Callable[[str], list[str]] = "navbound.algorithms.none"

    def words(self, model: str) -> list[str]:
        """Sentences on what the levels rest on."""
        sentences: list[str] = _loaded(self.assumptions)(model)
        return sentences


@dataclass(frozen=True, kw_only=True, eq=False)
class Sent(Entry):
    """Levels from what a service sent: at a place, along a route, or of a grid of users.

    (messages, navigation, time_ns, ``lat_rad``, ``lon_rad``, ``h_m``, ``mode``, ``mask_rad``) -> levels.

    Attributes
    ----------
    title : str
        Heading of the map.
    columns : tuple of Column
        What the map shows, the first column first.
    user_epoch_s : float
        What a user costs at one instant on one core, about. [s]
    """

    title: str
    columns: tuple[Column, ...]
    user_epoch_s: float = 4e-6


@dataclass(frozen=True, kw_only=True, eq=False)
class Grid(Entry):
    """Levels of a grid of users: (orbits, lat_rad, lon_rad, h_m, time_s, ``mask_rad``, options) -> levels with the columns and ``status``.

    Attributes
    ----------
    title : str
        Heading of the map.
    columns, causes
        What the map shows, the first column first, and why a user may have none of it.
    constellation : tuple of str
        Nominal constellations that it takes without another word.
    options : mapping
        Names and defaults of what a caller may set.
    demand : str or callable
        (options) -> limits required by default: a service level's name, or (name, whether its vertical limit counts, more limits as
        (column, limit, source, provenance)).
    words : str
        Sentence on what the levels rest on; options in braces.
    user_epoch_s : float
        What a user costs at one instant on one core, about: tiles are cut by it. [s]
    """

    title: str
    columns: tuple[Column, ...]
    causes: tuple[Cause, ...] = ()
    constellation: tuple[str, ...] = ("gps",)
    options: Mapping[str, Any] = field(default_factory=dict)
    demand: str | Callable[..., Any] = "navbound.algorithms.non_precision"
    words: str = ""
    user_epoch_s: float = 8e-6

    def limits(self, **options: Any) -> tuple[str, bool, tuple[tuple[str, float, str, str], ...]]:
        """The service level required, whether its vertical limit counts, and further limits."""
        name, vertical, more = _loaded(self.demand)(**options)
        return name, vertical, more


@dataclass(frozen=True)
class Algorithm:
    """One algorithm of protection levels.

    Attributes
    ----------
    declared : ProtectionMethod
        What a person must know of its levels.
    entries : tuple of Entry
        Ways to call it, of any of the four kinds.
    """

    declared: ProtectionMethod
    entries: tuple[Entry, ...] = ()


E = TypeVar("E", bound=Entry)

HPL = Column("hpl_m", "Horizontal protection level")
VPL = Column("vpl_m", "Vertical protection level")
ARAIM_CAUSES = (
    Cause("p_too_few", "Too few satellites, or badly placed ones", ("too_few_satellites", "singular")),
    Cause("p_too_many", "More satellites or fault modes than are worked out", ("too_many",)),
    Cause("p_not_monitored", "Faults that cannot be monitored take the whole integrity risk", ("not_monitored",)),
)

_FUNCTIONS: dict[str, tuple[Entry, ...]] = {
    "raim-slope": (
        Recorded(name="raim", call="navbound.raim.watch"),
        Place(name="raim", call="navbound.raim.predict", assumptions="navbound.raim.assumptions"),
    ),
    "raim-separation": (
        Grid(
            name="raim",
            call="navbound.araim.predict",
            settings={"service": "raim"},
            title="RAIM protection level",
            columns=(HPL,),
            causes=ARAIM_CAUSES,
            options={"model": "single-frequency"},
            words="One faulty satellite at a time, error model {model}.",
        ),
    ),
    "araim": (
        Recorded(name="araim", call="navbound.araim.watch", settings={"service": "lpv-200"}),
        Recorded(name="araim-horizontal", call="navbound.araim.watch", settings={"service": "horizontal"}),
        Place(name="araim", call="navbound.araim.predict", settings={"service": "horizontal"}, assumptions="navbound.araim.assumptions"),
        Grid(
            name="araim",
            call="navbound.araim.predict",
            title="ARAIM protection levels",
            columns=(VPL, HPL, Column("emt_m", "Effective monitor threshold")),
            causes=ARAIM_CAUSES,
            constellation=("gps", "galileo"),
            options={"service": "lpv-200", "model": "dual-frequency"},
            demand="navbound.araim.demand",
            words="Service {service}, error model {model}; integrity support data of the satellites as shipped, inferred.",
        ),
    ),
    "sbas": (Sent(name="sbas", call="navbound.sbas.protection_levels", title="SBAS protection levels", columns=(VPL, HPL)),),
}
_OF_SESSION: dict[str, Algorithm] = {}


def algorithms() -> dict[str, Algorithm]:
    """Every algorithm by its id: the core's in their order, then those of the session."""
    return {id_: Algorithm(declared, _entries(declared)) for id_, declared in protection_methods().items()} | _OF_SESSION


def _entries(declared: ProtectionMethod) -> tuple[Entry, ...]:
    """Functions of the package for it, and what its declaration is enough for: a map, and a place or a route."""
    own = _FUNCTIONS.get(declared.id, ())
    if not declared.of_orbits:
        return own
    by_id: dict[type[Entry], Entry] = {
        Place: Place(
            name=declared.id,
            call="navbound.araim.listed.predict",
            settings={"algorithm": declared.id},
            assumptions=partial(_assumptions, declared.id),
        ),
        Grid: Grid(
            name=declared.id,
            call="navbound.araim.listed.predict",
            settings={"algorithm": declared.id},
            title=declared.title,
            columns=(HPL, VPL),
            causes=ARAIM_CAUSES,
            options={"model": "single-frequency"},
            words="Usual settings, error model {model}.",
        ),
    }
    return own + tuple(entry for kind, entry in by_id.items() if not any(isinstance(one, kind) for one in own))


def _assumptions(algorithm: str, model: str) -> list[str]:
    words: list[str] = _loaded("navbound.araim.listed.assumptions")(algorithm, model)
    return words


def entries(kind: type[E]) -> dict[str, E]:
    """Every entry of a kind by its name."""
    return {one.name: one for algorithm in algorithms().values() for one in algorithm.entries if isinstance(one, kind)}


def entry(kind: type[E], argument: str, name: str) -> E:
    """The entry of a kind with this name.

    Raises
    ------
    InputError
        No such entry; the message names the argument and those that exist.
    """
    known = entries(kind)
    if name not in known:
        raise NotFoundError(argument, name, "algorithm", known)
    return known[name]


@contextmanager
def register(algorithm: Algorithm) -> Iterator[None]:
    """Add an algorithm of a caller's own while the context lasts: it appears wherever those of the core do.

    Raises
    ------
    InputError
        An id or a name that is taken.
    """
    known = algorithms()
    if algorithm.declared.id in known:
        raise InputError("id", algorithm.declared.id, domain=f"an id beside {', '.join(known)}")
    for one in algorithm.entries:
        if one.name in entries(type(one)):
            raise InputError("name", one.name, domain=f"a name beside {', '.join(entries(type(one)))}")
    _OF_SESSION[algorithm.declared.id] = algorithm
    try:
        yield
    finally:
        del _OF_SESSION[algorithm.declared.id]


def non_precision() -> tuple[str, bool, tuple[tuple[str, float, str, str], ...]]:
    """Limits of non-precision approach: the horizontal one."""
    return "NPA", False, ()


def none(_model: str) -> list[str]:
    """Nothing to add."""
    return []


def _loaded(call: str | Callable[..., Any]) -> Callable[..., Any]:
    if not isinstance(call, str):
        return call
    module, _, name = call.rpartition(".")
    loaded: Callable[..., Any] = getattr(import_module(module), name)
    return loaded
