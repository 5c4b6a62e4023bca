"""What the journals of a session say, followed while they grow. Nothing here is judged: it is read, kept for a while, and handed on."""

from __future__ import annotations

import math
import time
from collections import deque
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from navbound import __version__, _core
from navbound.errors import FormatError
from navbound.live import journal
from navbound.live.session import now_ns, origin_of
from navbound.live.settings import COMPUTING_S, load
from navbound.live.sinks import metrics, transition
from navbound.live.sinks.metrics import Counts, Taken
from navbound.live.tail import Tail
from navbound.status import REASONS
from navbound.table.columns import HORIZONTAL
from navbound.time import utc_offset_s

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

GPS_EPOCH_UNIX_S = 315_964_800
"""Unix time of 1980-01-06 00:00:00 UTC. [s]"""
_HOUR_NS = 3_600_000_000_000
FEED_LOST_S = 2.5
"""Time without any input of a live source, whose reader says each second that it is alive, after which the reader counts as lost. [s]"""
HISTORY_S = 600.0
HISTORY_ROWS = 6000
MOST_TRACKS = 64
MOST_EVENTS = 500

WORDS = ("status", "reason_id", "alert", "nav_mode")
NUMBERS = (
    "accuracy_bound_m",
    "integrity_bound_m",
    "integrity_compared_m",
    "rnp_m",
    "fte_m",
    "sigma_cross_m",
    "hpl_m",
    "est_lat_rad",
    "est_lon_rad",
    "est_h_m",
    "fte_v_m",
    "course_rad",
    *HORIZONTAL,
    "anp_cross_m",
    "anp_circle_m",
    "anp_vertical_m",
    "vpl_m",
    "hal_m",
    "val_m",
    "n_sv",
    "caution_in_s",
)
FIELDS = ("utc_s", *WORDS, *NUMBERS)
"""What a row of an epoch holds, in this order. A number that is none is null."""
Row = list[Any]


@dataclass
class Track:
    """What is kept of one aircraft."""

    rows: deque[Row] = field(default_factory=lambda: deque(maxlen=HISTORY_ROWS))
    time_ns: int = 0
    arrival_ns: int | None = None
    read_s: float = 0.0

    def add(self, row: Row) -> None:
        """Keep an epoch, and forget what is older than the history. A clock that was set back begins a new one."""
        if self.rows and row[0] <= self.rows[-1][0]:
            self.rows.clear()
        self.rows.append(row)
        while self.rows[0][0] < row[0] - HISTORY_S:
            self.rows.popleft()


@dataclass(frozen=True)
class News:
    """What came since the last look: rows by track, transitions."""

    rows: dict[str, list[Row]]
    transitions: list[dict[str, Any]]

    def __bool__(self) -> bool:
        """Whether there is any."""
        return bool(self.rows or self.transitions)


