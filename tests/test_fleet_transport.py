"""One contract, one suite: what is true of a transport of files is true of NATS JetStream."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from fleet_fixture import RECORD, Server, made, serving
from navbound import _core
from navbound.errors import FormatError, InputError
from navbound.live.fleet import FencedError, UnreachableError, connect, create, nats
from navbound.live.fleet.transport import Log

A, B, C = (_core.live_input("chunk", k, bytes([k]) * 40 * k) for k in (1, 2, 3))


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    with serving(tmp_path_factory.mktemp("nats")) as server:
        yield server


@pytest.fixture(params=["files", "nats"])
def name(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    if request.param == "files":
        return str(tmp_path / "fleet")
    server: Server = request.getfixturevalue("server")
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


def test_a_server_that_is_not_there_and_a_name_that_is_none_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="start a server"):
        connect("nats://127.0.0.1:1/fleet")
    for wrong in ("kafka://127.0.0.1:9092/x", "nats://127.0.0.1:4222", "nats://127.0.0.1:4222/a.b", "nats://127.0.0.1:x/a"):
        with pytest.raises(InputError):
            connect(wrong)
    with pytest.raises(InputError):
        create(str(tmp_path / "a"), RECORD, 0)
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "diary.txt").write_text("mine")
    with pytest.raises(FormatError, match="holds files that are not a fleet's"):
        create(str(tmp_path / "full"), RECORD, 2)


def test_a_worker_that_did_not_answer_is_shut_out(server: Server, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(nats, "LEASE_S", 0.2)
    name = server.name("fenced")
    with made(name) as frozen, connect(name) as other:
        assert frozen.claim(0)
        log = frozen.went_out(0)
        log.append(A, 0)
        assert not other.claim(0)
        while not other.claim(0):
            other.wait()
        with pytest.raises(FencedError):
            log.append(B, len(A))
        assert frozen.renew() == [0]
        later = other.went_out(0)
        later.append(C, len(A))
        assert everything(other.went_out(0)) == A + C


def test_a_server_that_dies_is_waited_for_and_loses_nothing(tmp_path: Path) -> None:
    with serving(tmp_path) as server, made(server.name("dies")) as writer, connect(server.name("dies")) as reader:
        source, log = writer.came_in(0), reader.came_in(0)
        source.append(A, 0)
        content = b""
        while len(content) < len(A):
            content += log.read(len(content))
        server.kill()
        with pytest.raises(UnreachableError):
            source.append(B, len(A))
        server.begin()
        while True:
            try:
                source.append(B, len(A))
                break
            except UnreachableError:
                writer.wait()
        while len(content) < len(A + B):
            content += log.read(len(content))
            reader.wait()
        assert content == A + B
        assert source.end() == len(A + B)
