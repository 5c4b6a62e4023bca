"""An algorithm of protection levels that a test adds: RAIM's levels, doubled."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from navbound import algorithms, raim, sbas
from navbound.methods import ProtectionMethod

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

WORDS = "Twice the level of RAIM, for a test"


@dataclass(frozen=True)
class Levels:
    """What a map and a prediction need."""

    hpl_m: NDArray[np.float64]
    n_sv: NDArray[np.int64]
    status: NDArray[np.str_]


def predict(*sky: Any, mask_rad: float, model: str = "single-frequency") -> Levels:
    """Levels from orbits."""
    levels = raim.predict(*sky, mask_rad=mask_rad, model=model)
    return Levels(2.0 * levels.hpl_m, levels.n_sv, levels.status)


def watch(*files: Any, **options: Any) -> Any:
    """Levels of recorded observations."""
    watched = raim.watch(*files, **options)
    doubled = watched.epochs.with_columns(watched.epochs["hpl_m"] * 2.0)
    return replace(watched, epochs=doubled, models=watched.models | {"protection levels": WORDS})


def sent(*messages: Any, **options: Any) -> Any:
    """Levels of a service's messages."""
    levels = sbas.protection_levels(*messages, **options)
    return Levels(2.0 * levels.hpl_m, levels.n_sv, levels.status)


TOY = algorithms.Algorithm(
    ProtectionMethod("toy", "Toy levels", "toy_algorithm.predict", "a test", "yours", "one satellite", WORDS, integrity=False),
    (
        algorithms.Recorded(name="toy", call="toy_algorithm.watch"),
        algorithms.Place(name="toy", call="toy_algorithm.predict", assumptions=lambda _model: [WORDS]),
        algorithms.Grid(
            name="toy",
            call="toy_algorithm.predict",
            title="Toy levels",
            columns=(algorithms.Column("hpl_m", "Horizontal protection level"),),
            causes=algorithms.ARAIM_CAUSES,
            options={"model": "single-frequency"},
            words=f"{WORDS}, error model {{model}}.",
        ),
    ),
)
