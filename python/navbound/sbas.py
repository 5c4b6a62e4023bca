"""SBAS: message logs, what the messages say, and the protection levels that follow from them.

Source of every formula: RTCA DO-229D (standard); what was checked against what stands in docs/methods/sbas.md.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from navbound import _core
from navbound._arrays import flatten, unflatten
from navbound._error_extraction import ErrorExtraction, error_extraction
from navbound._extraction_gains import (
    ALPHA,
    EXTRACTION_LABEL,
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
from navbound._receivers import file_content
from navbound._sbas_positions import MODES, CorrectedPositions, corrected_positions, service_of
from navbound.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from navbound._sbas_positions import Navigations
    from navbound.gnss import Observations

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


@dataclass(frozen=True)
class Refused:
    """A line of a log that is no good message.

    Attributes
    ----------
    line : int
        Line number, from 1.
    field, reason, text : str
        What is wrong where, and the line's beginning.
    """

    line: int
    field: str
    reason: str
    text: str


@dataclass(frozen=True)
class Messages:
    """A log of SBAS L1 messages; arrays have shape (n,).

    Attributes
    ----------
    time_ns : ndarray of int
        GPS time at which each message ended. [ns]
    prn : ndarray of int
        PRN of the geostationary satellite that sent it.
    data : ndarray of uint8, shape (n, 32)
        The 250 bits, first bit first; preamble and parity are right.
    format : str
        How the log is written.
    tag : {"end", "start"}
        What the log's own times were taken to mean; ``time_ns`` is the end in both cases.
    refused : list of Refused
        Lines that are no good message.
    """

    time_ns: NDArray[np.int64]
    prn: NDArray[np.uint8]
    data: NDArray[np.uint8]
    format: str
    tag: Literal["end", "start"]
    refused: list[Refused]

    def of(self, prn: int) -> Messages:
        """The messages of one geostationary satellite."""
        own = self.prn == prn
        return Messages(self.time_ns[own], self.prn[own], self.data[own], self.format, self.tag, self.refused)


@dataclass(frozen=True)
class Decoded:
    """One message.

    Attributes
    ----------
    time_ns : int
        GPS time of its end. [ns]
    prn : int
        Who sent it.
    type : int
        Message type, 0 to 63.
    fields : dict
        What it says; names carry units. Empty for types that tell a user nothing (62, 63) or that are unknown.
    """

    time_ns: int
    prn: int
    type: int
    fields: dict[str, Any]


@dataclass(frozen=True)
class Levels:
    """Protection levels; arrays have the common shape of times and places.

    Attributes
    ----------
    hpl_m : ndarray
        Horizontal level, NaN exactly where ``mode`` is empty. [m]
    vpl_m : ndarray
        Vertical level, NaN exactly where ``mode`` is not ``pa``. [m]
    n_sv : ndarray of int
        Satellites in the solution; without one, those that could be used.
    mode : ndarray of str
        ``pa`` precision approach, ``npa`` en route to non-precision approach, empty for no level.
    status : ndarray of str
        ``ok``, ``not_available``, or ``degraded`` for every level of a test signal.
    reason : ndarray of int
        0 where there is a level, else 1 + index into ``reasons``.
    reasons : list of str
        Why there is no level, in words.
    test_signal : bool
        A message 0 was disregarded on request: nothing here is for navigation.
    ignored : list of (int, str)
        Messages that changed nothing [GPS ns, why]: corrections before their mask, or after a message 0.
    """

    hpl_m: NDArray[np.float64]
    vpl_m: NDArray[np.float64]
    n_sv: NDArray[np.int64]
    mode: NDArray[np.str_]
    status: NDArray[np.str_]
    reason: NDArray[np.uint32]
    reasons: list[str]
    test_signal: bool
    ignored: list[tuple[int, str]]


@dataclass(frozen=True)
class Satellites:
    """The satellites of every solution, one row a satellite and epoch; arrays have shape (m,).

    Attributes
    ----------
    epoch : ndarray of int
        Index of the flattened time and place.
    prn, iode : ndarray of int
        GPS satellite, and issue of the navigation data that is corrected.
    az_rad, el_rad : ndarray
        Azimuth clockwise from north, elevation. [rad]
    delta_udre : ndarray
        Factor of the UDRE from messages 27 or 28.
    fast_correction_m, clock_correction_s, iono_vertical_m : ndarray
        To add to the range [m], to add to the broadcast clock offset [s], vertical delay on L1 at the pierce point [m].
    from_grid : ndarray of bool
        The ionosphere is the service's; false where en route the broadcast model stands in for it.
    sigma_flt_m, sigma_uire_m, sigma_tropo_m, sigma_air_m, sigma_m : ndarray
        The parts of the range's standard deviation, and their root sum of squares. [m]
    """

    epoch: NDArray[np.int64]
    prn: NDArray[np.int64]
    iode: NDArray[np.int64]
    az_rad: NDArray[np.float64]
    el_rad: NDArray[np.float64]
    delta_udre: NDArray[np.float64]
    fast_correction_m: NDArray[np.float64]
    clock_correction_s: NDArray[np.float64]
    iono_vertical_m: NDArray[np.float64]
    from_grid: NDArray[np.bool_]
    sigma_flt_m: NDArray[np.float64]
    sigma_uire_m: NDArray[np.float64]
    sigma_tropo_m: NDArray[np.float64]
    sigma_air_m: NDArray[np.float64]
    sigma_m: NDArray[np.float64]


@dataclass(frozen=True)
class FromTerms:
    """What given terms lead to; arrays have shape (n,), one value a satellite.

    Attributes
    ----------
    e_fc_m, e_iono_m : ndarray
        Degradation of the fast correction and of the grid. [m]
    sigma_flt_m, sigma_uive_m, sigma_uire_m, sigma_tropo_m, sigma_air_m, sigma_m : ndarray
        Standard deviations: corrected range, vertical and slant ionosphere, troposphere, receiver, all. [m]
    obliquity : ndarray
        Slant over vertical ionosphere.
    cov_ee_m2, cov_en_m2, cov_nn_m2, cov_uu_m2 : float
        Covariance of the weighted solution. [m²]
    d_major_m : float
        Largest horizontal standard deviation. [m]
    hdop, vdop : float
        Dilution of precision.
    hpl_pa_m, hpl_npa_m, vpl_m : float
        Levels. [m]
    """

    e_fc_m: NDArray[np.float64]
    e_iono_m: NDArray[np.float64]
    sigma_flt_m: NDArray[np.float64]
    sigma_uive_m: NDArray[np.float64]
    obliquity: NDArray[np.float64]
    sigma_uire_m: NDArray[np.float64]
    sigma_tropo_m: NDArray[np.float64]
    sigma_air_m: NDArray[np.float64]
    sigma_m: NDArray[np.float64]
    cov_ee_m2: float
    cov_en_m2: float
    cov_nn_m2: float
    cov_uu_m2: float
    d_major_m: float
    hdop: float
    vdop: float
    hpl_pa_m: float
    hpl_npa_m: float
    vpl_m: float


def read(path: str | Path, *, tag: Literal["end", "start"] | None = None) -> Messages:
    """Read a log of SBAS messages: EMS text, RTKLIB ``.sbs``, RINEX-B or a receiver's raw log, plain or packed by gzip.

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
    found = _core.sbas_read(content, str(place), tag)
    refused = [Refused(*row) for row in found.pop("refused")]
    return Messages(refused=refused, **found)


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
    found = _core.sbas_decode(np.ascontiguousarray(messages.data, dtype=np.uint8))
    return [
        Decoded(int(time_ns), int(prn), kind, fields)
        for time_ns, prn, (kind, fields) in zip(messages.time_ns, messages.prn, found, strict=True)
    ]


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
    found = _core.sbas_levels(service, places)
    codes = found["mode"].reshape(shape)
    good = "degraded" if test_signal else "ok"
    return Levels(
        hpl_m=unflatten(found["hpl_m"], shape),
        vpl_m=unflatten(found["vpl_m"], shape),
        n_sv=found["n_sv"].reshape(shape),
        mode=MODES[codes],
        status=np.where(codes > 0, good, "not_available"),
        reason=found["reason"].reshape(shape),
        reasons=found["reasons"],
        test_signal=test_signal,
        ignored=found["ignored"],
    )


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
    receiver = (mask_rad, noise_m, divergence_m)
    service = service_of(messages, navigation, mode=mode, receiver=receiver, test_signal=test_signal)
    return corrected_positions(
        service, observations, smoothing_s=smoothing_s, false_alarm=false_alarm, truth_ecef_m=truth_ecef_m, track=track
    )


