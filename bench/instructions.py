"""Instructions of every method, algorithm, the monitor and a navigated flight, counted under valgrind: exact, so that nothing grows unseen.

A clock on a shared machine does not see 5 %. A counter does, for one compiler: counts of another one are not comparable, and the check says
so in place of comparing them. What is counted are the instructions of a processor with the least vectors that valgrind shows the program.
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
KEPT = Path(__file__).with_name("instructions.json")
MOST = 1.05
"""Growth beyond which the check fails; provenance: ours."""
_HOW = ("--release", "--locked", "--quiet", "--message-format", "json-render-diagnostics")
BUILD = ("cargo", "build", *_HOW, "-p", "navbound-assess", "-p", "navbound-python", "--example", "kernels")
"""Together with the package whose build made everything else: what both need is then compiled once."""


def compiler() -> str:
    """Compiler and system that the counts are of."""
    words = subprocess.run(["rustc", "--version", "--verbose"], check=True, capture_output=True, text=True).stdout
    return " ".join(re.findall(r"^(?:release|host): (.+)$", words, re.MULTILINE))


def counted() -> dict[str, int]:
    """Instructions of one call of each kernel."""
    built = subprocess.run(BUILD, check=True, cwd=ROOT, stdout=subprocess.PIPE, text=True).stdout
    # Where it stands is for cargo to say: the folder of what is built may be another one.
    (program,) = (made["executable"] for made in map(json.loads, built.splitlines()) if made.get("executable"))
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out"
        count = ["valgrind", "--quiet", "--tool=callgrind", f"--callgrind-out-file={out}", "--dump-before=kernels::mark", program]
        printed = subprocess.run(count, check=True, capture_output=True, text=True).stdout
        kernels = [line.split() for line in printed.splitlines()]
        # A part ends whenever the mark is entered: before the calls of a kernel, and after them.
        parts = [Path(f"{out}.{2 * k}").read_text(encoding="utf-8") for k in range(1, len(kernels) + 1)]
    totals = [int(re.findall(r"^(?:totals|summary): (\d+)$", part, re.MULTILINE)[-1]) for part in parts]
    return {name: round(total / int(calls)) for (name, calls), total in zip(kernels, totals, strict=True)}


def differences(kept: dict[str, int], now: dict[str, int]) -> list[str]:
    """What keeps the check from passing."""
    missing = [f"{name}: kept and no longer counted" for name in kept.keys() - now.keys()]
    unknown = [f"{name}: counted and not kept" for name in now.keys() - kept.keys()]
    grown = [
        f"{name}: {now[name]} instructions, {kept[name]} are kept ({now[name] / kept[name]:.2f} times as many, {MOST} allowed)"
        for name in kept.keys() & now.keys()
        if now[name] > MOST * kept[name]
    ]
    return sorted(missing + unknown + grown)


def main() -> None:
    """Count, and compare or keep."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help="keep the counts of this machine's compiler")
    parser.add_argument("--quiet", action="store_true", help="print only what keeps the check from passing")
    options = parser.parse_args()
    write = options.write
    if shutil.which("valgrind") is None:
        sys.exit("SKIPPED ALOUD: valgrind is missing, instructions are NOT counted")
    kept = {} if write else json.loads(KEPT.read_text(encoding="utf-8"))
    if not write and kept["compiler"] != compiler():
        print(f"SKIPPED ALOUD: counts are kept of {kept['compiler']}, and the compiler is {compiler()}: they are not comparable")
        return
    now = counted()
    for name, n in now.items() if not options.quiet else ():
        before = kept.get("instructions", {}).get(name)
        print(f"{name:32} {n:>12}" + ("" if before is None else f"   {n / before:.3f} of what is kept"))
    if write:
        KEPT.write_text(json.dumps({"compiler": compiler(), "instructions": now}, indent=1) + "\n", encoding="utf-8")
    elif failing := differences(kept["instructions"], now):
        sys.exit("\n".join([*failing, "where a change is meant, ./dev instructions --write keeps the new counts"]))


if __name__ == "__main__":
    main()
