"""Small outputs of the shipped scenarios, kept in the repository: a change of any number shows up in the review as a diff.

They say what moved, not what is right. `./dev golden` rewrites them; the test compares.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import navbound
from navbound import ins, scenario
from navbound.run import fly
from navbound.run.directory import Run
from navbound.run.judge import judge

FOLDER = Path(__file__).parent / "golden"
DIGITS = 10
"""Significant digits kept; the same bits are expected everywhere, one rounding is allowed for."""


def outcome(run: Run) -> dict[str, Any]:
    """The numbers of a run that a user would notice."""
    summary = run.summary
    epochs = run.epochs
    every = [*range(0, epochs.height, 1180)]
    columns = ("est_lat_rad", "est_lon_rad", "fte_m", "nse_cross_m", "tse_exact_m", "tse_exact_integrity_m", "anp_circle_m", "anp_sphere_m")
    return {
        "share_inside": _short(summary.verdict.share_inside),
        "phases": [{k: _short(v) for k, v in p.model_dump().items()} for p in summary.phases],
        "accuracy": {m.id: {"mean_m": _short(m.mean_m), "coverage": _short(m.coverage)} for m in summary.accuracy},
        "alerts": [[e.kind, e.onset_ns, e.clear_ns, _short(e.peak_m)] for e in summary.events],
        "epochs": {name: [_short(v) for v in epochs[name].gather(every).to_list()] for name in columns},
    }


def sensed(flown: ins.Sensed) -> dict[str, Any]:
    """A few rows of the measurements of a sensed flight; inertial samples are derivatives of the path and keep fewer digits."""
    tables = ("satellites", "dme", "vor", "baro", "clock")
    return {
        name: {"rows": table.height}
        | {c: [_short(v) for v in table[c].gather_every(max(table.height // 4, 1)).to_list()] for c in table.columns}
        for name in tables
        for table in [getattr(flown, name)]
    }


def taxied(run: Run) -> dict[str, Any]:
    """The numbers of a landing and the taxi-in."""
    columns = ("est_lat_rad", "est_lon_rad", "ground_speed_mps", "fte_m", "nse_e_m", "nse_n_m", "hpl_m", "hpl_multi_m", "tse_exact_m")
    rows = run.epochs.gather_every(20)
    return {
        "protection": [{k: _short(v) for k, v in p.model_dump().items()} for p in run.summary.protection],
        "events": [[e.kind, e.onset_ns, e.clear_ns, _short(e.peak_m)] for e in run.summary.events],
        "epochs": {name: [_short(v) for v in rows[name].to_list()] for name in columns},
    }


FLOWN = {"beijing-shanghai-flown": "beijing-shanghai", "beijing-shanghai-jammed-flown": "beijing-shanghai-jammed"}
"""Kept besides the measurements: flights on them, with ten inertial samples a second."""
_LAID_OVER = {
    f"beijing-shanghai-{name}" for name in ("white", "satellite-wrong", "dme-wrong", "imu-jump", "baro-blocked", "spoofed-approach")
}
"""Their measurements are those of others but for a fault that tests/test_fused.py looks at."""


def names() -> list[str]:
    """Every file that is kept."""
    return [*sorted(set(scenario.shipped()) - _LAID_OVER), *FLOWN]


def kept(name: str) -> dict[str, Any]:
    """What is kept of a scenario: its run; its measurements where it has sensors; a flight on them; its way to the stand."""
    if name in FLOWN:
        loaded = scenario.load(FLOWN[name])
        assert loaded.sensors is not None
        slow = loaded.model_copy(update={"sensors": loaded.sensors.model_copy(update={"rate_hz": 10})})
        run = judge(fly.material(slow))
        return outcome(run) | {"nav_mode": run.epochs["nav_mode"].gather_every(590).to_list()}
    if isinstance(scenario.read(name), scenario.Taxi):
        return taxied(navbound.fly(name))
    loaded = scenario.load(name)
    return outcome(navbound.fly(name)) if loaded.sensors is None else sensed(ins.simulate(loaded))


def _short(value: Any) -> Any:
    return float(f"{value:.{DIGITS}g}") if isinstance(value, float) else value


def main() -> None:
    """Write every golden file."""
    FOLDER.mkdir(exist_ok=True)
    for name in names():
        text = json.dumps(kept(name), indent=1)
        (FOLDER / f"{name}.json").write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    if "--write" not in sys.argv:
        sys.exit("golden: --write rewrites the files under review")
    main()
