"""How long does it hold: the time from the loss of all aids but the inertial unit until an RNP is exceeded."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from navbound import anp
from navbound.ins.coasting import AIDED, SPECIFICATION, coasting_hold_s, drift_hold_s
from navbound.records.prediction import Hold
from navbound.scenario.sensors import grades, with_grade
from navbound.scenario.units import to_si
from navbound.table.columns import HORIZONTAL
from navbound.units import METRES_PER_NM

if TYPE_CHECKING:
    from navbound.run.expected.setup import Setup

RNP_NM = (0.3, 1.0, 4.0, 10.0)
LONGEST_S = 4 * 3600.0
DRIFT_MPS = 2.0 * METRES_PER_NM / 3600.0
"""95 % circle of an inertial system as approved: 14 CFR 121, appendix G; standard."""
EPU0_M = 0.05 * METRES_PER_NM
LOST_AT = 1.0 / 3.0
"""The filter loses its aids after this part of the flight."""


def hold(setup: Setup) -> list[Hold]:
    """Every RNP by every model: a drift rate, one channel, and the filter of the flight with units of each grade."""
    lines = []
    for nm in RNP_NM:
        rnp_m = nm * METRES_PER_NM
        drift = drift_hold_s(rnp_m, 0.0, EPU0_M, DRIFT_MPS, "epu")
        lines.append(Hold(rnp_m=rnp_m, model="drift 2 NM/h", provenance="standard", hold_s=drift, longest_s=float("1e6")))
        for name, unit in (("one channel, by specification", SPECIFICATION), ("one channel, aided before", AIDED)):
            lasts = coasting_hold_s(unit, rnp_m, LONGEST_S)
            lines.append(Hold(rnp_m=rnp_m, model=name, provenance="inferred", hold_s=lasts, longest_s=LONGEST_S))
    for grade in (name for name in grades() if name != "perfect"):
        lines += _by_filter(setup, grade)
    return lines


def _by_filter(setup: Setup, grade: str) -> list[Hold]:
    """The filter of the flight with a unit of a grade; satellites and stations are lost in its course, the altimeter stays."""
    lost_s = float(round(setup.scenario.duration_s * LOST_AT))
    left_s = setup.scenario.duration_s - lost_s
    imu = to_si(with_grade({"sensors": {"imu": {"grade": grade}}}), {})["sensors"]["imu"]
    fault = {"kind": "interference", "start_s": lost_s, "duration_s": left_s + 1.0}
    stations = [s.name for s in setup.scenario.sensors.stations] if setup.scenario.sensors else []
    faults = [fault]
    if stations:
        faults.append({"kind": "station-outage", "start_s": lost_s, "duration_s": left_s + 1.0, "stations": stations})
    columns = setup.sensors(imu=imu, faults=faults).error_free()
    after = np.flatnonzero((np.arange(len(columns["time_ns"])) > lost_s) & (columns["available"] == 1))
    ee, en, nn = (np.asarray(columns[name])[after] for name in HORIZONTAL)
    circle = anp.circle(np.stack([np.stack([ee, en], -1), np.stack([en, nn], -1)], -2), 0.05)
    lines = []
    for nm in RNP_NM:
        beyond = np.flatnonzero(circle > nm * METRES_PER_NM)
        lasts = float(after[beyond[0]] - lost_s) if len(beyond) else None
        model = f"filter of the flight, unit of {grade} grade"
        lines.append(Hold(rnp_m=nm * METRES_PER_NM, model=model, provenance="ours", hold_s=lasts, longest_s=left_s))
    return lines
