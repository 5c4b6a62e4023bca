"""What a session counted, as Prometheus reads it: text, version 0.0.4. No label names an aircraft."""

from __future__ import annotations

import bisect
from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from navbound import __version__, _core
from navbound.live import journal
from navbound.live.session import origin_of
from navbound.live.settings import load
from navbound.live.sinks import transition
from navbound.live.tail import Tail

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from navbound.live.settings import Settings

KIND = "text/plain; version=0.0.4; charset=utf-8"
LATENCIES_S = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0)
"""Upper ends of the classes of latency of alerts. [s]"""
_OUTCOMES = ("accepted", "duplicate", "late", "stale", "waiting_duplicate")


@dataclass
class Counts:
    """What stands in the journal out, counted.

    Attributes
    ----------
    epochs : Counter of str
        By status.
    transitions : Counter of (str, str)
        By kind and transition.
    latencies : list of int
        Alerts by class of latency; the last has no upper end.
    latency_s : float
        Sum of all. [s]
    n_late : int
        Later than the time to alert.
    """

    epochs: Counter[str] = field(default_factory=Counter)
    transitions: Counter[tuple[str, str]] = field(default_factory=Counter)
    latencies: list[int] = field(default_factory=lambda: [0] * (len(LATENCIES_S) + 1))
    latency_s: float = 0.0
    n_late: int = 0

    def see(self, statuses: Iterable[str], transitions: Iterable[Mapping[str, Any]]) -> None:
        """Count some more."""
        self.epochs.update(statuses)
        for each in transitions:
            self.transitions[each["kind"], each["transition"]] += 1
            latency_s = each["latency_s"]
            if latency_s is not None:
                self.latencies[bisect.bisect_left(LATENCIES_S, latency_s)] += 1
                self.latency_s += latency_s
                self.n_late += not each["within_time_to_alert"]

    @property
    def open(self) -> Counter[str]:
        """Alerts in force, by kind."""
        raised = Counter({kind: n for (kind, turn), n in self.transitions.items() if turn == "raised"})
        raised.subtract({kind: n for (kind, turn), n in self.transitions.items() if turn != "raised"})
        return raised

    def lines(self) -> list[str]:
        """As Prometheus reads it."""
        by_status = {f'status="{s}"': n for s, n in sorted(self.epochs.items())}
        return [*family("navbound_epochs_total", "counter", "Epochs by status.", by_status), *self.alert_lines()]

    def alert_lines(self) -> list[str]:
        """What is counted of alerts."""
        late, cumulated, sums = self.n_late, 0, list[str]()
        for upper, n in zip((*map(str, LATENCIES_S), "+Inf"), self.latencies, strict=True):
            cumulated += n
            sums.append(f'navbound_alert_latency_seconds_bucket{{le="{upper}"}} {cumulated}')
        return [
            *family(
                "navbound_alerts_total",
                "counter",
                "Transitions of alerts.",
                {f'kind="{kind}",transition="{turn}"': n for (kind, turn), n in sorted(self.transitions.items())},
            ),
            *family("navbound_open_alerts", "gauge", "Alerts in force.", {f'kind="{kind}"': n for kind, n in sorted(self.open.items())}),
            *family("navbound_alerts_late_total", "counter", "Alerts later than the time to alert.", {"": late}),
            "# HELP navbound_alert_latency_seconds From the time of what decided an alert to its writing.",
            "# TYPE navbound_alert_latency_seconds histogram",
            *sums,
            f"navbound_alert_latency_seconds_sum {self.latency_s!r}",
            f"navbound_alert_latency_seconds_count {cumulated}",
        ]


class Taken:
    """What the lane counted of its records, as of the last snapshot of the session."""

    def __init__(self, folder: Path, settings: Settings) -> None:
        self._path, self._settings = folder / journal.SNAPSHOT, settings
        self._read: int | None = None
        self.counters: dict[str, float] = {}
        self.n_unread = 0
        self.n_tracks: int | None = None
        self.written_s: float | None = None

    def poll(self) -> None:
        """Read the snapshot where it is a new one; one that is replaced while it is read is left to the next look."""
        try:
            status = self._path.stat()
            if status.st_mtime_ns == self._read:
                return
            lane, _, _ = _core.LiveLane.restore(self._settings.core(), self._path.read_bytes())
        except (OSError, ValueError):
            return
        self._read, self.written_s = status.st_mtime_ns, status.st_mtime
        self.counters, self.n_tracks = dict(lane.counters()), lane.n_tracks
        self.n_unread = sum(lane.passed_over().values())

    def lines(self) -> list[str]:
        """As Prometheus reads it."""
        if self.n_tracks is None:
            return []
        return [
            *family(
                "navbound_records_total",
                "counter",
                "Records and frames by what became of them, as of the last snapshot.",
                {f'outcome="{name}"': int(n) for name, n in outcomes(self.counters).items()},
            ),
            *family(
                "navbound_bytes_total", "counter", "Bytes of the source, as of the last snapshot.", {"": int(self.counters["n_bytes"])}
            ),
            # Without their names: text from the air is no label.
            *family(
                "navbound_unread_keys_total", "counter", "Keys of records that nothing reads, as of the last snapshot.", {"": self.n_unread}
            ),
            *family("navbound_tracks", "gauge", "Tracks that are watched, as of the last snapshot.", {"": self.n_tracks}),
        ]


def outcomes(counters: Mapping[str, float]) -> dict[str, float]:
    """Records and frames by what became of them."""
    taken = {name: counters.get(f"n_{name}", 0) for name in _OUTCOMES}
    return taken | {name: n for name, n in counters.items() if name.startswith("refused_")}


def family(name: str, kind: str, words: str, values: Mapping[str, float]) -> list[str]:
    """One metric with its labels."""
    rows = [f"{name}{f'{{{labels}}}' if labels else ''} {value}" for labels, value in values.items()]
    return [f"# HELP {name} {words}", f"# TYPE {name} {kind}", *rows] if rows else []


def assumed_lines(settings: Settings) -> list[str]:
    """What the user assumes of the accuracy, as Prometheus reads it; nothing where nothing is."""
    values = {} if settings.sigma_m is None else {"": settings.sigma_m}
    return family("navbound_assumed_sigma_metres", "gauge", "Standard deviation of each axis that the user stated.", values)


def text(parts: Iterable[Iterable[str]]) -> str:
    """The whole answer."""
    build = family("navbound_build_info", "gauge", "Version.", {f'version="{__version__}"': 1})
    return "".join(f"{line}\n" for part in (build, *parts) for line in part)


def of(folder: Path) -> str:
    """What a session counted until now.

    Raises
    ------
    FormatError
        Not the folder of a session, or a damaged journal.
    """
    settings = load(folder / journal.SETTINGS)
    counts, taken, out = Counts(), Taken(folder, settings), Tail(folder / journal.OUT)
    origin, behind = origin_of(folder), True
    while behind:
        frames, behind = out.frames(), out.behind
        if frames:
            counts.see(_core.live_epochs(frames)["status"], transition.records(frames, settings, origin=origin))
    taken.poll()
    return text([assumed_lines(settings), counts.lines(), taken.lines()])
