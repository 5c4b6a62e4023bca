"""A process counts as gone only where its own host says so for certain."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from navbound.live.fleet.brokers import processes

LEFT = "from navbound.live.fleet.brokers import processes; print(processes.mark(), flush=True); input()"
HERE = processes.mark()

pytestmark = pytest.mark.skipif(not HERE, reason="SKIPPED ALOUD: this system does not tell which of its processes live")


def test_a_process_is_gone_once_it_was_killed_before_and_after_its_parent_knows() -> None:
    process = subprocess.Popen([sys.executable, "-c", LEFT], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    left = process.stdout.readline().strip()
    assert left.rpartition("#")[0] == HERE.rpartition("#")[0]
    assert not processes.is_gone(left)
    process.kill()
    os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT)
    assert processes.is_gone(left)
    process.communicate()
    assert processes.is_gone(left)


def test_a_number_that_another_process_has_by_now_is_of_one_that_is_gone() -> None:
    place, _, began = HERE.rpartition("/")
    assert not processes.is_gone(HERE)
    assert processes.is_gone(f"{place}/{int(began) - 1}")


@pytest.mark.parametrize(
    "of",
    [
        "",
        "#",
        "x",
        "#1/1",
        "elsewhere/1@other#999999999/1",
        HERE.partition("#")[0] + "#x/1",
        HERE.partition("#")[0] + "#9²/1",
        HERE.partition("#")[0] + f"#{10**30}/1",
    ],
)
def test_nothing_is_known_of_another_host_and_of_what_is_no_mark(of: str) -> None:
    assert not processes.is_gone(of)


def test_a_process_of_another_user_is_not_gone(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(_: int, __: int) -> None:
        raise PermissionError

    monkeypatch.setattr(os, "kill", refused)
    assert not processes.is_gone(HERE)
