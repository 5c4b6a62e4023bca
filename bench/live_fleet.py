"""A fleet that misbehaves on purpose, in real time, against the batch monitor: lost, extra and double alerts, latency, CPU, memory.

    .venv/bin/python bench/live_fleet.py files --aircraft 5000 --seconds 60
    .venv/bin/python bench/live_fleet.py nats --kill worker        # or: --kill broker; both 30 s after the begin
    .venv/bin/python bench/live_fleet.py nats --kill crew --seconds 150    # two workers: one is killed, the other frozen for a minute
    .venv/bin/python bench/live_fleet.py kafka                     # needs what ./dev test kafka brings

Acceptance lines A17 to A21 of the live specification. The fleet and its truth are shared data, beside the repository.
"""

from __future__ import annotations

import argparse
import json
import os
import runpy
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).parents[1]
SHARED = ROOT.parent / "shared" / "live"
sys.path[:0] = [str(ROOT / "tests"), str(SHARED)]

from fleet_fixture import Server  # noqa: E402
from kafka_fixture import KafkaServer  # noqa: E402
from navbound.live.session import now_ns  # noqa: E402

COMMAND = [sys.executable, "-c", "from navbound.cli.start import process; process()", "live"]
TICK_S = 0.01
BETWEEN_S, FROZEN_S = 15.0, 60.0
BROKERS: dict[str, type[Server]] = {"nats": Server, "kafka": KafkaServer}


def produce(n: int, seconds: int, seed: int, to: Any) -> int:
    """Write the lines as time passes, with times of now; by how much the times were shifted. [ns]."""
    module = runpy.run_path(str(SHARED / "fleet.py"))
    lines = module["records"](n, seconds, seed)
    begun_s, shift_ns = time.monotonic() + 0.5, now_ns() + 500_000_000 - module["T0"]
    at, late_s = 0, 0.0
    while at < len(lines):
        due, until = [], time.monotonic() - begun_s
        while at < len(lines) and lines[at][0] <= until:
            head, _, tail = lines[at][2].partition('"time_ns":')
            stamp, _, rest = tail.partition(",")
            due.append(f'{head}"time_ns":{int(stamp) + shift_ns},{rest}}}\n')
            at += 1
        if due:
            late_s = max(late_s, until - lines[at - len(due)][0])
            to.write("".join(due).encode())
            to.flush()
        time.sleep(TICK_S)
    # At once: to give three million lines back takes seconds, in which a source that is open would be silent.
    to.close()
    print(f"producer: {len(lines)} records, at most {late_s:.2f} s late", flush=True)
    return int(shift_ns)


class Process:
    """A command of navbound with its lines, processor time and memory."""

    def __init__(self, *arguments: str, **options: Any) -> None:
        self.process = subprocess.Popen([*COMMAND, *arguments], stderr=subprocess.PIPE, text=False, **options)
        self.lines: list[tuple[int, bytes]] = []
        self.report: list[str] = []
        self.cpu_s = self.memory_mb = 0.0
        self._threads = [threading.Thread(target=self._hear, daemon=True)]
        if self.process.stdout is not None:
            self._threads.append(threading.Thread(target=self._read, daemon=True))
        for thread in self._threads:
            thread.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.lines.append((now_ns(), line))

    def _hear(self) -> None:
        assert self.process.stderr is not None
        self.report.extend(line.decode() for line in self.process.stderr)

    def look(self) -> None:
        """Keep processor time [s] and largest memory [MB] of now."""
        self.cpu_s, self.memory_mb = use_of(self.process.pid) or (self.cpu_s, self.memory_mb)

    def end(self, number: int = signal.SIGTERM) -> None:
        self.look()
        if self.process.poll() is None:
            self.process.send_signal(number)
        self.process.wait()
        for thread in self._threads:
            thread.join(5.0)


