"""ARAIM on a receiver's recorded observations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
import polars as pl

from navbound import _core
from navbound._araim_settings import (
    SERVICES,
    SUPPORT,
    ErrorModel,
    Service,
    Support,
    airborne_numbers,
    error_model,
    rule_numbers,
    stated,
    support_rows,
)
from navbound._receivers import SYSTEMS, Navigation, Observations, with_errors
from navbound.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True)
class Watched:
    """A receiver's epochs after detection and exclusion.

    Attributes
    ----------
    epochs : DataFrame
        The epoch table (docs/notation.md): ``track``, ``time_ns``, ``est_*``, ``hpl_m``, ``vpl_m``, ``emt_m``, ``n_sv``, ``n_excluded``,
        ``n_modes``, ``mode``, ``status``, ``reason``, with truth also ``truth_*`` and ``nse_*``. ``status`` is ``degraded`` after an
        exclusion. Where a fault could not be excluded, and where nothing is left of the integrity risk, there are no levels: null.
    models : dict of str to str
        Every model by name, for the record of a run.
    """

    epochs: pl.DataFrame
    models: dict[str, str]


def watch(
    observations: Observations,
    navigation: Navigation,
    *,
    systems: str = "GE",
    signals: Literal["single", "dual"] = "dual",
    service: str | Service = "lpv-200",
    support: Support = SUPPORT,
    model: str | ErrorModel | None = None,
    mask_rad: float = float(np.radians(5.0)),
    truth_ecef_m: ArrayLike | None = None,
    track: str | None = None,
) -> Watched:
    """ARAIM of every epoch of an observation file: position, tests of its residuals, exclusion, levels.

    Parameters
    ----------
    observations, navigation
        From ``gnss.read_observations`` and ``gnss.read_navigation``.
    systems : str, optional
        Letters of ``gnss.SYSTEMS``.
    signals : {"single", "dual"}, optional
        L1, E1, B1I with the broadcast ionosphere; or ionosphere-free pairs.
    service : str or Service, optional
        A name of :data:`SERVICES`, or budgets of one's own.
    support : Support, optional
        What is promised of the satellites.
    model : str or ErrorModel, optional
        A name of :data:`ERROR_MODELS`; without it that of the signals.
    mask_rad : float, optional
        Lowest elevation. [rad]
    truth_ecef_m : array_like, shape (3,) or (n_epochs, 3), optional
        True position, Earth-fixed. [m]
    track : str, optional
        Name of the track; by default the marker's or the file's.

    Raises
    ------
    InputError
        Systems that are not there, single signals without a broadcast ionosphere, numbers outside their domain.
    """
    chosen = checked_model(navigation, systems, signals, model, mask_rad)
    numbers = rule_numbers(service)
    if len(numbers) != 7:
        raise InputError("service", service, domain=f"one of {', '.join(SERVICES)}, or a Service")
    found = _core.araim_watch(
        observations._core, navigation._core, systems, signals == "dual", mask_rad, support_rows(support), airborne_numbers(chosen), numbers
    )
    status = np.array(found.pop("words"))[found.pop("outcome")]
    decision = np.array(found.pop("decision"), dtype=np.str_)
    usable = (status == "ok") & (decision != "not_excluded")
    without = np.isin(decision, ["", "not_excluded"])
    why = np.where(
        decision == "not_excluded", "a fault that cannot be excluded", np.where(status == "not_monitored", status, found["reason"])
    )
    excluded = [",".join(names) for names in found.pop("excluded")]
    epochs = pl.DataFrame(
        {
            "track": [track or observations.marker or observations.path.name] * observations.n_epochs,
            "time_ns": observations.time_ns,
            **{name: found[name] for name in ("est_lat_rad", "est_lon_rad", "est_h_m")},
            **{name: np.where(usable, found[name], np.nan) for name in ("hpl_m", "vpl_m", "emt_m")},
            **{name: found[name] for name in ("n_sv", "n_excluded", "n_modes")},
            "mode": ["araim"] * observations.n_epochs,
            "status": np.where(without, "not_available", np.where(decision == "excluded", "degraded", "ok")),
            "reason": [f"excluded {e}" if e else w for e, w in zip(excluded, why.tolist(), strict=True)],
        }
    ).with_columns(pl.selectors.float().fill_nan(None), pl.col("reason").replace({"": None}))
    budgets = SERVICES[service] if isinstance(service, str) else service
    name = service if isinstance(service, str) else "the caller's"
    models = {
        "protection levels": f"ARAIM with exclusion, {name}: {stated(budgets)}",
        "promises of satellites": stated(support),
        "range errors": stated(chosen),
        "signals": "ionosphere-free pairs" if signals == "dual" else "one pseudorange, Klobuchar",
        "exclusion": "equal shares of the integrity risk for every decision (ours)",
    }
    return Watched(with_truth(epochs, truth_ecef_m), models)


def checked_model(navigation: Navigation, systems: str, signals: str, model: str | ErrorModel | None, mask_rad: float) -> ErrorModel:
    """The error model of a receiver's signals, after a look at what else was asked.

    Raises
    ------
    InputError
        Systems that are not there, other signals, single signals without a broadcast ionosphere, a mask outside [0, pi/2), no such model.
    """
    if not systems or any(s not in SYSTEMS for s in systems):
        raise InputError("systems", systems, domain=f"letters of {''.join(SYSTEMS)}")
    if signals not in {"single", "dual"}:
        raise InputError("signals", signals, domain="single, dual")
    if signals == "single" and not navigation.has_ionosphere:
        raise InputError("signals", "single", domain="dual, or a navigation file with the ionosphere of GPS")
    if not 0 <= mask_rad < np.pi / 2:
        raise InputError("mask_rad", mask_rad, "rad", "[0, pi/2)")
    return error_model(f"{signals}-frequency" if model is None else model)


def with_truth(epochs: pl.DataFrame, truth_ecef_m: ArrayLike | None) -> pl.DataFrame:
    """Errors beside the positions, where truth is known."""
    return epochs if truth_ecef_m is None else with_errors(epochs, truth_ecef_m)
