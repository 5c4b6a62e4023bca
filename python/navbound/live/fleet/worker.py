"""A worker: claims lanes, judges them, gives some back when others come, and ends when another has taken its place."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from navbound.live.fleet.lane_run import LaneRun
from navbound.live.fleet.reading import newest_status
from navbound.live.fleet.transport import FencedError, UnreachableError
from navbound.live.session import now_ns
from navbound.live.settings import Settings
from navbound.live.sinks import transition

if TYPE_CHECKING:
    from collections.abc import Callable

    from navbound import _core
    from navbound.live.fleet.transport import Transport

RENEW_S = 1.0
SILENT_S = 2.0
"""Time without any input, heartbeats included, after which the feeder counts as lost: all that a clock of the host decides. [s]"""


class Worker:
    """Works on the lanes of a fleet.

    Parameters
    ----------
    transport : Transport
        Of the fleet.
    report : callable, optional
        Takes each transition once it is written.
    say : callable, optional
        Takes sentences.

    Attributes
    ----------
    lanes : dict of int to LaneRun
        Those it has.
    n_transitions : int
        Written by it.
    """

    def __init__(
        self,
        transport: Transport,
        *,
        report: Callable[[dict[str, Any]], None] = lambda _: None,
        say: Callable[[str], None] = lambda _: None,
    ) -> None:
        self._transport, self._report, self._say = transport, report, say
        self.settings = Settings(**transport.record["settings"])
        self._live = transport.record.get("origin", {}).get("kind") == "live"
        self._core = self.settings.core()
        self.lanes: dict[int, LaneRun] = {}
        self.n_transitions = self.n_epochs = 0
        self._heard_s = time.monotonic()
        self._lost: int | None = None
        self._renewed_s = -RENEW_S
        self._came_in = [transport.came_in(lane) for lane in range(transport.n_lanes)]
        self._elsewhere = dict.fromkeys(range(transport.n_lanes), 0)

    def _took(self, rows: list[_core._TransitionRow]) -> None:
        for row in rows:
            self.n_transitions += 1
            self._report(transition.record(row, self.settings, replayed=not self._live))

    def run(self, *, stop: Callable[[], bool] = lambda: False, finishing: Callable[[], bool] = lambda: False) -> None:
        """Work until `stop`.

        Parameters
        ----------
        stop : callable
            Called each round.
        finishing : callable
            Whether the feeder has ended: then this ends as well, once every lane of the fleet is judged to its end and written out, by this
            worker or by one that lives. A lane whose worker is gone is taken over first.

        Raises
        ------
        FencedError
            Another worker took a lane over while this one did not answer: what it holds is not of now.
        """
        while not stop():
            self._share(everything=finishing())
            n_bytes = self._round()
            if n_bytes:
                self._heard_s = time.monotonic()
            elif finishing() and not self._waiting():
                break
            else:
                self._transport.wait()
            self._watch(n_bytes > 0)
        self.close()

    def _waiting(self) -> bool:
        """Whether any lane of the fleet may hold something that is not judged and out: what others have shown of theirs counts."""
        try:
            return any(self._judged_to(lane) < log.end() for lane, log in enumerate(self._came_in))
        except UnreachableError:
            return True

    def _judged_to(self, lane: int) -> int:
        """Position to which a lane is judged and out, as far as this worker knows. [B]."""
        if (run := self.lanes.get(lane)) is not None:
            return -1 if run.is_unsent else run.position
        self._elsewhere[lane] = max(self._elsewhere[lane], newest_status(self._transport, lane).get("position", 0))
        return self._elsewhere[lane]

    def _round(self) -> int:
        n = 0
        for run in self.lanes.values():
            n += run.step()
        return n

    def _share(self, *, everything: bool) -> None:
        """Say that it lives; claim free lanes up to its share, or all that nobody has; give back what is above it."""
        if time.monotonic() - self._renewed_s < RENEW_S:
            return
        self._renewed_s = time.monotonic()
        if taken := self._transport.renew():
            raise FencedError(f"lane {taken[0]} was taken over by another worker while this one did not answer")
        try:
            share = self._transport.n_lanes if everything else -(-self._transport.n_lanes // max(1, self._transport.n_workers()))
        except UnreachableError:
            # What it has it keeps: lanes given back now would be restored and judged again once somebody answers.
            return
        for lane in range(self._transport.n_lanes):
            if len(self.lanes) >= share:
                break
            if lane not in self.lanes and self._transport.claim(lane):
                try:
                    self.lanes[lane] = LaneRun(self._transport, lane, self._core, report=self._took, say=self._say)
                except UnreachableError:
                    # What was restored so far is begun again once somebody answers.
                    self._transport.release(lane)
                    break
        if len(self.lanes) > share:
            lane, run = self.lanes.popitem()
            self._give_back(run)
            self._say(f"lane {lane} given back")

    def _give_back(self, run: LaneRun) -> None:
        self.n_epochs += run.n_epochs
        run.release()

    def _watch(self, heard: bool) -> None:
        """Whether the feeder lives: one alert of the feed, none of an aircraft."""
        if heard and self._lost is not None:
            self._feed("cleared", self._lost)
            self._lost = None
        elif not heard and self._lost is None and self._live and self.lanes and time.monotonic() - self._heard_s > SILENT_S:
            self._lost = now_ns()
            self._feed("raised", self._lost)

    def _feed(self, turn: str, annunciation_ns: int) -> None:
        now, key = now_ns(), f"feed:source/0/feed_lost/{annunciation_ns}/{turn}"
        clear = now if turn == "cleared" else None
        times = (annunciation_ns, annunciation_ns, clear, now, None, now)
        row = ((key, None, 0, "feed_lost", turn), times, (float("nan"),) * 3, 0)
        self._report(transition.record(row, self.settings, replayed=False))

    def counters(self) -> dict[str, float]:
        """What the lanes that it has counted, together."""
        total: dict[str, float] = {}
        for run in self.lanes.values():
            for name, n in run.counters().items():
                total[name] = total.get(name, 0) + n
        return total

    def close(self) -> None:
        """Keep every state and give the lanes back."""
        for run in self.lanes.values():
            self._give_back(run)
        self.lanes.clear()
