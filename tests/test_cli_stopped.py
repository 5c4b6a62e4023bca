"""Ctrl-C: a command ends at once wherever its work is, says what was kept and how to go on, and leaves nothing that reads as whole."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from navbound.exit_status import MEANINGS, STOPPED

AT_ONCE_S = 1.0
BUSY_S = 9.0
"""What a test machine that does other things may add."""


def begun(folder: Path, *arguments: str) -> tuple[subprocess.Popen[str], Path]:
    """A command that is in the middle of its work."""
    reported = folder / "progress"
    environment = os.environ | {"NAVBOUND_PROGRESS": str(reported)}
    process = subprocess.Popen(
        [sys.executable, "-m", "navbound", *arguments],
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    until = time.monotonic() + 120.0
    while not reported.exists():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < until
        time.sleep(0.05)
    return process, reported


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ([], "Nothing was kept: results appear whole at the end, and what stood there before still stands."),
        (["--checkpoint", "parts", "--backend", "processes"], "Finished parts are kept in parts: the same command goes on from there."),
    ],
)
def test_ctrl_c_ends_a_command_at_once_and_says_what_was_kept(options: list[str], words: str, tmp_path: Path) -> None:
    process, reported = begun(tmp_path, "map", "araim", "--step-deg", "2", *options)
    began = time.monotonic()
    # As a terminal does: to the command and to what it started.
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=60)
    took = time.monotonic() - began
    assert process.returncode == STOPPED == 130
    assert err.strip().splitlines()[-1] == f"navbound: stopped. {words}"
    assert "Traceback" not in err
    assert out == ""
    assert took < AT_ONCE_S + BUSY_S
    assert json.loads(reported.read_text())["total"] > 1
    assert not (tmp_path / "out" / "map-araim" / "manifest.json").exists()
    # What another job finds there is no obstacle: the lock has ended with the process.
    assert STOPPED in MEANINGS
