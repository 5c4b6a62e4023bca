"""A file of ARINC 424: what is in it, and which routes make a procedure."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from navbound import _core
from navbound.errors import FormatError, InputError
from navbound.procedures.findings import Finding, finding
from navbound.procedures.legs import LevelOfService, Procedure, leg
from navbound.procedures.whole import doubts
from navbound.table.arguments import checked
from navbound.units import METRES_PER_NM
from navbound.words.plurals import counted

LISTED = 12
"""Names that a refusal lists; the file has all."""
ORDER = {**dict.fromkeys("147FT", 0), **dict.fromkeys("258M", 1), **dict.fromkeys("369SV", 2)}
"""Place of a route type in a departure or an arrival: before the common part, the common part, after it (ARINC 424-18, 5.7; standard)."""
SAME = 0.01
"""Two RNP within this share of each other are one, written with other digits. [1]"""


@dataclass(frozen=True)
class Refused:
    """A line that is not used.

    Attributes
    ----------
    line : int
        Its number, from 1.
    field, reason, text : str
        Which field, why, and what stands there.
    """

    line: int
    field: str
    reason: str
    text: str


@dataclass(frozen=True)
class RouteEntry:
    """One route of a procedure.

    Attributes
    ----------
    route_type : str
        Column 20 of its records.
    transition : str
        Its transition; empty for the common or final part.
    n_legs : int
        Legs.
    refused : tuple of int
        Its refused lines: with any, the route is not whole.
    gaps : tuple of (int, int, bool)
        Line before which records are missing by the file's record numbers, how many, and whether inside the route, which is then not whole.
    """

    route_type: str
    transition: str
    n_legs: int
    refused: tuple[int, ...]
    gaps: tuple[tuple[int, int, bool], ...] = ()


@dataclass(frozen=True)
class Entry:
    """One procedure of the file.

    Attributes
    ----------
    airport, kind, ident : str
        Airport, ``sid``, ``star`` or ``approach``, and identifier.
    line : int
        Line of its first record.
    routes : tuple of RouteEntry
        Its routes.
    levels : tuple of LevelOfService
        Lines of minima of an RNP AR approach.
    """

    airport: str
    kind: str
    ident: str
    line: int
    routes: tuple[RouteEntry, ...]
    levels: tuple[LevelOfService, ...]


class Database:
    """A navigation database; made by :func:`read`."""

    def __init__(self, core: _core.NavigationDatabase, file: str) -> None:
        self._core = core
        self.file = file

    @cached_property
    def entries(self) -> tuple[Entry, ...]:
        """Procedures in the order of the file."""
        return tuple(_entry(row) for row in self._core.procedures())

    @property
    def header(self) -> list[str]:
        """The header lines, cycle and effective date among them."""
        return self._core.header

    @property
    def n_lines(self) -> int:
        """Lines of the file."""
        return self._core.n_lines

    @property
    def counts(self) -> dict[str, int]:
        """Records of each kind; ``others`` are of kinds that are not read."""
        return self._core.counts

    @property
    def n_refused(self) -> int:
        """Lines that are not used."""
        return self._core.n_refused

    @property
    def refused(self) -> list[Refused]:
        """The first ten thousand of them."""
        return [Refused(*row) for row in self._core.refused]

    @property
    def notes(self) -> list[str]:
        """What of the file is not used, in words."""
        words = []
        if self.n_refused:
            first = self.refused[0]
            words.append(
                f"{self.n_refused} of {self.n_lines} lines refused; the first is line {first.line}: "
                f"{first.field} {first.reason} ({first.text!r})."
            )
        if self._core.n_unattributed:
            words.append(
                f"{counted(self._core.n_unattributed, 'refused line names', 'refused lines name')} no route: a procedure of this "
                "file may lack a leg."
            )
        return words

    def contradictions(self, airport: str | None = None) -> list[Finding]:
        """Contradictions in the published data, and remarks, in the order of the file's procedures.

        Parameters
        ----------
        airport : str, optional
            Only those of one airport.
        """
        return [finding(row) for row in self._core.contradictions() if airport is None or row["airport"] == airport]

    def procedure(
        self,
        airport: str,
        procedure: str,
        transition: str | None = None,
        *,
        missed: bool = False,
        line: str | None = None,
        defaults: bool = False,
    ) -> Procedure:
        """Legs of a procedure; see :func:`navbound.path.procedure`.

        Raises
        ------
        FormatError
            A refused or missing line in a route that is needed.
        InputError
            A name that the file does not have.
        """
        index, entry = self._find(airport, procedure)
        routes = _routes(entry, transition)
        for k in routes:
            for number in entry.routes[k].refused:
                raise FormatError(
                    self.file, f"{airport} {procedure}: this line is refused, so the route is not whole", number, self._why(number)
                )
            for number, n, inside in entry.routes[k].gaps:
                if inside:
                    raise FormatError(self.file, f"{airport} {procedure}: {_missing(n)}, so the route is not whole", number)
        between = [
            f"{_missing(n)} before line {number} of {Path(self.file).name}, between two routes of {entry.ident}"
            for k in routes
            for number, n, inside in entry.routes[k].gaps
            if not inside
        ]
        selected_m = None if line is None else self._selected(index, entry, routes, line)
        rows, path = self._core.path(index, routes, missed, selected_m, defaults)
        legs = tuple(leg(row) for row in rows)
        return Procedure(
            airport=entry.airport,
            kind=entry.kind,
            ident=entry.ident,
            transition=transition or "",
            missed=missed,
            line=line,
            legs=legs,
            levels=entry.levels,
            file=self.file,
            notes=(*self.notes, *between),
            doubts=doubts(self, entry, self._legs_by_route(index), routes, legs, missed=missed),
            core=path,
        )

    def threshold_elevation_m(self, airport: str, runway: str) -> float | None:
        """Elevation of a runway's threshold, such as ``RW26`` [m]."""
        return self._core.elevations(airport, runway)[1]

    def threshold_heights_m(self, airport: str, runway: str) -> tuple[float | None, float | None]:
        """Elevation of a runway's threshold, and its height above the ellipsoid; None where the file has none [m]."""
        return self._core.elevations(airport, runway)[1:]

    def _legs_by_route(self, index: int) -> list[list[dict[str, Any]]]:
        return [self._core.path(index, [k], True, None, False)[0] for k in range(len(self.entries[index].routes))]

    def _why(self, number: int) -> str | None:
        return next((f"{r.field} {r.reason}" for r in self.refused if r.line == number), None)

    def _find(self, airport: str, procedure: str) -> tuple[int, Entry]:
        at_airport = [(i, e) for i, e in enumerate(self.entries) if e.airport == airport]
        if not at_airport:
            raise InputError("airport", airport, domain=_one_of({e.airport for e in self.entries}))
        named = [(i, e) for i, e in at_airport if e.ident == procedure]
        if not named:
            raise InputError("procedure", procedure, domain=_one_of({e.ident for _, e in at_airport}))
        if len(named) > 1:
            kinds = ", ".join(e.kind for _, e in named)
            raise InputError("procedure", procedure, domain=f"names of one procedure; {airport} has {len(named)} of this name ({kinds})")
        return named[0]

    def _selected(self, index: int, entry: Entry, routes: list[int], line: str) -> float:
        """RNP of the selected line: a published one, or one that the final approach codes [m]."""
        selected_m = _rnp_m(line)
        rows, _ = self._core.path(index, routes, False, None, False)
        coded = [row["rnp_coded_m"] for row in rows if row["part"] == "final" and row["rnp_coded_m"] is not None]
        known = [level.rnp_m for level in entry.levels] + coded
        if known and not any(abs(selected_m - m) <= SAME * max(selected_m, m) for m in known):
            names = sorted({f"RNP {m / METRES_PER_NM:.3g}" for m in known})
            raise InputError("line", line, domain=f"a line of minima of {entry.airport} {entry.ident}: {', '.join(names)}")
        return selected_m


