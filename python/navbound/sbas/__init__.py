"""SBAS: message logs, what the messages say, and the protection levels that follow from them.

Source of every formula: RTCA DO-229D (standard); what was checked against what stands in docs/methods/sbas.md.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from navbound import _core
from navbound.errors import InputError
from navbound.gnss import Observations
from navbound.gnss.files import file_content
from navbound.methods import EXTRACTION_LABEL
from navbound.sbas.extraction import ErrorExtraction, error_extraction
from navbound.sbas.gains import (
    ALPHA,
    MU_MOST_M,
    ExtractionBeta,
    ExtractionBias,
    ExtractionFactor,
    ExtractionGains,
    extraction_beta,
    extraction_beta_from_autocorrelation,
    extraction_beta_from_spectrum,
    extraction_bias,
    extraction_bias_dop,
    extraction_factor,
    extraction_gains,
)
from navbound.sbas.positions import MODES, CorrectedPositions, Navigations, corrected_positions, service_of
from navbound.sbas.records import Decoded, Levels, Messages, Refused, Satellites
from navbound.sbas.terms import FromTerms, covariance_levels, levels_from_terms
from navbound.table.arguments import checked
from navbound.table.arrays import flatten, unflatten

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


__all__ = [
    "ALPHA",
    "EXTRACTION_LABEL",
    "MU_MOST_M",
    "CorrectedPositions",
    "Decoded",
    "ErrorExtraction",
    "ExtractionBeta",
    "ExtractionBias",
    "ExtractionFactor",
    "ExtractionGains",
    "FromTerms",
    "Levels",
    "Messages",
    "Refused",
    "Satellites",
    "covariance_levels",
    "decode",
    "error_extraction",
    "extraction_beta",
    "extraction_beta_from_autocorrelation",
    "extraction_beta_from_spectrum",
    "extraction_bias",
    "extraction_bias_dop",
    "extraction_factor",
    "extraction_gains",
    "levels_from_terms",
    "protection_levels",
    "read",
    "satellites",
    "solve",
]

Mode = Literal["auto", "pa", "npa"]

_MASK_RAD = 0.08726646259971647
"""5 degrees: the standard's mask."""


@checked
def read(path: str | Path, *, tag: Literal["end", "start"] | None = None) -> Messages:
    """Read a log of SBAS messages: EMS text, RTKLIB ``.sbs``, RINEX-B or a receiver's raw log, plain or packed (gzip, compress, zip).

    Parameters
    ----------
    path : path
        The file.
    tag : {"end", "start"}, optional
        Whether the log's times are the second in which a message ends or begins. A second's mistake moves a quarter of the levels by
        more than 1 %. Without it EMS and RTKLIB logs are taken as tagged at the end; RINEX-B has no convention known to us and needs it.

    Returns
    -------
    Messages
        In the order of the file. Damaged lines, and L5 messages in an RTKLIB log, are in ``refused``.

    Raises
    ------
    FormatError
        None of the formats, a damaged packing, RINEX-B without ``tag``, or a receiver's log with ``"start"``: its messages are dated by the
        measurements beside them.
    InputError
        An unknown ``tag``.
    """
    if tag not in (None, "end", "start"):
        raise InputError("tag", tag, domain="end, start")
    place, content = file_content(path)
    log = _core.sbas_read(content, str(place), tag)
    refused = [Refused(*row) for row in log.pop("refused")]
    return Messages(refused=refused, **log)


@checked
def decode(messages: Messages) -> list[Decoded]:
    """Say what messages contain (DO-229D, appendix A).

    Parameters
    ----------
    messages : Messages
        From :func:`read`, or put together by the caller.

    Returns
    -------
    list of Decoded
        One a message.

    Raises
    ------
    InputError
        A block whose preamble or parity is wrong.
    """
    decoded = _core.sbas_decode(np.ascontiguousarray(messages.data, dtype=np.uint8))
    return [
        Decoded(int(time_ns), int(prn), kind, fields)
        for time_ns, prn, (kind, fields) in zip(messages.time_ns, messages.prn, decoded, strict=True)
    ]


