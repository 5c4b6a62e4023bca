"""The server of the live display: who may ask, what a page receives, what a slow, silent or hostile one costs the others."""

from __future__ import annotations

import asyncio
import ipaddress
import json
import math
import os
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest

from display_fixture import SETTINGS, Browser, Fed, served
from navbound import _core, live
from navbound.errors import FormatError, InputError
from navbound.live import journal
from navbound.live.display import Options, Watch, server, watch
from navbound.live.display import child as display_child
from navbound.live.session import now_ns, origin_of
from navbound.live.sinks import tables
from navbound.live.tail import Tail
from navbound.serve import hub, request

FOREIGN = "http://attacker.example"


@pytest.fixture
def fed(tmp_path: Path) -> Iterator[Fed]:
    session = Fed(tmp_path / "session")
    yield session
    session.close()


def test_without_the_token_nothing_is_sent(fed: Fed) -> None:
    fed.position()
    with served(fed.folder) as display:
        page = Browser(display)
        for method, path in (("GET", "/events"), ("GET", "/session"), ("POST", "/alive"), ("POST", "/acknowledge")):
            assert page.ask(method, path, "{}" if method == "POST" else "").status == 401, path
        assert page.ask("POST", "/session", json.dumps({"token": "0" * 32})).status == 401
        assert page.ask("POST", "/session", json.dumps({"token": 7})).status == 401
        assert page.ask("GET", "/session", Cookie=f"navbound-{display.port}={'0' * 32}").status == 401
        answer = page.ask("POST", "/session", json.dumps({"token": display.door.token}))
        assert answer.status == 204
        cookie = answer.headers["set-cookie"]
        assert all(part in cookie for part in ("HttpOnly", "SameSite=Strict", "Path=/"))
        assert page.ask("GET", "/session", Cookie=cookie.split(";")[0]).status == 204
        # The token stands where browsers do not send it, and no answer repeats it.
        assert display.address.endswith(f"/#{display.door.token}")
        assert len(display.door.token) == 32
        assert display.door.token not in page.ask("GET", "/").body


def test_other_hosts_and_other_origins_are_refused(fed: Fed) -> None:
    with served(fed.folder) as display:
        page = Browser(display).begin()
        for host in ("attacker.example", f"attacker.example:{display.port}", "127.0.0.1", f"127.0.0.1:{display.port + 1}", None):
            assert page.ask("GET", "/", Host=host).status == 421, host
        assert page.ask("GET", "/", Host=f"localhost:{display.port}").status == 200
        for origin in (FOREIGN, "null", f"https://{page.host}", None):
            assert page.ask("POST", "/acknowledge", '{"alert": "a"}', Origin=origin).status == 403, origin
        assert page.ask("GET", "/session", Origin=FOREIGN).status == 403
        # From the right page the same request is understood: there is no such alert.
        assert page.ask("POST", "/acknowledge", '{"alert": "a"}').status == 404


@pytest.mark.parametrize(
    "path",
    [
        "/../../etc/passwd",
        "/%2e%2e/%2e%2e/etc/passwd",
        "/%252e%252e/etc/passwd",
        "/live.js/",
        "/live.js%00",
        "//etc/passwd",
        "/_web/live.js",
    ],
)
def test_no_path_reaches_a_file(fed: Fed, path: str) -> None:
    with served(fed.folder) as display:
        assert Browser(display).ask("GET", path).status == 404