@checked
def read(file: str | Path) -> Database:
    """Read a navigation database of ARINC 424, plain or packed by gzip; its text is not kept.

    Parameters
    ----------
    file : str or path
        The file: 132 characters a line.

    Raises
    ------
    FormatError
        A file that cannot be opened, or without one record.
    """
    return Database(_core.NavigationDatabase.read(str(file)), str(file))


_Route = tuple[str, str, int, list[int], list[tuple[int, int, bool]]]
"""Type, transition, legs, refused lines and gaps of a route, as the core gives it."""


def _missing(n: int) -> str:
    return f"{counted(n, 'record is', 'records are')} missing by the record numbers"


def _entry(row: tuple[str, str, str, int, list[_Route], list[tuple[int, float]]]) -> Entry:
    airport, kind, ident, line, routes, levels = row
    return Entry(
        airport,
        kind,
        ident,
        line,
        tuple(RouteEntry(route_type, transition, n, tuple(refused), tuple(gaps)) for route_type, transition, n, refused, gaps in routes),
        tuple(LevelOfService(number, rnp_m) for number, rnp_m in levels),
    )


def _routes(entry: Entry, transition: str | None) -> list[int]:
    """Indices of the routes that are flown, in their order: the named transitions, and what all share."""
    named = [name for name in (transition or "").split("+") if name]
    has = {r.transition for r in entry.routes if r.transition not in {"", "ALL"}}
    for name in named:
        if name not in has:
            raise InputError("transition", name, domain=_one_of(has) if has else f"none: {entry.ident} has no transitions")
    flown = [k for k, r in enumerate(entry.routes) if r.transition in named or r.transition in {"", "ALL"}]
    if not flown:
        raise InputError("transition", str(transition), domain=_one_of(has))
    if entry.kind == "approach":
        return sorted(flown, key=lambda k: entry.routes[k].route_type != "A")
    return sorted(flown, key=lambda k: ORDER.get(entry.routes[k].route_type, 1))


def _one_of(names: set[str]) -> str:
    ordered = sorted(names)
    more = f" and {len(ordered) - LISTED} more" if len(ordered) > LISTED else ""
    return f"one of {', '.join(ordered[:LISTED])}{more}"


def _rnp_m(line: str) -> float:
    match = re.fullmatch(r"RNP (?:AR )?(\d+(?:\.\d+)?)", line.strip(), re.IGNORECASE)
    value = float(match[1]) if match else float("nan")
    if not 0 < value <= 20:
        raise InputError("line", line, domain="'RNP x' with x in NM, in (0, 20]")
    return value * METRES_PER_NM
