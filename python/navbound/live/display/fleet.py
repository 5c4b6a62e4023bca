"""What the workers of a fleet say, followed while they work: newest states of all tracks, alerts in force, and who works on what."""

from __future__ import annotations

import asyncio
import json
import time
from collections import Counter, deque
from dataclasses import dataclass, field
from http import HTTPStatus
from typing import TYPE_CHECKING, Any

from navbound import __version__, _core
from navbound.errors import NavboundError
from navbound.live.display.watch import FEED_LOST_S, alert_of, number, shown_transition, utc_s
from navbound.live.fleet.reading import Reader
from navbound.live.fleet.transport import connect
from navbound.live.session import now_ns
from navbound.live.settings import Settings
from navbound.live.sinks import metrics
from navbound.live.sinks.metrics import Counts
from navbound.serve import request
from navbound.serve.service import Options, Service, pages, shell
from navbound.status import REASONS

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from navbound.live.fleet.transport import Transport
    from navbound.serve import hub

WORKER_LOST_S = 3.0
"""Time without a word of a lane's worker, which speaks each second, after which nobody counts as working on it. [s]"""
MOST_TRACKS = 200_000
MOST_EVENTS = 300
STATUS_S = 0.5
"""Longest time between two words to a page: it takes two seconds of silence for a lost link. [s]"""
WITHOUT_SCRIPTS = "This page shows nothing without scripts. Nothing is monitored on this screen."
NUMBERS = (
    "est_lat_rad",
    "est_lon_rad",
    "accuracy_bound_m",
    "integrity_compared_m",
    "rnp_m",
    "fte_m",
    "nic",
    "nac_p",
    "sil",
)
FIELDS = ("track", "utc_s", "alerts", "status", "reason_id", *NUMBERS)
"""What a row of a track holds, in this order. A number that is none is null."""
LETTERS = {"warning": "W", "caution": "C", "unavailable": "U"}
Row = list[Any]


@dataclass
class FleetNews:
    """What is new: rows of tracks, and transitions."""

    states: dict[str, Row] = field(default_factory=dict)
    transitions: list[dict[str, Any]] = field(default_factory=list)

    def __bool__(self) -> bool:
        return bool(self.states or self.transitions)


