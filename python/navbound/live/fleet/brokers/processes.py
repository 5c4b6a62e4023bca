"""The mark of a process, and whether the one that left a mark is gone: known for certain only on its own host, and where Linux tells.

A worker that was killed is so followed at once by one beside it, and not after the time in which it would have said that it lives. Nothing
rests on it that a fence does not hold as well: who is wrongly believed gone is shut out of its logs.
"""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path
from typing import NamedTuple

_PROCESSES = Path("/proc")


@cache
def _host() -> str:
    """Which start of which system, and the numbers that processes have in this container; empty where the system tells neither."""
    try:
        boot = (_PROCESSES / "sys/kernel/random/boot_id").read_text().strip()
        return f"{boot}/{os.stat(_PROCESSES / 'self/ns/pid').st_ino}@{os.uname().nodename}"
    except OSError:
        return ""


def mark() -> str:
    """Of this process: host, number and time of start, together of no other; empty where the system does not tell."""
    entry = _entry(os.getpid())
    return f"{_host()}#{os.getpid()}/{entry.began}" if _host() and entry else ""


def is_gone(of: str) -> bool:
    """Whether the process with a mark has surely ended. False for one of another host, and wherever it cannot be known."""
    host, _, process = of.rpartition("#")
    number, _, began = process.partition("/")
    if not host or host != _host() or not (number.isascii() and number.isdigit()):
        return False
    try:
        # A process of another user is there and refuses.
        os.kill(int(number), 0)
    except ProcessLookupError:
        return True
    except (OSError, OverflowError):
        return False
    now = _entry(int(number))
    # Another process has its number by now, or its parent does not know yet how it ended.
    return now is not None and (now.began != began or now.is_ended)


class _Entry(NamedTuple):
    began: str
    is_ended: bool


def _entry(number: int) -> _Entry | None:
    """What the system tells of a process: when it began, in ticks, and whether none of its threads is left."""
    place = _PROCESSES / str(number)
    try:
        fields = (place / "stat").read_text().rpartition(")")[2].split()
        return _Entry(fields[19], fields[0] in {"Z", "X"} and len(os.listdir(place / "task")) <= 1)
    except OSError:
        return None
