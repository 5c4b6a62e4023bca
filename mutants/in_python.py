"""The vectors and the contract tests against the mutants of a build: one process collects the tests, a fork of it runs them for a mutant.

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
from collections.abc import Callable
from pathlib import Path

import pytest
from _pytest.runner import runtestprotocol

import navbound._core

ROOT = Path(__file__).parents[1]
# Tests of bound, monitor and judge through public functions; the others need minutes, a browser or another machine's files.
FILES = (
    "vectors", "anp", "anp_covariances", "anp_oracle", "araim", "argument_contract", "error_extraction", "evaluation", "false_inside", "fault_campaign",
    "fused", "fused_integrity", "fused_witnesses", "gbas", "gbas_aided", "ins_entry", "judge_errors", "levels_of_nothing", "nan_contract", "predict",
    "protection_methods", "raim", "risks", "rnp", "rnp_monitor", "rnp_state", "rraim", "sbas", "sbas_message_loss", "sbas_positions",
    "stations", "status", "thin_evidence", "tse", "verdict",
)  # fmt: skip
LONGEST_S = 25.0
WHOLE_S = 90.0
AT_ONCE = 2


class Trial:
    """Replaces the loop over the tests."""

    def __init__(self, numbers: list[int], result: Path) -> None:
        self.numbers, self.result = numbers, result
        self.library = ctypes.CDLL(navbound._core.__file__)
        self.library.navbound_reached.restype = ctypes.c_bool
        self.items: list[pytest.Item] = []
        self.took: dict[int, float] = {}
        self.reach: dict[int, set[int]] = {n: set() for n in numbers}

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Trace, then one fork for each mutant."""
        self.items = session.items
        traced = self.result.with_suffix(".trace")
        child = os.fork()
        if child == 0:
            self.trace(traced)
            os._exit(0)
        os.waitpid(child, 0)
        for k, took, reached in map(json.loads, traced.read_text().splitlines()):
            self.took[k] = took
            for n in reached:
                self.reach[n].add(k)
        print(f"{len(self.took)} of {len(self.items)} tests pass in {sum(self.took.values()):.0f} s", flush=True)
        found = self.judged()
        self.result.write_text(json.dumps(found))
        return True

    def passes(self, k: int, following: int | None) -> bool:
        """Whether a test passes now."""
        reports = runtestprotocol(self.items[k], nextitem=None if following is None else self.items[following], log=False)
        return not any(r.failed for r in reports)

    def trace(self, path: Path) -> None:
        """Which mutants each test reaches, and its time; a test that fails or takes long is not used."""
        for n in self.numbers:
            self.library.navbound_reached(n)
        with path.open("w") as file:
            for k in range(len(self.items)):
                begin = time.monotonic()
                good = self.passes(k, k + 1 if k + 1 < len(self.items) else None)
                took = time.monotonic() - begin
                reached = [n for n in self.numbers if self.library.navbound_reached(n)]
                if good and took < LONGEST_S:
                    file.write(json.dumps([k, took, reached]) + "\n")
                    file.flush()
                elif not good:
                    print(f"fails without a mutant: {self.items[k].nodeid}", flush=True)

    def candidates(self, n: int) -> list[int]:
        """Tests for a mutant, the shortest first: those that reach it, then those that share a fixture or a memory with one of them."""
        direct = sorted(self.reach[n], key=self.took.__getitem__)
        files = {self.items[k].path for k in direct}
        beside = sorted((k for k in self.took if k not in self.reach[n] and self.items[k].path in files), key=self.took.__getitem__)
        chosen, whole = [], 0.0
        for k in direct + beside:
            whole += self.took[k]
            if whole < WHOLE_S or k == direct[0]:
                chosen.append(k)
        return chosen

    def attempt(self, n: int, candidates: list[int], told: Callable[[str], None]) -> None:
        """In a fork: run the tests with a mutant until one fails."""
        os.environ["MUTANT"] = str(n)
        self.library.navbound_mutant(n)
        for k, following in zip(candidates, [*candidates[1:], None], strict=True):
            told(f"?{self.items[k].nodeid}")
            if not self.passes(k, following):
                told(f"!{self.items[k].nodeid}")
                return
        told("")

    def judged(self) -> dict[int, str]:
        """The test that kills each mutant, or nothing."""
        waiting, running, found = list(self.numbers), {}, {}
        while waiting or running:
            while waiting and len(running) < AT_ONCE:
                n = waiting.pop()
                candidates = self.candidates(n)
                if not candidates:
                    found[n] = ""
                    continue
                word = self.result.with_suffix(f".{n}")
                child = os.fork()
                if child == 0:
                    os.setpgid(0, 0)
                    self.attempt(n, candidates, word.write_text)
                    os._exit(0)
                limit = 60.0 + 10.0 * sum(self.took[k] for k in candidates)
                running[child] = (n, time.monotonic() + limit, word)
            for child, (n, end, word) in list(running.items()):
                over = time.monotonic() > end
                if over:
                    os.killpg(child, signal.SIGKILL)
                if not over and os.waitpid(child, os.WNOHANG)[0] == 0:
                    continue
                if over:
                    os.waitpid(child, 0)
                text = word.read_text() if word.exists() else "?at once"
                word.unlink(missing_ok=True)
                found[n] = f"{text[1:]} does not end" if over else f"{text[1:]} ends the process" if text.startswith("?") else text[1:]
                del running[child]
            time.sleep(0.01)
        return found


def main() -> int:
    """Collect the tests and run them for the mutants that are named."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--result", type=Path, required=True)
    parser.add_argument("numbers", type=int, nargs="+")
    a = parser.parse_args()
    files = [str(path) for name in FILES if (path := ROOT / "tests" / f"test_{name}.py").is_file()]
    options = ["-q", "--no-header", "-p", "no:cacheprovider", "-p", "no:terminal", "--capture=no", *files]
    trial = Trial(a.numbers, a.result)
    with open(os.devnull, "w") as sink:
        keep, sys.stderr = sys.stderr, sink
        try:
            pytest.main(options, plugins=[trial])
        finally:
            sys.stderr = keep
    return 0 if a.result.exists() else 1


if __name__ == "__main__":
    sys.exit(main())
