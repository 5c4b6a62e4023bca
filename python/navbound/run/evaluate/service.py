"""What the messages of an augmentation service were over the epochs of a run, for the page: counts, time-outs, UDRE and GIVE over time."""

from __future__ import annotations

import math
from collections import defaultdict
from typing import TYPE_CHECKING

import numpy as np

from navbound import sbas
from navbound.records.performance import GridPoint, MessageCount, ServiceLog, UdreHistory
from navbound.sbas import grid as iono_grid

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from navbound.sbas import Decoded, Messages

NS = 1_000_000_000
MOST_MESSAGES = 2 * 86_400
"""Messages that are looked at one by one, two days of them. [1] Ours."""
MOST_BINS, LEAST_BIN_S = 240, 12
"""Bins of the page; every fast correction is sent within one. [1, s] Ours."""
BEFORE_NS = 1200 * NS
"""Masks that were sent before the first epoch count for as long as the longest time-out of them."""
NOT_MONITORED = 14
_GIVEI_NOT_MONITORED = 15
_DO_NOT_USE, _UNKNOWN = "X", "."
"""Signs of `GridPoint.states` that are no indicator."""
TYPES: dict[int, tuple[str, int | None]] = {
    0: ("not for use: test", None),
    1: ("mask of satellites", 600),
    2: ("fast corrections and UDRE, satellites 1 to 13 of the mask", 12),
    3: ("fast corrections and UDRE, 14 to 26", 12),
    4: ("fast corrections and UDRE, 27 to 39", 12),
    5: ("fast corrections and UDRE, 40 to 51", 12),
    6: ("UDRE of all satellites", None),
    7: ("degradation of fast corrections", 240),
    9: ("orbit of the geostationary satellite", 240),
    10: ("degradation parameters", 240),
    12: ("time of the network", None),
    17: ("almanac of geostationary satellites", None),
    18: ("masks of the grid", 1200),
    24: ("fast and long-term corrections", None),
    25: ("long-term corrections", 240),
    26: ("delays and GIVE of the grid", 600),
    27: ("service regions", 86_400),
    28: ("covariance of clocks and orbits", 240),
    62: ("internal test", None),
    63: ("null", None),
}
"""Type to its content and the time-out of its data on a precision approach [s]; those of ``crates/core/src/signal/sbas/timeout.rs``."""
_UDRE_BLOCKS = {2: 0, 3: 1, 4: 2, 5: 3}
_GRID_S = 600
_BLOCK = 15
"""Points of a message 26."""
_FULL = 13
"""Satellites of a message of fast corrections."""


def service_of_files(logs: Sequence[Path], prn: int | None, first_ns: int, last_ns: int) -> ServiceLog | None:
    """The messages of these logs over the epochs of a run; None where they hold none of the time."""
    every = [sbas.read(log) for log in logs]
    time_ns, sender, data = (np.concatenate([getattr(m, name) for m in every]) for name in ("time_ns", "prn", "data"))
    near = (time_ns >= first_ns - BEFORE_NS) & (time_ns <= last_ns) & (np.full(len(sender), prn is None) | (sender == prn))
    order = np.flatnonzero(near)[np.argsort(time_ns[near], kind="stable")]
    if not (time_ns[order] >= first_ns).any():
        return None
    messages = sbas.Messages(time_ns[order], sender[order], data[order], every[0].format, every[0].tag, [])
    return service_log(messages, first_ns)


