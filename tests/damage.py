"""Random damage to real files of every kind, judged for wrong numbers too.

``python tests/damage.py [N] [--seed S]`` or ``./dev damage``. A damaged file is

- refused by an error of navbound that names it,
- or read with the same numbers,
- or read with losses that are counted or noted,
- or, where the damaged bytes carry no checksum, read with another number in the records that these bytes belong to and in no other: a file
  that says 51 where it said 50 is a file that says 51.

Anything else is a failure: another exception, more than 10 s of processor time, more than 2 GB, or a number that is wrong in silence. Which
records a line belongs to follows from the undamaged file: those that change where the line is left out.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import resource
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, reduce
from itertools import accumulate
from multiprocessing.connection import Connection
from operator import xor
from pathlib import Path

import numpy as np

from damage_kinds import BESIDE, KINDS, Cell, Cells, Kind, Result
from navbound.errors import FormatError, InputError

HANG_S, MEMORY_BYTES = 10.0, 2 << 30
WAIT_S = 120.0
"""A process that waits for ever uses no time of the processor. [s]"""
FAILURES = ("CRASH", "HANG", "MEMORY", "WRONG", "SILENT", "WRONG FILE")


@dataclass(frozen=True)
class Damage:
    """What was done: the changed bytes, and the half-open range of the original's bytes that they replace or touch."""

    words: str
    content: bytes
    begin: int
    end: int


def damage(random: np.random.Generator, content: bytes, *, binary: bool) -> Damage:  # noqa: PLR0911
    """One random damage."""
    n = len(content)
    at = int(random.integers(0, n))
    length = int(random.integers(1, 40))
    end = min(n, at + length)
    piece = content[at:end]
    junk = bytes(random.integers(0, 256, length, dtype=np.uint8))
    digit = b"%d" % random.integers(0, 10)
    extreme = [b"nan", b"1e308", b"-1", b"", b"99999999999999", b"0", b"inf", b"-", b" " * length][int(random.integers(0, 9))]
    kinds = ["bit", "byte", "digit", "deleted", "inserted", "zeroed", "junk", "extreme", "cut", "twice", "swapped"]
    kind = kinds[int(random.integers(0, 8 if random.random() < 0.7 else len(kinds)))]
    if kind == "bit":
        return Damage(kind, content[:at] + bytes([content[at] ^ 1 << int(random.integers(0, 8))]) + content[at + 1 :], at, at + 1)
    if kind == "byte":
        return Damage(kind, content[:at] + junk[:1] + content[at + 1 :], at, at + 1)
    if kind == "digit":
        while not binary and not content[at : at + 1].isdigit():
            at = int(random.integers(0, n))
        return Damage(kind, content[:at] + digit + content[at + 1 :], at, at + 1)
    if kind == "extreme":
        return Damage(kind, content[:at] + extreme + content[end:], at, end)
    if kind == "cut":
        return Damage(kind, content[:at], at, n)
    if kind == "twice":
        return Damage(kind, content[:end] + piece + content[end:], at, end)
    if kind == "swapped":
        far = min(n, end + length)
        return Damage(kind, content[:at] + content[end:far] + piece + content[far:], at, far)
    made = {"deleted": b"", "inserted": junk + piece, "zeroed": bytes(end - at), "junk": junk[: end - at]}[kind]
    return Damage(kind, content[:at] + made + content[end:], at, end)


def differing(clean: Cells, cells: Cells) -> tuple[set[Cell], set[Cell], set[Cell]]:
    """Cells that are lost, changed, and new."""
    lost = {k for k in clean if k not in cells}
    changed = {k for k, v in clean.items() if k in cells and cells[k] != v}
    return lost, changed, {k for k in cells if k not in clean}


