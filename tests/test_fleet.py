"""A fleet between feeder and workers gives the alerts of the batch monitor, each once, whoever is killed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from fleet_fixture import RECORD, Lines, Server, fed, made, outputs, reported, serving, worked
from kafka_fixture import PretendedKafka, kafka_serving
from live_fixture import FLEET, Sent, fleet, frames, recorded, truth
from navbound import _core, live
from navbound.live import journal
from navbound.live.fleet import Feeder, FencedError, Worker, connect, create, lane_run
from navbound.live.fleet.brokers import shared
from navbound.live.fleet.transport import Transport


@pytest.fixture(scope="module")
def nats(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    with serving(tmp_path_factory.mktemp("nats")) as server:
        yield server


@pytest.fixture(scope="module")
def kafka(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    with kafka_serving(tmp_path_factory.mktemp("kafka")) as server:
        yield server


@pytest.fixture(scope="module")
def pretended() -> PretendedKafka:
    return PretendedKafka()


@pytest.fixture(params=["nats", "kafka"])
def server(request: pytest.FixtureRequest) -> Server:
    server: Server = request.getfixturevalue(request.param)
    return server


@pytest.fixture(params=["files", "nats", "kafka"])
def name(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    if request.param == "files":
        return str(tmp_path / "fleet")
    server: Server = request.getfixturevalue(request.param)
    return server.name(f"fleet-{abs(hash(request.node.name)) % 10**8}")


def require_truth(name: str, n: int, seconds: int, seed: int) -> None:
    """Every alert of the batch monitor, and no other, each once."""
    entry = reported(name)
    assert len(entry) == len({record["key"] for record in entry}), "an alert is written twice"
    raised, cleared = truth(n, seconds, seed)
    assert min(len(raised), len(cleared)) > 5
    assert {f"{t['track']}/{t['kind']}/{t['annunciation_ns']}/raise" for t in entry if t["transition"] == "raised"} == raised
    assert {f"{t['track']}/{t['kind']}/{t['onset_ns']}/clear/{t['clear_ns']}" for t in entry if t["transition"] == "cleared"} == cleared
    assert len(entry) == len(raised) + len(cleared)


@pytest.mark.parametrize(("n", "seconds", "seed"), [(150, 60, 1), (80, 50, 5)])
def test_a_fleet_gives_the_alerts_of_the_batch_monitor_each_once(name: str, tmp_path: Path, n: int, seconds: int, seed: int) -> None:
    with made(name) as transport, create(str(tmp_path / "spool"), RECORD, 3) as spool:
        fed(transport, fleet(n, seconds, seed), None if "://" not in name else spool)
        worker = worked(transport)
    assert worker.n_epochs > 0.9 * n * seconds
    require_truth(name, n, seconds, seed)


@pytest.mark.parametrize("kind", ["nats", "pretended", "kafka"])
def test_a_lane_is_a_session_and_files_and_a_broker_give_the_same_bits(kind: str, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    sent, server = fleet(60, 40, 3), request.getfixturevalue(kind)
    files, broker = str(tmp_path / "fleet"), server.name("same-bits")
    with made(files) as transport:
        fed(transport, sent)
        worked(transport)
        in_files = outputs(transport)
    with made(broker) as transport, create(str(tmp_path / "spool"), RECORD, 3) as spool:
        fed(transport, sent, spool)
        worked(transport)
        assert outputs(transport) == in_files
    assert sum(map(len, in_files)) > 10
    for lane in range(3):
        session = live.judge(tmp_path / "fleet" / f"lane-{lane:02d}", tmp_path / f"judged-{lane}")
        assert session.n_epochs > 100
        again = _core.live_transitions(journal.read(tmp_path / f"judged-{lane}" / journal.OUT))
        before = _core.live_transitions(journal.read(tmp_path / "fleet" / f"lane-{lane:02d}" / journal.OUT))
        assert [row[0] for row in again] == [row[0] for row in before]


class KilledError(Exception):
    """The worker is gone."""


def killed_at(transport: Transport, at: str, passes: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Work until a call has happened so often, and leave everything as a killed process would."""
    left, of = [passes], lane_run.LaneRun

    def counted(self: lane_run.LaneRun, *arguments: object) -> object:
        left[0] -= 1
        if left[0] == 0:
            raise KilledError
        return whole(self, *arguments)

    whole = getattr(of, at)
    with monkeypatch.context() as patched:
        patched.setattr(of, at, counted)
        with pytest.raises(KilledError):
            worked(transport)