def require_begun(place: str) -> None:
    """Wait until a fleet is there."""
    from navbound.live.fleet import connect  # noqa: PLC0415

    with connect(place, patience_s=60.0):
        pass


def main() -> None:
    ask = argparse.ArgumentParser(description=__doc__)
    ask.add_argument("transport", choices=["files", *BROKERS])
    ask.add_argument("--aircraft", type=int, default=5000)
    ask.add_argument("--seconds", type=int, default=60)
    ask.add_argument("--seed", type=int, default=1)
    ask.add_argument("--kill", choices=["worker", "broker", "crew"])
    ask.add_argument("--kill-s", type=float, default=30.0)
    how = ask.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        run(how, Path(folder))


def run(how: argparse.Namespace, folder: Path) -> None:
    """One run, printed."""
    server = BROKERS[how.transport](folder) if how.transport in BROKERS else None
    place = str(folder / "fleet") if server is None else server.name("bench")
    feeder = Process("feed", "-", "--to", place, "--spool", str(folder / "spool"), stdin=subprocess.PIPE)
    require_begun(place)
    workers = [Process("work", place, "--json", stdout=subprocess.PIPE) for _ in range(2 if how.kill == "crew" else 1)]
    time.sleep(8.0)
    killed_ns, again_ns = 0, 0

    def kill() -> None:
        nonlocal killed_ns, again_ns
        time.sleep(how.kill_s)
        killed_ns = now_ns()
        if how.kill in {"worker", "crew"}:
            workers[0].end(signal.SIGKILL)
            again_ns = now_ns()
            workers.append(Process("work", place, "--json", stdout=subprocess.PIPE))
            if how.kill == "crew":
                freeze(workers[1].process)
        elif server is not None:
            server.kill()
            time.sleep(3.0)
            again_ns = now_ns()
            server.begin()
            print(f"broker: answers {(now_ns() - again_ns) / 1e9:.1f} s after it was started again", flush=True)

    killer = threading.Thread(target=kill, daemon=True)
    if how.kill:
        killer.start()
    load_before, begun = os.getloadavg()[0], time.monotonic()
    for worker in workers:
        worker.look()
    before = [worker.cpu_s for worker in workers]
    broker_before_s = broker_use(server)[0]
    shift_ns = produce(how.aircraft, how.seconds, how.seed, feeder.process.stdin)
    feeder.process.wait()
    feeder.end()
    time.sleep(6.0)
    passed_s = time.monotonic() - begun
    broker_s, broker_mb = broker_use(server)
    # One that was started again begins anew: its start is in the figure then.
    broker_s -= 0.0 if how.kill == "broker" else broker_before_s
    for worker in workers:
        worker.end()
    read = subprocess.run([*COMMAND, "alerts", place], stdout=subprocess.PIPE, check=True).stdout
    judge(how, [json.loads(line) for line in read.splitlines()], shift_ns)
    timed([json.loads(line) | {"heard_ns": heard} for worker in workers for heard, line in worker.lines], killed_ns, again_ns)
    for worker, since_s in zip(workers, [*before, 0.0], strict=False):
        print(f"worker: {worker.cpu_s - since_s:.1f} s CPU in {passed_s:.0f} s, {worker.memory_mb:.0f} MB;", " ".join(worker.report)[-400:])
    print(f"broker: {broker_s:.1f} s CPU in {passed_s:.0f} s, {broker_mb:.0f} MB")
    print(f"load {load_before:.1f} to {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors")
    print("feeder:", " ".join(feeder.report)[-400:])
    if server is not None:
        server.kill()


def freeze(process: subprocess.Popen[bytes]) -> None:
    """Stop a worker for a minute and let it go on: it must then end by itself."""
    time.sleep(BETWEEN_S)
    process.send_signal(signal.SIGSTOP)
    time.sleep(FROZEN_S)
    process.send_signal(signal.SIGCONT)
    begun = time.monotonic()
    try:
        code = process.wait(FROZEN_S)
        print(f"the frozen worker ended {time.monotonic() - begun:.1f} s after it was let go, with {code}", flush=True)
    except subprocess.TimeoutExpired:
        print(f"the frozen worker still works {FROZEN_S:g} s after it was let go", flush=True)


