"""Columns in which a recording states the validity or the integrity of its own positions: which names, and what their words mean.

A word that is understood decides. A word or a column that is not understood, but speaks of integrity by its name, is named in the result.
Names and codes as NMEA 0183, u-blox, NovAtel, MAVLink and RTKLIB write them (provenance: standard, from knowledge of the formats).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from navbound import _core
from navbound.read import own_positions
from navbound.read.columns.naming import words

Effect = Literal["invalid", "alert"]

STALE_AFTER_S = 2.0
"""Age from which a position is stale, whoever says its age. [s] Provenance: ours."""


@dataclass(frozen=True)
class Kind:
    """A kind of statement.

    Attributes
    ----------
    effect : {"invalid", "alert"}
        What a word against the position does: the row has no valid position, or its receiver raised an alert.
    names : frozenset of str
        Columns, in lower case.
    against, fine : frozenset of str
        Words against the position, and words that speak for it or say nothing.
    other_against : bool
        Any word that is neither is against it. Numbers are, too, unless `numbers_unknown`.
    numbers_unknown : bool
        A number may mean either, and is not understood.
    above, below : float
        A number above the one or below the other is against the position, any other says nothing.
    fine_begins : str
        Words that begin so are fine, unless they are against the position.
    against_named : str
        Pattern of names of several words that are against the position.
    empty_against : bool
        A field without a word is against the position; otherwise it states nothing.
    """

    effect: Effect
    names: frozenset[str]
    against: frozenset[str]
    fine: frozenset[str]
    other_against: bool = False
    numbers_unknown: bool = False
    above: float = math.inf
    below: float = -math.inf
    fine_begins: str = ""
    against_named: str = ""
    empty_against: bool = False


_DIGITS, _GGA = frozenset("0123456789"), frozenset(map(str, _core.GGA_QUALITIES))
_NO = words(
    "0 -1 false f no n none v void invalid not_valid bad unusable fail failed lost off unhealthy unavailable not_available unreliable"
)
_YES = words("1 true t yes y a valid ok good healthy on active available usable reliable sps dgps pps")
_NO_FIX = words(
    "0 -1 false no none no_fix nofix nosoln no_solution loi invalid not_valid lost v void n time time_only dr deadreckon dead_reckon "
    "dead_reckoning estimated"
)
_FIX = words(
    "2 3 4 5 6 9 true yes fix valid 2d 3d 2ddiff 3ddiff 2d_fix 3d_fix gps gnss dgps dgnss rtk rtk_fixed rtk_float fixed float sps pps ppp "
    "sbas single autonomous differential a d r f p"
)
NO_ALERT = words(
    "normal none no ok off false 0 nan null n_a na good clear cleared pass passed nominal healthy valid available n safe in_use"
)
"""Words that state that there is no alert. Any other is one: nobody knows what it means, and it is not "normal"."""

_ALARMS = words("spoof spoofed spoofing jam jammed jamming anomaly error err fault failure alarm alert warning")
_ALARM_FLAGS = (
    {
        f"{word}_{what}"
        for word in (*_ALARMS, "nav_error", "gps_error", "gnss_error")
        for what in ("flag", "detected", "active", "raised", "set")
    }
    | _ALARMS - {"error", "err"}
    | {f"{level}_exceeded" for level in ("hal", "hil", "hpl", "hul", "pl", "xpl", "al", "limit", "alert_limit")}
    | {
        f"{whose}_{word}"
        for word in _ALARMS - {"error", "err"}
        for whose in ("gps", "gnss", "nav", "pos", "position", "is", "integrity", "raim")
    }
    | {
        f"{whose}_{word}"
        for word in ("failed", "fail", "lost", "invalid", "bad", "unreliable", "unusable", "unavailable")
        for whose in ("gps", "gnss", "nav", "pos", "position", "fix", "solution", "integrity", "raim", "monitor", "receiver", "signal")
    }
)
"""Names of flags that are raised against a position. Provenance: ours."""

NO_INTEGRITY = words("n no none off false")
"""Words that state that there is no integrity or no monitor, where the column is named by what it has."""

_AGES = words(
    "position_age pos_age fix_age age_of_position age_of_fix seen_pos gps_age gnss_age last_pos_age last_position_age last_fix_age "
    "time_since_fix time_since_last_fix time_since_last_update time_since_update pos_delay position_delay fix_delay pos_latency "
    "position_latency fix_latency staleness dt_fix tow_age data_age gps_latency gnss_latency"
)
_SECONDS, _MILLISECONDS = words("s sec secs seconds"), words("ms msec millis milliseconds")


def _age(names: frozenset[str], per_s: float) -> Kind:
    return Kind("invalid", names, frozenset(), frozenset(), above=per_s * STALE_AFTER_S, below=-per_s * STALE_AFTER_S)


AGE = _age(
    _AGES
    | {f"{name}_{unit}" for name in _AGES for unit in _SECONDS}
    | {f"age_{unit}" for unit in _SECONDS}
    | {f"last_update_{unit}" for unit in _SECONDS}
    | words("seconds_since_update seconds_since_last_update seconds_since_fix seconds_since_last_fix"),
    1.0,
)
"""The age of a position, in seconds; it dates the position, too. One that is of the future is of another clock."""

AGE_MS = _age(frozenset(f"{name}_{unit}" for name in (*_AGES, "age", "last_update") for unit in _MILLISECONDS), 1e3)
"""The same in milliseconds."""

AGES = ((AGE, 1.0), (AGE_MS, 1e-3))
"""Kinds of ages, and their units [s]."""

BY_OTHERS = Kind("invalid", own_positions.LISTS, _YES, words("0 false f no n none off []"), other_against=True)
"""Whether others computed the position."""

NUC = Kind("invalid", words("nuc_p nucp nuc"), words("0"), frozenset("123456789"))
"""Version 0 transponders: 0 is an unknown integrity. The other categories are radii."""

READSB_TYPE = Kind(
    "invalid",
    frozenset(),
    own_positions.FOREIGN,
    frozenset(),
    other_against=True,
    fine_begins=own_positions.OWN_BEGINS,
    empty_against=True,
)
"""The `type` of readsb's aircraft, by the rule of its live lines."""

