"""What a line says of its own position under keys that are none of the contract: the names and words of tables, for the core."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from navbound import _core
from navbound.read.columns.place_names import INERTIAL_APART_M, PLACES_APART_M, place_words
from navbound.read.quantities import POSITION_TIME_NAMES, QUANTITIES, QUANTITY, STATED_QUANTITIES, UNITS
from navbound.read.statements.kinds import BEFORE, KINDS, kind_of
from navbound.read.statements.names import BARE_LENGTHS, speaks_of_integrity
from navbound.table.columns import COVARIANCE

_JUDGED = frozenset({"sigma_e_m", "sigma_n_m", "epu_m", "rc_m", "nac_p", "nic", "nuc_p", "pic", "hpl_m", "status", *COVARIANCE})
"""Quantities of tables that bound a position or speak for it. Under a name that is none of the contract their value is not understood."""
_CONTRACT = ("sigma_m", "rnp_m")
"""Keys of the contract that no table has: written otherwise, they are none of it."""
_USABLE_MODES = frozenset({"coasting"})
"""Modes of navbound's own tables in which a position is usable; its status says how well."""

Kinds = list[tuple[list[str], list[str], float | None, float | None]]


Places = tuple[list[list[str]], list[float]]


def for_core() -> tuple[Kinds, list[str], Places]:
    """Kinds as names, words and the range of numbers that say nothing against the position; words of a mode against it; other places."""
    judged = [q for q in QUANTITIES if q.name in _JUDGED] + [q for q in STATED_QUANTITIES if q.name != "alert"]
    named = [*_CONTRACT, *POSITION_TIME_NAMES, *sorted(BARE_LENGTHS), *(name for q in judged for name in (q.name, *q.aliases))]
    lengths = {name.removesuffix("_m") for q in judged if q.si == "m" for name in (q.name, *q.aliases)} | BARE_LENGTHS
    kinds: Kinds = [([*named, *(f"{name}_{unit}" for name in sorted(lengths) for unit in UNITS["m"])], [], None, None)]
    # Under its own name the contract has the number of satellites.
    kinds.append((sorted(QUANTITY["n_sv"].aliases.keys() - {"n_sv"}), ["null", "", "nan"], float(_core.DETERMINING_SATELLITES), None))
    for kind in KINDS:
        spelled = kind.names | {f"{before}_{name}" for name in kind.names for before in BEFORE}
        several = [f"{name}s" for name in spelled] if kind.effect == "alert" else []
        # What bounds a position in a table is understood under no other name than the contract's.
        least, most = (None if math.isinf(each) else each for each in (kind.below, kind.above))
        kinds.append((sorted({*spelled, *several}.difference(named)), sorted(kind.fine), least, most))
    mode = kind_of("nav_mode")
    modes = sorted((mode.against if mode is not None else frozenset()) - _USABLE_MODES)
    return kinds, modes, (list(place_words()), [PLACES_APART_M, INERTIAL_APART_M])


_AGAINST = 5
"""What speaks against positions that a sentence names. [1]"""


def against(counts: Mapping[str, int]) -> str:
    """A sentence on what spoke against positions, the most frequent first."""
    often = sorted(counts, key=lambda name: (-counts[name], name))
    others = f" and {len(often) - _AGAINST} more" if len(often) > _AGAINST else ""
    return f"what speaks against positions: {', '.join(f'{counts[name]} {name}' for name in often[:_AGAINST])}{others}"


_SHOWN = 20
"""Keys that a sentence names; of those that may speak of accuracy or integrity all. [1]"""


def unread(keys: Iterable[str]) -> str:
    """A sentence about keys that nothing reads, with how often each came where that is known; some may speak of accuracy or integrity."""
    counts = keys if isinstance(keys, Mapping) else {}
    names = sorted(keys)
    shown = [f"{counts[name]} {name}" if name in counts else name for name in names[:_SHOWN]]
    others = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    speaking = [name for name in names if speaks_of_integrity(name)]
    more = f"; by their names these may speak of accuracy or integrity, and nothing is judged by them: {', '.join(speaking)}"
    return f"keys that nothing reads: {', '.join(shown)}{others}{more if speaking else ''}"