class FleetWatch:
    """Follows a fleet.

    Parameters
    ----------
    transport : Transport
        Of the fleet.
    clock : callable
        Time that never goes back. [s]
    """

    def __init__(self, transport: Transport, clock: Callable[[], float] = time.monotonic) -> None:
        self._transport, self._clock = transport, clock
        self.settings = Settings(**transport.record["settings"])
        self.origin = {"kind": "recording", "source": ""} | transport.record["origin"]
        self._reader = Reader(transport)
        self.counts = Counts()
        self.rows: dict[str, Row] = {}
        self.n_hidden = 0
        self.open: dict[str, dict[str, Any]] = {}
        self._letters: dict[str, set[str]] = {}
        self.events: deque[dict[str, Any]] = deque(maxlen=MOST_EVENTS)
        self.n_transitions = 0
        self.acknowledged: set[str] = set()
        self.trouble: str | None = None
        self.behind = False
        self._lanes: dict[int, tuple[dict[str, Any], float]] = {}
        self._begun_s = clock()

    def poll(self) -> FleetNews:
        """Read on. What cannot be read is trouble that every page shows."""
        news = FleetNews()
        try:
            for lane in range(self._transport.n_lanes):
                for status, states in self._transport.shown(lane):
                    self._lanes[lane] = (json.loads(status), self._clock())
                    if states:
                        self._states(_core.live_epochs(states), news)
            records = self._reader.more()
            self.behind = bool(records)
            for record in records:
                self._transition(record, news)
            self.counts.see((), records)
        except (NavboundError, OSError, ValueError) as e:
            self.trouble = str(e)
        return news

    def _states(self, columns: dict[str, Any], news: FleetNews) -> None:
        numbers = [columns[name] for name in NUMBERS]
        for i, track in enumerate(columns["track"]):
            if track not in self.rows and len(self.rows) >= MOST_TRACKS:
                self.n_hidden += 1
                continue
            times = [track, utc_s(int(columns["time_ns"][i])), self._alerts(track), columns["status"][i], columns["reason_id"][i]]
            self.rows[track] = news.states[track] = [*times, *(number(float(x[i])) for x in numbers)]

    def _alerts(self, track: str) -> str:
        """Letters of the alerts in force of a track, the gravest first."""
        have = self._letters.get(track, ())
        return "".join(letter for kind, letter in LETTERS.items() if kind in have)

    def _transition(self, record: dict[str, Any], news: FleetNews) -> None:
        shown, alert = shown_transition(record), alert_of(record["key"])
        self.n_transitions += 1
        self.events.append(shown)
        news.transitions.append(shown)
        track, kind, raised = record["track"], record["kind"], record["transition"] == "raised"
        if raised:
            self.open[alert] = shown
        else:
            self.open.pop(alert, None)
            self.acknowledged.discard(alert)
        if track is None:
            return
        have = self._letters.setdefault(track, set())
        have.add(kind) if raised else have.discard(kind)
        if record["transition"] == "expired":
            self.rows.pop(track, None)
            self._letters.pop(track, None)
            news.states[track] = [track]
        elif track in self.rows:
            row = self.rows[track]
            row[FIELDS.index("alerts")] = self._alerts(track)
            news.states[track] = row

    def status(self) -> dict[str, Any]:
        """How old everything is now, by the clock of this host; of a recording, by its own newest time."""
        lanes = []
        for lane in range(self._transport.n_lanes):
            report, at_s = self._lanes.get(lane, ({}, self._begun_s))
            silent_s = round(self._clock() - at_s, 2)
            waiting = {name: report.get(name) for name in ("n_tracks", "lag_s", "position")}
            lanes.append({"lane": lane, "silent_s": silent_s, "worked": bool(report) and silent_s <= WORKER_LOST_S, **waiting})
        events = [report["event_ns"] for report, _ in self._lanes.values() if report.get("event_ns") is not None]
        live = self.origin["kind"] == "live"
        now_utc_s = utc_s(now_ns() if live else max(events)) if live or events else None
        worst = Counter((self._alerts(track) or "N")[0] for track in self.rows)
        return {
            "feed": self.feed(),
            "now_utc_s": now_utc_s,
            "lanes": lanes,
            "n_tracks": len(self.rows),
            "counts": dict(worst),
            "n_hidden": self.n_hidden,
            "trouble": self.trouble,
        }

    def feed(self) -> str:
        """``live``, ``ended`` (of a recording), or ``lost``: workers speak, and say that the feeder does not."""
        if self.trouble is not None:
            return "lost"
        if self.origin["kind"] != "live":
            return "ended"
        spoken = [(report, at_s) for report, at_s in self._lanes.values() if self._clock() - at_s <= WORKER_LOST_S]
        if not spoken:
            return "lost"
        heard = [report["heard_s"] + self._clock() - at_s for report, at_s in spoken if report.get("heard_s") is not None]
        return "lost" if not heard or min(heard) > FEED_LOST_S else "live"

    def health(self) -> tuple[bool, dict[str, Any]]:
        """Whether the fleet is lost, and what /health says."""
        status = self.status()
        idle = [lane["lane"] for lane in status["lanes"] if not lane["worked"]]
        lost = status["feed"] == "lost" or len(idle) == len(status["lanes"])
        word = "lost" if lost else "degraded" if idle or self.open else "ok"
        last = self.events[-1]["key"] if self.events else None
        return lost, {"status": word, "lanes_without_worker": idle, "last_alert": last, "version": __version__}

    def metrics(self, clients: int) -> str:
        """What was counted, for Prometheus. No label names an aircraft."""
        status, report = self.status(), [report for report, _ in self._lanes.values()]
        family, own = metrics.family, list[str]()
        total: Counter[str] = Counter()
        for one in report:
            total.update({name: int(n) for name, n in one.get("counters", {}).items()})
        outcomes = {f'outcome="{name}"': n for name, n in sorted(metrics.outcomes(total).items())}
        own += family("navbound_records_total", "counter", "Records and lines by what became of them.", outcomes)
        own += family("navbound_tracks", "gauge", "Tracks that are watched.", {"": sum(one.get("n_tracks", 0) for one in report)})
        lanes = {f'lane="{lane["lane"]}"': lane for lane in status["lanes"]}
        own += family(
            "navbound_lane_worked",
            "gauge",
            "1 while a worker says that it works on the lane.",
            {k: int(v["worked"]) for k, v in lanes.items()},
        )
        lags = {k: v["lag_s"] for k, v in lanes.items() if v["lag_s"] is not None}
        own += family("navbound_lag_seconds", "gauge", "Age of the newest input when its lane was judged last.", lags)
        own += family("navbound_feed_up", "gauge", "1 while the feeder says that it is alive.", {"": int(status["feed"] == "live")})
        own += family("navbound_display_clients", "gauge", "Pages that are open.", {"": clients})
        return metrics.text([self.counts.alert_lines(), own])

    def session(self) -> dict[str, Any]:
        """What does not change while the fleet runs."""
        s = self.settings
        return {
            "run": self._transport.name,
            "fields": FIELDS,
            "origin": self.origin,
            "rnp_m": s.rnp_m,
            "rnp_table": s.rnp_table,
            "stale_s": s.stale_s + s.lateness_s,
            "risk_accuracy": s.risk_accuracy,
            "risk_integrity": s.risk_integrity,
            "n_lanes": self._transport.n_lanes,
            "reasons": {name: reason.words for name, reason in REASONS.items()},
        }

    def snapshot(self) -> dict[str, Any]:
        """Everything a page shows."""
        open_of_feed = [shown for shown in self.open.values() if shown["track"] is None]
        return {
            "session": self.session(),
            "rows": list(self.rows.values()),
            "feed_alerts": open_of_feed,
            "events": list(self.events),
            "n_transitions": self.n_transitions,
            "status": self.status(),
        }