def test_what_is_too_long_too_slow_or_no_request_is_refused(fed: Fed, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(request, "REQUEST_S", 0.5)
    with served(fed.folder) as display:
        page = Browser(display)
        own = f"Host: {page.host}\r\n"
        assert page.ask("GET", "/", X_Long="x" * 9 * 1024).status == 431
        assert page.ask("POST", "/session", "x" * 5000).status == 413
        assert page.raw(f"POST /session HTTP/1.1\r\n{own}Content-Length: {'9' * 5000}\r\n\r\n".encode()).status == 413
        bad = {
            "no request": "GIVE ME\r\n\r\n",
            "another protocol": f"GET / SPDY/3\r\n{own}\r\n",
            "a header twice": f"GET / HTTP/1.1\r\n{own}{own}\r\n",
            "a length that is none": f"POST /session HTTP/1.1\r\n{own}Content-Length: -1\r\n\r\n",
            "pieces": f"POST /session HTTP/1.1\r\n{own}Transfer-Encoding: chunked\r\n\r\n",
            "an address of elsewhere": f"GET {FOREIGN}/ HTTP/1.1\r\n{own}\r\n",
        }
        for what, text in bad.items():
            assert page.raw(text.encode()).status == 400, what
        began = time.monotonic()
        with socket.create_connection(("127.0.0.1", display.port), 10.0) as line:
            line.sendall(b"GET / HTTP/1.1\r\n")
            assert page.read(line).status == 408
        assert 0.4 < time.monotonic() - began < 5.0
        assert page.ask("DELETE", "/").status == 405
        for body in ("[1]", "{", '{"token":' + "[" * 3000):
            assert page.ask("POST", "/session", body).status == 400
        assert page.ask("GET", "/").status == 200


def test_every_answer_has_the_headers_that_keep_a_page_to_itself(fed: Fed) -> None:
    with served(fed.folder) as display:
        page = Browser(display)
        for answer in (page.ask("GET", "/"), page.ask("GET", "/live.js"), page.ask("GET", "/nothing"), page.ask("GET", "/", Host="x")):
            policy = answer.headers["content-security-policy"]
            assert "default-src 'none'" in policy
            assert "frame-ancestors 'none'" in policy
            assert "require-trusted-types-for 'script'" in policy
            assert "unsafe" not in policy
            assert (answer.headers["x-content-type-options"], answer.headers["referrer-policy"]) == ("nosniff", "no-referrer")
            assert answer.headers["cache-control"] == "no-store"
            assert not any(name.startswith("access-control") for name in answer.headers)


def test_no_script_of_the_page_takes_text_for_markup_or_program() -> None:
    served_scripts = [content for path, (content, _) in server.bundle().items() if path.endswith(".js")]
    assert len(served_scripts) == 2
    for script in served_scripts:
        assert not re.search(rb"innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\(|new Function", script)


def test_only_this_host_is_listened_on(fed: Fed) -> None:
    with served(fed.folder) as display:
        addresses = [line.getsockname()[0] for line in display._sockets]
    assert len(addresses) in {1, 2}
    assert all(ipaddress.ip_address(address).is_loopback for address in addresses)


def test_an_address_that_asks_too_often_has_to_wait(fed: Fed, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(request, "RATE_PER_S", 0.001)
    with served(fed.folder) as display:
        page = Browser(display)
        statuses = [page.ask("GET", "/session").status for _ in range(int(request.BURST) + 3)]
    assert statuses == [401] * int(request.BURST) + [429] * 3


def test_a_port_that_is_taken_is_an_error(fed: Fed) -> None:
    with served(fed.folder) as display, pytest.raises(FormatError, match="choose another --port"):
        server.Server(Watch(fed.folder), Options(display.port))
    with pytest.raises(InputError, match="port"):
        Options(70_000)


def test_a_page_gets_what_the_journal_out_holds(fed: Fed) -> None:
    fed.position()
    with served(fed.folder) as display:
        time.sleep(0.5)
        with Browser(display).begin().stream() as page:
            snapshot = page.next("snapshot")
            fields = snapshot["session"]["fields"]
            fed.position(hpl_m=None, vpl_m=None, nav_mode=None)
            rows: list[list[object]] = []
            while not rows:
                rows = page.next("state")["rows"]
    expected = tables.epochs(fed.folder)
    assert expected.height == 2
    assert snapshot["track"] == "F1"
    for shown, at in ((snapshot["rows"][0], 0), (rows[-1], 1)):
        sent = dict(zip(fields, shown, strict=True))
        for name in watch.NUMBERS:
            value = expected[name][at]
            if value is None or math.isnan(value):
                assert sent[name] is None, name
            else:
                # Twelve digits are sent.
                assert sent[name] == pytest.approx(value, rel=1e-11), name
        assert {name: sent[name] for name in watch.WORDS} == {name: expected[name][at] for name in watch.WORDS}
        # Seconds of UTC since 1970: GPS time began 3657 days later and is 18 s ahead since 2017. A double holds a quarter of a microsecond.
        assert sent["utc_s"] == pytest.approx(expected["time_ns"][at] / 1e9 + 3657 * 86_400 - 18, abs=1e-6)
    # What the second record does not state is not that of the first.
    assert [dict(zip(fields, rows[-1], strict=True))[name] for name in ("hpl_m", "vpl_m", "nav_mode")] == [None, None, None]


def test_alerts_reach_every_page_with_the_keys_of_the_session(fed: Fed) -> None:
    fed.position()
    with served(fed.folder) as display:
        browser = Browser(display).begin()
        with browser.stream() as one, browser.stream() as other:
            for page in (one, other):
                assert page.next("snapshot")["open"] == []
            fed.position(fte_m=2000.0)
            sent = [[page.next("alert")["key"] for _ in fed.reported] for page in (one, other)]
        assert sent[0] == sent[1] == [each["key"] for each in fed.reported]
        assert len(sent[0]) == 1
        # One that comes later receives what lasts.
        with browser.stream() as late:
            snapshot = late.next("snapshot")
    assert [each["key"] for each in snapshot["open"]] == sent[0]
    assert snapshot["open"][0]["kind"] == "warning"


def test_an_acknowledgement_is_kept_and_sent_and_ends_no_alert(fed: Fed) -> None:
    fed.position()
    fed.position(fte_m=2000.0)
    with served(fed.folder) as display:
        time.sleep(0.5)
        browser = Browser(display).begin()
        with browser.stream() as page:
            (alert,) = page.next("snapshot")["open"]
            assert browser.ask("POST", "/acknowledge", json.dumps({"alert": "F1/0/warning/0"})).status == 404
            for _ in range(2):
                assert browser.ask("POST", "/acknowledge", json.dumps({"alert": alert["alert"]})).status == 204
            assert page.next("acknowledged")["alert"] == alert["alert"]
        with browser.stream() as page:
            again = page.next("snapshot")
    assert again["acknowledged"] == [alert["alert"]]
    assert [each["key"] for each in again["open"]] == [alert["key"]]
    (kept,) = [json.loads(line) for line in (fed.folder / journal.ACKNOWLEDGED).read_text().splitlines()]
    assert (kept["alert"], kept["session"]) == (alert["alert"], 1)
    fed.end()
    # The file belongs to the folder.
    live.Session(fed.folder, SETTINGS, resume=True).close()


def test_a_page_that_never_reads_costs_the_others_nothing(fed: Fed, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hub, "SILENT_S", 3.0)
    fed.position()
    with served(fed.folder) as display:
        browser = Browser(display).begin()
        deaf = [socket.create_connection(("127.0.0.1", display.port), 5.0) for _ in range(8)]
        for line in deaf:
            line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            line.sendall(browser.text("GET", "/events"))
        with browser.stream() as page:
            client = page.next("snapshot")["client"]
            waited, most = list[float](), 0
            began = time.monotonic()
            while time.monotonic() - began < 5.0:
                most = max(most, len(display.hub.clients))
                sent = time.monotonic()
                fed.position()
                while not page.next("state")["rows"]:
                    pass
                waited.append(time.monotonic() - sent)
                assert browser.ask("POST", "/alive", json.dumps({"client": client})).status == 204
                time.sleep(0.2)
            assert (most, len(display.hub.clients)) == (9, 1), "silent pages were not dropped"
        for line in deaf:
            line.close()
    # A page receives news each 0.1 s; the machine may be busy with other things for some more.
    assert sorted(waited)[len(waited) // 2] < 0.4
    assert len(waited) > 5


def test_more_pages_than_are_served_are_refused(fed: Fed, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(request, "BURST", 1000.0)
    fed.position()
    with served(fed.folder) as display:
        browser = Browser(display).begin()
        lines = []
        for _ in range(hub.MOST_CLIENTS):
            lines.append(socket.create_connection(("127.0.0.1", display.port), 5.0))
            lines[-1].sendall(browser.text("GET", "/events"))
            assert b"200 OK" in lines[-1].recv(15)
        assert browser.ask("GET", "/events").status == 503
        for line in lines:
            line.close()
        # Who leaves makes room.
        until = time.monotonic() + 5.0
        while display.hub.clients and time.monotonic() < until:
            time.sleep(0.05)
        with browser.stream() as page:
            assert page.status == 200


def test_what_waits_for_a_page_is_bounded_and_alerts_are_never_merged() -> None:
    async def run() -> None:
        client = hub.Client(1, "F1", 0.0)
        for k in range(1000):
            client.show([[float(k)]], {"feed": "live"})
        assert client.n_waiting == hub.MOST_ROWS
        for k in range(hub.MOST_ALERTS):
            client.tell("alert", {"key": k})
        assert not client.closed
        sent = (await client.take()).decode()
        keys = [json.loads(line.removeprefix("data: "))["key"] for line in sent.splitlines() if '"key"' in line]
        assert keys == list(range(hub.MOST_ALERTS))
        state = json.loads(sent.split("event: state\ndata: ")[1])
        assert state["rows"] == [[float(k)] for k in range(1000 - hub.MOST_ROWS, 1000)]
        assert state["n_skipped"] == 1000 - hub.MOST_ROWS
        for k in range(hub.MOST_ALERTS + 1):
            client.tell("alert", {"key": k})
        assert client.closed, "a page that has lost an alert must begin anew"
        assert await client.take() == b""

    asyncio.run(run())


class Time:
    """A clock that a test turns."""

    now_s = 100.0

    def __call__(self) -> float:
        return self.now_s


def test_a_reader_that_is_silent_is_lost_and_a_source_that_ended_says_so(fed: Fed) -> None:
    clock = Time()
    seen = Watch(fed.folder, clock)
    fed.position()
    seen.poll()
    assert seen.feed() == "live"
    clock.now_s += 2.4
    assert seen.feed() == "live"
    fed.heartbeat()
    seen.poll()
    clock.now_s += 2.4
    assert seen.feed() == "live"
    clock.now_s += 0.2
    assert seen.feed() == "lost"
    fed.end()
    seen.poll()
    assert seen.feed() == "ended"


def test_the_age_of_live_data_is_that_of_their_time_and_of_a_recording_that_of_its_reading(tmp_path: Path) -> None:
    clock = Time()
    settings = live.Settings(format="json", rnp_m=555.6, method="tse-exact")
    now = Fed(tmp_path / "live", settings)
    now.position(time_ns=now_ns() - 7_000_000_000)
    seen = Watch(now.folder, clock)
    seen.poll()
    # The position was seven seconds old when it came; the test takes some of its own.
    assert seen.status()["ages_s"]["F1"] == pytest.approx(7.0, abs=1.0)
    old = Fed(tmp_path / "replay", settings, live.Origin("replay", "a log", 0.5))
    old.position(time_ns=now_ns() - 7_000_000_000)
    seen = Watch(old.folder, clock)
    seen.poll()
    clock.now_s += 3.0
    assert seen.status()["ages_s"]["F1"] == 3.0
    # At half the pace data come half as often.
    assert (settings.stale_s, seen.stale_s()) == (2.0, 4.0)
    clock.now_s += 60.0
    assert seen.feed() == "live", "a recording has no reader that could be silent"
    for each in (now, old):
        each.close()


def test_a_damaged_journal_is_trouble_on_every_page(fed: Fed) -> None:
    fed.position()
    seen = Watch(fed.folder)
    seen.poll()
    with (fed.folder / journal.OUT).open("ab") as file:
        file.write(b"\x05\x00\x00\x00nonsense and more of it")
    seen.poll()
    assert seen.feed() == "lost"
    assert "damaged" in str(seen.status()["trouble"])


def test_a_journal_out_of_another_version_is_refused_with_what_to_do(fed: Fed) -> None:
    fed.position()
    fed.end()
    # A frame whose payload begins with the version of journals in, which is 1.
    (fed.folder / journal.OUT).write_bytes(_core.live_input("end", None, b""))
    with pytest.raises(FormatError, match=r"another version.*navbound live judge"):
        tables.epochs(fed.folder)
    with pytest.raises(FormatError, match=r"another version.*navbound live judge"):
        live.Session(fed.folder, SETTINGS, resume=True)
    live.judge(fed.folder, fed.folder.parent / "anew")
    assert tables.epochs(fed.folder.parent / "anew").height == 1


def test_a_frame_that_is_not_whole_yet_is_waited_for(fed: Fed) -> None:
    fed.position()
    whole = (fed.folder / journal.OUT).read_bytes()
    piece = fed.folder / "piece.nvj"
    tail = Tail(piece)
    assert tail.frames() == b""
    for cut in (3, len(whole) // 2, len(whole) - 1):
        piece.write_bytes(whole[:cut])
        assert tail.frames() == b"", cut
    piece.write_bytes(whole)
    assert tail.frames() == whole
    piece.write_bytes(whole[:5])
    with pytest.raises(FormatError, match="shorter"):
        tail.frames()


def test_late_records_are_not_the_present_and_a_clock_set_back_begins_anew(fed: Fed) -> None:
    seen = Watch(fed.folder)
    hpl = watch.FIELDS.index("hpl_m")
    begin = now_ns() - 60_000_000_000
    for k in (0, 1, 2, 1):
        fed.position(time_ns=begin + k * 100_000_000, hpl_m=float(10 + k))
    seen.poll()
    assert [row[hpl] for row in seen.tracks["F1"].rows] == [10.0, 11.0, 12.0]
    for k in range(40):
        fed.position(time_ns=begin - 30_000_000_000 + k * 100_000_000, hpl_m=float(20 + k))
    seen.poll()
    rows = list(seen.tracks["F1"].rows)
    assert all(later[0] > earlier[0] for earlier, later in pairwise(rows))
    assert rows[-1][hpl] == 59.0


def test_history_and_tracks_are_bounded(fed: Fed) -> None:
    seen = Watch(fed.folder)
    begin = now_ns() - 1_000_000_000_000
    for k in range(0, 900, 3):
        fed.position(time_ns=begin + k * 1_000_000_000)
    for k in range(watch.MOST_TRACKS + 5):
        fed.position(f"T{k}", time_ns=begin + 900_000_000_000)
    seen.poll()
    first, last = seen.tracks["F1"].rows[0], seen.tracks["F1"].rows[-1]
    assert last[0] - first[0] == pytest.approx(watch.HISTORY_S, abs=1e-6)
    assert (len(seen.tracks), seen.n_hidden) == (watch.MOST_TRACKS, 6)


def test_health_is_ok_degraded_or_lost_without_a_token(fed: Fed) -> None:
    def word(display: server.Server) -> tuple[int, str]:
        answer = Browser(display).ask("GET", "/health")
        return answer.status, json.loads(answer.body)["status"]

    with served(fed.folder) as display:
        assert word(display) == (200, "degraded")
        fed.position()
        time.sleep(0.5)
        assert word(display) == (200, "ok")
        fed.position(fte_m=2000.0)
        time.sleep(0.5)
        assert word(display) == (200, "degraded")
        time.sleep(watch.FEED_LOST_S + 0.3)
        assert word(display) == (503, "lost")


def test_the_display_beside_a_session_ends_with_it_and_its_death_does_not_hurt(fed: Fed) -> None:
    fed.position()
    with display_child(fed.folder, Options()) as child:
        port = int(child.text.split(":")[2].split("/")[0])
        socket.create_connection(("127.0.0.1", port), 5.0).close()
    with pytest.raises(OSError, match="refused"):
        socket.create_connection(("127.0.0.1", port), 5.0).close()
    with display_child(fed.folder, Options()) as child:
        assert child._process.pid is not None
        os.kill(child._process.pid, signal.SIGKILL)
        fed.position()
    assert fed.session.n_epochs == 2


def test_a_folder_that_is_no_session_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="settings of a live session"):
        display_child(tmp_path, Options())


def test_a_log_is_replayed_with_its_display_and_both_end_on_demand(tmp_path: Path) -> None:
    source, out = tmp_path / "lines.jsonl", tmp_path / "out"
    records = [{"v": 1, "track": "F1", "time_ns": 10**18 + k * 10**9, "fte_m": 5.0, "sigma_m": 3.0} for k in range(60)]
    source.write_text("".join(json.dumps(record) + "\n" for record in records))
    command = [sys.executable, "-m", "navbound", "live", "replay", str(source), "--speed", "20", "--level", "LPV-200", "--display"]
    with subprocess.Popen([*command, "--out", str(out)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline().startswith("Display: http://127.0.0.1:")
        until = time.monotonic() + 20.0
        while not (out / "epochs.parquet").exists() and time.monotonic() < until:
            time.sleep(0.1)
        time.sleep(0.5)
        assert process.poll() is None, "the display stays open for being read"
        process.send_signal(signal.SIGINT)
        stdout, stderr = process.communicate(timeout=15)
    assert process.returncode == 0, stderr
    assert "60 epochs" in stdout
    assert "stays open" in stderr
    origin = origin_of(out)
    # Limits of LPV-200: ICAO Annex 10, table 3.7.2.4-1.
    assert (origin["kind"], origin["speed"], origin["limits"]) == ("replay", 20.0, {"name": "LPV-200", "hal_m": 40.0, "val_m": 35.0})


def test_a_journal_is_judged_with_its_own_settings(fed: Fed) -> None:
    fed.position()
    fed.end()
    command = [
        sys.executable,
        "-m",
        "navbound",
        "live",
        "replay",
        str(fed.folder),
        "--spec",
        "RNP 1",
        "--out",
        str(fed.folder.parent / "out"),
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "--spec" in done.stderr
