"""Files that are refused for their columns: what is lacking, what comes nearest, and what to do."""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING

from navbound.errors import FormatError
from navbound.read.columns.column import POSITION, Column
from navbound.read.columns.naming import LONGEST_NAME, declare, parted_form, plain_form
from navbound.read.quantities import LEVEL_QUANTITIES, QUANTITIES, TIME_NAMES, TIME_UNITS

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

_MOST_COMPARED = 1000
"""Columns whose names are compared with the known ones. [1]"""
_MOST_SHOWN = 30
"""Columns that a refusal names, the nearest to a known name first: the one that is looked for may have a name like none. [1]"""


def refuse_twins(columns: dict[str, Column], declared: set[str], names: list[str], path: Path) -> None:
    """Refuse a column beside which another one has the same name but for case, blanks or a unit: the order would decide."""
    for quantity, column in columns.items():
        forms = {plain_form(column.name)[0], parted_form(column.name)}
        twins = [name for name in names if name != column.name and forms & {plain_form(name)[0], parted_form(name)}]
        if twins and quantity not in declared:
            what = f"“{column.name}” and “{twins[0]}” are one name in another writing, and nothing says which of both counts"
            raise FormatError(path, f"{what}; {declare(f'{quantity}=COLUMN')}", 1, quantity)


def _unit_of_time(name: str) -> str:
    """The unit that the name of a column suggests; ``UNIT`` where it suggests none."""
    parts = set(parted_form(name).split("_"))
    sizes = {"ns": {"ns", "nsec"}, "us": {"us", "usec", "micros"}, "ms": {"ms", "msec", "millis"}, "s": {"s", "sec", "unix", "epoch"}}
    size = next((size for size, words in sizes.items() if words & parts), None)
    if size is None and not {"gps", "utc"} & parts:
        return "UNIT"
    scale = "gps" if "gps" in parts else "utc"
    return f"{scale}_{size}" if f"{scale}_{size}" in TIME_UNITS else f"{scale}_s"


_TRUTH_ALIASES = frozenset(alias for q in QUANTITIES if q.name in {"truth_lat_rad", "truth_lon_rad"} for alias in q.aliases)


def truth_as_position(names: Iterable[str]) -> dict[str, str]:
    """Of a recording that holds a true position and no estimate, its columns as those of a position: quantity to ``column:unit``."""
    of_truth = {"truth_lat_rad": "est_lat_rad", "truth_lon_rad": "est_lon_rad", "truth_h_m": "est_h_m"}
    aliases = {alias: (q.name, unit) for q in QUANTITIES for alias, unit in q.aliases.items()}
    known = {name: aliases[plain_form(name)[0]] for name in names if plain_form(name)[0] in aliases}
    if {"est_lat_rad", "est_lon_rad"} & {quantity for quantity, _ in known.values()}:
        return {}
    return {of_truth[quantity]: f"{name}:{unit}" for name, (quantity, unit) in known.items() if quantity in of_truth}


WITHOUT_LEVEL = (
    "positions with a covariance and no protection level are judged by `navbound analyze`; protection levels are made of observations "
    "(RINEX with navigation files, or a receiver's log with --solve) by `navbound evaluate --protection`"
)
"""What to do with a file whose protection levels are to be judged and that has none."""


def require(columns: dict[str, Column], times: list[Column], names: list[str], path: Path, required: Sequence[str]) -> None:
    """Refuse a table without a time or a required quantity, and say what comes nearest."""
    aliases = {q.name: list(q.aliases) for q in QUANTITIES + LEVEL_QUANTITIES}
    needs = {"time": ([*times], list(TIME_NAMES))}
    needs |= {name: ([columns[name]] if name in columns else [], aliases[name]) for name in required}
    for need, (present, known) in needs.items():
        if present:
            continue
        short = [n for n in names if len(n) <= LONGEST_NAME][:_MOST_COMPARED]
        near = {n: max(difflib.SequenceMatcher(None, plain_form(n)[0], a).ratio() for a in known) for n in short}
        best = sorted(short, key=lambda n: -near[n])[:_MOST_SHOWN]
        if not best:
            raise FormatError(path, "the first line names no columns: a table begins with their names", 1, need)
        others = f" and {len(names) - len(best)} more" if len(names) > len(best) else ""
        truth = [n for n in names if plain_form(n)[0] in _TRUTH_ALIASES]
        if need in POSITION and truth:
            of_truth = f"the file has the true position ({', '.join(truth[:3])}) and no estimate"
            advice = "name it with --truth beside the recording that it is the truth of"
            raise FormatError(path, f"no column holds it; {of_truth}: {advice}", 1, need)
        without = f"; {WITHOUT_LEVEL}" if need in {"hpl_m", "vpl_m"} else ""
        unit = {"time": _unit_of_time(best[0]), "est_lat_rad": "deg", "est_lon_rad": "deg"}.get(need, "m")
        more = f"; units: {', '.join(TIME_UNITS)}" if need == "time" else ""
        raise FormatError(
            path,
            f"no column holds it (known names: {', '.join(known[:6])}, ...); the file has {', '.join(best)}{others}; "
            f"if one of them is it, {declare(f'{need}=COLUMN:{unit}')}{more}{without}",
            1,
            need,
        )