ACCURACY_WORDS = Kind(
    "alert",
    words("nav_accuracy navigation_accuracy nav_accur nav_acc position_accuracy pos_accuracy gps_accuracy gnss_accuracy accuracy accur"),
    words("low very_low poor bad downgraded downgrade degraded unreliable none no"),
    words("high very_high good ok normal full fine"),
)
"""An accuracy in words, as flight management systems have it (NAV ACCUR HIGH or LOW); in numbers a column of such a name is a length."""

_SSM = words("gps gnss nav pos position lat lon latitude longitude")
"""Whose sign and status matrix a column is."""

_LEAST = 1e-9
"""A number above nothing. [1]"""

KINDS: tuple[Kind, ...] = (
    Kind(
        "invalid",
        words(
            "valid is_valid validity position_valid pos_valid gps_valid gnss_valid fix_valid data_valid nav_valid solution_valid "
            "location_valid usable reliable trusted healthy gps_ok gnss_ok position_ok pos_ok nav_ok integrity_ok raim_ok "
            "fix_ok gnss_fix_ok used use in_use gps_used gnss_used accepted believed "
            "good is_good pos_good position_good gps_good ok is_ok crc_ok checksum_ok parity_ok "
            "gnssfixok available is_available gps_available gnss_available raim_available integrity_available pl_valid hpl_valid xpl_valid"
        ),
        _NO,
        _YES,
        other_against=True,
    ),
    Kind(
        "invalid",
        words(
            "fix gps gnss gps_fix gnss_fix has_fix fix_status position_fix fixstatus gpsfix lock locked is_locked gps_lock gnss_lock "
            "gps_locked gnss_locked"
        ),
        _NO_FIX | words("unlocked searching"),
        _FIX | words("1 locked"),
    ),
    # ARINC 429. As numbers the codes of binary and of decimal words differ.
    Kind(
        "invalid",
        words("ssm sign_status_matrix") | {f"{whose}_ssm" for whose in _SSM} | {f"ssm_{axis}" for axis in ("lat", "lon")},
        words("ncd fw ft no_computed_data failure_warning functional_test"),
        words("no normal normal_operation"),
        other_against=True,
        numbers_unknown=True,
    ),
    Kind("invalid", words("fix_type fixtype gps_fix_type gnss_fix_type fix_mode gps_mode gnss_mode"), _NO_FIX | {"1"}, _FIX),
    Kind(
        "invalid",
        words("fix_quality gps_quality gps_qual gga_quality quality_indicator fixquality gps_quality_indicator"),
        _NO_FIX | _DIGITS - _GGA | words("simulator simulation simulated manual"),
        _FIX - _DIGITS | _GGA,
    ),
    Kind(
        "invalid",
        words("q qual quality quality_flag pos_qual position_qual solution_quality pos_quality position_quality nav_quality gnss_quality"),
        _NO_FIX | words("bad poor unusable unreliable degraded unavailable"),
        _FIX | words("1 good ok"),
    ),
    Kind(
        "invalid",
        words(
            "mode nav_mode navigation_mode pos_mode position_mode posmode mode_indicator positioning_mode sol_status solution_status "
            "gps_primary gnss_primary sol_stat solstat solution_state "
            "solution_type sol_type pos_type position_type nav_status navigation_status gps_status gnss_status position_status"
        ),
        words(
            "n e m s v no off none no_fix nofix not_valid invalid invalid_fix insufficient_obs no_convergence singularity cov_trace "
            "test_dist cold_start v_h_limit residuals integrity_warning pending unauthorized dr dead_reckoning coast coasting estimated "
            "extrapolated propagated predicted simulated simulator simulation manual fixedpos memory last_known lost degraded fail failed "
            "fault alert alarm warning caution not_available unavailable denied reversion reversionary no_nav acquisition standby "
            "stopped halted frozen stale jammed spoofed unreliable"
        )
        | own_positions.COMPUTED,
        _FIX - words("2 3 4 5 6 9")
        | words(
            "nav navigation normal ok good sol_computed waas egnos narrow_int wide_int l1_int psrdiff l1_float "
            "narrow_float active available tracking"
        ),
    ),
    Kind(
        "invalid",
        words(
            "dead_reckoning is_dead_reckoning deadreckoning gps_denied gnss_denied gps_lost gnss_lost no_gps no_gnss no_fix fix_lost "
            "gps_loss gnss_loss gps_outage gnss_outage unusable synthetic is_synthetic old is_old estimated "
            "is_estimated predicted is_predicted extrapolated is_extrapolated interpolated is_interpolated propagated coasted coasting "
            "is_coasting posstale pos_stale position_stale is_stale psr_only ssr_only cst "
            "simulated is_simulated inertial_only ins_only coast dr is_dr suspect suspected is_suspect held is_held imputed "
            "is_imputed filled is_filled infilled"
        ),
        _YES,
        _NO - words("v invalid not_valid bad unusable fail failed unhealthy unreliable"),
        other_against=True,
    ),
    # The granular tables of flight trackers: P where there is a position.
    Kind("invalid", words("no_position no_pos without_position"), _YES | {"n"}, words("p 0 false no"), other_against=True),
    AGE,
    AGE_MS,
    # How a position came: what others computed or repeat is none that the aircraft claims anything of.
    Kind(
        "invalid",
        own_positions.OF_ANYTHING,
        own_positions.FOREIGN,
        own_positions.OWN,
        fine_begins=own_positions.OWN_BEGINS,
        against_named=own_positions.NAMED_COMPUTED,
    ),
    Kind(
        "invalid",
        own_positions.OF_POSITION,
        own_positions.FOREIGN | own_positions.OPENSKY_FOREIGN,
        own_positions.OWN | own_positions.OPENSKY_OWN,
        other_against=True,
        fine_begins=own_positions.OWN_BEGINS,
    ),
    # What keeps the position of an aircraft, where it may be inertial sensors alone.
    Kind(
        "invalid",
        own_positions.OF_NAVIGATION,
        own_positions.FOREIGN | own_positions.INERTIAL,
        own_positions.OWN,
        fine_begins=own_positions.OWN_BEGINS,
        against_named=own_positions.NAMED_COMPUTED,
    ),
    BY_OTHERS,
    Kind("invalid", own_positions.UPDATE_TYPE, own_positions.UPDATE_FOREIGN, own_positions.UPDATE_OWN, other_against=True),
    NUC,
    # The rule of solved positions; receivers write 99.99 where they know none.
    Kind("invalid", words("hdop pdop gdop vdop dop"), frozenset(), frozenset(), above=_core.MOST_DILUTION),
    Kind(
        "alert",
        words("spoofing_state spoof_state spoof_det_state jamming_state jam_state"),
        words("2 3 indicated detected warning critical"),
        words("0 1 unknown ok none no"),
    ),
    # In words alone: numbers are of a scale that the name does not tell.
    Kind(
        "alert",
        words("gps_interference gnss_interference interference_level jamming_level"),
        words("high severe critical detected warning true yes"),
        words("none no low ok false"),
        numbers_unknown=True,
    ),
    # readsb: when GPS still worked well, shown for 15 minutes after it was lost or heavily degraded.
    Kind("alert", words("gps_ok_before"), frozenset(), frozenset(), other_against=True),
    # 0 where no integrity is known or a probability of 1e-3 is exceeded; what the other levels say nothing here reads.
    Kind(
        "alert",
        words("sil source_integrity_level surveillance_integrity_level sda system_design_assurance"),
        words("0 unknown"),
        words("1 2 3"),
    ),
    # The least of a scale is none, whatever the scale; the others are named.
    Kind(
        "alert",
        words("gps_level gnss_level trust trust_level confidence confidence_level confidence_pct confidence_percent"),
        words("0 none no low very_low poor false untrusted unreliable"),
        words("high very_high full true yes"),
        below=_LEAST,
    ),
    Kind(
        "alert",
        words("raim raim_status raim_state integrity integrity_status integrity_flag integrity_state fde fde_status health gps_health"),
        frozenset(),
        NO_ALERT - NO_INTEGRITY,
        other_against=True,
        numbers_unknown=True,
    ),
    Kind(
        "alert",
        words(
            "alert alert_state alarm raim_alert raim_warning raim_fault raim_alarm integrity_alert integrity_warning integrity_alarm "
            "integrity_lost loss_of_integrity loi fault fault_flag fault_detected failure gps_fault gnss_fault nav_fault warning caution "
            "warn warning_flag "
            "spoofing spoofed spoofing_detected spoof_flag jamming jammed jamming_detected interference invalid is_invalid "
            "position_invalid unreliable outlier misleading hmi error_flag do_not_use not_valid degraded unable_rnp rnp_alert rnp_warning "
            "raim_flag unhealthy unsafe rejected bad frozen stale stuck mock mocked is_mock mock_location is_mocked from_mock_provider "
            "unable_req_nav_perf unable_required_navigation_performance unable_nav_perf anp_alert faulty suspicious fail failed "
            "mi sim simulator reverted reversion nav_accuracy_downgraded navaccuracydowngrad "
            "is_from_mock_provider simulated_location untrusted fake ghost false_target bad_position bad_pos bad_fix "
            "exclude excluded masked hazard hazardous "
            "flag_bad bad_flag bit_fail bit_fault bite_fail bite_fault "
            "discarded discard flagged dnu rnp_unable unable map_shift gps_primary_lost loss_of_gps loss_of_gnss not_to_be_used"
        )
        | _ALARM_FLAGS,
        frozenset(),
        NO_ALERT,
        other_against=True,
    ),
)

_BY_NAME = {name.replace("_", ""): kind for kind in KINDS for name in kind.names}

BEFORE = ("is", "has")
"""Words before a name that change nothing of it."""


def kind_of(plain_name: str) -> Kind | None:
    """The kind of statement that a column of this name makes; None for any other column."""
    name = plain_name.replace("_", "")
    for each in (name, *(name.removeprefix(before) for before in BEFORE)):
        several = _BY_NAME.get(each.removesuffix("s"))
        kind = _BY_NAME.get(each, several if several is not None and several.effect == "alert" else None)
        if kind is not None:
            return kind
    return None