class Watch:
    """The journals of a folder.

    Parameters
    ----------
    folder : Path
        Of a session that runs, or ran.
    clock : callable
        Time that never goes back. [s]

    Raises
    ------
    FormatError
        Not the folder of a session.
    """

    def __init__(self, folder: Path, clock: Callable[[], float] = time.monotonic) -> None:
        self.folder, self._clock = folder, clock
        self.settings = load(folder / journal.SETTINGS)
        self.origin = origin_of(folder)
        self.counts, self.taken = Counts(), Taken(folder, self.settings)
        self._in, self._out = Tail(folder / journal.IN), Tail(folder / journal.OUT)
        self.tracks: dict[str, Track] = {}
        self.n_hidden = 0
        self.open: dict[str, dict[str, Any]] = {}
        self.events: deque[dict[str, Any]] = deque(maxlen=MOST_EVENTS)
        self.n_transitions = 0
        self.acknowledged: set[str] = set()
        self.ended = False
        self.trouble: str | None = None
        self._input_s = clock()

    def poll(self) -> News:
        """Read on. A journal that cannot be read is trouble that every page shows."""
        rows: dict[str, list[Row]] = {}
        transitions: list[dict[str, Any]] = []
        try:
            self._inputs(self._in.frames())
            frames = self._out.frames()
            if frames:
                columns = _core.live_epochs(frames)
                self._epochs(columns, rows)
                transitions = self._transitions(frames)
                self.counts.see(columns["status"], transitions)
        except (FormatError, OSError, ValueError) as e:
            self.trouble = str(e)
        return News(rows, transitions)

    @property
    def behind(self) -> bool:
        """Whether more is there than was read at once."""
        return self._out.behind or self._in.behind

    def _inputs(self, frames: bytes) -> None:
        if not frames:
            return
        self._input_s = self._clock()
        self.ended = _core.live_inputs(frames)[-1][0] == "end"

    def _epochs(self, columns: dict[str, Any], rows: dict[str, list[Row]]) -> None:
        numbers = [columns[name] for name in NUMBERS]
        words = [columns[name] for name in WORDS]
        now = self._clock()
        for i, name in enumerate(columns["track"]):
            if not columns["accepted"][i]:
                # What the monitor did not take in order has no place on an axis of time, nor is it the present.
                continue
            track = self.tracks.get(name)
            if track is None:
                if len(self.tracks) >= MOST_TRACKS:
                    self.n_hidden += 1
                    continue
                track = self.tracks[name] = Track()
            time_ns = int(columns["time_ns"][i])
            row = [utc_s(time_ns), *(word[i] for word in words), *(number(x[i]) for x in numbers)]
            rows.setdefault(name, []).append(row)
            track.time_ns, track.arrival_ns, track.read_s = time_ns, columns["arrival_ns"][i], now
            track.add(row)

    def _transitions(self, frames: bytes) -> list[dict[str, Any]]:
        records = transition.records(frames, self.settings, origin=self.origin)
        shown = [shown_transition(record) for record in records]
        for each in shown:
            self.n_transitions += 1
            self.events.append(each)
            if each["transition"] == "raised":
                self.open[each["alert"]] = each
            else:
                self.open.pop(each["alert"], None)
                self.acknowledged.discard(each["alert"])
        return shown

    def status(self) -> dict[str, Any]:
        """How old everything is now, by the clock of this host."""
        return {
            "feed": self.feed(),
            "ages_s": {name: self._age_s(track) for name, track in self.tracks.items()},
            "silent_s": round(self._clock() - self._input_s, 2),
            "trouble": self.trouble,
            "n_hidden": self.n_hidden,
        }

    def feed(self) -> str:
        """``live``, ``ended``, or ``lost``: the reader of a live source does not even say that it is alive."""
        if self.trouble is not None:
            return "lost"
        if self.ended:
            return "ended"
        silent = self.origin["kind"] == "live" and self._clock() - self._input_s > FEED_LOST_S
        return "lost" if silent else "live"

    def _age_s(self, track: Track) -> float:
        """Of a live source the time since the data were true; of a recording the time since they were read."""
        if self.origin["kind"] == "live" and track.arrival_ns is not None:
            return round(max(0.0, (now_ns() - track.time_ns) / 1e9), 3)
        return round(self._clock() - track.read_s, 3)

    def stale_s(self) -> float:
        """Age from which data are stale on a page [s]. A recording that is read slowly sends slowly."""
        speed = self.origin.get("speed") or 1.0
        return self.settings.stale_s / min(1.0, speed)

    def session(self) -> dict[str, Any]:
        """What does not change while the session runs."""
        s = self.settings
        chain = {
            "sample period": s.sample_period_s,
            "transport": s.transport_s,
            "order": s.lateness_s,
            "computing": COMPUTING_S,
            "wait": s.raise_delay_s,
            "display": s.display_s,
        }
        return {
            "run": f"{self.folder.name}",
            "fields": FIELDS,
            "origin": self.origin,
            "rnp_m": s.rnp_m,
            "assumed": s.assumed,
            "path": s.path,
            "method": " or ".join(dict.fromkeys(s.methods)),
            "risk_accuracy": s.risk_accuracy,
            "risk_integrity": s.risk_integrity,
            "sample_period_s": s.sample_period_s,
            "stale_s": self.stale_s(),
            "monitor_stale_s": s.stale_s,
            "time_to_alert_s": s.time_to_alert_s,
            "chain": chain,
            "reasons": {name: reason.words for name, reason in REASONS.items()},
        }

    def health(self) -> tuple[bool, dict[str, Any]]:
        """Whether the session is lost, and what /health says."""
        status = self.status()
        lost, ages_s = status["feed"] == "lost", status["ages_s"].values()
        stale = not ages_s or min(ages_s) > self.stale_s()
        word = "lost" if lost else "degraded" if stale or self.open else "ok"
        last = self.events[-1]["key"] if self.events else None
        return lost, {"status": word, "age_s": min(ages_s, default=None), "last_alert": last, "version": __version__}

    def metrics(self, clients: int) -> str:
        """What was counted, for Prometheus."""
        self.taken.poll()
        status = self.status()
        known = status["ages_s"].values()
        ages = {'what="newest"': min(known), 'what="oldest"': max(known)} if known else {}
        written_s = self.taken.written_s
        own = [
            *metrics.family("navbound_event_age_seconds", "gauge", "Age of the data of the tracks that the display follows.", ages),
            *metrics.family(
                "navbound_feed_up", "gauge", "1 while the reader of the source says that it is alive.", {"": int(status["feed"] == "live")}
            ),
            *metrics.family("navbound_display_clients", "gauge", "Pages that are open.", {"": clients}),
        ]
        if written_s is not None:
            own += metrics.family(
                "navbound_snapshot_age_seconds", "gauge", "Age of the snapshot.", {"": round(max(0.0, time.time() - written_s), 1)}
            )
        return metrics.text([metrics.assumed_lines(self.settings), self.counts.lines(), self.taken.lines(), own])

    def snapshot(self, requested: str | None) -> dict[str, Any]:
        """Everything a page shows of one aircraft, and the alerts of all."""
        name = requested if requested in self.tracks else next(iter(self.tracks), None)
        return {
            "session": self.session(),
            "track": name,
            "tracks": list(self.tracks),
            "rows": list(self.tracks[name].rows) if name is not None else [],
            "open": list(self.open.values()),
            "events": list(self.events),
            "n_transitions": self.n_transitions,
            "acknowledged": sorted(self.acknowledged),
            "status": self.status(),
        }


