"""What a log of SBAS messages holds and what follows from it; public in `navbound.sbas`."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


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
    late_s : dict of int to int or None
        How late ``time_ns`` is by each sender's preambles, which follow a GPS second that six divides: 0, 1 or -1; None where too few
        messages agree. Nothing is moved. [s]
    """

    time_ns: NDArray[np.int64]
    prn: NDArray[np.uint8]
    data: NDArray[np.uint8]
    format: str
    tag: Literal["end", "start"]
    refused: list[Refused]
    late_s: dict[int, int | None] = field(default_factory=dict)

    def of(self, prn: int) -> Messages:
        """The messages of one geostationary satellite."""
        own = self.prn == prn
        late = {sender: s for sender, s in self.late_s.items() if sender == prn}
        return replace(self, time_ns=self.time_ns[own], prn=self.prn[own], data=self.data[own], late_s=late)

    def tag_words(self) -> list[str]:
        """What the preambles say against the times; empty where they agree or say nothing."""
        late = [str(sender) for sender, s in self.late_s.items() if s == 1]
        early = [str(sender) for sender, s in self.late_s.items() if s == -1]
        stated = f"the log's times are taken for the {self.tag} of each message"
        words = []
        if late:
            words.append(f"by the preambles the messages of PRN {', '.join(late)} ended one second before the times used; {stated}.")
        if early:
            words.append(f"by the preambles the messages of PRN {', '.join(early)} ended one second after the times used; {stated}.")
        return words


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
    reasons, reason_ids : list of str
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
    reason_ids: list[str]
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
