"""What a worker of a fleet loads: many of them share a host."""

from __future__ import annotations

import subprocess
import sys

PROGRAM = """
import sys
from navbound.live.fleet import worker
from navbound.live.settings import Settings

Settings(format="json", rnp_m=555.6).core()
print("polars" in sys.modules, "navbound.live.fleet.worker" in sys.modules)
"""


def test_a_worker_loads_no_library_of_tables() -> None:
    done = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.split() == ["False", "True"]
