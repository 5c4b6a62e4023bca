"""The flights of `navbound demo`: what a fault that lasts does, and the flight display with the spoofed approach."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import navbound
from navbound.exit_status import NO_VERDICT
from navbound.live.session import origin_of


def test_a_fault_that_lasts_keeps_what_follows() -> None:
    run = navbound.fly("beijing-shanghai-spoofed")
    (fault,) = run.summary.faults
    assert fault.moments[0].words == "spoofing begins"
    assert [m.time_ns for m in fault.moments] == sorted(m.time_ns for m in fault.moments)


def test_the_spoofed_approach_is_replayed_on_the_flight_display(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "navbound", "demo", "--live", "--out", str(tmp_path)]
    # No browser is opened on the machine of the test.
    quiet = {**os.environ, "BROWSER": "true"}
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=quiet) as process:
        assert process.stdout is not None
        sentences = list[str]()
        while not (sentences and sentences[-1].startswith("Display: http://127.0.0.1:")):
            sentences.append(process.stdout.readline())
            assert sentences[-1], "it ended before the display was there"
        # A minute of the flight.
        time.sleep(2.0)
        process.send_signal(signal.SIGINT)
        rest, trouble = process.communicate(timeout=30)
    # The rest of the recording was not judged.
    assert process.returncode == NO_VERDICT, trouble
    assert "stopped at byte" in rest + trouble
    assert "spoofing begins" in "".join(sentences)
    assert "epochs of 1 track, " in rest
    origin = origin_of(tmp_path / "session")
    assert (origin["kind"], origin["speed"]) == ("replay", 60.0)
    # The path ahead is that of the flight: from Beijing (40 N, 117 E) to Shanghai (31 N, 121 E), to a degree.
    (first, last) = (origin["points"][0], origin["points"][-1])
    assert [round(math.degrees(x)) for x in (*first[:2], *last[:2])] == [40, 117, 31, 121]