class Bench:
    """One kind of file, read undamaged, and judged."""

    def __init__(self, kind: Kind, folder: Path) -> None:
        self.kind, self.content = kind, kind.make()
        self.path = folder / kind.name
        (folder / f"sound-{kind.name}").write_bytes(self.content)
        self.beside = []
        for name, make in (BESIDE[b] for b in kind.beside):
            self.beside.append(folder / name)
            self.beside[-1].write_bytes(make())
        self.clean = self.read(self.content)
        self.lines = [0, *(i + 1 for i, byte in enumerate(self.content) if byte == 10)]

    def read(self, content: bytes) -> Result:
        self.path.write_bytes(content)
        return self.kind.result(self.path, *self.beside)

    def line_at(self, at: int) -> int:
        return int(np.searchsorted(self.lines, at, side="right")) - 1

    @cache  # noqa: B019
    def influence(self, line: int) -> frozenset[Cell] | None:
        """Cells that change where a line is left out; None where everything may: a head without which nothing is read."""
        begin = self.lines[line]
        end = self.lines[line + 1] if line + 1 < len(self.lines) else len(self.content)
        try:
            reading, _ = self.read(self.content[:begin] + self.content[end:])
        except (FormatError, InputError):
            return None
        lost, changed, new = differing(self.clean[0], reading)
        return frozenset(lost | changed | new)

    def verdict(self, d: Damage) -> tuple[str, str]:  # noqa: PLR0911
        """What became of a damaged file, and the words."""
        try:
            reading, stated = self.read(d.content)
        except (FormatError, InputError) as e:
            return ("refused" if self.path.name in str(e) else "WRONG FILE"), str(e)
        lost, changed, new = differing(self.clean[0], reading)
        counted = stated != self.clean[1]
        if not (lost or changed or new):
            return ("counted" if counted else "same"), ""
        if self.kind.protection == "file":
            return "WRONG", f"{len(lost)} lost, {len(changed)} changed, {len(new)} new behind a checksum of the whole"
        if self.kind.protection == "parity" and self._keeps_parity(d):
            return ("counted" if counted else "data"), ""
        if self.kind.protection in {"record", "parity"}:
            if self._keeps_sum(d):
                return ("counted" if counted else "data"), ""
            if changed or new:
                return "WRONG", f"changed {_some(changed)}, new {_some(new)} behind checksums"
            # Between two frames a log may end.
            whole = d.words == "cut" and self.content[d.begin : d.begin + 2] in {b"$@", b"\xb5b", b"\xaa\x44"}
            return ("data" if whole else "counted", "") if counted or whole else ("SILENT", f"lost {_some(lost)}")
        return self._unprotected(d, (lost, changed, new), counted=counted)

    def _keeps_parity(self, d: Damage) -> bool:
        """Whether the damage is of a kind that an exclusive or cannot see, within a sentence: bytes that changed places or came twice."""
        after = d.content[d.begin : len(d.content) - (len(self.content) - d.end)]
        before = self.content[d.begin : d.end]
        same = reduce(xor, before, 0) == reduce(xor, after, 0)
        return d.words in {"swapped", "twice"} and same and not {*b"$\r\n"} & {*before, *after}

    def _keeps_sum(self, d: Damage) -> bool:
        """Whether a damaged u-blox frame still has its own checksum: Fletcher's sums let one exchange of 32 bytes in eight pass."""
        frame = self.content.rfind(b"\xb5b", 0, d.begin + 1)
        if frame < 0 or len(d.content) != len(self.content):
            return False
        body = frame + 6 + int.from_bytes(self.content[frame + 4 : frame + 6], "little")
        if not frame + 6 <= d.begin <= d.end <= body:
            return False
        sums = accumulate(d.content[frame + 2 : body])
        last, total = 0, 0
        for last in sums:
            total += last
        return bytes([last % 256, total % 256]) == d.content[body : body + 2]

    def _unprotected(self, d: Damage, cells: tuple[set[Cell], set[Cell], set[Cell]], *, counted: bool) -> tuple[str, str]:
        lost, changed, new = cells
        first, last = self.line_at(d.begin), self.line_at(max(d.begin, d.end - 1))
        if d.words == "cut":
            # What stands before the cut line is whole; the cut line itself is seen by its missing end.
            last = first
        allowed: set[Cell] = set()
        for line in range(first, min(last + 2, len(self.lines))):
            each = self.influence(line)
            while each is not None and not each and line > 0:
                # A line that may be left out, as what it states is assumed without it, belongs to the record of those before it.
                line -= 1  # noqa: PLW2901
                each = self.influence(line)
            if each is None:
                return "declared otherwise", "the head was changed"
            allowed |= each
        # A line belongs to its whole record: what it states may be what is assumed without it.
        keys = {key for key, _ in allowed}
        outside = {cell for cell in changed if cell[0] not in keys}
        # A row that now states the time of another is one of two rows of that time, of which one is counted or both are kept.
        repeats = (counted or self.kind.keeps_repeats) and len({key for key, _ in outside}) <= last - first + 1
        if outside and d.words != "cut" and not repeats:
            return "WRONG", f"changed {_some(outside)}, which belong to other lines"
        n_records = len({key for key, _ in new} - keys)
        if n_records > len(keys) + 2 * (last - first + 2):
            return "WRONG", f"{n_records} new records {_some(new)} of {last - first + 1} lines"
        if counted:
            return "counted", ""
        if d.words == "cut":
            whole = d.begin in {self.lines[first], self.lines[first] - 1, len(self.content) - 1}
            of_line = self.influence(first) or frozenset()
            untouched = not (changed or new) and not of_line & lost
            return ("data", "") if whole or untouched else ("SILENT", f"cut in line {first + 1}")
        return ("data", "") if not lost - allowed else ("SILENT", f"lost {_some(lost - allowed)}, which belong to other lines")


