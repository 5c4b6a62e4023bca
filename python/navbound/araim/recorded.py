"""ARAIM on a receiver's recorded observations."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from navbound import _core
from navbound.araim.settings import SERVICES, SUPPORT, ErrorModel, Service, Support, airborne_numbers, rule_numbers, stated, support_rows
from navbound.errors import InputError
from navbound.gnss.files import Navigation, Observations
from navbound.gnss.watched import Watched, checked_model, checked_smoothing, judged, range_models, watched
from navbound.table.arguments import checked

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@checked
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
    smoothing_s: float | None = 100.0,
    truth_ecef_m: ArrayLike | None = None,
    track: str | None = None,
    keep_ranges: bool = False,
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
    smoothing_s : float, optional
        Time constant of carrier smoothing, free of divergence; 100 s is that of the error models (standard). The sigma of a range grows
        by the code noise that is left; ``None`` uses the pseudoranges as measured, with all of it. [s]
    truth_ecef_m : array_like, shape (3,) or (n_epochs, 3), optional
        True position, Earth-fixed. [m]
    track : str, optional
        Name of the track; by default the marker's or the file's.
    keep_ranges : bool, optional
        Keep what became of every satellite: `Watched.heard`.

    Returns
    -------
    Watched
        With ``hpl_m``, ``vpl_m``, ``emt_m``, ``n_sv``, ``n_excluded``, ``n_modes``. Where a fault could not be excluded, and where nothing
        is left of the integrity risk, there are no levels.

    Raises
    ------
    InputError
        Systems that are not there, single signals without a broadcast ionosphere, numbers outside their domain.
    """
    observations.require_epochs()
    selected = checked_model(navigation, systems, signals, model, mask_rad)
    numbers = rule_numbers(service)
    if len(numbers) != 7:
        raise InputError("service", service, domain=f"one of {', '.join(SERVICES)}, or a Service")
    recorded = _core.araim_watch(
        observations._core,
        navigation._core,
        systems,
        signals == "dual",
        mask_rad,
        support_rows(support),
        airborne_numbers(selected),
        numbers,
        checked_smoothing(smoothing_s),
        keep_ranges,
    )
    outcome = np.array(recorded.pop("words"))[recorded.pop("outcome")]
    decision = np.array(recorded.pop("decision"), dtype=np.str_)
    # Codes that are led off together agree with each other: no level covers them.
    led_off = np.array(recorded["reason_id"], dtype=np.str_) == "codes_led_off"
    usable = (outcome == "ok") & (decision != "not_excluded") & ~led_off
    columns = {
        **{name: np.where(usable, recorded[name], np.nan) for name in ("hpl_m", "vpl_m", "emt_m")},
        **{name: recorded[name] for name in ("n_sv", "n_excluded", "n_modes")},
        "mode": ["araim"] * observations.n_epochs,
        **judged(recorded, [",".join(names) for names in recorded.pop("excluded")]),
    }
    budgets = SERVICES[service] if isinstance(service, str) else service
    name = service if isinstance(service, str) else "the caller's"
    models = {
        "protection levels": f"ARAIM with exclusion, {name}: {stated(budgets)}",
        **range_models(support, selected, signals),
        "exclusion": "equal shares of the integrity risk for every decision (ours)",
    }
    recorded["decision_words"] = np.where(decision == "excluded", columns["excluded_sv"], decision)
    p_false_alert = budgets.false_alarm_v + budgets.false_alarm_h
    return watched(observations, recorded, columns, models, track=track, truth_ecef_m=truth_ecef_m, p_false_alert=p_false_alert)
