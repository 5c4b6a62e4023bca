"""The vectors and the contract tests against the mutants of a build: one process imports what they need, a fork of it runs them for a mutant.

The library that is imported holds every mutant of the sample behind a switch (`switches.py`); a call into it sets the active one.
"""

from __future__ import annotations

import argparse
import ctypes
import json
import os
import signal
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np  # noqa: F401: before the fork
import pytest
import scipy.integrate
import scipy.optimize
import scipy.stats  # noqa: F401

import navbound
import navbound._core

ROOT = Path(__file__).parents[1]
# Tests of bound, monitor and judge through public functions; the others need minutes, a browser or another machine's files.
FILES = (
    "vectors", "anp", "anp_covariances", "anp_oracle", "araim", "argument_contract", "error_extraction", "evaluation", "false_inside", "fault_campaign",
    "fused", "fused_integrity", "fused_witnesses", "gbas", "gbas_aided", "ins_entry", "judge_errors", "levels_of_nothing", "nan_contract", "predict",
    "protection_methods", "raim", "risks", "rnp", "rnp_monitor", "rnp_state", "rraim", "sbas", "sbas_message_loss", "sbas_positions",
    "stations", "status", "thin_evidence", "tse", "verdict",
)  # fmt: skip
LONGEST_S = 40.0
WHOLE_S = 30.0
AT_ONCE = 2


LIBRARY = ctypes.CDLL(navbound._core.__file__)
LIBRARY.navbound_reached.restype = ctypes.c_bool
OPTIONS = ("-q", "--no-header", "-p", "no:cacheprovider", "-p", "no:xdist", "--tb=no", "-x")


class Tracer:
    """Notes for each test its time and the mutants it reaches; a test that fails or takes long is not used."""

    def __init__(self, numbers: list[int], path: Path) -> None:
        self.numbers, self.path = numbers, path
        self.good = True

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Whether it passes."""
        self.good &= report.passed

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """Around one test with its fixtures."""
        self.good, begin = True, time.monotonic()
        done = yield
        took = time.monotonic() - begin
        reached = [n for n in self.numbers if LIBRARY.navbound_reached(n)]
        if self.good and took < LONGEST_S:
            with self.path.open("a") as file:
                file.write(json.dumps([item.nodeid, took, reached]) + "\n")
        return done


class Chosen:
    """Runs some tests of the files only, in their order, and notes which one runs."""

    def __init__(self, ids: list[str], word: Path) -> None:
        self.place = {name: k for k, name in enumerate(ids)}
        self.word = word

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Choose and order."""
        items[:] = sorted((i for i in items if i.nodeid in self.place), key=lambda i: self.place[i.nodeid])

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        """The test that runs."""
        self.word.write_text(nodeid)


def forked(files: list[str], options: tuple[str, ...], plugin: object, mutant: int) -> int:
    """Identity of a process that runs the tests; no thread of the library exists before it."""
    child = os.fork()
    if child:
        return child
    os.setpgid(0, 0)
    sink = os.open(os.devnull, os.O_WRONLY)
    os.dup2(sink, 1)
    os.dup2(sink, 2)
    os.environ["MUTANT"] = str(mutant)
    LIBRARY.navbound_mutant(mutant)
    try:
        status = int(pytest.main([*options, *files], plugins=[plugin]))
    except BaseException:  # noqa: BLE001: whatever a mutant does to the tests
        status = 1
    os._exit(status)


class Trial:
    """Tests, what they reach and how long they take."""

    def __init__(self, traced: Path) -> None:
        self.took: dict[str, float] = {}
        self.reach: dict[int, set[str]] = {}
        for name, took, reached in map(json.loads, traced.read_text().splitlines()):
            self.took[name] = took
            for n in reached:
                self.reach.setdefault(n, set()).add(name)

    def candidates(self, n: int) -> list[str]:
        """Tests for a mutant, the shortest first: those that reach it, then those that share a fixture or a memory with one of them."""
        reach = self.reach.get(n, set())
        direct = sorted(reach, key=self.took.__getitem__)
        files = {name.split("::")[0] for name in direct}
        beside = sorted((k for k in self.took if k not in reach and k.split("::")[0] in files), key=self.took.__getitem__)
        chosen, whole = [], 0.0
        for name in direct + beside:
            whole += self.took[name]
            if whole < WHOLE_S or name == direct[0]:
                chosen.append(name)
        return chosen


def verdict(status: int, over: bool, word: str) -> str:
    """The test that kills a mutant, or nothing; pytest leaves with 1 where a test fails, with 2 where one cannot be collected."""
    if over:
        return f"{word} does not end"
    if os.WIFSIGNALED(status):
        return f"{word} ends the process"
    return {0: "", 1: word, 2: "collection", 5: ""}.get(os.WEXITSTATUS(status), f"{word} ends the process")


def judged(numbers: list[int], trial: Trial, work: Path) -> dict[int, str]:
    """The test that kills each mutant, or nothing."""
    waiting, running, found = list(numbers), {}, {}
    while waiting or running:
        while waiting and len(running) < AT_ONCE:
            n = waiting.pop()
            ids = trial.candidates(n)
            if not ids:
                found[n] = ""
                continue
            word = work.with_suffix(f".{n}")
            limit_s = 60.0 + 10.0 * sum(trial.took[k] for k in ids)
            child = forked(sorted({k.split("::")[0] for k in ids}), OPTIONS, Chosen(ids, word), n)
            running[child] = (n, time.monotonic() + limit_s, word)
        for child, (n, end, word) in list(running.items()):
            over = time.monotonic() > end
            if over:
                os.killpg(child, signal.SIGKILL)
            ended, status = os.waitpid(child, 0 if over else os.WNOHANG)
            if ended:
                found[n] = verdict(status, over, word.read_text() if word.exists() else "collection")
                word.unlink(missing_ok=True)
                print(f"{n} {found[n]}", flush=True)
                del running[child]
        time.sleep(0.01)
    return found


def main() -> int:
    """Trace the tests and run them for the mutants that are named."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--result", type=Path, required=True)
    parser.add_argument("--again", action="store_true", help="with the trace of the last run of the same build and tests")
    parser.add_argument("numbers", type=int, nargs="+")
    a = parser.parse_args()
    traced = a.result.with_suffix(".trace")
    if not a.again:
        traced.unlink(missing_ok=True)
        files = [path for name in FILES if (ROOT / (path := f"tests/test_{name}.py")).is_file()]
        LIBRARY.navbound_reached(0)
        os.waitpid(forked(files, OPTIONS[:-1], Tracer(a.numbers, traced), 0), 0)
    trial = Trial(traced)
    print(f"{len(trial.took)} tests pass in {sum(trial.took.values()):.0f} s", flush=True)
    a.result.write_text(json.dumps(judged(a.numbers, trial, a.result)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
