"""Processes of our own do not hear Ctrl-C, from their first moment on."""

from __future__ import annotations

import os
import signal
import time

import pytest

from navbound.scale.spawned import CONTEXT, deaf_to_interrupts


@pytest.mark.parametrize("late_s", [0.0, 0.005, 0.02, 0.05, 0.3])
def test_a_child_that_begins_does_not_end_of_an_interrupt(late_s: float, capfd: pytest.CaptureFixture[str]) -> None:
    child = CONTEXT.Process(target=time.sleep, args=(0.5,))
    with deaf_to_interrupts():
        child.start()
    time.sleep(late_s)
    assert child.pid is not None
    os.kill(child.pid, signal.SIGINT)
    child.join(60)
    assert child.exitcode == 0
    assert capfd.readouterr().err == ""


def test_who_starts_a_process_hears_interrupts_again() -> None:
    with deaf_to_interrupts():
        assert signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, [])
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, [])
