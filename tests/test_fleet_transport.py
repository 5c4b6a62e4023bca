"""One contract, one suite: what is true of a transport of files is true of NATS JetStream and of Kafka."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from fleet_fixture import RECORD, Server, made, serving
from kafka_fixture import PretendedKafka, kafka_serving
from navbound import _core
from navbound.errors import FormatError, InputError
from navbound.live.fleet import FencedError, UnreachableError, connect, create
from navbound.live.fleet.brokers import shared
from navbound.live.fleet.transport import Log

A, B, C = (_core.live_input("chunk", k, bytes([k]) * 40 * k) for k in (1, 2, 3))


@pytest.fixture(scope="module")
def nats(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    with serving(tmp_path_factory.mktemp("nats")) as server:
        yield server


@pytest.fixture(scope="module")
def kafka(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    with kafka_serving(tmp_path_factory.mktemp("kafka")) as server:
        yield server


@pytest.fixture(scope="module")
def pretended() -> Iterator[PretendedKafka]:
    with pytest.MonkeyPatch.context() as patched:
        server = PretendedKafka()
        # It holds an empty answer back for all of that time, whatever is written meanwhile.
        patched.setattr("navbound.live.fleet.brokers.cluster.FETCH_WAIT_MS", 5)
        yield server


BROKERS = ["nats", "pretended", "kafka"]


@pytest.fixture(params=BROKERS)
def broker(request: pytest.FixtureRequest) -> str:
    server: Server = request.getfixturevalue(request.param)
    return server.name(f"suite-{abs(hash(request.node.name)) % 10**8}")


@pytest.fixture(params=["files", *BROKERS])
def name(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    if request.param == "files":
        return str(tmp_path / "fleet")
    server: Server = request.getfixturevalue(request.param)
    return server.name(f"suite-{abs(hash(request.node.name)) % 10**8}")


def everything(log: Log) -> bytes:
    content = b""
    while len(content) < log.end():
        content += log.read(len(content))
    return content


def test_what_is_appended_is_read_by_another_in_order_and_from_any_frame(name: str) -> None:
    with made(name) as writer, connect(name) as reader:
        log = writer.came_in(1)
        log.append(A, 0)
        log.append(B + C, len(A))
        assert log.end() == len(A + B + C)
        assert everything(reader.came_in(1)) == A + B + C
        behind = reader.came_in(1)
        content = b""
        while len(content) < len(B + C):
            content += behind.read(len(A + content))
        assert content == B + C
        assert reader.came_in(0).end() == reader.came_in(2).end() == reader.went_out(1).end() == 0
        assert reader.came_in(0).read(0) == b""


def test_a_reader_gets_nothing_twice_and_waits_at_the_end(name: str) -> None:
    with made(name) as writer, connect(name) as reader:
        source, log = writer.came_in(0), reader.came_in(0)
        content, at = b"", 0
        for k in range(20):
            frame = _core.live_input("heartbeat", k, b"")
            source.append(frame, at)
            at += len(frame)
            while len(content) < at:
                content += log.read(len(content))
        assert content == b"".join(_core.live_input("heartbeat", k, b"") for k in range(20))
        assert log.read(len(content)) == b""


def test_to_append_again_changes_nothing_and_something_else_is_refused(name: str) -> None:
    with made(name) as first, connect(name) as second:
        log = first.came_in(0)
        log.append(A, 0)
        log.append(A, 0)
        again = second.came_in(0)
        again.append(A, 0)
        assert again.end() == log.end() == len(A)
        with pytest.raises(FencedError):
            again.append(B, 0)
        with pytest.raises(FencedError):
            again.append(B, len(A) + 1)
        assert everything(second.came_in(0)) == A


def test_to_append_again_with_more_writes_what_is_not_there(name: str) -> None:
    with made(name) as first, connect(name) as second:
        log = first.came_in(0)
        log.append(A, 0)
        # A writer that was not answered repeats itself, with what has come meanwhile.
        again = second.came_in(0)
        again.append(A + B, 0)
        again.append(B + C, len(A))
        again.append(B, len(A))
        assert again.end() == len(A + B + C)
        with pytest.raises(FencedError):
            again.append(B + B, len(A))
        assert everything(first.came_in(0)) == A + B + C


def test_a_writer_that_knows_less_than_another_wrote_finds_it(broker: str) -> None:
    with made(broker) as first, connect(broker) as second:
        log, other = first.came_in(0), second.came_in(0)
        log.append(A, 0)
        other.append(B, len(A))
        other.append(C, len(A + B))
        # The same again is no harm, part by part; what then differs is.
        log.append(B + C + A, len(A))
        with pytest.raises(FencedError):
            other.append(B, len(A + B + C))
        assert everything(second.came_in(0)) == A + B + C + A


def test_frames_written_together_are_read_from_any_of_them(name: str) -> None:
    with made(name) as writer, connect(name) as reader:
        writer.came_in(0).append(A + B + C, 0)
        writer.came_in(0).append(A, len(A + B + C))
        whole = A + B + C + A
        for begin in (len(A), len(A + B), len(A + B + C)):
            log, content = reader.came_in(0), b""
            while len(content) < len(whole) - begin:
                content += log.read(begin + len(content))
            assert content == whole[begin:]


def test_a_reader_asks_again_where_a_log_ends(name: str) -> None:
    with made(name) as writer, connect(name) as reader:
        log, source = reader.came_in(0), writer.came_in(0)
        assert log.end() == 0
        source.append(A, 0)
        assert log.end() == len(A)


def test_the_newest_snapshot_comes_first_and_the_one_before_it_stays(name: str) -> None:
    with made(name) as transport, connect(name) as other:
        assert other.kept(0) == []
        for k in range(4):
            transport.keep(0, bytes([k]) * 700_000)
        assert [content[:1] for content in other.kept(0)] == [b"\x03", b"\x02"]
        assert all(len(content) == 700_000 for content in other.kept(0))
        other.keep(0, b"\x04")
        assert [content[:1] for content in transport.kept(0)] == [b"\x04", b"\x03"]
        assert transport.kept(1) == []


def test_a_lane_has_one_worker_until_it_is_stated_back(name: str) -> None:
    with made(name) as first, connect(name) as second:
        first.renew()
        assert first.claim(0)
        assert not second.claim(0)
        assert second.claim(1)
        first.release(0)
        assert second.claim(0)
        assert first.renew() == second.renew() == []


def test_newest_states_reach_who_shows_them(name: str) -> None:
    with made(name) as transport, connect(name) as other:
        other.shown(2)
        seen: list[tuple[bytes, bytes]] = []
        for k in range(200):
            transport.show(2, b"status %d" % k, [b"x" * 1000, b"y" * 1000])
            other.wait()
            seen += other.shown(2)
            if seen:
                break
        status, states = seen[-1]
        assert status.startswith(b"status ")
        assert states == b"x" * 1000 + b"y" * 1000
        assert other.shown(1) == []


def test_another_fleet_of_the_same_name_is_refused_and_the_same_is_gone_on_with(name: str) -> None:
    with made(name) as transport:
        transport.came_in(0).append(A, 0)
    with made(name) as again:
        assert again.came_in(0).end() == len(A)
    with pytest.raises(FormatError, match="other settings or another number of lanes"):
        create(name, RECORD, 4)
    other = RECORD | {"settings": RECORD["settings"] | {"rnp_m": 1.0}}
    with pytest.raises(FormatError, match="other settings or another number of lanes"):
        create(name, other, 3)


def test_a_fleet_that_is_not_there_says_how_to_begin_one(name: str) -> None:
    with pytest.raises(FormatError, match="begin one with navbound live feed"):
        connect(name + "x")


@pytest.mark.parametrize("scheme", ["nats", "kafka"])
def test_a_server_that_is_not_there_and_a_name_that_is_none_are_refused(scheme: str) -> None:
    pytest.importorskip({"nats": "nats", "kafka": "confluent_kafka"}[scheme], reason=f"SKIPPED ALOUD: no client of {scheme}")
    with pytest.raises(FormatError, match="start a"):
        connect(f"{scheme}://localhost:1/fleet")
    for wrong in ("://127.0.0.1:4222", "://127.0.0.1:4222/a.b", "://127.0.0.1:x/a", ":///a"):
        with pytest.raises(InputError, match=f"{scheme}://host:port/NAME"):
            connect(scheme + wrong)


def test_kafka_with_a_password_is_refused_without_printing_it() -> None:
    pytest.importorskip("confluent_kafka", reason="SKIPPED ALOUD: no client of kafka")
    with pytest.raises(InputError, match="connections with passwords are not built") as refused:
        connect("kafka://me:secret@127.0.0.1:1/fleet")
    assert "secret" not in str(refused.value)


@pytest.mark.parametrize(("scheme", "library", "modules"), [("nats", "nats", ["nats"]), ("kafka", "confluent_kafka", ["kafka", "cluster"])])
def test_a_broker_whose_client_is_missing_says_what_to_install(
    scheme: str, library: str, modules: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in modules:
        monkeypatch.delitem(sys.modules, f"navbound.live.fleet.brokers.{module}", raising=False)
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(InputError, match=rf"pip install 'navbound\[{scheme}\]'"):
        connect(f"{scheme}://127.0.0.1:1/fleet")


def test_what_is_no_transport_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="kafka://host:port/NAME"):
        connect("redis://127.0.0.1:6379/x")
    with pytest.raises(InputError):
        create(str(tmp_path / "a"), RECORD, 0)
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "diary.txt").write_text("mine")
    with pytest.raises(FormatError, match="holds files that are not a fleet's"):
        create(str(tmp_path / "full"), RECORD, 2)


def test_a_worker_that_did_not_answer_is_shut_out(broker: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shared, "LEASE_S", 0.2)
    with made(broker) as frozen, connect(broker) as other:
        assert frozen.claim(0)
        log = frozen.went_out(0)
        log.append(A, 0)
        assert not other.claim(0)
        while not other.claim(0):
            other.wait()
        for _ in range(2):
            with pytest.raises(FencedError):
                log.append(B, len(A))
        assert frozen.renew() == [0]
        later = other.went_out(0)
        later.append(C, len(A))
        assert everything(other.went_out(0)) == A + C


HOLDS = """
import sys, time
from navbound.live.fleet import connect
with connect(sys.argv[1]) as transport:
    transport.renew()
    print(transport.claim(0), flush=True)
    time.sleep(600)
