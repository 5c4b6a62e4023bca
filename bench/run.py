"""Speed in one run: every bench module's figures with their goals, written to bench/results with the machine's description.

Wall clock on a shared machine means little; the ratio of two figures of the same run means something. Each figure is the least CPU time
of its repeats on one thread unless its note says otherwise.
"""

from __future__ import annotations

import argparse
import importlib
import json
import os
import platform
import sys
from datetime import UTC, datetime
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from clock import Row, show

MODULES = (
    "start",
    "calls",
    "tse",
    "anp",
    "runs",
    "sbas",
    "gbas",
    "gnss",
    "kpi",
    "dme",
    "sensors",
    "araim",
    "raim",
    "ins",
    "maps",
    "rnp",
    "procedures",
)
RESULTS = Path(__file__).parent / "results"


def machine() -> dict[str, object]:
    """What ran it."""
    model = "unknown"
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        model = next((line.split(":", 1)[1].strip() for line in cpuinfo.read_text().splitlines() if line.startswith("model name")), model)
    return {
        "processor": model,
        "cores": os.cpu_count(),
        "load_1min": os.getloadavg()[0],
        "system": platform.platform(),
        "python": platform.python_version(),
    }


def main() -> None:
    """Measure, print; write where everything was measured."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("modules", nargs="*", default=list(MODULES), help=f"of {', '.join(MODULES)}; nothing is written unless all are run")
    arguments = parser.parse_args()
    for name in arguments.modules:
        if name not in MODULES:
            parser.error(f"no bench {name}; there are {', '.join(MODULES)}")
    rows: list[tuple[str, Row]] = []
    for name in arguments.modules:
        print(f"== {name}")
        group: list[Row] = importlib.import_module(name).measure()
        show(group)
        rows += [(name, row) for row in group]
    goals = [row for _, row in rows if row.met is not None]
    missed = [row.name for row in goals if not row.met]
    if goals:
        print(f"{len(goals) - len(missed)} of {len(goals)} goals met" + (f"; not met: {', '.join(missed)}" if missed else ""))
    if set(arguments.modules) == set(MODULES):
        write(rows)


def write(rows: list[tuple[str, Row]]) -> None:
    """The results of today, beside the machine."""
    first = {group: row.seconds_per_item for group, row in reversed(rows)}
    results = [row._asdict() | {"met": row.met, "group": group, "ratio": row.seconds_per_item / first[group]} for group, row in rows]
    RESULTS.mkdir(exist_ok=True)
    stamp = datetime.now(UTC).strftime("%Y-%m-%d")
    out = RESULTS / f"{stamp}.json"
    out.write_text(json.dumps({"date": stamp, "machine": machine(), "results": results}, indent=1) + "\n")
    print(f"written to {out}")


if __name__ == "__main__":
    main()