@pytest.mark.parametrize("at", ["_push", "_write", "snapshot"])
def test_a_worker_that_is_gone_at_any_point_is_followed_by_another_without_loss_or_repeat(
    name: str, at: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lane_run, "SNAPSHOT_S", 0.0)
    n, seconds = 60, 40
    with made(name) as transport, create(str(tmp_path / "spool"), RECORD, 3) as spool:
        fed(transport, fleet(n, seconds, 2), None if "://" not in name else spool)
    monkeypatch.setattr("navbound.live.fleet.files.READ_BYTES", 20_000)
    monkeypatch.setattr("navbound.live.fleet.brokers.numbered.MOST_READ", 20_000)
    for passes in (1, 2, 1):
        with connect(name) as transport:
            killed_at(transport, at, passes, monkeypatch)
    with connect(name) as transport:
        worked(transport)
    require_truth(name, n, seconds, 2)


def test_a_damaged_snapshot_is_refused_aloud_and_the_one_before_it_serves(name: str, tmp_path: Path) -> None:
    with made(name) as transport, create(str(tmp_path / "spool"), RECORD, 3) as spool:
        fed(transport, fleet(60, 40, 2), None if "://" not in name else spool)
        worked(transport)
        spoken: list[str] = []
        for damage in (b"", b"no snapshot", transport.kept(0)[0][:-9]):
            transport.keep(0, damage)
            Worker(transport, say=spoken.append).run(finishing=lambda: True)
            assert any("lane 0: a snapshot is refused" in sentence for sentence in spoken), damage
    require_truth(name, 60, 40, 2)


def test_outputs_that_are_not_those_of_the_inputs_are_refused(tmp_path: Path) -> None:
    name = str(tmp_path / "fleet")
    with made(name, 1) as transport:
        fed(transport, fleet(60, 40, 2))
        worked(transport)
    other = recorded(tmp_path / "other", frames(fleet(60, 40, 3), heartbeats=True), FLEET)
    live.judge(other, tmp_path / "judged")
    lane = tmp_path / "fleet" / "lane-00"
    for snapshot in lane.glob("snapshot*"):
        snapshot.unlink()
    (lane / journal.OUT).write_bytes((tmp_path / "judged" / journal.OUT).read_bytes())
    with connect(name) as transport, pytest.raises(Exception, match=r"other outputs than went out|inputs that are not there any more"):
        worked(transport)


WORK = "import sys; from navbound.cli.start import process; sys.argv = ['navbound', 'live', 'work', sys.argv[1], '--json']; process()"


def test_workers_are_killed_and_stopped_and_lanes_move(server: Server, tmp_path: Path) -> None:
    """A21: one of two is killed, the next frozen and let go; the frozen one is shut out and ends."""
    name, n, seconds, seed = server.name("moves"), 60, 40, 4
    with made(name, 4) as transport, create(str(tmp_path / "spool"), RECORD, 4) as spool:
        begin = [subprocess.Popen([sys.executable, "-c", WORK, name], stderr=subprocess.PIPE, text=True) for _ in range(2)]
        try:
            while len({(transport._newest("lease", lane) or (b"",))[0] for lane in range(4)} - {b""}) < 2:
                time.sleep(0.1)
            fed(transport, fleet(n, seconds, seed), spool)
            begin[0].send_signal(signal.SIGKILL)
            begin[1].send_signal(signal.SIGSTOP)
            worked(transport)
            begin[1].send_signal(signal.SIGCONT)
            assert begin[1].wait(90) != 0
            assert "this worker ends, and nothing of it is lost" in (begin[1].stderr.read() if begin[1].stderr else "")
        finally:
            for process in begin:
                if process.poll() is None:
                    process.kill()
                process.wait()
                if process.stderr:
                    process.stderr.close()
    require_truth(name, n, seconds, seed)


class Slowly(Lines):
    """A recording that takes some seconds."""

    def __init__(self, sent: tuple[Sent, ...], *, pace_s: float) -> None:
        super().__init__(sent)
        self._pace_s = pace_s

    def read(self, timeout_s: float) -> bytes | None:
        time.sleep(self._pace_s)
        return super().read(timeout_s)