def service_log(messages: Messages, first_ns: int) -> ServiceLog:
    """What messages of one satellite were from an instant on; those before it only say what the masks were."""
    first_ns = int(messages.time_ns[messages.time_ns >= first_ns][0])
    n_before = int((messages.time_ns < first_ns).sum())
    n = len(messages.time_ns) - n_before
    kept = slice(0, n_before + min(n, MOST_MESSAGES))
    cut = sbas.Messages(messages.time_ns[kept], messages.prn[kept], messages.data[kept], messages.format, messages.tag, [])
    decoded = sbas.decode(cut)
    time_ns = cut.time_ns[n_before:]
    last_ns = int(time_ns[-1])
    seconds = np.unique(time_ns // NS)
    bin_ns = max(LEAST_BIN_S, -(-(last_ns - first_ns + 1) // (MOST_BINS * NS))) * NS
    histories = _Histories(first_ns, bin_ns, int((last_ns - first_ns) // bin_ns) + 1)
    for message in decoded:
        histories.take(message)
    udre, give, n_points = histories.end()
    words = [] if n <= MOST_MESSAGES else [f"The messages are those of the first two days, {MOST_MESSAGES} of {n}."]
    return ServiceLog(
        prn=int(messages.prn[n_before]),
        first_ns=first_ns,
        last_ns=last_ns,
        n_messages=len(time_ns),
        n_missing=int(seconds[-1] - seconds[0]) + 1 - len(seconds),
        longest_silence_s=float(np.diff(time_ns).max()) / NS if len(time_ns) > 1 else 0.0,
        types=list(_counts(decoded[n_before:])),
        bin_ns=bin_ns,
        udre=udre,
        give=give,
        n_points=n_points,
        grid=histories.grid(),
        words=words,
    )


def _counts(decoded: list[Decoded]) -> Iterator[MessageCount]:
    ends = defaultdict[int, list[int]](list)
    fresh = defaultdict[int, list[int]](list)
    """When the data of a type were sent by whatever message: UDRE indicators stand in messages 6 and 24 too."""
    for message in decoded:
        ends[message.type].append(message.time_ns)
        for kind in _restates(message):
            fresh[kind].append(message.time_ns)
    for kind in sorted(ends):
        what, time_out_s = TYPES.get(kind, ("not read", None))
        own = np.diff(ends[kind])
        gaps = np.diff(fresh[kind])
        n_out = 0 if time_out_s is None else int((gaps > time_out_s * NS).sum())
        yield MessageCount(
            type=kind,
            what=what,
            n=len(ends[kind]),
            longest_gap_s=float(own.max()) / NS if own.size else None,
            time_out_s=time_out_s,
            n_time_outs=n_out,
        )


def _restates(message: Decoded) -> tuple[int, ...]:
    """Types whose data a message states."""
    if message.type == 6:
        return (2, 3, 4, 5)
    if message.type == 24:
        blocks = {(position - 1) // _FULL for position in message.fields["position"]}
        return (24, *(kind for kind, block in _UDRE_BLOCKS.items() if block in blocks), 25)
    return (message.type,)


class _Histories:
    """Indicators as they were sent, in bins of time."""

    def __init__(self, first_ns: int, bin_ns: int, n_bins: int) -> None:
        self._first_ns, self._bin_ns, self._n = first_ns, bin_ns, n_bins
        self._mask: tuple[int, list[int]] | None = None
        self._udre: dict[int, list[int | None]] = {}
        self._grid: dict[int, tuple[int, list[int]]] = {}
        self._give: dict[tuple[int, int], tuple[str, int]] = {}
        self._states: dict[tuple[int, int], list[str]] = {}
        self._counts: list[list[int]] = []

    def take(self, message: Decoded) -> None:
        """In the order of time."""
        fields = message.fields
        at = (message.time_ns - self._first_ns) // self._bin_ns
        while len(self._counts) < at:
            self._close()
        if message.type == 1:
            self._mask = fields["iodp"], fields["prn"]
        elif message.type in {2, 3, 4, 5, 24} and self._mask is not None and fields["iodp"] == self._mask[0]:
            for position, indicator in zip(fields["position"], fields["udrei"], strict=True):
                self._state(position, indicator, at)
        elif message.type == 6:
            for position, indicator in enumerate(fields["udrei"], 1):
                self._state(position, indicator, at)
        elif message.type == 18:
            self._grid[fields["band"]] = fields["iodi"], fields["point"]
        elif message.type == 26:
            self._points(message)

    def _state(self, position: int, indicator: int, at: int) -> None:
        if self._mask is None or at < 0 or not 1 <= position <= len(self._mask[1]):
            return
        bins = self._udre.setdefault(self._mask[1][position - 1], [None] * self._n)
        bins[at] = indicator if bins[at] is None else max(bins[at] or 0, indicator)

    def _points(self, message: Decoded) -> None:
        band, fields = message.fields["band"], message.fields
        iodi, points = self._grid.get(band, (-1, []))
        if fields["iodi"] != iodi:
            return
        for k, (indicator, delay_m) in enumerate(zip(fields["givei"], fields["delay_m"], strict=True)):
            index = _BLOCK * fields["block"] + k
            if index < len(points):
                self._give[band, points[index]] = _DO_NOT_USE if delay_m is None else f"{indicator:X}", message.time_ns

    def _close(self) -> None:
        """The grid at the end of a bin."""
        end_ns = self._first_ns + (len(self._counts) + 1) * self._bin_ns
        counts = [0] * 16
        for band, (_, points) in self._grid.items():
            for point in points:
                sign, sent_ns = self._give.get((band, point), (_UNKNOWN, end_ns))
                if end_ns - sent_ns > _GRID_S * NS:
                    sign = _UNKNOWN
                self._states.setdefault((band, point), [_UNKNOWN] * self._n)[len(self._counts)] = sign
                if sign != _UNKNOWN:
                    counts[_GIVEI_NOT_MONITORED if sign == _DO_NOT_USE else int(sign, 16)] += 1
        self._counts.append(counts)

    def grid(self) -> list[GridPoint]:
        """The points of all masks, from south to north and west to east; those that are none of the standard's table are left out."""
        placed = []
        for (band, point), signs in self._states.items():
            table = iono_grid.points(band)
            if 1 <= point <= len(table):
                placed.append((table[point - 1], "".join(signs)))
        return [GridPoint(lat_rad=math.radians(lat), lon_rad=math.radians(lon), states=states) for (lat, lon), states in sorted(placed)]

    def end(self) -> tuple[list[UdreHistory], list[list[int]], int]:
        """What there was: indicators of satellites that were monitored, counts of grid points, points of the masks."""
        while len(self._counts) < self._n:
            self._close()
        monitored = {prn: bins for prn, bins in self._udre.items() if any(each is not None and each < NOT_MONITORED for each in bins)}
        udre = [UdreHistory(sv=_name(prn), worst=bins) for prn, bins in sorted(monitored.items())]
        return udre, self._counts, sum(len(points) for _, points in self._grid.values())


def _name(prn: int) -> str:
    """PRN of the mask: 1 to 32 GPS, 38 to 61 GLONASS, 120 and above geostationary."""
    if prn <= 32:
        return f"G{prn:02d}"
    return f"R{prn - 37:02d}" if 38 <= prn <= 61 else f"S{prn}"
