"""An hour of a geostationary satellite that augments GPS: corrections, integrity and a grid of the ionosphere over Europe."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from navbound import gnss
from navbound.examples.station import Station, measure
from navbound.sbas import grid as iono_grid
from navbound.write.sbas import Sent

if TYPE_CHECKING:
    from navbound.examples.station import StationRecording
    from navbound.sbas.grid import Points

PRN = 120
_NS = 10**9
_MASK = range(1, 33)
_FAST = 13
"""Satellites in one of messages 2 to 5."""
_UDREI, _NOT_MONITORED, _DO_NOT_USE = 5, 14, 15
_GIVEI, _NO_GRID = 5, 15
_DELAY_M = 0.125
_BLOCK = 15
"""Grid points in one of messages 26."""
_BANDS = (3, 4, 5, 9)
_FROM, _TO = (20, -40), (65, 45)
"""Corners of the service: latitude, longitude [deg]."""
_GRID_S = 300
"""The ionosphere is measured so often. [s]"""
_LOOK_S = 60
"""How often it is looked at which satellites are above the horizon. [s]"""
_ALERT_S = 4
"""An alert is repeated so often, once a second."""
_RATIO = (1575.42 / 1227.60) ** 2 - 1.0
"""Delay on the second frequency less that on the first, in delays on the first."""
_HIGH_RAD = float(np.radians(40.0))
_EARTH_M, _SHELL_M = 6_378_136.3, 350_000.0


@dataclass(frozen=True)
class Service:
    """What is sent, and what goes wrong.

    Attributes
    ----------
    begin_s : int
        GPS time of the first message. [s]
    duration_s : int
        How long. [s]
    seed : int
        Of the stations that measure the ionosphere.
    centre_rad : tuple
        Satellites above the horizon here are monitored: latitude, longitude. [rad]
    wrong : tuple
        Satellite, and from and until after the first message: do not use it. [s]
    silent : tuple of (float, float)
        From and until after the first message: nothing is sent. [s]
    """

    begin_s: int
    duration_s: int
    seed: int
    centre_rad: tuple[float, float]
    wrong: tuple[str, tuple[int, int]]
    silent: tuple[tuple[int, int], ...] = ()


def messages(service: Service, recording: StationRecording) -> list[Sent]:
    """The messages of a service for the satellites of a recording: one a second.

    Messages 2 to 4 come every six seconds; masks, degradation and long-term corrections within two minutes, the grid within five. All
    corrections are zero: the errors that the recording has are within the indicators.
    """
    slow = _Slow(service, recording)
    begin_s, (name, (from_s, until_s)) = service.begin_s, service.wrong
    seen, sent = list[int](), list[Sent]()
    for k in range(service.duration_s):
        time_s = begin_s + k
        if k % _LOOK_S == 0:
            seen = _indicators(service, recording, time_s)
        if any(first <= k < last for first, last in service.silent):
            continue
        indicators = list(seen)
        if from_s <= k < until_s:
            indicators[_MASK.index(int(name[1:]))] = _DO_NOT_USE
        if from_s <= k < from_s + _ALERT_S:
            # An alert goes before everything else.
            sent.append(_fast(time_s, _MASK.index(int(name[1:])) // _FAST, 3, indicators))
        elif k % 6 < 3:
            sent.append(_fast(time_s, k % 6, k // 6 % 3, indicators))
        else:
            sent.append(slow.next(time_s))
    return sent


def _fast(time_s: int, part: int, iodf: int, indicators: list[int]) -> Sent:
    here = [*indicators, *[_NOT_MONITORED] * (3 * _FAST)][_FAST * part : _FAST * (part + 1)]
    return Sent(time_s, 2 + part, [(iodf, 2), (0, 2), *[(0, 12)] * _FAST, *((each, 4) for each in here)])


def _indicators(service: Service, recording: StationRecording, time_s: int) -> list[int]:
    """UDRE indicator of every satellite of the mask: those above the horizon are monitored."""
    names, above = _above(recording.navigation.orbits("gps", time_s * _NS), *service.centre_rad)
    monitored = {name for name, each in zip(names, above, strict=True) if each > 0.0}
    return [_UDREI if f"G{prn:02d}" in monitored else _NOT_MONITORED for prn in _MASK]


def _above(orbits: gnss.Orbits, lat_rad: float, lon_rad: float) -> tuple[tuple[str, ...], list[float]]:
    """Satellites and their elevations [rad]."""
    _, el_rad = gnss.directions(orbits, lat_rad, lon_rad, 0.0, 0.0)
    return orbits.satellite, el_rad.ravel().tolist()


class _Slow:
    """What is sent between the fast corrections, in turn."""

    def __init__(self, service: Service, recording: StationRecording) -> None:
        self._service, self._recording = service, recording
        self._n = 0
        self._kinds = _kinds()
        self._delay_m = cache(self._measured_m)
        self._orbits = cache(lambda time_s: recording.navigation.orbits("gps", time_s * _NS))
        records = recording.navigation.records()
        self._records = list(zip(*(records[name].to_list() for name in ("satellite", "orbit_time_ns", "issue")), strict=True))

    def next(self, time_s: int) -> Sent:
        """The next of them, with what is known at its time."""
        kind = self._kinds[self._n % len(self._kinds)]
        self._n += 1
        return Sent(time_s, *self._made(kind, time_s))

    def _made(self, kind: tuple[int, int], time_s: int) -> tuple[int, list[tuple[int, int]]]:
        which, part = kind
        if which == 1:
            return 1, [(int(prn in _MASK), 1) for prn in range(1, 211)] + [(0, 2)]
        if which == 7:
            return 7, [(1, 4), (0, 2), (0, 2), *[(0, 4)] * 51]
        if which == 10:
            # Of the corrections of this service: half of the resolution of the grid, which is new every 300 s.
            none, two_minutes = (0, 10), (120, 9)
            return 10, [none, none, none, two_minutes, none, two_minutes, none, none, two_minutes, (0, 6), (63, 10), (300, 9), none, (0, 9)]
        if which == 18:
            points = iono_grid.points(part)
            return 18, [(len(_BANDS), 4), (part, 4), (0, 2), *((int(_served(part, each)), 1) for each in points)]
        if which == 25:
            return 25, self._long_term(part, time_s)
        return 26, self._grid(part, time_s)

    def _long_term(self, part: int, time_s: int) -> list[tuple[int, int]]:
        issues = self._issues(time_s)
        fields: list[tuple[int, int]] = []
        for half in range(2):
            fields.append((0, 1))
            for place in range(4 * part + 2 * half, 4 * part + 2 * half + 2):
                issue = issues.get(f"G{_MASK[place]:02d}")
                fields += [(0, 51)] if issue is None else [(place + 1, 6), (issue % 256, 8), (0, 9), (0, 9), (0, 9), (0, 10)]
            fields += [(0, 2), (0, 1)]
        return fields

    def _issues(self, time_s: int) -> dict[str, int]:
        """Issue of the record of every satellite that is nearest in time."""
        nearest: dict[str, tuple[int, int]] = {}
        for name, orbit_ns, issue in self._records:
            nearest[name] = min(nearest.get(name, (2**63, 0)), (abs(orbit_ns - time_s * _NS), issue))
        return {name: issue for name, (_, issue) in nearest.items()}

    def _grid(self, part: int, time_s: int) -> list[tuple[int, int]]:
        band, block, points = _blocks()[part]
        fields = [(band, 4), (block, 4)]
        for point in points:
            delay_m = self._delay_m(point, time_s - time_s % _GRID_S)
            fields += [(0, 9), (_NO_GRID, 4)] if delay_m is None else [(round(delay_m / _DELAY_M), 9), (_GIVEI, 4)]
        return fields + [(0, 13)] * (_BLOCK - len(points)) + [(0, 2), (0, 7)]

    def _measured_m(self, point: tuple[int, int], time_s: int) -> float | None:
        """Vertical delay on the first frequency as a station under the point measures it: the mean over its high satellites [m]."""
        seed = self._service.seed + 1000 * (point[0] + 90) + point[1] + 180
        lat_rad, lon_rad = map(float, np.radians(point))
        station = Station(lat_rad, lon_rad, 0.0, time_s * _NS, 1.0, 1, seed, mask_rad=_HIGH_RAD, galileo=False)
        measured = measure(station, "GRID")
        first, second = (
            dict(codes.select("satellite", "value").iter_rows())
            for codes in (measured.observations.column("G", code) for code in ("C1C", "C2L"))
        )
        names, above = _above(self._orbits(time_s), lat_rad, lon_rad)
        elevation = dict(zip(names, above, strict=True))
        vertical = [(second[name] - first[name]) / _RATIO * _mapped(elevation[name]) for name in first if name in second]
        return max(float(np.mean(vertical)), 0.0) if vertical else None


def _mapped(el_rad: float) -> float:
    """Vertical delay in slant ones: thin shell."""
    return float(np.sqrt(1.0 - (_EARTH_M * np.cos(el_rad) / (_EARTH_M + _SHELL_M)) ** 2))


def _served(band: int, point: tuple[int, int]) -> bool:
    return _FROM[0] <= point[0] <= _TO[0] and _FROM[1] <= point[1] <= _TO[1] and (band == 9 or point[0] <= 55)


def _kinds() -> list[tuple[int, int]]:
    """Kind and part, in turn: the grid once, and all others two times, in two rounds of less than two minutes."""
    often = [(1, 0), (7, 0), (10, 0), *((25, k) for k in range(len(_MASK) // 4))]
    grid = [(18, band) for band in _BANDS] + [(26, k) for k in range(len(_blocks()))]
    half = len(grid) // 2
    return [*often, *grid[:half], *often, *grid[half:]]


@cache
def _blocks() -> list[tuple[int, int, Points]]:
    """Band, block and points of every message 26."""
    blocks = []
    for band in _BANDS:
        served = [point for point in iono_grid.points(band) if _served(band, point)]
        blocks += [(band, k // _BLOCK, served[k : k + _BLOCK]) for k in range(0, len(served), _BLOCK)]
    return blocks