class FleetServer(Service):
    """The page of a fleet.

    Parameters
    ----------
    watch : FleetWatch
        The fleet.
    options : Options
        How.
    """

    def __init__(self, watch: FleetWatch, options: Options) -> None:
        page = shell("navbound fleet", "fleet", WITHOUT_SCRIPTS, "display")
        super().__init__(options, pages(page, "fleet.js", "clock.js", "fleet.css"))
        self.watch = watch
        self._sent_s = 0.0
        self.handlers |= {("GET", "/health"): self._health, ("GET", "/metrics"): self._metrics}

    def turn(self, now_s: float) -> bool:
        """Report to the pages what the workers wrote and showed."""
        news = self.watch.poll()
        if news or now_s - self._sent_s >= STATUS_S:
            self._sent_s = now_s
            for each in news.transitions:
                self.hub.tell("alert", each)
            status = self.watch.status()
            for client in self.hub.clients.values():
                client.merge(news.states, status)
        return self.watch.behind

    def _health(self, _query: request.Request) -> bytes:
        lost, record = self.watch.health()
        code = HTTPStatus.SERVICE_UNAVAILABLE if lost else HTTPStatus.OK
        return request.answer(code, json.dumps(record).encode(), "application/json")

    def _metrics(self, _query: request.Request) -> bytes:
        return request.answer(HTTPStatus.OK, self.watch.metrics(len(self.hub.clients)).encode(), metrics.KIND)

    def snapshot(self, client: hub.Client) -> dict[str, Any]:
        """All of the fleet until now."""
        del client
        return self.watch.snapshot()


def beside_fleet(
    folder: Path, what: tuple[str, Options], ready: Callable[[str], None], say: Callable[[str], None], stop: Callable[[], bool]
) -> None:
    """Serve the page of a fleet in a process beside its feeder."""
    del folder, say  # a fleet may have no folder, and a display speaks on its pages
    name, options = what
    with connect(name, patience_s=10.0) as transport:
        server = FleetServer(FleetWatch(transport), options)
        ready(server.address)
        asyncio.run(server.run(stop))
