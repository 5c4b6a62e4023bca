"""A receiver's own positions with an SBAS service's corrections, and the protection levels of those very solutions.

RTCA DO-229D, appendices A.4.4, A.4.5 and J.2 (standard); what was checked against what stands in docs/methods/sbas.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from navbound import _core
from navbound.errors import InputError
from navbound.gnss.files import Navigation, read_navigation
from navbound.gnss.receivers import with_errors
from navbound.status import REASONS

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from navbound.gnss.files import Observations
    from navbound.sbas import Messages

Navigations = Navigation | str | Path | Sequence[str | Path]
"""Navigation data: read already, or files."""

MODES = np.array(["", "pa", "npa"])
"""What a level is for, by the code that the core gives it."""


@dataclass(frozen=True)
class CorrectedPositions:
    """Positions with a service's corrections and what they rest on.

    Attributes
    ----------
    epochs : DataFrame
        The epoch table (docs/notation.md), a row an epoch of the recording: ``track``, ``time_ns``, ``est_*``, ``cov_*``, ``hpl_m``,
        ``vpl_m``, ``mode``, ``n_sv``, ``n_redundant``, ``hdop``, ``vdop``, ``p_residual``, ``status``, ``reason``, with truth also
        ``truth_*`` and ``nse_*``. Null where there is none. The covariance is that of the service's error model: an upper bound.
    satellites : DataFrame
        A row a satellite and solution: ``epoch`` (row of ``epochs``), ``prn``, ``az_rad`` (clockwise from true north), ``el_rad``,
        ``residual_m`` (measured less modelled range), ``sigma_m`` (by the error model), ``from_grid`` (false: the broadcast ionosphere
        served instead of the service's grid, en route).
    unused : dict of str to int
        Satellite-epochs that were not used, by reason; those below the mask are not among them.
    models : dict of str to str
        Every model by name, for the record of a run.
    smoothed_share : float or None
        Share of the pseudoranges that the carrier smoothed; those that begin an arc are as measured. None without smoothing.
    test_signal : bool
        A message 0 was disregarded on request: nothing here is for navigation.
    ignored : list of (int, str)
        Messages that changed nothing [GPS ns, why].
    """

    epochs: pl.DataFrame
    satellites: pl.DataFrame
    unused: dict[str, int]
    models: dict[str, str]
    smoothed_share: float | None
    test_signal: bool
    ignored: list[tuple[int, str]]


def corrected_positions(
    service: dict[str, Any],
    observations: Observations,
    *,
    smoothing_s: float | None,
    false_alarm: float,
    truth_ecef_m: ArrayLike | None,
    track: str | None,
) -> CorrectedPositions:
    """What :func:`navbound.sbas.solve` documents, from a service's checked description."""
    positions = _core.sbas_positions(service, observations._core, smoothing_s, false_alarm)
    satellites, unused, share, ignored = (positions.pop(name) for name in ("satellites", "unused", "smoothed_share", "ignored"))
    if service["test_signal"]:
        positions["reason_id"] = [id_ or "test_signal" for id_ in positions["reason_id"]]
        positions["status"] = [REASONS[id_].status for id_ in positions["reason_id"]]
        positions["reason"] = [
            sentence or REASONS[id_].words for id_, sentence in zip(positions["reason_id"], positions["reason"], strict=True)
        ]
    positions["mode"] = MODES[positions["mode"]]
    name = track or observations.marker or observations.path.name
    epochs = pl.DataFrame({"track": [name] * observations.n_epochs, "time_ns": observations.time_ns, **positions})
    epochs = epochs.with_columns(pl.col("mode", "reason_id", "reason").replace({"": None}), pl.selectors.float().fill_nan(None))
    if truth_ecef_m is not None:
        epochs = with_errors(epochs, truth_ecef_m)
    models = _models(service, smoothing_s, false_alarm)
    return CorrectedPositions(epochs, pl.DataFrame(satellites), unused, models, share, bool(service["test_signal"]), ignored)


def _models(service: dict[str, Any], smoothing_s: float | None, false_alarm: float) -> dict[str, str]:
    fallback = service["navigation"].klobuchar("G") is not None
    return {
        "orbits and clocks": "broadcast, of the issue that the service corrects; long-term, fast and range-rate corrections; group delay",
        "ionosphere": "the service's grid; en route without it "
        + ("Klobuchar, GPS message" if fallback else "nothing: the navigation file has no model"),
        "troposphere": "DO-229 A.4.2.4, by latitude and day of the year; height above the ellipsoid",
        "smoothing": "none" if smoothing_s is None else f"hatch, {smoothing_s:g} s, where there is a carrier",
        "weights": f"DO-229 error model; receiver noise {service['noise_m']:g} m, airborne multipath",
        "residual test": f"chi-square, false alarm {false_alarm:g} an epoch; marks, never excludes: levels hold for the satellites used",
    }


def service_of(
    messages: Messages,
    navigation: Navigations,
    *,
    mode: str,
    receiver: tuple[float, float, float],
    test_signal: bool,
) -> dict[str, Any]:
    """One service as a user hears it, checked, for the core.

    Raises
    ------
    InputError
        Messages of several satellites, an unknown mode.
    FormatError
        An unreadable navigation file.
    """
    senders = np.unique(messages.prn).tolist()
    if len(senders) > 1:
        raise InputError("messages", f"PRNs {senders}", domain="the messages of one satellite: messages.of(prn)")
    if mode not in ("auto", "pa", "npa"):
        raise InputError("mode", mode, domain="auto, pa, npa")
    mask_rad, noise_m, divergence_m = receiver
    records = navigation if isinstance(navigation, Navigation) else read_navigation(navigation)
    return {
        "message_time_ns": np.ascontiguousarray(messages.time_ns, dtype=np.int64),
        "data": np.ascontiguousarray(messages.data, dtype=np.uint8),
        "navigation": records._core,
        "mode": mode,
        "mask_rad": float(mask_rad),
        "noise_m": float(noise_m),
        "divergence_m": float(divergence_m),
        "test_signal": test_signal,
    }
