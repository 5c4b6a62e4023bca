"""Speed of navbound.ins.simulate: two hours at 200 Hz with every sensor; one thread, process CPU time.

An item is one sample of the inertial unit; a flight of the shipped scenario has 1.4 million.
"""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Any

from navbound import ins, scenario

if TYPE_CHECKING:
    from navbound.scenario import Scenario


def seconds(flight: Scenario, repeats: int = 3) -> tuple[float, int]:
    """Best CPU time of a flight, and its samples."""
    best, samples = math.inf, 0
    for _ in range(repeats):
        start = time.process_time()
        samples = ins.simulate(flight).imu.height
        best = min(best, time.process_time() - start)
    return best, samples


def measure() -> list[dict[str, object]]:
    """One row a measurement: name, seconds_per_item, n, note."""
    full = scenario.load("beijing-shanghai")
    assert full.sensors is not None
    bare: dict[str, Any] = {"gnss": None, "dme": None, "vor": None, "baro": None}
    rows: list[dict[str, object]] = []
    for name, sensors in (("truth and inertial unit", full.sensors.model_copy(update=bare)), ("every sensor", full.sensors)):
        best, samples = seconds(full.model_copy(update={"sensors": sensors}))
        rows.append(
            {"name": name, "seconds_per_item": best / samples, "n": samples, "note": f"{best:.2f} s a flight, route and tables included"}
        )
    return rows