@pytest.mark.parametrize("kind", ["nats", "kafka"])
def test_a_broker_that_dies_under_a_fleet_loses_nothing_and_doubles_nothing(kind: str, tmp_path: Path) -> None:
    """A20: between a feeder and a worker that are at work."""
    n, seconds, seed = 60, 40, 2
    with (serving if kind == "nats" else kafka_serving)(tmp_path / "server") as server:
        name, heard = server.name("dies"), list[str]()
        with made(name) as transport, create(str(tmp_path / "spool"), RECORD, 3) as spool, connect(name) as other:
            feeder = Feeder(spool, live.Settings(**RECORD["settings"]), target=transport, say=heard.append)
            worker = Worker(other, say=heard.append)
            feeding = threading.Thread(target=lambda: feeder.run(Slowly(fleet(n, seconds, seed), pace_s=0.2)))
            working = threading.Thread(target=lambda: worker.run(finishing=lambda: not feeding.is_alive()))
            feeding.start()
            working.start()
            while worker.n_transitions < 3:
                time.sleep(0.05)
            assert feeding.is_alive()
            server.kill()
            time.sleep(1.0)
            server.begin()
            feeding.join(120.0)
            working.join(120.0)
            assert not feeding.is_alive()
            assert not working.is_alive()
        assert not any("given back" in sentence or "recovered" in sentence for sentence in heard)
        require_truth(name, n, seconds, seed)


def stepped(run: lane_run.LaneRun, seconds: float) -> None:
    """Work on a lane for a while."""
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        run.step()


def test_a_frozen_worker_writes_nothing_behind_its_back(server: Server, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shared, "LEASE_S", 0.3)
    name = server.name("frozen")
    with made(name, 1) as frozen, create(str(tmp_path / "spool"), RECORD, 1) as spool:
        fed(frozen, fleet(60, 40, 2), spool)
        assert frozen.claim(0)
        run = lane_run.LaneRun(frozen, 0, FLEET.core(), report=lambda _: None, say=lambda _: None)
        with connect(name) as other:
            worked(other)
        with pytest.raises(FencedError):
            stepped(run, 20.0)
    require_truth(name, 60, 40, 2)


def test_a_worker_names_keys_that_nothing_reads_once(tmp_path: Path) -> None:
    lines = "".join(f'{{"v":1,"track":"A","time_ns":{k * 10**9},"fte_m":0,"sigma_m":5,"colour":1}}\n' for k in range(1, 5)).encode()
    heard: list[str] = []
    with create(str(tmp_path / "fleet"), RECORD, 1) as transport:
        transport.came_in(0).append(_core.live_input("chunk", None, lines), 0)
        assert transport.claim(0)
        run = lane_run.LaneRun(transport, 0, FLEET.core(), report=lambda _: None, say=heard.append)
        run.step()
        run.show()
        run.release()
    assert heard == ["lane 0: keys that nothing reads: colour"]


def test_a_dead_feeder_is_one_alert_and_not_one_for_each_aircraft(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A8: nothing arrives any more, heartbeats included."""
    record = RECORD | {"origin": {"kind": "live", "source": "a test", "speed": None}}
    now_ns = live.session.now_ns()
    lines = "".join(f'{{"v":1,"track":"{k:06x}","time_ns":{now_ns},"fte_m":0,"sigma_m":5}}\n' for k in range(50))
    declared: list[str] = []
    monkeypatch.setattr("navbound.live.fleet.worker.SILENT_S", 0.2)
    with create(str(tmp_path / "fleet"), record, 2) as transport:
        log = transport.came_in(0)
        log.append(_core.live_input("chunk", now_ns, lines.encode()), 0)
        worker = Worker(transport, report=lambda each: declared.append(f"{each['kind']} {each['transition']}"))
        until = time.monotonic() + 0.8
        worker.run(stop=lambda: time.monotonic() > until or len(declared) > 0)
        assert declared == ["feed_lost raised"]
        worker = Worker(transport, report=lambda each: declared.append(f"{each['kind']} {each['transition']}"))
        worker.run(stop=lambda: len(declared) > 1)
        assert declared == ["feed_lost raised"] * 2
        assert worker.n_transitions == 0
    assert os.path.exists(tmp_path / "fleet" / "fleet.json")
