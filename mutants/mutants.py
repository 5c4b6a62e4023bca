"""Mutation testing of bound, monitor and judge: a random sample of the mutants that cargo-mutants lists, all compiled into one build.

./dev mutants [N] [--seed S]

Compiling each of 6500 mutants takes minutes each; here a copy of the sources holds every mutant of the sample behind a switch
(``if mutant::is(17) { a - b } else { a + b }``) and is compiled twice: once with the core's own tests, once as the Python module. The tests
of the core run first. The reference vectors and the contract tests, which are written in Python, run for the mutants that those leave
alive. A first run without a mutant notes which mutants each test reaches, so that only those tests run. A mutant that does not compile in
place is left out of the sample and counted, as is one in a ``const fn``, where there is no switch.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import re
import shutil
import subprocess
import sys
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from switches import ROOT, Mutant, written

SCOPE = ("crates/core/src/bound/**", "crates/core/src/monitor/**", "crates/core/src/judge/**", "crates/assess/src/judge*.rs")
FAST = ("--profile", "fast", *(a for setting in ('inherits="release"', 'lto="off"', "codegen-units=16", "debug=false", "incremental=true")
                               for a in ("--config", f"profile.fast.{setting}")))  # fmt: skip
TESTS = ("test", "--no-run", "--config", "profile.dev.package.navbound-core.opt-level=1", "-p", "navbound-core")
MODULE = ("build", *FAST, "-p", "navbound-python", "--features", "pyo3/extension-module")


def listed() -> list[dict[str, Any]]:
    """All mutants of the scope."""
    command = ["cargo", "mutants", "--list", "--json", "--no-config", "--dir", str(ROOT)]
    for scope in SCOPE:
        command += ["-f", scope]
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def sample(every: list[dict[str, Any]], n: int, seed: int) -> list[Mutant]:
    """`n` of them, each as likely as any other."""
    chosen = random.Random(seed).sample(every, min(n, len(every)))
    point = lambda p: (p["line"] - 1, p["column"] - 1)  # noqa: E731
    return [
        Mutant(k, m["name"], m["file"], m["genre"], m["replacement"], point(m["span"]["start"]), point(m["span"]["end"]),
               (m["function"] or {}).get("function_name", ""))
        for k, m in enumerate(chosen, 1)
    ]  # fmt: skip


def compiled(copy: Path, target: Path, what: tuple[str, ...]) -> tuple[list[Path], set[int], str]:
    """The programs or the module that cargo makes; or the mutants that do not compile, and the compiler's words."""
    python = ROOT / ".venv" / "bin" / "python"
    done = subprocess.run(
        ["cargo", *what, "--message-format=json", "--offline"],
        cwd=copy, capture_output=True, text=True, check=False,
        env=os.environ | {"CARGO_TARGET_DIR": str(target), "PYO3_PYTHON": str(python)},
    )  # fmt: skip
    made, wrong, words = [], set(), ""
    for line in done.stdout.splitlines():
        message = json.loads(line)
        if message.get("executable") and message.get("profile", {}).get("test"):
            made.append(Path(message["executable"]))
        if (message.get("target") or {}).get("name") == "_core" and message.get("filenames"):
            made.append(Path(message["filenames"][0]))
        error = message.get("message") or {}
        if error.get("level") == "error":
            near: set[int] = set()
            for span in error.get("spans", []):
                text = (copy / span["file_name"]).read_text().splitlines()[span["line_start"] - 1 : span["line_end"]]
                near |= {int(n) for n in re.findall(r"mutant::is\((\d+)\)", "\n".join(text))}
            wrong |= near
            # A last error only counts the others.
            words += "" if near or not error.get("spans") else error.get("rendered", "")
    return ([] if done.returncode else made), wrong, words or done.stderr[-3000:]


def prepared(chosen: list[Mutant], copy: Path, target: Path) -> tuple[list[Mutant], list[Path], Path]:
    """The mutants that can be switched, the test programs that hold them, and the Python module that does."""
    left_out: dict[int, str] = {}
    while True:
        stay = [m for m in chosen if m.number not in left_out]
        left_out |= written(stay, copy)
        # The module has more crates than the tests of the core.
        builds = []
        for what in (TESTS, MODULE):
            made, wrong, words = compiled(copy, target, what)
            print(f"{len(stay)} mutants, {len(wrong)} do not compile, {len(made)} {what[0]} products", flush=True)
            builds.append(made)
            if not made:
                break
        else:
            print(f"left out: {dict(Counter(left_out.values()))}")
            return [m for m in chosen if m.number not in left_out], builds[0], builds[1][0]
        if not wrong:
            raise SystemExit(words[:6000])
        left_out |= dict.fromkeys(wrong, "does not compile")


