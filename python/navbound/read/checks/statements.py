"""Columns in which a recording states the validity or the integrity of its own positions: which names, and what their words mean.

A word that is understood decides. A word or a column that is not understood, but speaks of integrity by its name, is named in the result.
Names and codes as NMEA 0183, u-blox, NovAtel, MAVLink and RTKLIB write them (provenance: standard, from knowledge of the formats).
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import polars as pl

from navbound import _core
from navbound.read import own_positions
from navbound.read.columns.naming import LONGEST_PARTED, name_parts
from navbound.read.columns.place_names import NO_TRUTH, speaks_of_place

if TYPE_CHECKING:
    from collections.abc import Iterable

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


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


_DIGITS, _GGA = frozenset("0123456789"), frozenset(map(str, _core.GGA_QUALITIES))
_NO = _words(
    "0 -1 false f no n none v void invalid not_valid bad unusable fail failed lost off unhealthy unavailable not_available unreliable"
)
_YES = _words("1 true t yes y a valid ok good healthy on active available usable reliable sps dgps pps")
_NO_FIX = _words("0 -1 false no none no_fix nofix invalid not_valid lost v void n time time_only dr dead_reckoning estimated")
_FIX = _words(
    "2 3 4 5 6 9 true yes fix valid 2d 3d 2d_fix 3d_fix gps gnss dgps dgnss rtk rtk_fixed rtk_float fixed float sps pps ppp sbas single "
    "autonomous differential a d r f p"
)
NO_ALERT = _words(
    "normal none no ok off false 0 nan null n_a na good clear cleared pass passed nominal healthy valid available n safe in_use"
)
"""Words that state that there is no alert. Any other is one: nobody knows what it means, and it is not "normal"."""

_ALARMS = _words("spoof spoofed spoofing jam jammed jamming anomaly error err fault failure alarm alert warning")
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

NO_INTEGRITY = _words("n no none off false")
"""Words that state that there is no integrity or no monitor, where the column is named by what it has."""

_AGES = _words(
    "position_age pos_age fix_age age_of_position age_of_fix seen_pos gps_age gnss_age last_pos_age last_position_age last_fix_age "
    "time_since_fix time_since_last_fix time_since_last_update time_since_update pos_delay position_delay fix_delay pos_latency "
    "position_latency fix_latency staleness dt_fix tow_age data_age gps_latency gnss_latency"
)
_SECONDS, _MILLISECONDS = _words("s sec secs seconds"), _words("ms msec millis milliseconds")


def _age(names: frozenset[str], per_s: float) -> Kind:
    return Kind("invalid", names, frozenset(), frozenset(), above=per_s * STALE_AFTER_S, below=-per_s * STALE_AFTER_S)


AGE = _age(
    _AGES
    | {f"{name}_{unit}" for name in _AGES for unit in _SECONDS}
    | {f"age_{unit}" for unit in _SECONDS}
    | {f"last_update_{unit}" for unit in _SECONDS}
    | _words("seconds_since_update seconds_since_last_update seconds_since_fix seconds_since_last_fix"),
    1.0,
)
"""The age of a position, in seconds; it dates the position, too. One that is of the future is of another clock."""

AGE_MS = _age(frozenset(f"{name}_{unit}" for name in (*_AGES, "age", "last_update") for unit in _MILLISECONDS), 1e3)
"""The same in milliseconds."""

AGES = ((AGE, 1.0), (AGE_MS, 1e-3))
"""Kinds of ages, and their units [s]."""

BY_OTHERS = Kind("invalid", own_positions.LISTS, _YES, _words("0 false f no n none off []"), other_against=True)
"""Whether others computed the position."""

NUC = Kind("invalid", _words("nuc_p nucp nuc"), _words("0"), frozenset("123456789"))
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
    _words("nav_accuracy navigation_accuracy nav_accur nav_acc position_accuracy pos_accuracy gps_accuracy gnss_accuracy accuracy accur"),
    _words("low very_low poor bad downgraded downgrade degraded unreliable none no"),
    _words("high very_high good ok normal full fine"),
)
"""An accuracy in words, as flight management systems have it (NAV ACCUR HIGH or LOW); in numbers a column of such a name is a length."""

_SSM = _words("gps gnss nav pos position lat lon latitude longitude")
"""Whose sign and status matrix a column is."""

_LEAST = 1e-9
"""A number above nothing. [1]"""

KINDS: tuple[Kind, ...] = (
    Kind(
        "invalid",
        _words(
            "valid is_valid validity position_valid pos_valid gps_valid gnss_valid fix_valid data_valid nav_valid solution_valid "
            "location_valid usable reliable trusted healthy gps_ok gnss_ok position_ok pos_ok nav_ok integrity_ok raim_ok "
            "fix_ok gnss_fix_ok used use in_use accepted believed "
            "good is_good pos_good position_good gps_good ok is_ok crc_ok checksum_ok parity_ok "
            "gnssfixok available is_available gps_available gnss_available raim_available integrity_available pl_valid hpl_valid xpl_valid"
        ),
        _NO,
        _YES,
        other_against=True,
    ),
    Kind(
        "invalid",
        _words(
            "fix gps gnss gps_fix gnss_fix has_fix fix_status position_fix fixstatus gpsfix lock locked is_locked gps_lock gnss_lock "
            "gps_locked gnss_locked"
        ),
        _NO_FIX | _words("unlocked searching"),
        _FIX | _words("1 locked"),
    ),
    # ARINC 429. As numbers the codes of binary and of decimal words differ.
    Kind(
        "invalid",
        _words("ssm sign_status_matrix") | {f"{whose}_ssm" for whose in _SSM} | {f"ssm_{axis}" for axis in ("lat", "lon")},
        _words("ncd fw ft no_computed_data failure_warning functional_test"),
        _words("no normal normal_operation"),
        other_against=True,
        numbers_unknown=True,
    ),
    Kind("invalid", _words("fix_type fixtype gps_fix_type gnss_fix_type fix_mode gps_mode gnss_mode"), _NO_FIX | {"1"}, _FIX),
    Kind(
        "invalid",
        _words("fix_quality gps_quality gps_qual gga_quality quality_indicator fixquality gps_quality_indicator"),
        _NO_FIX | _DIGITS - _GGA | _words("simulator simulation simulated manual"),
        _FIX - _DIGITS | _GGA,
    ),
    Kind(
        "invalid",
        _words("q qual quality quality_flag solution_quality pos_quality position_quality nav_quality gnss_quality"),
        _NO_FIX | _words("bad poor unusable unreliable degraded unavailable"),
        _FIX | _words("1 good ok"),
    ),
    Kind(
        "invalid",
        _words(
            "mode nav_mode navigation_mode pos_mode position_mode posmode mode_indicator positioning_mode sol_status solution_status "
            "gps_primary gnss_primary sol_stat solstat solution_state "
            "solution_type sol_type pos_type position_type nav_status navigation_status gps_status gnss_status position_status"
        ),
        _words(
            "n e m s v no off none no_fix nofix not_valid invalid invalid_fix insufficient_obs no_convergence singularity cov_trace "
            "test_dist cold_start v_h_limit residuals integrity_warning pending unauthorized dr dead_reckoning coast coasting estimated "
            "extrapolated propagated predicted simulated simulator simulation manual fixedpos memory last_known lost degraded fail failed "
            "fault alert alarm warning caution not_available unavailable denied reversion reversionary no_nav acquisition standby "
            "stopped halted frozen stale jammed spoofed unreliable"
        )
        | own_positions.COMPUTED,
        _FIX - _words("2 3 4 5 6 9")
        | _words(
            "nav navigation normal ok good sol_computed waas egnos narrow_int wide_int l1_int psrdiff l1_float "
            "narrow_float active available tracking"
        ),
    ),
    Kind(
        "invalid",
        _words(
            "dead_reckoning is_dead_reckoning deadreckoning gps_denied gnss_denied gps_lost gnss_lost no_gps no_gnss no_fix fix_lost "
            "gps_loss gnss_loss gps_outage gnss_outage unusable synthetic is_synthetic old is_old estimated "
            "is_estimated predicted is_predicted extrapolated is_extrapolated interpolated is_interpolated propagated coasted coasting "
            "is_coasting posstale pos_stale position_stale is_stale psr_only ssr_only cst "
            "simulated is_simulated inertial_only ins_only coast dr is_dr suspect suspected is_suspect held is_held imputed "
            "is_imputed"
        ),
        _YES,
        _NO - _words("v invalid not_valid bad unusable fail failed unhealthy unreliable"),
        other_against=True,
    ),
    # The granular tables of flight trackers: P where there is a position.
    Kind("invalid", _words("no_position no_pos without_position"), _YES | {"n"}, _words("p 0 false no"), other_against=True),
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
    Kind("invalid", _words("hdop pdop gdop vdop dop"), frozenset(), frozenset(), above=_core.MOST_DILUTION),
    Kind(
        "alert",
        _words("spoofing_state spoof_state spoof_det_state jamming_state jam_state"),
        _words("2 3 indicated detected warning critical"),
        _words("0 1 unknown ok none no"),
    ),
    # In words alone: numbers are of a scale that the name does not tell.
    Kind(
        "alert",
        _words("gps_interference gnss_interference interference_level jamming_level"),
        _words("high severe critical detected warning true yes"),
        _words("none no low ok false"),
        numbers_unknown=True,
    ),
    # readsb: when GPS still worked well, shown for 15 minutes after it was lost or heavily degraded.
    Kind("alert", _words("gps_ok_before"), frozenset(), frozenset(), other_against=True),
    # 0 where no integrity is known or a probability of 1e-3 is exceeded; what the other levels say nothing here reads.
    Kind(
        "alert",
        _words("sil source_integrity_level surveillance_integrity_level sda system_design_assurance"),
        _words("0 unknown"),
        _words("1 2 3"),
    ),
    # The least of a scale is none, whatever the scale; the others are named.
    Kind(
        "alert",
        _words("trust trust_level confidence confidence_level confidence_pct confidence_percent"),
        _words("0 none no low very_low poor false untrusted unreliable"),
        _words("high very_high full true yes"),
        below=_LEAST,
    ),
    Kind(
        "alert",
        _words("raim raim_status raim_state integrity integrity_status integrity_flag integrity_state fde fde_status health gps_health"),
        frozenset(),
        NO_ALERT - NO_INTEGRITY,
        other_against=True,
        numbers_unknown=True,
    ),
    Kind(
        "alert",
        _words(
            "alert alert_state alarm raim_alert raim_warning raim_fault raim_alarm integrity_alert integrity_warning integrity_alarm "
            "integrity_lost loss_of_integrity loi fault fault_flag fault_detected failure gps_fault gnss_fault nav_fault warning caution "
            "warn warning_flag "
            "spoofing spoofed spoofing_detected spoof_flag jamming jammed jamming_detected interference invalid is_invalid "
            "position_invalid unreliable outlier misleading hmi error_flag do_not_use not_valid degraded unable_rnp rnp_alert rnp_warning "
            "raim_flag unhealthy unsafe rejected bad frozen stale stuck mock mocked is_mock mock_location is_mocked from_mock_provider "
            "unable_req_nav_perf unable_required_navigation_performance unable_nav_perf anp_alert faulty suspicious fail failed "
            "mi sim simulator reverted reversion nav_accuracy_downgraded navaccuracydowngrad "
            "is_from_mock_provider simulated_location untrusted fake ghost false_target bad_position bad_pos bad_fix "
            "exclude excluded masked "
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

_SPEAKS = _words(
    "status "
    "valid invalid validity fix quality raim fde integrity alert alarm warning caution fault failure fail failed health healthy "
    "flag flags mode nac nacp nacv nucp nic sil sils sda rc hpl hul hil hal vpl vul val xpl protection containment hil spoofing "
    "spoofed spoof jamming jammed jam interference reliable reliability trust usable error errors uncertainty accuracy acc hacc "
    "vacc pacc sigma std stddev epu anp epe eph epv ehpe cep drms rms fom hfom vfom "
    "nse tse fte err coasting coast extrapolated age nsat nsats sats satellites sat "
    "epx epy epd hrms vrms 2drms cep50 cep95 r95 sd sdev ehe eve hdop pdop pl level major minor outage dr mlat tisb datum covariance type "
    "available availability exceeded exceedance herr verr poserr "
    "deviation cdi monitor message msg state carrsoln "
    "hpe herror h50 h95 mrse residual misfit dev unc uncert smaj rss tke ci95 ci "
    "confidence outlier misleading degraded lost loss solution denied reckoning estimated predicted propagated simulated source "
    "p50 p67 p68 p95 p99 merit navperf rnp anomaly anomalies protected pte latency lag delay seen exceed exceeds svs used "
)
"""Parts of names that speak of validity, accuracy or integrity. Provenance: ours."""


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


_ACCURACY = _words(
    "acc hacc pacc accuracy uncertainty sigma std stddev sd sdev epe eph ehpe ehe epx epy cep cep50 cep95 r95 drms 2drms rms hrms hfom "
    "twodrms hpe herror h50 h95 mrse "
    "fom nse tse fte err error errors herr poserr"
)
"""Parts of names of a horizontal accuracy or error, a length. Provenance: ours."""
_NO_POSITION = _words(
    "v vert vertical u up down alt altitude height z vel velocity speed sog rate climb track heading head hdg course cog bearing yaw roll "
    "pitch attitude angle t time clock clk bias drift gyro accel acceleration imu mag lin linear ang angular range doppler phase code id "
    "flag flags count counter n num number type message mode status state percent pct ratio mps mps2 s ns us ms deg rad dps kt kts hz db"
)
"""Parts of names of something else. Provenance: ours."""


def _parts_of_lengths(name: str) -> set[str]:
    """The parts of a name, and each without the plane or the share that it is of: `err2d`, `hpe95`."""
    parts = {*name_parts(name), name[:LONGEST_PARTED].lower()}
    return parts | {_OF_PLANE_OR_SHARE.sub("", part) for part in parts}


_ENDINGS = ("2d", "50", "67", "68", "95", "99")
_OF_PLANE_OR_SHARE = re.compile(rf"(?<=[a-z])({'|'.join(_ENDINGS)})$")
"""Endings of an error in the plane, and of the share of errors within a length."""


_APART = _words("dist distance offset offs diff difference delta separation gap discrepancy deviation displacement residual misclosure")
_REFERENCE, _POSITION = _words("ref reference"), _words("true actual surveyed known")
_OF_POSITION = _words("position pos point place location")
"""Parts of names of a distance from the true position, and from something else that is called a reference. Provenance: ours."""


def _speaks_of_truth(name: str) -> bool:
    """Whether the name is one of a true place that nothing reads, or of the distance from it: an error under another name."""
    parts = set(name_parts(name))
    if not _NO_POSITION.isdisjoint(parts):
        return False
    return "truth" in name[:LONGEST_PARTED].lower() or _speaks_of_distance_from_truth(name)


def _speaks_of_distance_from_truth(name: str) -> bool:
    parts, together = set(name_parts(name)), name[:LONGEST_PARTED].lower()
    words = ("dist", "offset", "diff", "delta")
    apart = not _APART.isdisjoint(parts) or ("truth" in together and any(each in together for each in words))
    of_truth = "truth" in together or (not _POSITION.isdisjoint(parts) and not _OF_POSITION.isdisjoint(parts))
    of_reference = not _REFERENCE.isdisjoint(parts) and NO_TRUTH.isdisjoint(parts)
    return apart and (of_truth or of_reference)


def speaks_of_integrity(name: str) -> bool:
    """Whether the name of a column that nothing reads, is one of a statement of integrity, a truth or another place."""
    parts = _parts_of_lengths(name)
    spoken = not _SPEAKS.isdisjoint([*parts, *(part.removesuffix("s") for part in parts)])
    return spoken or _speaks_of_truth(name) or speaks_of_place(name)


def speaks_of_accuracy(name: str) -> bool:
    """Whether the name is one of a horizontal accuracy or error, so that its numbers are lengths."""
    parts = _parts_of_lengths(name)
    # `acc_x` is an acceleration.
    if "acc" in parts and parts & {"x", "y", "body", "g"}:
        return False
    return (not _ACCURACY.isdisjoint(parts) or _speaks_of_distance_from_truth(name)) and _NO_POSITION.isdisjoint(parts)


_LEVEL = _words("hpl hil hul hpls hils")
_LEVEL_IN_WORDS = tuple(map(_words, ("protection level", "integrity level", "integrity limit", "containment radius", "containment limit")))
"""Parts of names of a horizontal protection level, a length. Provenance: ours."""


def speaks_of_level(name: str) -> bool:
    """Whether the name is one of a horizontal protection level, so that its numbers are lengths."""
    parts = _parts_of_lengths(name)
    named = not _LEVEL.isdisjoint(parts) or any(together <= parts for together in _LEVEL_IN_WORDS)
    return named and _NO_POSITION.isdisjoint(parts)


_WHOSE = _words("h horizontal pos position gps gnss horizontal_position estimated_horizontal estimated_horizontal_position")
_WHAT = _words("acc accuracy uncertainty sigma std stddev")
BARE_LENGTHS = (
    _words(
        "anp hacc pacc accuracy epe eph ehpe ehe epx epy cep cep50 cep95 r95 drms 2drms twodrms hrms hfom herr poserr "
        "hpe herror h50 h95 mrse"
    )
    | {f"{what}{ending}" for what in _words("err error hpe herror hacc") for ending in _ENDINGS}
    | _LEVEL
    | _words("protection_level containment_radius containment_limit horizontal_integrity_level horizontal_integrity_limit")
    | {f"{whose}_{what}" for whose in _WHOSE for what in _WHAT}
    | {f"{what}_{whose}" for whose in ("h", "horizontal") for what in _WHAT}
    | {f"horizontal_containment_{what}" for what in ("radius", "limit")}
)
"""Bare names that can only be those of a horizontal accuracy or protection level; `acc`, `error` or `std` alone may be anything. Ours."""


@dataclass(frozen=True)
class Stated:
    """What one column states, row by row.

    Attributes
    ----------
    against : Series of str
        The word against the position; null where there is none.
    unknown : list of str
        Words that are not understood, the first few.
    """

    against: pl.Series
    unknown: list[str]


SHOWN = 3
"""Words of a column that are named. [1]"""
_SHOWN_CHARACTERS = 60
"""Of a free text. [1]"""
_MISSING = ("", "nan", "null", "na", "n/a")


def stated(kind: Kind, raw: pl.Series) -> Stated:
    """Read a column. An empty field states nothing."""
    text = _printable(raw.cast(pl.String, strict=False)).str.strip_chars().str.to_lowercase()
    text = text.str.replace_all(r"[\s\-]+", "_").str.replace(r"^\+?(-?\d+)\.0*$", "$1").str.replace(r"^_(\d)", "-$1")
    value = text.cast(pl.Float64, strict=False)
    number = value.is_not_null() | text.is_in(["true", "false"])
    declared = text.is_not_null() & ~text.is_in(_MISSING)
    fine = text.is_in(_listed(kind.fine))
    against = text.is_in(_listed(kind.against))
    if kind.against_named:
        against |= text.str.contains(kind.against_named) & ~fine
    if kind.fine_begins:
        fine |= text.str.starts_with(kind.fine_begins) & ~against
    unknown = declared & ~fine & ~against
    missing = ~declared.fill_null(value=False)
    empty = missing.any() and kind.effect == "invalid" and not kind.empty_against
    if kind.numbers_unknown:
        unknown, fine = unknown | (declared & number), fine & ~number
    if kind.other_against:
        others = unknown & ~number if kind.numbers_unknown else unknown
        against, unknown = against | others, unknown & ~others
    if kind.above < math.inf:
        # A negative one is none.
        against = ((value > kind.above) | (value < kind.below)).fill_null(value=False)
        unknown, empty = unknown & ~against & (value.is_null() | (value < 0.0)), False
    # A word of an alarm is one in a column of states too.
    alarm = (unknown & ~number & _alarm(text, _STATE_ALARM)).fill_null(value=False)
    against, unknown = against | alarm, unknown & ~alarm
    words = pl.select(pl.when(declared & against & ~fine).then(text)).to_series()
    if kind.empty_against:
        words = pl.select(pl.when(missing).then(pl.lit("nothing")).otherwise(words)).to_series()
    return Stated(words, text.filter(unknown.fill_null(value=False)).unique(maintain_order=True).head(SHOWN).to_list() + ["empty"] * empty)


_ALARM = (
    r"\b(unable|unreliable|invalid|lost|fail|fails|failed|failure|fault|faulty|alarm|alert|warning|misleading|spoof|spoofed|spoofing|jam|jammed|jamming|"
    r"degraded|unhealthy|unsafe|downgrade|downgraded|unavail|unavailable|disagree|inop|loss|doubtful|dead reckoning|outage|exceeded|"
    r"accur low|accuracy low|low accuracy|accur downgrad|map shift|(?:pos|position) uncertain|verify pos(?:ition)?|"
    r"verloren|ungueltig|ungültig|gestoert|gestört|perte|perdue?|invalide|brouillage|perdid[ao]|inválid[ao]|sin señal|"
    r"mlat\d*|multilat\w*|tis b|tisb|irs only|irs nav only|ins only|inertial only|disconnected|extrapolated|simulated data|"
    r"simulated position)\b"
)
_STATE_ALARM = _ALARM.replace("(unable", "(simulated|simulation|simulator|mocked|unable")
"""In a column of states a simulation is of the position, in a free text of anything."""
_NONE = r"\b(no|none|not|without|clear|cleared|off|false|ended|end|over|0)\b"
_NO_POSITION_WORDS = (
    r"\b(no (fix|position|solution|navigation|gps|gnss|raim|integrity|satellite|satellites|computed data)|not to be used|"
    r"not (valid|available|usable|reliable|for nav|for navigation)|"
    r"do not use)\b"
)
"""Words of alarms in a free text, words that take them back, and sentences without either that say the same. Provenance: ours."""


def alarming(texts: pl.DataFrame) -> list[str]:
    """Columns of texts in which any row has a word of an alarm; few have, and a table may have thousands."""
    if not texts.width:
        return []
    words = f"(?i){_ALARM}|{_NO_POSITION_WORDS}".replace(r"\b(", "(").replace(r")\b", ")").replace(" ", r"[\s_-]+")
    has = texts.select(pl.all().str.contains(words).any().fill_null(value=False)).row(0)
    return [name for name, any_row in zip(texts.columns, has, strict=True) if any_row]


def alarms(raw: pl.Series) -> Stated:
    """Read a column of free texts that nothing else reads: a message of a receiver or a crew. A text that takes an alarm back is named."""
    raw = _printable(raw)
    against = _alarm_in_any_part(raw)
    words = pl.select(pl.when(against).then(raw.str.slice(0, _SHOWN_CHARACTERS))).to_series()
    taken_back = _plain_text(raw).str.contains(_ALARM).fill_null(value=False) & ~against
    return Stated(words, raw.filter(taken_back).unique(maintain_order=True).head(SHOWN).to_list())


def _printable(raw: pl.Series) -> pl.Series:
    """Without what colours a terminal or moves its cursor: a word stands alone there, and words of a file are printed."""
    return raw.str.replace_all(r"\x1b\[[0-9;]*[A-Za-z]", " ").str.replace_all(r"[\x00-\x1f\x7f]", " ")


def _plain_text(raw: pl.Series) -> pl.Series:
    return raw.str.to_lowercase().str.replace_all(r"[_\-]+", " ")


def _alarm(raw: pl.Series, alarms: str = _ALARM) -> pl.Series:
    """Which texts state an alarm that they do not take back."""
    alarm, none, outright = (_plain_text(raw).str.contains(words).fill_null(value=False) for words in (alarms, _NONE, _NO_POSITION_WORDS))
    return outright | (alarm & ~none)


_PARTS = r"[;|]"
"""What parts statements of a text that say nothing of each other."""


def _alarm_in_any_part(raw: pl.Series) -> pl.Series:
    """The same, where a good word of one statement of a text takes back no alarm of another: `alert=none;integrity=failed`."""
    against = _alarm(raw)
    several = (raw.str.contains(_PARTS) & _plain_text(raw).str.contains(_ALARM) & ~against).fill_null(value=False)
    if not several.any():
        return against
    parts = pl.DataFrame({"at": several.arg_true(), "part": raw.filter(several).str.replace_all(_PARTS, ";").str.split(";")}).explode(
        "part"
    )
    alarming_rows = parts.filter(_alarm(parts["part"]))["at"].unique()
    return against | pl.int_range(len(raw), eager=True).cast(alarming_rows.dtype).is_in(alarming_rows.implode())


def _listed(words: Iterable[str]) -> list[str]:
    return sorted(words)
