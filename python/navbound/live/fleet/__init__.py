"""Many aircraft: a feeder that writes their lines down by lane, workers that judge lanes, and what carries both.

`transport` is the contract, `files` and `brokers` hold it; `feeder` reads a source; `lane_run` judges one lane and survives being killed;
`worker` shares lanes with other workers; `crew` keeps workers alive on one host; `pretend` is a fleet for a first look.
"""

from __future__ import annotations

from navbound.live.fleet.feeder import Feeder
from navbound.live.fleet.transport import FencedError, UnreachableError, connect, create
from navbound.live.fleet.worker import Worker

__all__ = ["Feeder", "FencedError", "UnreachableError", "Worker", "connect", "create"]
