"""Any algorithm of the core's list whose satellites have the receiver's own ranges: what orbits promise, and levels by its id."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from navbound import _core
from navbound.araim.settings import ERROR_MODELS, SUPPORT, ErrorModel, Support, airborne_numbers, overhead, support_rows
from navbound.errors import NotFoundError
from navbound.methods import protection_methods

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from navbound.gnss.constellations import Orbits


@dataclass(frozen=True)
class Levels:
    """Levels of every user at every instant.

    Attributes
    ----------
    hpl_m, vpl_m : ndarray
        NaN without a position, or where the algorithm has no vertical level; infinite where a fault cannot be detected. [m]
    n_sv : ndarray
        Satellites above the mask. [1]
    status : ndarray of str
        ``ok``, or why there is no finite level.
    beside : dict of str to ndarray
        The numbers that the algorithm names beside its levels; the ending of each name is its unit.
    """

    hpl_m: NDArray[np.float64]
    vpl_m: NDArray[np.float64]
    n_sv: NDArray[np.int64]
    status: NDArray[np.str_]
    beside: dict[str, NDArray[np.float64]]


def predict(
    orbits: Orbits,
    lat_rad: ArrayLike,
    lon_rad: ArrayLike,
    h_m: ArrayLike,
    time_s: ArrayLike,
    *,
    algorithm: str,
    mask_rad: float = float(np.radians(5.0)),
    support: Support = SUPPORT,
    model: str | ErrorModel = "single-frequency",
) -> Levels:
    """Protection levels of every user at every instant by the algorithm of an id, with its usual settings.

    Parameters
    ----------
    orbits, lat_rad, lon_rad, h_m, time_s, mask_rad, support, model
        As of :func:`navbound.araim.predict`.
    algorithm : str
        An id of :func:`navbound.methods.protection_methods` that has ``of_orbits``.

    Returns
    -------
    Levels
        Arrays of the shape of ``time_s`` followed by that of the users.

    Raises
    ------
    InputError
        No such algorithm, or one that orbits are not enough for; and as :func:`navbound.araim.predict`.
    """
    if algorithm not in known():
        raise NotFoundError("algorithm", algorithm, "algorithm of orbits", known())
    shape, sky = overhead(orbits, (lat_rad, lon_rad, h_m), time_s, mask_rad)
    computed = _core.algorithm_predict(algorithm, *sky, support_rows(support), airborne_numbers(model))
    status = np.array(computed.pop("words"))[computed.pop("outcome")]
    columns = {name: values.reshape(shape) for name, values in computed.items()}
    hpl_m, vpl_m, n_sv = (columns.pop(name) for name in ("hpl_m", "vpl_m", "n_sv"))
    return Levels(hpl_m, vpl_m, n_sv, status.reshape(shape), columns)


def known() -> list[str]:
    """Ids of the algorithms that orbits are enough for."""
    return [id_ for id_, declared in protection_methods().items() if declared.of_orbits]


def assumptions(algorithm: str, model: str) -> list[str]:
    """What predicted levels rest on, as sentences."""
    declared, errors = protection_methods()[algorithm], ERROR_MODELS[model]
    return [
        f"Levels: {declared.title}; covers {declared.covers}; assumes {declared.assumes}; usual settings.",
        f"Range errors: {errors.source} ({errors.provenance}); orbits and clocks: {SUPPORT.source} ({SUPPORT.provenance}).",
    ]
