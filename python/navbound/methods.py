"""The lists of methods and of protection levels: what each is, its source, its promises. Read from the core; nothing is listed twice."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Literal, cast

from navbound import _core
from navbound.errors import NotFoundError
from navbound.table.columns import HORIZONTAL, METHOD_INPUTS

if TYPE_CHECKING:
    import numpy as np
    import polars as pl
    from numpy.typing import NDArray

_EXTRACTION = _core.ee_declaration()
EXTRACTION_LABEL = str(_EXTRACTION["label"])
"""What stands beside every number of Error Extraction (:mod:`navbound.sbas`)."""
EXTRACTION_MARK = "ee_"
"""How the name of every column of Error Extraction begins."""

Provenance = Literal["printed", "re-derived", "standard", "ours", "inferred", "yours"]


@dataclass(frozen=True)
class Method:
    """One entry of the core's list.

    Attributes
    ----------
    id : str
        Command-line choice and page name; ``tse-exact`` has the columns ``tse_exact_m`` and ``tse_exact_integrity_m``.
    error_column : str
        The column of the epoch table whose magnitude this method bounds.
    may_alert : bool
        False for experimental bounds and for exhibits of a misprint.
    """

    id: str
    title: str
    source: str
    provenance: Provenance
    error_column: str
    assumes: str
    scales_with_length: bool
    ignores_north: bool
    monotone_in_risk: bool
    conservative: bool
    may_alert: bool

    @property
    def column(self) -> str:
        """Column of the accuracy bound."""
        return f"{self.id.replace('-', '_')}_m"

    @property
    def integrity_column(self) -> str:
        """Column of the integrity bound."""
        return f"{self.id.replace('-', '_')}_integrity_m"


@dataclass(frozen=True)
class ProtectionMethod:
    """One algorithm of protection levels.

    Attributes
    ----------
    function : str
        Where it is called; it needs satellites, messages or a filter, so it has a function of its own.
    provenance : str
        Of the formulas. Priors, budgets and error models carry their own, in the run record and in ``docs/methods``.
    covers, assumes : str
        Which faults the levels cover, and what must be true for the stated risk to be true.
    integrity : bool
        Whether integrity may rest on it; False for experimental levels.
    of_orbits : bool
        Whether orbits and an error model of ranges are all that it needs: then it can be mapped and predicted by its id.
    """

    id: str
    title: str
    function: str
    source: str
    provenance: Provenance
    covers: str
    assumes: str
    integrity: bool
    of_orbits: bool = False


@dataclass(frozen=True)
class BoundColumn:
    """One method over a table: bounds [m], and per row the index of its reason, 0 where there is a bound."""

    bound_m: NDArray[np.float64]
    reason: NDArray[np.uint32]
    reasons: list[tuple[str, str]]
    """(id of ``navbound.status.REASONS``, words), in order; reason ``k`` of a row is entry ``k - 1``."""


@cache
def methods() -> dict[str, Method]:
    """Every method by its id, in the order of the core's list."""
    return {m["id"]: Method(**m) for m in _core.methods()}


@cache
def protection_methods() -> dict[str, ProtectionMethod]:
    """Every algorithm of protection levels by its id, in the order of the core's list."""
    return {p["id"]: ProtectionMethod(**p) for p in _core.protection_methods()}


def method(method_id: str) -> Method:
    """The method with this id.

    Raises
    ------
    InputError
        No such method; the message lists those that exist.
    """
    try:
        return methods()[method_id]
    except KeyError:
        raise NotFoundError("method", method_id, "method", methods()) from None


_NSE = ("nse_e_m", "nse_n_m", "nse_u_m")
ERRORS_NEED = {
    "nse_h_m": {"nse_e_m"},
    "nse_3d_m": {"nse_e_m", "nse_u_m"},
    "nse_along_m": {"nse_e_m", "course_rad"},
    "nse_cross_m": {"nse_e_m", "course_rad"},
    "tse_m": {"nse_e_m", "course_rad", "fte_m"},
    "tse_v_m": {"nse_e_m", "course_rad", "fte_v_m", "nse_u_m", "path_angle_rad"},
    "sigma_cross_m": {*HORIZONTAL, "course_rad"},
}
"""Columns of errors, and those that an epoch table must have for them."""


def with_errors(epochs: pl.DataFrame) -> pl.DataFrame:
    """An epoch table with the errors along the axes of its path, and the deviation of the navigation error across it.

    Parameters
    ----------
    epochs : DataFrame
        Columns of docs/notation.md.

    Returns
    -------
    DataFrame
        With ``nse_h_m``, ``nse_3d_m``, ``nse_along_m``, ``nse_cross_m``, ``tse_m``, ``tse_v_m`` and ``sigma_cross_m``, where the table has
        what they need; null where a row lacks it. [m] Provenance: ours, the projection is that of :func:`navbound.tse.project`.
    """
    import polars as pl  # noqa: PLC0415 - a list of methods needs no tables

    columns = {name: column_of(epochs, name) for name in (*METHOD_INPUTS, *_NSE) if name in epochs.columns}
    errors = _core.errors_of(epochs.height, columns)
    there = {name: errors[name] for name, needs in ERRORS_NEED.items() if needs <= set(epochs.columns)}
    return epochs.with_columns(pl.Series(name, values, nan_to_null=True) for name, values in there.items())


def bounds(epochs: pl.DataFrame, method_id: str, risk: float) -> BoundColumn:
    """Evaluate one method over an epoch table.

    Parameters
    ----------
    epochs : DataFrame
        Columns of docs/notation.md; those the method needs and the table lacks make every row unavailable.
    method_id : str
        An id of :func:`methods`.
    risk : float
        Allowed risk. [1]

    Returns
    -------
    BoundColumn
        Source equation and promises: see the method's entry.

    Raises
    ------
    InputError
        Unknown method, or a risk outside [1e-300, 0.5].
    """
    selected = method(method_id)
    columns = {name: column_of(epochs, name) for name in METHOD_INPUTS if name in epochs.columns}
    bound_m, reason, reasons = _core.bounds_of(selected.id, risk, epochs.height, columns)
    return BoundColumn(bound_m, reason, reasons)


def column_of(epochs: pl.DataFrame, name: str) -> NDArray[np.float64]:
    """A numeric column as float64, null as NaN."""
    import numpy as np  # noqa: PLC0415  (the list of methods is used without tables too)
    import polars as pl  # noqa: PLC0415

    values = epochs.get_column(name).cast(pl.Float64).fill_null(float("nan")).to_numpy()
    return cast("NDArray[np.float64]", np.ascontiguousarray(values))