_TIMES = ("annunciation", "onset", "clear", "event")


def shown_transition(record: dict[str, Any]) -> dict[str, Any]:
    """A transition as a page needs it: times in UTC seconds, and the name that raise and clear share."""
    times = {f"{name}_utc_s": None if record[f"{name}_ns"] is None else utc_s(record[f"{name}_ns"]) for name in _TIMES}
    lengths = {name: number(record[name]) for name in ("peak_m", "limit_m", "min_margin_m", "latency_s")}
    kept = {name: record[name] for name in ("key", "track", "kind", "transition", "within_time_to_alert", "position")}
    return {**kept, **times, **lengths, "alert": alert_of(record["key"])}


def utc_s(time_ns: int) -> float:
    """Unix time of a GPS time. [s]."""
    return time_ns / 1e9 + GPS_EPOCH_UNIX_S - _offset_s(time_ns // _HOUR_NS)


@lru_cache(maxsize=48)
def _offset_s(hour: int) -> int:
    return utc_offset_s(hour * _HOUR_NS)


def alert_of(key: str) -> str:
    """What raise and clear of one alert have in common: the key without its last part."""
    return key.rpartition("/")[0]


def number(value: float | None) -> float | None:
    """Twelve digits; what is no number is null."""
    return float(f"{value:.12g}") if value is not None and math.isfinite(value) else None