def _some(cells: set[Cell]) -> str:
    return f"{len(cells)} ({', '.join(map(str, sorted(map(str, cells))[:2]))})"


def _worker(connection: Connection, folder: Path) -> None:
    benches: dict[str, Bench] = {}
    while True:
        try:
            name, d = connection.recv()
        except EOFError:
            return
        try:
            if name not in benches:
                benches[name] = Bench(KINDS[name], folder)
            answer = benches[name].verdict(d) if d is not None else ("ready", "")
        except Exception as e:
            answer = ("CRASH", f"{type(e).__name__}: {e}")
        if resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 > MEMORY_BYTES:
            answer = ("MEMORY", "more than 2 GB")
        connection.send(answer)


class Worker:
    """A process of its own, so that a hang, an abort and a waste of memory are seen and survived."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.start()

    def start(self) -> None:
        # A copy of a process with threads may wait for a lock that nobody holds any more.
        context = multiprocessing.get_context("spawn")
        self.connection, theirs = context.Pipe()
        self.process = context.Process(target=_worker, args=(theirs, self.folder), daemon=True)
        self.process.start()
        theirs.close()

    def ask(self, name: str, d: Damage | None) -> tuple[str, str]:
        begin, begun = self._processor_s(), time.monotonic()
        self.connection.send((name, d))
        while not self.connection.poll(1.0):
            if not self.process.is_alive():
                self.start()
                return "CRASH", "the process ended"
            if d is not None and (self._processor_s() - begin > HANG_S or time.monotonic() - begun > WAIT_S):
                self.process.kill()
                self.start()
                return "HANG", f"more than {HANG_S} s"
        try:
            answer: tuple[str, str] = self.connection.recv()
        except EOFError:
            self.start()
            return "CRASH", "the process ended"
        return answer

    def _processor_s(self) -> float:
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def run(n: int, seed: int, folder: Path, names: list[str] | None = None) -> Iterator[tuple[str, str, str, Damage]]:
    """Kind, verdict, words and damage of each of `n` files; kinds in turn, each as often as its weight says."""
    worker, random = Worker(folder), np.random.default_rng(seed)
    names = names or list(KINDS)
    weights = np.array([KINDS[name].weight for name in names])
    contents = {name: KINDS[name].make() for name in names}
    for name in names:
        answer = worker.ask(name, None)
        assert answer[0] == "ready", (name, answer)
    for k in range(n):
        name = names[int(random.choice(len(names), p=weights / weights.sum()))]
        d = damage(np.random.default_rng((seed, k)), contents[name], binary=KINDS[name].binary)
        yield (name, *worker.ask(name, d), d)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("n", type=int, nargs="?", default=20_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", action="append")
    arguments = parser.parse_args()
    counts: dict[str, Counter[str]] = {name: Counter() for name in KINDS}
    begin, n_failures = time.monotonic(), 0
    with tempfile.TemporaryDirectory() as folder:
        for k, (name, verdict, words, d) in enumerate(run(arguments.n, arguments.seed, Path(folder), arguments.kind)):
            counts[name][verdict] += 1
            if verdict in FAILURES:
                n_failures += 1
                print(f"{verdict}: {name}, number {k}, {d.words} at {d.begin} to {d.end}: {words[:300]}", flush=True)
            if k % 2000 == 1999:
                show(counts, time.monotonic() - begin, arguments.seed)
    show(counts, time.monotonic() - begin, arguments.seed)
    return int(n_failures > 0)


def show(counts: dict[str, Counter[str]], seconds: float, seed: int) -> None:
    """Print the table so far."""
    verdicts = ["refused", "counted", "same", "data", "declared otherwise", *FAILURES]
    print("| kind | " + " | ".join(["all", *verdicts]) + " |\n|---" + "|---" * (len(verdicts) + 1) + "|")
    total: Counter[str] = sum(counts.values(), Counter())
    for name, each in [*counts.items(), ("all", total)]:
        if each:
            print(f"| {name} | {each.total()} | " + " | ".join(str(each[v]) for v in verdicts) + " |")
    print(f"{total.total()} files in {seconds:.0f} s, seed {seed}, failures: {sum(total[v] for v in FAILURES)}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
