"""Whether the legs of a procedure are the whole of it: what a damaged or lost record of the file leaves behind."""

from __future__ import annotations

import gzip
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from navbound.procedures.legs import STATES
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from navbound.procedures.database import Database, Entry
    from navbound.procedures.legs import Leg

    Rows = list[dict[str, Any]]

BEGINNINGS = ("IF", "FC", "HF", "PI")
"""Legs that begin at their own fix: no other began one of the 32,751 routes of approaches of cycle 2604."""
_LACKING = ("no_fix", "no_centre", "no_navaid", "ambiguous_fix", "no_variation", "not_coded", "impossible")
"""States of legs that a record of the file should have given a path."""
_FROM_A_FIX = ("TF", "RF", "AF")
"""Legs that begin where another ends, at a fix."""
_AIRPORT = slice(6, 10)
"""Columns of the airport."""
_READ = 160
"""Characters of a line that are read at once; a record has 132."""


def doubts(
    database: Database, entry: Entry, rows: Sequence[Rows], routes: Sequence[int], legs: Sequence[Leg], *, missed: bool
) -> tuple[str, ...]:
    """Sentences on what speaks against the legs being the whole procedure; none where nothing does.

    Parameters
    ----------
    database : Database
        The file.
    entry : Entry
        The procedure.
    rows : sequence of list of dict
        The legs of each of its routes, as the core gives them.
    routes : sequence of int
        Its routes that are flown.
    legs : sequence of Leg
        Their legs, joined.
    missed : bool
        Whether the missed approach belongs to them.
    """
    words = [*_refused(database, entry), *_numbers(entry, rows, routes), *_paths(legs)]
    if entry.kind == "approach":
        at = [k for k, leg in enumerate(legs) if leg.role == "M"]
        if not at or (not missed and at[-1] != len(legs) - 1):
            words.append(f"{entry.ident} does not end at a missed approach point: its last leg is {_named(legs[-1]) if legs else 'none'}.")
    else:
        # Of an approach both ends are known.
        words += _gaps(entry, routes)
    return tuple(dict.fromkeys(words))


def _refused(database: Database, entry: Entry) -> list[str]:
    """Lines of the airport, or of no airport of the file, that are not used."""
    if not database.n_refused:
        return []
    reasons = {r.line: f"{r.field} {r.reason}" for r in database.refused}
    airports = {e.airport for e in database.entries}
    words = []
    for number, text in _lines(database.file, set(reasons)).items():
        airport = text[_AIRPORT].strip()
        # Enroute fixes and navaids are no legs; where a leg needs one that is lost, the leg says so.
        enroute = text[4:5] in ("D", "E") and len(text) > _AIRPORT.stop
        if not enroute and (airport == entry.airport or airport not in airports):
            words.append(
                f"Line {number} of {Path(database.file).name} is refused ({reasons[number]}); it may have been a part of this procedure."
            )
    more = len(words) - 3
    return [
        *words[:3],
        *([f"{counted(more, 'more line')} of the file {agreeing(more, 'is', 'are')} refused that may have been."] if more > 0 else []),
    ]


def _lines(file: str, numbers: set[int]) -> dict[int, str]:
    """The first characters of some lines, a line at a time."""
    with Path(file).open("rb") as plain:
        packed = plain.read(2) == b"\x1f\x8b"
    texts: dict[int, str] = {}
    with gzip.open(file, "rb") if packed else Path(file).open("rb") as stream:
        number, begins = 1, True
        while (piece := stream.readline(_READ)) and len(texts) < len(numbers):
            if begins and number in numbers:
                texts[number] = piece.decode("latin-1").rstrip("\r\n")
            begins = piece.endswith(b"\n")
            number += begins
    return texts


def _numbers(entry: Entry, rows: Sequence[Rows], routes: Sequence[int]) -> list[str]:
    """Routes that begin with a leg that needs one before it, or whose sequence numbers jump."""
    step = min((legs[0]["sequence"] for legs in rows if legs), default=0)
    words = []
    for k in routes:
        legs, route = rows[k], entry.routes[k]
        if not legs:
            continue
        name = f"{entry.ident}{f', transition {route.transition}' if route.transition else ''}"
        is_final = entry.kind == "approach" and route.route_type != "A"
        first = legs[0]
        begins = first["terminator"] in BEGINNINGS if entry.kind == "approach" else first["terminator"] not in _FROM_A_FIX
        if not begins or (first["sequence"] > step and not is_final):
            words.append(f"{name} begins with leg {_called(first)}: the record of a leg before it may be missing.")
        for before, after in pairwise(legs):
            if after["sequence"] - before["sequence"] > step:
                words.append(f"{name} goes from leg {_called(before)} to leg {_called(after)}: the record of a leg between may be missing.")
    return words


def _gaps(entry: Entry, routes: Sequence[int]) -> list[str]:
    """Records missing before a route that is flown or before the next one: what is lost may be an end of the former."""
    words = []
    for k in sorted({*routes, *(k + 1 for k in routes)}):
        for number, n, _ in entry.routes[k].gaps if k < len(entry.routes) else ():
            words.append(f"{counted(n, 'record is', 'records are')} missing before line {number}, by the record numbers.")
    return words


def _paths(legs: Sequence[Leg]) -> list[str]:
    """Legs without the path that they should have, and legs that do not begin where the one before ends."""
    words = []
    for k, leg in enumerate(legs):
        if leg.state in _LACKING or (k and leg.state == "no_start" and leg.terminator in _FROM_A_FIX):
            words.append(f"Leg {_named(leg)} has no path: {STATES[leg.state]}.")
        elif k and leg.terminator == "IF" and legs[k - 1].has_path and legs[k - 1].state != "open_end":
            words.append(f"No leg leads from {legs[k - 1].fix} to {leg.fix}.")
    return words


def _named(leg: Leg) -> str:
    return f"{leg.sequence:03d} {leg.fix or '-'} {leg.terminator}"


def _called(row: dict[str, Any]) -> str:
    return f"{row['sequence']:03d} {row['fix'] or '-'} {row['terminator']}"
