"""Names that speak of validity, accuracy, a protection level or a truth, of columns that nothing reads."""

from __future__ import annotations

import re

from navbound.read.columns.naming import LONGEST_PARTED, name_parts, words
from navbound.read.columns.place_names import NO_TRUTH, speaks_of_place

_SPEAKS = words(
    "status "
    "hplfd hplwas vplwas valid invalid validity fix quality raim fde integrity alert alarm warning caution fault failure fail failed "
    "health healthy "
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


_ACCURACY = words(
    "acc hacc pacc accuracy uncertainty sigma std stddev sd sdev epe eph ehpe ehe epx epy cep cep50 cep95 r95 drms 2drms rms hrms hfom "
    "twodrms hpe herror h50 h95 mrse "
    "fom nse tse fte err error errors herr poserr"
)
"""Parts of names of a horizontal accuracy or error, a length. Provenance: ours."""
_NO_POSITION = words(
    "v vert vertical u up down alt altitude height z vel velocity speed sog rate climb track heading head hdg course cog bearing yaw roll "
    "c pitch attitude angle t time clock clk bias drift gyro accel acceleration imu mag lin linear ang angular range doppler phase code id "
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


_APART = words("dist distance offset offs diff difference delta separation gap discrepancy deviation displacement residual misclosure")
_REFERENCE, _POSITION = words("ref reference"), words("true actual surveyed known")
_OF_POSITION = words("position pos point place location")
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


_LEVEL = words("hpl hil hul hpls hils hplfd hplwas")
_LEVEL_IN_WORDS = tuple(map(words, ("protection level", "integrity level", "integrity limit", "containment radius", "containment limit")))
"""Parts of names of a horizontal protection level, a length. Provenance: ours."""


def speaks_of_level(name: str) -> bool:
    """Whether the name is one of a horizontal protection level, so that its numbers are lengths."""
    parts = _parts_of_lengths(name)
    named = not _LEVEL.isdisjoint(parts) or any(together <= parts for together in _LEVEL_IN_WORDS)
    return named and _NO_POSITION.isdisjoint(parts)


_WHOSE = words("h horizontal pos position gps gnss horizontal_position estimated_horizontal estimated_horizontal_position")
_WHAT = words("acc accuracy uncertainty sigma std stddev")
BARE_LENGTHS = (
    words(
        "anp hacc pacc accuracy epe eph ehpe ehe epx epy cep cep50 cep95 r95 drms 2drms twodrms hrms hfom herr poserr "
        "hpe herror h50 h95 mrse horizontal_error horizontal_err position_error pos_err acc95 acc_95"
    )
    | {f"{what}{ending}" for what in words("err error hpe herror hacc") for ending in _ENDINGS}
    | _LEVEL
    | words("protection_level containment_radius containment_limit horizontal_integrity_level horizontal_integrity_limit")
    | {f"{whose}_{what}" for whose in _WHOSE for what in _WHAT}
    | {f"{what}_{whose}" for whose in ("h", "horizontal") for what in _WHAT}
    | {f"horizontal_containment_{what}" for what in ("radius", "limit")}
)
"""Bare names that can only be those of a horizontal accuracy or protection level; `acc`, `error` or `std` alone may be anything. Ours."""
