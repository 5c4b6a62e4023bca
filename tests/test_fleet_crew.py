"""When a feed has ended nothing is left unjudged: not the lanes of a worker that is gone, and not in silence."""

from __future__ import annotations

import os
import signal
import threading
import time
from pathlib import Path

import pytest

from fleet_fixture import fed, made, reported
from live_fixture import fleet, truth
from navbound import _core
from navbound.cli.live.fleet import alerts
from navbound.errors import FormatError
from navbound.live import journal
from navbound.live.fleet import UnreachableError, Worker, connect
from navbound.live.fleet.crew import Crew
from navbound.live.fleet.files import STATUS

N, SECONDS, SEED = 60, 40, 2


def keys(name: str) -> set[str]:
    return {record["key"] for record in reported(name)}


def judged(folder: Path) -> set[str]:
    """What one worker gives that nobody disturbs."""
    with made(str(folder)) as transport:
        fed(transport, fleet(N, SECONDS, SEED))
        Worker(transport).run(finishing=lambda: True)
    raised, cleared = truth(N, SECONDS, SEED)
    entry = keys(str(folder))
    assert len(entry) == len(raised) + len(cleared)
    return entry


def test_a_worker_ends_only_when_the_lanes_of_others_are_judged_too(tmp_path: Path) -> None:
    name = str(tmp_path / "fleet")
    with made(name) as transport:
        fed(transport, fleet(N, SECONDS, SEED))
    with connect(name) as other, connect(name) as transport:
        assert other.claim(1)
        rest = threading.Thread(target=Worker(transport).run, kwargs={"finishing": lambda: True})
        rest.start()
        rest.join(2.0)
        assert rest.is_alive(), "the lane of another was left where it stood"
        other.release(1)
        rest.join(30.0)
        assert not rest.is_alive()
    assert keys(name) == judged(tmp_path / "undisturbed")


def test_lanes_that_another_has_judged_are_not_waited_for(tmp_path: Path) -> None:
    name = str(tmp_path / "fleet")
    with made(name) as transport:
        fed(transport, fleet(N, SECONDS, SEED))
    with connect(name) as other, connect(name) as transport:
        ended, holder = threading.Event(), Worker(other)
        rest = threading.Thread(target=holder.run, kwargs={"stop": ended.is_set})
        rest.start()
        try:
            while not holder.lanes:
                time.sleep(0.01)
            Worker(transport).run(finishing=lambda: True)
            assert holder.lanes, "the one that does not end still has its own"
        finally:
            ended.set()
            rest.join()
    assert keys(name) == judged(tmp_path / "undisturbed")


def test_a_worker_that_is_killed_at_the_end_of_the_feed_is_followed_by_another(tmp_path: Path) -> None:
    name, sentences = str(tmp_path / "fleet"), list[str]()
    with made(name) as transport, Crew(name, 1, report=lambda _: None, say=sentences.append) as crew:
        begun = crew.members[0].process.pid
        assert begun is not None
        os.kill(begun, signal.SIGKILL)
        fed(transport, fleet(N, SECONDS, SEED))
        crew.finish(lambda: False)
    assert any("worker 1 ended (-9)" in sentence for sentence in sentences)
    assert keys(name) == judged(tmp_path / "undisturbed")


def test_alerts_of_a_fleet_that_is_judged_in_part_say_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    name = str(tmp_path / "fleet")
    with made(name) as transport:
        fed(transport, fleet(N, SECONDS, SEED))
        Worker(transport).run(finishing=lambda: True)
    alerts(name)
    assert "not all is judged" not in capsys.readouterr().err
    with made(name) as transport:
        log = transport.came_in(1)
        log.append(_core.live_input("heartbeat", 1, b""), log.end())
    alerts(name)
    assert "not all is judged: lanes 1 hold more" in capsys.readouterr().err
    # What a kill tore says nothing, and is no error.
    (tmp_path / "fleet" / "lane-01" / STATUS).write_bytes(b'{"lane": 1, "posi')
    alerts(name)
    assert "Traceback" not in capsys.readouterr().err


def test_what_cannot_be_judged_is_an_error_and_not_an_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("navbound.live.fleet.crew._AGAIN_MOST_S", 0.1)
    name = str(tmp_path / "fleet")
    with made(name, 1) as transport:
        fed(transport, fleet(N, SECONDS, SEED))
    path = tmp_path / "fleet" / "lane-00" / journal.IN
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 0x40
    path.write_bytes(content)
    with (
        Crew(name, 1, report=lambda _: None, say=lambda _: None) as crew,
        pytest.raises(FormatError, match=r"not judged to its end: worker 1 ended 6 times \(.*a frame is damaged at byte \d+\);"),
    ):
        crew.finish(lambda: False)


def test_a_worker_keeps_its_lanes_while_nobody_answers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It gave them back one by one, and judged them again from their snapshots afterwards."""
    monkeypatch.setattr("navbound.live.fleet.worker.RENEW_S", 0.0)
    sentences, rounds, silent = list[str](), [0], [False]
    with made(str(tmp_path / "fleet")) as transport:
        counted = transport.n_workers

        def n_workers() -> int:
            if silent[0]:
                raise UnreachableError("nobody answers")
            return int(counted())

        def stop() -> bool:
            rounds[0] += 1
            silent[0] = rounds[0] > 5
            if rounds[0] == 15:
                assert sorted(worker.lanes) == [0, 1, 2]
            return rounds[0] == 15

        monkeypatch.setattr(transport, "n_workers", n_workers)
        worker = Worker(transport, say=sentences.append)
        worker.run(stop=stop)
    assert rounds[0] == 15
    assert sentences == []
