"""RAIM on a receiver's recorded observations."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from navbound import _core
from navbound.araim.settings import RAIM, SUPPORT, ErrorModel, Requirement, Support, airborne_numbers, requirement_numbers, support_rows
from navbound.gnss.files import Navigation, Observations
from navbound.gnss.watched import Watched, checked_model, checked_smoothing, judged, range_models, watched
from navbound.table.arguments import checked

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

SOURCES: tuple[str, str] = _core.raim_sources()
"""Documents of the method: of the published level, and of the noise added to it."""


@checked
def watch(
    observations: Observations,
    navigation: Navigation,
    *,
    systems: str = "G",
    signals: Literal["single", "dual"] = "single",
    requirement: Requirement = RAIM,
    support: Support = SUPPORT,
    model: str | ErrorModel | None = None,
    mask_rad: float = float(np.radians(5.0)),
    smoothing_s: float | None = 100.0,
    truth_ecef_m: ArrayLike | None = None,
    track: str | None = None,
    keep_ranges: bool = False,
) -> Watched:
    """RAIM of every epoch of an observation file: position, test of its residuals, exclusion, levels.

    Parameters
    ----------
    observations, navigation
        From ``gnss.read_observations`` and ``gnss.read_navigation``.
    systems : str, optional
        Letters of ``gnss.SYSTEMS``.
    signals : {"single", "dual"}, optional
        L1, E1, B1I with the broadcast ionosphere; or ionosphere-free pairs.
    requirement : Requirement, optional
        Risks.
    support : Support, optional
        What is promised of the satellites: of it RAIM takes ``sigma_ura_m``.
    model : str or ErrorModel, optional
        A name of ``araim.ERROR_MODELS``; without it that of the signals.
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
        With ``hpl_m``, ``vpl_m``, ``hel_m``, ``vel_m``, ``hpl_slope_m``, ``vpl_slope_m``, ``n_sv``, ``n_redundant``, ``n_excluded``,
        ``decision``. Where a fault could not be detected or not be excluded there are no levels.

    Raises
    ------
    InputError
        Systems that are not there, single signals without a broadcast ionosphere, numbers outside their domain.
    """
    observations.require_epochs()
    selected = checked_model(navigation, systems, signals, model, mask_rad)
    numbers = requirement_numbers(requirement)
    promises, airborne = support_rows(support), airborne_numbers(selected)
    smoothing = checked_smoothing(smoothing_s)
    recorded = _core.raim_watch(
        observations._core, navigation._core, systems, signals == "dual", mask_rad, promises, airborne, numbers, smoothing, keep_ranges
    )
    outcome = np.array(recorded.pop("words"))[recorded.pop("outcome")]
    decision = np.array(recorded.pop("decision"), dtype=np.str_)
    # Codes that are led off together agree with each other: no level covers them.
    led_off = np.array(recorded["reason_id"], dtype=np.str_) == "codes_led_off"
    usable = np.isin(decision, ["none", "excluded"]) & (outcome == "ok") & ~led_off
    levels = ("hpl_m", "vpl_m", "hpl_slope_m", "vpl_slope_m")
    columns = {
        **{name: np.where(usable, recorded[name], np.nan) for name in levels},
        **{name: np.where(np.isfinite(recorded[name]), recorded[name], np.nan) for name in ("hel_m", "vel_m")},
        **{name: recorded[name] for name in ("n_sv", "n_redundant")},
        "n_excluded": (decision == "excluded").astype(np.int64),
        "decision": decision,
        "mode": ["raim"] * observations.n_epochs,
        **judged(recorded, recorded.pop("excluded")),
    }
    models = {
        "protection levels": f"RAIM, weighted slope: {SOURCES[0]}",
        "noise in the levels": SOURCES[1],
        "risks": f"false alarm {requirement.false_alarm:g}, missed detection {requirement.missed_detection:g}, without a fault "
        f"{requirement.fault_free:g}: {requirement.source}; together {requirement.provenance}",
        "use": "the risks are those of en route to non-precision approach; vertical levels at them promise nothing for vertical guidance",
        **range_models(support, selected, signals),
        "satellites": f"{systems}, elevation {np.degrees(mask_rad):g} deg and more",
    }
    recorded["decision_words"] = np.where(decision == "excluded", columns["excluded_sv"], decision)
    p_false_alert = requirement.false_alarm
    return watched(observations, recorded, columns, models, track=track, truth_ecef_m=truth_ecef_m, p_false_alert=p_false_alert)
