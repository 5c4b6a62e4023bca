"""What the list of columns says of a table's columns: which declaration is a column's, and what a report carries and draws."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, Literal

from navbound.table import columns
from navbound.table.declare import UNITS, Column, Drawn, unit_of

if TYPE_CHECKING:
    from collections.abc import Iterable


def named(names: Iterable[str]) -> tuple[Column, ...]:
    """Declared columns of the epoch table, in the order of the names.

    Raises
    ------
    KeyError
        A name that is not declared.
    """
    of = {column.name: column for column in columns.EPOCHS}
    return tuple(of[name] for name in names)


def declaration(name: str, methods: Iterable[str] = ()) -> Column | None:
    """The declaration of a column of the epoch table; None where there is none.

    Parameters
    ----------
    name : str
        A column's name; those of methods and of states too.
    methods : iterable of str
        Ids of the methods whose columns count as declared.
    """
    forms = {f"{method.replace('-', '_')}{ending}": f"<method>{ending}" for method in methods for ending in ("_m", "_integrity_m")}
    form = re.sub(r"^p_state_[1-9][0-9]*$", "p_state_<i>", forms.get(name, name))
    return next((column for column in columns.EPOCHS if column.name == form), None)


def in_report(kind: Literal["text", "number"], methods: Iterable[str] = (), n_states: int = 0) -> list[str]:
    """Names of the columns that a report carries: words, or numbers.

    Parameters
    ----------
    kind : {"text", "number"}
        Words or numbers of any type.
    methods : iterable of str
        Ids of the methods of the run; their bounds at both risks are carried.
    n_states : int
        Number of states of the run's classifier.
    """
    ids = [method.replace("-", "_") for method in methods]
    names: list[str] = []
    for column in columns.EPOCHS:
        if not column.shown or (column.kind == "text") != (kind == "text"):
            continue
        if "<method>" in column.name:
            names += [column.name.replace("<method>", of) for of in ids]
        elif "<i>" in column.name:
            names += [column.name.replace("<i>", str(i)) for i in range(1, n_states + 1)]
        else:
            names.append(column.name)
    return list(dict.fromkeys(names))


def drawn(names: Iterable[str]) -> list[dict[str, object]]:
    """Charts that the report draws from declarations, with those of their columns that a table has.

    Returns
    -------
    list of dict
        ``title``, ``unit`` and ``lines`` of each chart; a line has ``column``, ``label``, ``about`` and ``limit``.
    """
    present = set(names)
    charts: dict[tuple[str, str], list[dict[str, object]]] = {}
    for column in columns.EPOCHS:
        if isinstance(column.shown, Drawn) and column.name in present:
            line: dict[str, object] = {
                "column": column.name,
                "label": column.shown.label,
                "about": column.plain,
                "limit": column.shown.limit,
            }
            charts.setdefault((column.shown.chart, column.unit), []).append(line)
    return [{"title": title, "unit": UNITS[unit], "lines": lines} for (title, unit), lines in charts.items()]


def metadata(names: Iterable[str], methods: Iterable[str] = ()) -> dict[str, str]:
    """Units and meanings of an epoch table's columns, for the file that holds it: JSON under the key ``navbound_columns``."""
    ids = list(methods)
    known = {name: declaration(name, ids) for name in names}
    stated = {
        name: {"unit": UNITS[unit_of(name) if column.kind != "text" else "text"], "meaning": column.plain}
        for name, column in known.items()
        if column
    }
    return {"navbound_columns": json.dumps(stated, ensure_ascii=False)}
