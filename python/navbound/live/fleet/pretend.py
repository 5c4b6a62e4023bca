"""A fleet that flies nowhere: ADS-B states as readsb writes them, of aircraft that do not exist and misbehave on purpose.

For a first look and for measurements; nothing of it is a recording. The same number and seed give the same aircraft with the same faults.
"""

from __future__ import annotations

import json
import re
import time
from dataclasses import dataclass

import numpy as np

from navbound.errors import InputError
from navbound.units import MPS_PER_KT

NAME = "simulated"
MOST_AIRCRAFT = 50_000
_FORM = re.compile(r"simulated:(\d{1,6})(?:,(\d{1,9}))?")
_HOSTILE = "<img src=x onerror=alert(1)>"
_BOX_DEG = ((43.0, 51.0), (-4.0, 8.0))
_CYCLE_S = 60
METRES_PER_DEGREE = 111_195.0
"""Of latitude, on a sphere of 6371 km: good enough for aircraft that are not there. [m]"""


@dataclass(frozen=True)
class Kind:
    """How some aircraft misbehave: their share, for how long in a minute, and what their lines state instead."""

    share: float
    seconds: int
    instead: dict[str, object]


KINDS = {
    "quiet": Kind(0.86, 0, {}),
    "inaccurate": Kind(0.03, 12, {"nac_p": 5}),
    "unsure": Kind(0.03, 8, {"nic": 4}),
    "uncategorised": Kind(0.02, 6, {"nac_p": None}),
    "silent": Kind(0.02, 6, {}),
    "foreign": Kind(0.01, 10, {"type": "mlat"}),
    "hostile": Kind(0.03, _CYCLE_S, {"flight": _HOSTILE}),
}


def is_name(source: str) -> bool:
    """Whether a source is a simulated fleet."""
    return source.partition(":")[0] == NAME


class Pretend:
    """Lines of a fleet, one an aircraft and second, as time passes: as :class:`navbound.live.source.Source` says."""

    live = True
    size: int | None = None
    up = True

    def __init__(self, source: str) -> None:
        entry = _FORM.fullmatch(source)
        if entry is None or not 1 <= int(entry[1]) <= MOST_AIRCRAFT:
            raise InputError("source", source, domain=f"simulated:N or simulated:N,SEED with 1 to {MOST_AIRCRAFT} aircraft")
        n, draw = int(entry[1]), np.random.Generator(np.random.Philox(key=int(entry[2] or 1)))
        self._phase_ms = (np.arange(n) * 1000) // n
        self._lat_deg, self._lon_deg = (draw.uniform(*side, n) for side in _BOX_DEG)
        self._track_deg, self._speed_mps = draw.uniform(0, 360, n), draw.uniform(60, 240, n)
        self._height_ft = draw.integers(50, 390, n) * 100
        names = list(KINDS)
        self._kind = draw.choice(names, n, p=[KINDS[name].share for name in names])
        self._start = draw.integers(0, _CYCLE_S, n)
        self._begun_ms = time.time_ns() // 1_000_000
        self._sent_ms = self._begun_ms

    def read(self, timeout_s: float) -> bytes | None:
        """Take the lines that are due: as :class:`navbound.live.source.Source` says."""
        time.sleep(timeout_s)
        now_ms = time.time_ns() // 1_000_000
        # What a busy machine did not send in time is not sent: late lines would say less than none.
        self._sent_ms = max(self._sent_ms, now_ms - 1000)
        # An aircraft sends at its phase of each second.
        due_ms = now_ms - (now_ms - self._phase_ms) % 1000
        who = np.flatnonzero(due_ms > self._sent_ms)
        who = who[np.argsort(due_ms[who], kind="stable")]
        self._sent_ms = now_ms
        return b"".join(self._line(int(a), int(due_ms[a])) for a in who)

    def _line(self, a: int, time_ms: int) -> bytes:
        since_s = (time_ms - self._begun_ms) / 1000.0
        kind, way_m = KINDS[self._kind[a]], self._speed_mps[a] * since_s
        misbehaves = (int(since_s) - int(self._start[a])) % _CYCLE_S < kind.seconds
        if misbehaves and self._kind[a] == "silent":
            return b""
        course = np.radians(self._track_deg[a])
        north_deg = way_m * np.cos(course) / METRES_PER_DEGREE
        east_deg = way_m * np.sin(course) / METRES_PER_DEGREE / np.cos(np.radians(self._lat_deg[a]))
        line: dict[str, object] = {
            "now": time_ms / 1000.0,
            "hex": f"{0x400000 + a:06x}",
            "type": "adsb_icao",
            "flight": f"NVB{a:05d}",
            "lat": round(self._lat_deg[a] + north_deg, 6),
            "lon": round(self._lon_deg[a] + east_deg, 6),
            "alt_geom": int(self._height_ft[a]),
            "gs": round(self._speed_mps[a] / MPS_PER_KT, 1),
            "track": round(self._track_deg[a], 2),
            "seen_pos": 0.0,
            "nic": 8,
            "nac_p": 9 + a % 3,
            "sil": 3,
            "version": 2,
        }
        if misbehaves:
            line |= kind.instead
        return json.dumps(line, separators=(",", ":")).encode() + b"\n"

    def skip(self, n_bytes: int) -> None:
        """What was sent is gone."""

    def close(self) -> None:
        """Nothing is open."""
