"""Speed of navbound.ins.simulate: two hours at 200 Hz with every sensor; one thread.

An item is one sample of the inertial unit; a flight of the shipped scenario has 1.4 million.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from clock import Row, seconds, show
from navbound import ins, scenario


def measure() -> list[Row]:
    """One row a measurement."""
    full = scenario.load("beijing-shanghai")
    assert full.sensors is not None
    bare: dict[str, Any] = {"gnss": None, "dme": None, "vor": None, "baro": None}
    rows: list[Row] = []
    for name, sensors in (("truth and inertial unit", full.sensors.model_copy(update=bare)), ("every sensor", full.sensors)):
        flight = full.model_copy(update={"sensors": sensors})
        samples = ins.simulate(flight).imu.height
        best = seconds(partial(ins.simulate, flight), 3)
        rows.append(Row(name, best / samples, samples, f"{best:.2f} s a flight, route and tables included"))
    return rows


if __name__ == "__main__":
    show(measure())