@checked
def protection_levels(
    messages: Messages,
    navigation: Navigations,
    time_ns: ArrayLike,
    *,
    lat_rad: ArrayLike,
    lon_rad: ArrayLike,
    h_m: ArrayLike,
    mode: Mode = "auto",
    mask_rad: float = _MASK_RAD,
    noise_m: float = 0.36,
    divergence_m: float = 0.0,
    test_signal: bool = False,
) -> Levels:
    """Protection levels at times and places, from a service's messages and the satellites' navigation data.

    Times and places broadcast: ``time_ns`` of shape (t, 1) against places of shape (p,) gives every place at every time, and what the
    service offers at one instant is computed once for all places.

    Parameters
    ----------
    messages : Messages
        Of one geostationary satellite (``messages.of(prn)``). A message can be used 0.12 s after its end.
    navigation : Navigation, path or sequence of paths
        From :func:`navbound.gnss.read_navigation`, or its files. The record corrected is the healthy one of the issue (IODE) that the
        service names.
    time_ns : array_like of int
        GPS time. [ns]
    lat_rad, lon_rad, h_m : array_like
        Place, WGS-84. [rad, m]
    mode : {"auto", "pa", "npa"}
        Precision approach, en route to non-precision approach, or the first with the second where it has no level. En route a satellite
        whose pierce point the grid does not serve takes the ionosphere that GPS broadcasts, where ``navigation`` has it.
    mask_rad : float
        Lowest elevation used. [rad]
    noise_m, divergence_m : float
        Receiver noise (0.36 m: accuracy designator A at minimum power) and code-carrier divergence. [m]
    test_signal : bool
        Disregard message 0 ("do not use"). Every level is then marked ``degraded``: it is not for navigation.

    Returns
    -------
    Levels
        DO-229D appendices A.4.4, A.4.5 and J.2: HPL = 6.0 d_major and VPL = 5.33 d_U (pa), HPL = 6.18 d_major (npa).

    Raises
    ------
    InputError
        Messages of several satellites, shapes that do not broadcast, or a value outside its domain.
    FormatError
        An unreadable navigation file.
    """
    service = service_of(messages, navigation, mode=mode, receiver=(mask_rad, noise_m, divergence_m), test_signal=test_signal)
    shape, places = _places(time_ns, lat_rad, lon_rad, h_m)
    levels = _core.sbas_levels(service, places)
    codes = levels["mode"].reshape(shape)
    good = "degraded" if test_signal else "ok"
    return Levels(
        hpl_m=unflatten(levels["hpl_m"], shape),
        vpl_m=unflatten(levels["vpl_m"], shape),
        n_sv=levels["n_sv"].reshape(shape),
        mode=MODES[codes],
        status=np.where(codes > 0, good, "not_available"),
        reason=levels["reason"].reshape(shape),
        reasons=levels["reasons"],
        reason_ids=levels["reason_ids"],
        test_signal=test_signal,
        ignored=levels["ignored"],
    )


@checked
def satellites(
    messages: Messages,
    navigation: Navigations,
    time_ns: ArrayLike,
    *,
    lat_rad: ArrayLike,
    lon_rad: ArrayLike,
    h_m: ArrayLike,
    mode: Mode = "auto",
    mask_rad: float = _MASK_RAD,
    noise_m: float = 0.36,
    divergence_m: float = 0.0,
    test_signal: bool = False,
) -> Satellites:
    """The satellites behind :func:`protection_levels`, with their corrections and the parts of their error.

    Parameters
    ----------
    messages, navigation, time_ns, lat_rad, lon_rad, h_m, mode, mask_rad, noise_m, divergence_m, test_signal
        As there.

    Returns
    -------
    Satellites
        Rows only for epochs with a level.

    Raises
    ------
    InputError, FormatError
        As there.
    """
    service = service_of(messages, navigation, mode=mode, receiver=(mask_rad, noise_m, divergence_m), test_signal=test_signal)
    _, places = _places(time_ns, lat_rad, lon_rad, h_m)
    return Satellites(**_core.sbas_satellites(service, places))