def covariance_levels(covariance_m2: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """HPL = 6.0 d_major and VPL = 5.33 d_U of covariances of the position (DO-229D J.2, precision approach; standard).

    They are integrity levels only where the covariance is that of the SBAS error model.

    Parameters
    ----------
    covariance_m2 : array_like, shape (..., 6)
        ee, en, nn, eu, nu, uu; east, north, up. [m²]

    Returns
    -------
    hpl_m, vpl_m : ndarray, shape (...)
        NaN where the six numbers are no covariance. [m]

    Raises
    ------
    InputError
        Another shape.
    """
    shape, (flat,) = flatten(covariance_m2=(covariance_m2, (6,)))
    found = _core.sbas_covariance_levels(flat)
    return unflatten(found["hpl_m"], shape), unflatten(found["vpl_m"], shape)


def levels_from_terms(
    *,
    az_rad: ArrayLike,
    el_rad: ArrayLike,
    udrei: ArrayLike,
    givei: ArrayLike,
    x_pp: ArrayLike,
    y_pp: ArrayLike,
    delta_udre: ArrayLike = 1.0,
    fast_mps2: ArrayLike = 0.0,
    fast_age_s: ArrayLike = 0.0,
    latency_s: ArrayLike = 0.0,
    e_rrc_m: ArrayLike = 0.0,
    e_ltc_m: ArrayLike = 0.0,
    e_er_m: ArrayLike = 0.0,
    rss_udre: ArrayLike = 0,
    iono_step_m: ArrayLike = 0.0,
    iono_interval_s: ArrayLike = 1.0,
    iono_ramp_mps: ArrayLike = 0.0,
    iono_age_s: ArrayLike = 0.0,
    rss_iono: ArrayLike = 0,
    noise_m: ArrayLike = 0.36,
    divergence_m: ArrayLike = 0.0,
) -> FromTerms:
    """Levels of one solution whose error-model terms are all given.

    Parameters
    ----------
    az_rad, el_rad : array_like, shape (n,)
        Azimuth clockwise from north, elevation. [rad]
    udrei : array_like of int, shape (n,)
        UDRE indicators, 0 to 13.
    givei : array_like of int, shape (n, 4)
        GIVE indicators, 0 to 14, of the cell's corners: north-east, north-west, south-west, south-east.
    x_pp, y_pp : array_like, shape (n,)
        Place of the pierce point in its cell from the south-west corner, in cell widths and heights.
    delta_udre : array_like
        Factor of the UDRE, at least 1.
    fast_mps2, fast_age_s, latency_s : array_like
        Degradation factor a [m/s²], age and system latency [s]: e_fc = a (age + latency)² / 2.
    e_rrc_m, e_ltc_m, e_er_m : array_like
        Further degradations. [m]
    rss_udre, rss_iono : array_like of bool
        Degradations are added as squares.
    iono_step_m, iono_interval_s, iono_ramp_mps, iono_age_s : array_like
        e_iono = step floor(age / interval) + ramp age. [m, s, m/s, s]
    noise_m, divergence_m : array_like
        Receiver. [m]

    Returns
    -------
    FromTerms
        DO-229D appendices A.4.5 and J.2.

    Raises
    ------
    InputError
        An indicator that forbids use, a negative term, or satellites that do not determine a position.
    """
    numbers = (az_rad, el_rad, udrei, delta_udre, fast_mps2, fast_age_s, latency_s, e_rrc_m, e_ltc_m, e_er_m, rss_udre, x_pp, y_pp)
    rest = (iono_step_m, iono_interval_s, iono_ramp_mps, iono_age_s, rss_iono, noise_m, divergence_m)
    names = [
        "az_rad",
        "el_rad",
        "udrei",
        "delta_udre",
        "fast_mps2",
        "fast_age_s",
        "latency_s",
        "e_rrc_m",
        "e_ltc_m",
        "e_er_m",
        "rss_udre",
        "x_pp",
        "y_pp",
    ]
    names_rest = ["iono_step_m", "iono_interval_s", "iono_ramp_mps", "iono_age_s", "rss_iono", "noise_m", "divergence_m"]
    named: dict[str, tuple[ArrayLike, tuple[int, ...]]] = {n: (v, ()) for n, v in zip(names, numbers, strict=True)}
    named["givei"] = (givei, (4,))
    named |= {n: (v, ()) for n, v in zip(names_rest, rest, strict=True)}
    shape, columns = flatten(**named)
    if len(shape) != 1:
        raise InputError("az_rad", f"shape {shape}", domain="shape (n,)")
    try:
        return FromTerms(**_core.sbas_from_terms(np.column_stack(columns)))
    except InputError:
        raise
    except ValueError as e:
        raise InputError("az_rad", f"{shape[0]} satellites", domain=f"satellites that determine a position: {e}") from e
