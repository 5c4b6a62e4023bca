"""Kafka as a transport: a topic for what came in and one for what went out, a partition a lane, and three for the rest.

Kafka writes every record that comes, so nothing of it can be written on a condition. A record of a log names the one that it was written
behind, and of two that name the same one the first counts (`numbered`): the order of a partition is the same for all who read it, so all
know which that is, and the writer of the other learns it before it goes on. Leases follow from the same order (`partition.Kept`). No
transaction, no group and no number of a producer takes part, so nothing of them can expire while a broker is away.

What cannot be had: a record that does not count stays in its topic, and who reads there without this library must apply the rule; what a
cluster loses by electing a leader that lacks records (`unclean.leader.election.enable`) is not recognised; a log keeps its newest bytes
and not a time, since a log without any record does not tell where it ended; encrypted connections and passwords are not built.
"""

from __future__ import annotations

import contextlib
import socket
import time
from collections import deque
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from navbound.errors import FormatError, InputError
from navbound.live.fleet.brokers import shared
from navbound.live.fleet.brokers.cluster import MOST_RECORD, Client, Following, header, partitions
from navbound.live.fleet.brokers.partition import KafkaLog, Kept
from navbound.live.fleet.brokers.shared import CONNECT_S, Broker
from navbound.live.fleet.transport import WAIT_S, UnreachableError

if TYPE_CHECKING:
    from confluent_kafka import Consumer

PORT = 9092
PART = "Navbound-Part"
MOST_KEPT = 64 << 20
"""Bytes of snapshots of a lane that the broker keeps. [B]"""
_SEGMENTS = 8
_SHOWN_MS = 60_000
_SMALL_SEGMENT = 1 << 20
_SNAPSHOTS = 2


