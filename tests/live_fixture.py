"""Journals for tests of live data: records with arrivals, faults on purpose, and the shared fleet where it is present."""

from __future__ import annotations

import json
import runpy
import sys
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from navbound import _core, live
from navbound.live import journal

SHARED = Path(__file__).parents[2] / "shared" / "live"
FLEET = live.Settings(format="json", rnp_m=555.6, method="tse-exact", lateness_s=1.0)
Sent = tuple[int, str]
"""Arrival [ns] and line."""


@cache
def fleet(n: int, seconds: int, seed: int = 1) -> tuple[Sent, ...]:
    """Records of the fleet that misbehaves on purpose."""
    if not SHARED.is_dir():
        pytest.skip(f"SKIPPED ALOUD: no fleet at {SHARED}")
    module = runpy.run_path(str(SHARED / "fleet.py"))
    return tuple((module["T0"] + round(send * 1e9), text + "}\n") for send, _, text in module["records"](n, seconds, seed))


@cache
def truth(n: int, seconds: int, seed: int = 1) -> tuple[frozenset[str], frozenset[str]]:
    """Keys of alerts raised and cleared by the batch monitor over the same fleet; a clear with its time."""
    fleet(n, seconds, seed)
    sys.path.insert(0, str(SHARED))
    try:
        raised, cleared, _, _ = runpy.run_path(str(SHARED / "reference.py"))["reference"](n, seconds, seed)
    finally:
        sys.path.remove(str(SHARED))
    return frozenset(raised), frozenset(f"{key}/{event['clear_ns']}" for key, event in cleared.items())


def frames(sent: Iterable[Sent], per_chunk: int = 50, *, heartbeats: bool = False) -> bytes:
    """A journal in: chunks of some records, each at the arrival of its last one, and a heartbeat each second."""
    out, waiting, beat = list[bytes](), list[Sent](), 0
    for each in sent:
        waiting.append(each)
        if len(waiting) == per_chunk:
            out.append(_chunk(waiting))
            waiting = []
            if heartbeats and each[0] >= beat:
                out.append(_core.live_input("heartbeat", each[0], b""))
                beat = each[0] + 1_000_000_000
    if waiting:
        out.append(_chunk(waiting))
    return b"".join([*out, _core.live_input("end", None, b"")])


def _chunk(sent: list[Sent]) -> bytes:
    return _core.live_input("chunk", sent[-1][0], "".join(line for _, line in sent).encode())


def recorded(folder: Path, content: bytes, settings: live.Settings = FLEET) -> Path:
    """A folder with a journal in and its settings, as a session leaves it."""
    folder.mkdir(parents=True)
    (folder / journal.IN).write_bytes(content)
    (folder / journal.SETTINGS).write_text(json.dumps({"settings": json.loads(settings.text())}))
    return folder


def transitions(folder: Path) -> list[dict[str, Any]]:
    """What was reported."""
    return [json.loads(line) for line in (folder / journal.EVENTS).read_text().splitlines()]


def generator(seed: int) -> np.random.Generator:
    """Counter-based: the same faults for the same seed."""
    return np.random.Generator(np.random.Philox(key=seed))