def killed_by_core(stay: list[Mutant], programs: list[Path], copy: Path, work: Path) -> dict[int, str]:
    """Test of the core that kills each mutant; those that none kills are absent."""
    reach: dict[int, list[tuple[float, Path, str]]] = {}
    folder = copy / "crates" / "core"
    for program in programs:
        for test in (t for t in tests_of(program, folder) if not t.startswith("architecture::")):
            trace = work / "trace"
            trace.unlink(missing_ok=True)
            begin = time.monotonic()
            if run(program, test, folder, {"MUTANT_TRACE": str(trace)}, 600) != 0:
                print(f"fails without a mutant: {program.name} {test}")
                continue
            took = time.monotonic() - begin
            for n in set(trace.read_text().split()) if trace.exists() else ():
                reach.setdefault(int(n), []).append((took, program, test))

    def killer(m: Mutant) -> str:
        for took, program, test in sorted(reach.get(m.number, []), key=lambda t: t[0]):
            if run(program, test, folder, {"MUTANT": str(m.number)}, 60 + 10 * took) != 0:
                return test
        return ""

    with ThreadPoolExecutor(2) as pool:
        killers = zip(stay, pool.map(killer, stay), strict=True)
        return {m.number: test for m, test in killers if test}


def tests_of(program: Path, folder: Path) -> list[str]:
    """Names of a program's tests."""
    listing = subprocess.run([program, "--list", "--format", "terse"], cwd=folder, capture_output=True, text=True, check=True).stdout
    return [line.removesuffix(": test") for line in listing.splitlines() if line.endswith(": test")]


def run(program: Path, test: str, folder: Path, variables: dict[str, str], seconds: float) -> int:
    """Exit status of one test; a test that does not end has failed."""
    environment = os.environ | variables | {"CARGO_MANIFEST_DIR": str(folder), "PROPTEST_CASES": "64"}
    command = [program, "--exact", test, "--test-threads", "1", "-q"]
    try:
        return subprocess.run(command, cwd=folder, env=environment, capture_output=True, timeout=seconds, check=False).returncode
    except subprocess.TimeoutExpired:
        return -1


def packaged(module: Path, work: Path) -> Path:
    """The Python package with the module that holds the mutants."""
    package = work / "package"
    shutil.rmtree(package, ignore_errors=True)
    shutil.copytree(ROOT / "python", package, ignore=shutil.ignore_patterns("__pycache__", "*.so"))
    shutil.copy2(module, package / "navbound" / "_core.abi3.so")
    return package


def killed_by_python(stay: list[Mutant], package: Path, work: Path) -> dict[int, str]:
    """Vector or contract test that kills each mutant; those that none kills are absent."""
    result = work / "python.json"
    command = [ROOT / ".venv" / "bin" / "python", Path(__file__).parent / "in_python.py", "--result", result]
    subprocess.run(
        [*command, *(str(m.number) for m in stay)], cwd=ROOT, check=True,
        env=os.environ | {"PYTHONPATH": str(package), "PYTHONDONTWRITEBYTECODE": "1"},
    )  # fmt: skip
    return {int(n): test for n, test in json.loads(result.read_text()).items() if test}


def report(stay: list[Mutant], killers: dict[int, str], n_all: int) -> None:
    """Print every mutant with what kills it, and the share."""
    for m in sorted(stay, key=lambda m: (m.number in killers, m.name)):
        print(f"killed {m.name} ({killers[m.number]})" if m.number in killers else f"SURVIVES {m.name}")
    n, killed = len(stay), len(killers)
    share = killed / max(n, 1)
    half = 1.96 * (share * (1 - share) / max(n, 1)) ** 0.5
    print(f"{killed} of {n} killed: {share:.1%} +- {half:.1%} (95 %), of {n_all} mutants in all")


def main() -> int:
    """Sample, build, run, and print the figures and the survivors."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("n", type=int, nargs="?", default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--list", type=Path, help="a list made before by cargo mutants --list --json")
    parser.add_argument("--work", type=Path, default=ROOT / "target" / "mutants")
    parser.add_argument("--target", type=Path, default=ROOT / "target")
    parser.add_argument("--only-python", action="store_true", help="leave the tests of the core out")
    a = parser.parse_args()
    every = json.loads(a.list.read_text()) if a.list else listed()
    copy = a.work / "copy"
    stay, programs, module = prepared(sample(every, a.n, a.seed), copy, a.target)
    package = packaged(module, a.work)
    killers = {} if a.only_python else killed_by_core(stay, programs, copy, a.work)
    print(f"the tests of the core kill {len(killers)} of {len(stay)}", flush=True)
    killers |= killed_by_python([m for m in stay if m.number not in killers], package, a.work)
    report(stay, killers, len(every))
    return 0


if __name__ == "__main__":
    sys.exit(main())