def _places(
    time_ns: ArrayLike, lat_rad: ArrayLike, lon_rad: ArrayLike, h_m: ArrayLike
) -> tuple[tuple[int, ...], dict[str, NDArray[np.generic]]]:
    instants = np.asarray(time_ns)
    if instants.dtype.kind not in "iu":
        raise InputError("time_ns", f"{instants.dtype}", domain="whole nanoseconds")
    # Nanoseconds do not fit a double: only their shape takes part in the broadcast of the places.
    names = {"lat_rad": (lat_rad, ()), "lon_rad": (lon_rad, ()), "h_m": (h_m, ())}
    shape, (_, lat, lon, h) = flatten(time_ns=(np.zeros(instants.shape), ()), **names)
    times = np.ascontiguousarray(np.broadcast_to(instants, shape)).reshape(-1).astype(np.int64)
    return shape, {"time_ns": times, "lat_rad": lat, "lon_rad": lon, "h_m": h}


@checked
def solve(
    observations: Observations,
    navigation: Navigations,
    messages: Messages,
    *,
    mode: Mode = "auto",
    mask_rad: float = _MASK_RAD,
    noise_m: float = 0.36,
    divergence_m: float = 0.0,
    smoothing_s: float | None = 100.0,
    false_alarm: float = 1e-4,
    test_signal: bool = False,
    truth_ecef_m: ArrayLike | None = None,
    track: str | None = None,
) -> CorrectedPositions:
    """Positions of a recording with a service's corrections, each with the protection levels of that very solution.

    C/A pseudoranges on L1, smoothed by their own carrier; broadcast orbits and clocks of the issue that the service corrects, with its
    fast, range-rate and long-term corrections; ionosphere of the service's grid; troposphere of DO-229 A.4.2.4; weights of the
    error model behind the levels. An error of the position is what its levels bound.

    Parameters
    ----------
    observations : Observations
        From :func:`navbound.gnss.read_observations`.
    navigation : Navigation, path or sequence of paths
        From :func:`navbound.gnss.read_navigation`, or its files.
    messages : Messages
        Of one geostationary satellite (``messages.of(prn)``). A message can be used 0.12 s after its end.
    mode : {"auto", "pa", "npa"}
        Precision approach, en route to non-precision approach, or the first with the second where it has no solution. En route a satellite
        whose pierce point the grid does not serve takes the ionosphere that GPS broadcasts, where ``navigation`` has it.
    mask_rad : float
        Lowest elevation used. [rad]
    noise_m, divergence_m : float
        Receiver noise (0.36 m: accuracy designator A at minimum power) and code-carrier divergence. [m]
    smoothing_s : float, optional
        Time constant of the smoothing; ``None`` uses pseudoranges as measured. A code without carrier stays as measured. [s]
    false_alarm : float
        Risk of a false alarm of the residual test, an epoch; it marks an epoch ``degraded`` and excludes nothing. [1]
    test_signal : bool
        Disregard message 0 ("do not use"). Every position is then marked ``degraded``: it is not for navigation.
    truth_ecef_m : array_like, shape (3,) or (n_epochs, 3), optional
        True position, Earth-fixed; NaN where it is not known. [m]
    track : str, optional
        Name of the track; by default the marker's or the file's.

    Returns
    -------
    CorrectedPositions
        ``epochs`` with positions, covariance, ``hpl_m``, ``vpl_m``, ``mode``; the satellites of every solution; what was not used and why.

    Raises
    ------
    InputError
        Messages of several satellites, or a value outside its domain.
    FormatError
        An unreadable navigation file.
    """
    observations.require_epochs()
    receiver = (mask_rad, noise_m, divergence_m)
    service = service_of(messages, navigation, mode=mode, receiver=receiver, test_signal=test_signal)
    return corrected_positions(
        service, observations, smoothing_s=smoothing_s, false_alarm=false_alarm, truth_ecef_m=truth_ecef_m, track=track
    )
