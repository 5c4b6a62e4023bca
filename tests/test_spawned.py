"""Processes of our own do not hear Ctrl-C, from their first moment on, and begin whole wherever it is raised."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from navbound.scale.spawned import CONTEXT, deaf_to_interrupts


@pytest.mark.parametrize("late_s", [0.0, 0.005, 0.02, 0.05, 0.3])
def test_a_child_that_begins_does_not_end_of_an_interrupt(late_s: float, capfd: pytest.CaptureFixture[str]) -> None:
    child = CONTEXT.Process(target=time.sleep, args=(0.5,))
    deaf_to_interrupts(child.start)
    time.sleep(late_s)
    assert child.pid is not None
    os.kill(child.pid, signal.SIGINT)
    child.join(60)
    assert child.exitcode == 0
    assert capfd.readouterr().err == ""


def test_who_starts_a_process_hears_interrupts_still() -> None:
    assert signal.SIGINT in deaf_to_interrupts(lambda: signal.pthread_sigmask(signal.SIG_BLOCK, []))
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, [])


INTERRUPTED = '''
"""Ctrl-C comes between the birth of a child and its first data, with a thread beside the main one that takes the signal."""
import os, signal, threading, time
from multiprocessing import util
from navbound.scale.spawned import CONTEXT, deaf_to_interrupts

def work():
    print("worked", flush=True)

if __name__ == "__main__":
    threading.Thread(target=time.sleep, args=(30.0,), daemon=True).start()
    begun = threading.Thread.start

    def late(thread):
        begun(thread)
        time.sleep(LATE_S)

    threading.Thread.start = late
    spawn = util.spawnv_passfds

    def interrupted(path, args, fds):
        pid = spawn(path, args, fds)
        if b"resource_tracker" not in b" ".join(os.fsencode(a) for a in args):
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(0.2)
        return pid

    util.spawnv_passfds = interrupted
    child = CONTEXT.Process(target=work)
    try:
        deaf_to_interrupts(child.start)
    except KeyboardInterrupt:
        print("interrupted", flush=True)
    child.join(60)
'''


@pytest.mark.parametrize("late_s", [0.0, 1.0], ids=["main in time", "main late"])
def test_ctrl_c_between_the_birth_of_a_child_and_its_first_data_leaves_it_whole(late_s: float, tmp_path: Path) -> None:
    program = tmp_path / "interrupted.py"
    program.write_text(INTERRUPTED.replace("LATE_S", str(late_s)))
    done = subprocess.run([sys.executable, program], capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stderr, sorted(done.stdout.split())) == (0, "", ["interrupted", "worked"])


ENDED = """
import os
from navbound.scale.spawned import CONTEXT, deaf_to_interrupts

if __name__ == "__main__":
    lock = deaf_to_interrupts(CONTEXT.Lock)
    print(os.environ.get("PYTHONWARNINGS"), lock._semlock.name, flush=True)
    os._exit(130)
"""


@pytest.mark.parametrize("setting", [None, "default"])
def test_a_process_that_ends_at_once_leaves_no_words_of_others_and_no_semaphores(setting: str | None, tmp_path: Path) -> None:
    program = tmp_path / "ended.py"
    program.write_text(ENDED)
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONWARNINGS"}
    environment |= {} if setting is None else {"PYTHONWARNINGS": setting}
    done = subprocess.run([sys.executable, program], capture_output=True, text=True, timeout=60, check=False, env=environment)
    kept, semaphore = done.stdout.split()
    assert (done.returncode, done.stderr, kept) == (130, "", str(setting))
    assert not Path("/dev/shm", f"sem.{semaphore.removeprefix('/')}").exists()
