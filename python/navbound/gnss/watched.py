"""What the monitors on board have in common when they watch a receiver's recorded observations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound.araim.settings import ErrorModel, Support, error_model, stated
from navbound.errors import InputError
from navbound.gnss.files import Navigation, Observations
from navbound.gnss.monitor_fit import Fit, fit_of
from navbound.gnss.receivers import SYSTEMS, compared_words, heard_by_monitor, signal_words, unused_words, used_satellites, with_errors
from navbound.status import sentences

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike


@dataclass(frozen=True)
class Watched:
    """A receiver's epochs after detection and exclusion.

    Attributes
    ----------
    epochs : DataFrame
        The epoch table (docs/notation.md): ``track``, ``time_ns``, ``est_*``, the monitor's levels and numbers, ``mode``,
        ``excluded_sv``, ``status``, ``reason_id``, ``reason``, with truth also ``truth_*`` and ``nse_*``. ``status`` is ``degraded`` after
        an exclusion, ``not_available`` where a fault could not be excluded or there is no position. Where there are no levels they are
        null.
    models : dict of str to str
        Every model by name, for the record of a run.
    unused : dict of str to int
        Satellite-epochs of the requested systems that were not used, by the id of the reason in ``gnss.UNUSED``.
    used : DataFrame
        Ranges by satellite: ``sv``, ``signals``, ``message``, ``n_ranges``; those below the mask are among them.
    fit : Fit
        Whether the residuals and the detections agree with the error model.
    heard : DataFrame, optional
        What became of every satellite, with its residual at the monitor's position; where ranges are kept.
    """

    epochs: pl.DataFrame
    models: dict[str, str]
    unused: dict[str, int]
    used: pl.DataFrame
    fit: Fit
    heard: pl.DataFrame | None = None


def checked_model(navigation: Navigation, systems: str, signals: str, model: str | ErrorModel | None, mask_rad: float) -> ErrorModel:
    """The error model of a receiver's signals, after a check of the other options.

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


def judged(recorded: dict[str, Any], excluded_sv: Sequence[str]) -> dict[str, Any]:
    """Status, reason and excluded satellites of every epoch; the sentence names the satellites, or repeats the core's refusal."""
    ids = np.array(recorded.pop("reason_id"), dtype=np.str_)
    detail = np.char.add(np.where(np.array(excluded_sv) != "", " ", ""), np.array(excluded_sv, dtype=np.str_))
    refusal = np.array(recorded.pop("refusal"), dtype=np.str_)
    words = np.where(np.char.str_len(refusal) > 0, refusal, np.char.add(sentences(ids), detail))
    return {"excluded_sv": excluded_sv, "status": recorded.pop("status"), "reason_id": ids, "reason": words}


def watched(
    observations: Observations,
    recorded: dict[str, Any],
    columns: dict[str, Any],
    models: dict[str, str],
    *,
    track: str | None,
    truth_ecef_m: ArrayLike | None,
    p_false_alert: float,
) -> Watched:
    """The epoch table of a monitor: track, time and position, then the monitor's columns; errors beside them where truth is known.

    ``p_false_alert`` is the risk that one epoch's tests detect a fault where there is none. [1]
    """
    position = {name: recorded[name] for name in ("est_lat_rad", "est_lon_rad", "est_h_m")}
    named = track or observations.marker or observations.path.name
    heard = heard_by_monitor(recorded.get("heard"), named, observations.time_ns)
    epochs = pl.DataFrame({"track": [named] * observations.n_epochs, "time_ns": observations.time_ns, **position, **columns})
    # A value that does not exist is null in a table.
    epochs = epochs.with_columns(pl.selectors.float().fill_nan(None), pl.selectors.string().replace({"": None}))
    used, share = used_satellites(recorded["used"]), recorded["smoothed_share"]
    fit = fit_of(recorded["statistic"], recorded["redundancy"], recorded["decision_words"], p_false_alert)
    models = {
        **models,
        "satellites used": signal_words(used),
        "smoothing": "none" if share is None else f"divergence-free, {100 * share:.1f} % of the pseudoranges",
        "satellites not used (satellite-epochs)": unused_words(recorded["unused"]),
        "fit of the error model": fit.words,
        "codes led off": compared_words(recorded["compared"], observations.n_epochs),
    }
    return Watched(epochs if truth_ecef_m is None else with_errors(epochs, truth_ecef_m), models, recorded["unused"], used, fit, heard)


def checked_smoothing(smoothing_s: float | None) -> float | None:
    """A time constant, or none.

    Raises
    ------
    InputError
        One outside (0, 86400] s.
    """
    if smoothing_s is not None and not 0.0 < smoothing_s <= 86400.0:
        raise InputError("smoothing_s", smoothing_s, "s", "(0, 86400], or None")
    return smoothing_s


def range_models(support: Support, selected: ErrorModel, signals: str) -> dict[str, str]:
    """What is believed of the ranges, for the record."""
    return {
        "promises of satellites": stated(support),
        "range errors": f"{stated(selected)}; beside it the code noise that smoothing leaves, 0.13 m at the zenith for one pseudorange, "
        "and constants outside the broadcast clock: 0.4 m of GPS C/A where no P(Y) is observed, 2 m of BeiDou's pairs (inferred)",
        "signals": "ionosphere-free pairs" if signals == "dual" else "one pseudorange, Klobuchar",
    }