"""


def test_a_worker_of_this_host_that_was_killed_is_followed_at_once(broker: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shared, "LEASE_S", 1e9)
    with made(broker) as other:
        process = subprocess.Popen([sys.executable, "-c", HOLDS, broker], stdout=subprocess.PIPE)
        assert process.stdout is not None
        assert process.stdout.readline() == b"True\n"
        assert not other.claim(0)
        assert other.n_workers() == 1
        process.kill()
        # Its parent does not know how it ended: it still has its number.
        while not other.claim(0):
            other.wait()
        assert other.n_workers() == 0
        process.communicate()


def test_who_claimed_a_lane_and_slept_before_it_wrote_is_shut_out(broker: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shared, "LEASE_S", 0.2)
    with made(broker) as frozen, connect(broker) as other:
        assert frozen.claim(0)
        while not other.claim(0):
            other.wait()
        log = frozen.went_out(0)
        assert log.end() == 0
        with pytest.raises(FencedError):
            log.append(A, 0)
        other.went_out(0).append(B, 0)
        assert everything(other.went_out(0)) == B


def test_of_workers_that_claim_at_once_one_has_the_lane(broker: str) -> None:
    first: Any
    second: Any
    with made(broker) as first, connect(broker) as second:
        for lane in range(3):
            # Both have seen that nobody has it.
            first._newest("lease", lane)
            second._newest("lease", lane)
            taken = [each._put(("lease", lane), each._me.encode(), last=0) for each in (first, second)]
            assert [number is None for number in taken] == [False, True]
            assert first._newest("lease", lane) == second._newest("lease", lane) == (first._me.encode(), taken[0])


def test_a_lane_whose_log_does_not_answer_is_not_kept_from_others(broker: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shared, "LEASE_S", 0.2)

    def silent(_: object) -> None:
        raise UnreachableError("nobody answers")

    with made(broker) as transport, connect(broker) as other:
        with monkeypatch.context() as patched:
            patched.setattr(type(transport.went_out(0)), "fence", silent)
            assert not transport.claim(0)
        while not other.claim(0):
            assert transport.renew() == []
            other.wait()


@pytest.mark.parametrize("kind", ["nats", "kafka"])
def test_a_server_that_dies_is_waited_for_and_loses_nothing(kind: str, tmp_path: Path) -> None:
    with (serving if kind == "nats" else kafka_serving)(tmp_path) as server:
        require_waiting(server)


def require_waiting(server: Server) -> None:
    with made(server.name("dies")) as writer, connect(server.name("dies")) as reader:
        source, log = writer.came_in(0), reader.came_in(0)
        source.append(A, 0)
        content = b""
        while len(content) < len(A):
            content += log.read(len(content))
        assert writer.claim(1)
        server.kill()
        with pytest.raises(UnreachableError):
            source.append(B, len(A))
        server.begin()
        while True:
            try:
                source.append(B + C, len(A))
                break
            except UnreachableError:
                writer.wait()
        while len(content) < len(A + B + C):
            content += log.read(len(content))
            reader.wait()
        assert content == A + B + C
        assert source.end() == len(A + B + C)
        # Nobody could renew: no lane counts as left.
        assert not reader.claim(1)
        assert writer.renew() == []