def broker_use(server: Any) -> tuple[float, float]:
    """Of a broker's process: processor time [s] and largest memory [MB]; none where there is no broker."""
    return (server is not None and use_of(server.process.pid)) or (0.0, 0.0)


def use_of(pid: int) -> tuple[float, float] | None:
    """Processor time [s] and largest memory [MB] of a process until now."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        status = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return None
    peak = [int(line.split()[1]) / 1024 for line in status.splitlines() if line.startswith("VmHWM")]
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK"), peak[0] if peak else 0.0


def judge(how: argparse.Namespace, entry: list[dict[str, Any]], shift_ns: int) -> None:
    """Compare with the batch monitor over the same records."""
    raised, cleared, _, _ = runpy.run_path(str(SHARED / "reference.py"))["reference"](how.aircraft, how.seconds, how.seed)
    truth = {f"{e['track']}/{e['kind']}/{e['annunciation_ns'] + shift_ns}/raised" for e in raised.values()}
    truth |= {f"{e['track']}/{e['kind']}/{e['onset_ns'] + shift_ns}/cleared" for e in cleared.values()}
    names = [
        f"{t['track']}/{t['kind']}/{t['annunciation_ns' if t['transition'] == 'raised' else 'onset_ns']}/{t['transition']}"
        for t in entry
        if t["track"]
    ]
    double = len(entry) - len({t["key"] for t in entry})
    print(f"alerts: {len(truth)} of the batch monitor; {len(truth - set(names))} lost, {len(set(names) - truth)} extra, {double} double")
    begun_ns = shift_ns + runpy.run_path(str(SHARED / "fleet.py"))["T0"]
    for which, odd in (("lost", truth - set(names)), ("extra", set(names) - truth)):
        for kind, turn in sorted({(name.split("/")[1], name.split("/")[3]) for name in odd}):
            at_s = [(int(name.split("/")[2]) - begun_ns) / 1e9 for name in odd if name.split("/")[1::2] == [kind, turn]]
            print(f"  {which}: {len(at_s)} {kind} {turn}, at {min(at_s):.1f} to {max(at_s):.1f} s")
    for t in entry:
        if not t["track"]:
            print(f"  of the source: {t['kind']} {t['transition']} at {((t['annunciation_ns'] or 0) - begun_ns) / 1e9:.1f} s")


def timed(declared: list[dict[str, Any]], killed_ns: int, again_ns: int) -> None:
    """Latency from arrival to when a transition was written: a worker prints it then, and its own stamp is of when it judged."""
    known = [t for t in declared if t["arrival_ns"] is not None and t["track"]]
    # A record that waits for its order, or a silence, is decided a lateness (1 s) after it arrived.
    waited = {"all": known, "of no silence": [t for t in known if t["kind"] != "unavailable"]}
    for which, entry in waited.items():
        if entry:
            ms = np.array([(t["heard_ns"] - t["arrival_ns"]) / 1e6 for t in entry])
            parts = ", ".join(f"p{100 * q:.0f} {np.quantile(ms, q):.0f}" for q in (0.5, 0.9, 0.99))
            print(f"latency arrival to written, {which} {len(ms)}: {parts}, largest {ms.max():.0f} ms")
    later = [t["heard_ns"] for t in known if t["heard_ns"] > again_ns > 0]
    if later:
        since_again_s, since_kill_s = ((min(later) - since_ns) / 1e9 for since_ns in (again_ns, killed_ns))
        print(f"first alert {since_again_s:.1f} s after the new process began, {since_kill_s:.1f} s after the kill")


if __name__ == "__main__":
    main()