class Kafka(Broker):
    """Topics of a cluster: as :class:`navbound.live.fleet.transport.Transport` says."""

    hint = "does the cluster let this client make and read topics?"

    def __init__(self, name: str) -> None:
        super().__init__(name, PORT)
        parts = urlsplit(self._server)
        if parts.username is not None or parts.password is not None:
            raise InputError("to", self.name, domain="kafka://host:port/NAME without a user: connections with passwords are not built")
        address = (str(parts.hostname), parts.port or PORT)
        try:
            # The client would look for a broker that was never there for ever.
            socket.create_connection(address, CONNECT_S).close()
        except OSError as e:
            raise FormatError(
                self.name, f"nobody answers ({type(e).__name__}); start a broker of Kafka there, or check host and port"
            ) from e
        self.client = Client(f"{address[0]}:{address[1]}", self.name)
        self._followings: list[Following] = []
        self._kept: Kept | None = None
        self._shows: Consumer | None = None
        self._shown: list[deque[tuple[bytes, bytes]]] = []

    def _topic(self, kind: str) -> str:
        return f"{self._fleet}-{kind}"

    def _make(self, n_lanes: int) -> None:
        there = self.client.topics()
        size: dict[str, object] = {"max.message.bytes": MOST_RECORD}
        required: dict[str, tuple[int, dict[str, object]]] = {
            self._topic("in"): (n_lanes, size | _newest_bytes(shared.MOST_BYTES)),
            self._topic("out"): (n_lanes, size | _newest_bytes(shared.MOST_BYTES)),
            self._topic("snapshots"): (n_lanes, size | _newest_bytes(MOST_KEPT)),
            self._topic("shown"): (n_lanes, size | {"retention.ms": _SHOWN_MS, "segment.ms": _SHOWN_MS}),
            self._topic("kept"): (1, {"cleanup.policy": "compact", "segment.bytes": _SMALL_SEGMENT, "min.cleanable.dirty.ratio": 0.1}),
        }
        # An operator may have made them with other settings; fewer partitions than lanes are of another fleet.
        for topic, (n, _) in required.items():
            if there.get(topic, n) < n:
                raise FormatError(self.name, f"the topic {topic} has {there[topic]} partitions for {n} lanes; choose another NAME")
        self.client.make({topic: how for topic, how in required.items() if topic not in there})

    def _keeps(self) -> Kept | None:
        if self._kept is None and self._topic("kept") in self.client.topics():
            self._kept = Kept(self.client, self._topic("kept"), self._seen.clear)
        return self._kept

    def _newest(self, *key: object) -> tuple[bytes, int] | None:
        kept = self._keeps()
        return None if kept is None else kept.newest(".".join(map(str, key)))

    def _put(self, key: tuple[object, ...], content: bytes, last: int | None = None) -> int | None:
        kept = self._keeps()
        if kept is None:
            raise FormatError(self.name, f"the topic {self._topic('kept')} is gone")
        return kept.put(".".join(map(str, key)), content, last)

    def _members(self) -> list[str]:
        kept, prefix = self._keeps(), "worker."
        return [] if kept is None else [key.removeprefix(prefix) for key in kept.names() if key.startswith(prefix)]

    def _remove(self, *key: object) -> None:
        if (kept := self._keeps()) is not None:
            kept.remove(".".join(map(str, key)))

    def _log(self, kind: str, lane: int, written: tuple[int, int] | None = None) -> KafkaLog:
        return KafkaLog(self, self._topic(kind), lane, written)

    def follow(self, log: KafkaLog, number: int) -> None:
        """Let the records of a log come from an offset on; two logs of one partition take two connections."""
        following = next((each for each in self._followings if each.takes(log)), None)
        if following is None:
            following = Following(self.client)
            self._followings.append(following)
        following.begin(log, number)

    def pump(self, wait_s: float) -> None:
        """Hand out records that have come."""
        for following in self._followings:
            following.pump(wait_s)
            wait_s = 0.0

    def keep(self, lane: int, snapshot: bytes) -> None:
        """Keep a snapshot; its parts know the whole that they are of."""
        for k, part in enumerate(shared.cut(snapshot)):
            self.client.send(self._topic("snapshots"), lane, part, headers={PART: str(k)})

    def kept(self, lane: int) -> list[bytes]:
        """Snapshots whose parts are all there, the newest first."""
        topic = self._topic("snapshots")
        first, behind = self.client.bounds(topic, lane)
        if first == behind:
            return []
        last = self.client.records(topic, lane, behind - 1, behind)[0].value() or b""
        # Two snapshots, what a writer that was killed left of a third, and what one that was shut out wrote between.
        begin = max(first, behind - 2 * (_SNAPSHOTS + 2) * shared.n_parts(last))
        parts: dict[bytes, list[bytes]] = {}
        whole = list[bytes]()
        for record in self.client.records(topic, lane, begin, behind):
            content = bytes(record.value() or b"")
            whole_of, k = shared.digest(content), int(header(record, PART) or 0)
            parts[whole_of] = [*(parts.get(whole_of, []) if k else []), content]
            if len(parts[whole_of]) == shared.n_parts(content) and (snapshot := shared.joined(parts[whole_of])) is not None:
                whole.append(snapshot)
        return whole[: -_SNAPSHOTS - 1 : -1]

    def show(self, lane: int, status: bytes, states: list[bytes]) -> None:
        """Newest states, to whoever reads them within a minute; nobody waits until they are written."""
        with contextlib.suppress(UnreachableError):
            for part in shared.shown_parts(status, states):
                self.client.write(self._topic("shown"), lane, part)

    def shown(self, lane: int) -> list[tuple[bytes, bytes]]:
        """Status and states that came since the last call."""
        if self._shows is None:
            self._shown = [deque(maxlen=shared.MOST_SHOWN) for _ in range(self.n_lanes)]
            ends = [self.client.bounds(self._topic("shown"), k)[1] for k in range(self.n_lanes)]
            # Who was away while they were removed goes on with the newest.
            self._shows = self.client.consumer(**{"auto.offset.reset": "latest"})
            self._shows.assign(partitions(self._topic("shown"), ends))
        while (record := self._shows.poll(0.0)) is not None:
            if record.error() is None and (shown := shared.shown_of(bytes(record.value() or b""))) is not None:
                self._shown[int(record.partition() or 0)].append(shown)
        taken = list(self._shown[lane])
        self._shown[lane].clear()
        return taken

    def wait(self) -> None:
        """Until a record came, or for a while."""
        if self._followings:
            self.pump(WAIT_S)
        else:
            time.sleep(WAIT_S)

    def close(self) -> None:
        """Give everything back."""
        self._give_back()
        for each in (*self._followings, self._kept, self._shows):
            if each is not None:
                each.close()
        self.client.close()


def _newest_bytes(most: int) -> dict[str, object]:
    """Settings of a topic whose oldest bytes go first, and none of whose go with time."""
    return {"retention.ms": -1, "retention.bytes": most, "segment.bytes": most // _SEGMENTS}
