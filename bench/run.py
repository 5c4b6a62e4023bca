"""Speed as ratios in one run: every bench module's figures, written to bench/results with the machine's description.

Wall clock on a shared machine means little; the ratio of two figures of the same run means something. Each figure is the best of its
repeats, on one thread unless its note says otherwise.
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

MODULES = ("tse", "anp", "runs", "sbas", "gbas", "gnss", "kpi", "dme", "sensors", "araim", "raim", "ins", "maps")
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
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("modules", nargs="*", default=list(MODULES), help=f"of {', '.join(MODULES)}")
    arguments = parser.parse_args()
    sys.path.insert(0, str(Path(__file__).parent))
    os.environ.setdefault("RAYON_NUM_THREADS", "1")
    rows = []
    for name in arguments.modules:
        if name not in MODULES:
            parser.error(f"no bench {name}; there are {', '.join(MODULES)}")
        group = importlib.import_module(name).measure()
        base = group[0]["seconds_per_item"]
        for row in group:
            row |= {"group": name, "ratio": row["seconds_per_item"] / base}
            print(f"{name:5} {row['name']:44} {1e9 * row['seconds_per_item']:14.1f} ns  {row['ratio']:12.2f} x  {row['note']}")
        rows += group
    RESULTS.mkdir(exist_ok=True)
    stamp = datetime.now(UTC).strftime("%Y-%m-%d")
    out = RESULTS / f"{stamp}.json"
    out.write_text(json.dumps({"date": stamp, "machine": machine(), "results": rows}, indent=1) + "\n")
    print(f"written to {out}")


if __name__ == "__main__":
    main()
