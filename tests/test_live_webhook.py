"""Transitions to a webhook: all of them, in order, whatever the server does and whoever is killed; and never a word to a third party."""

from __future__ import annotations

import hashlib
import hmac
import json
import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import TYPE_CHECKING, Any

import pytest

from live_fixture import FLEET, fleet
from navbound import live
from navbound.errors import FormatError, InputError
from navbound.live import journal
from navbound.live.sinks import webhook
from navbound.live.sinks.webhook import Target, Webhook, secret_of
from navbound.live.source import File

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

SECRET = b"0123456789abcdef-secret"


@dataclass
class Received:
    """What a server took."""

    port: int = 0
    bodies: list[dict[str, Any]] = field(default_factory=list)
    keys: list[str] = field(default_factory=list)
    headers: list[dict[str, str]] = field(default_factory=list)
    raw: list[bytes] = field(default_factory=list)
    n_requests: int = 0

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}/hook/token?a=1"


@contextmanager
def server(answer: Callable[[int], int] = lambda _: 204) -> Iterator[Received]:
    """A server that answers each request by its number; what it answers with 2xx or 409 it has taken."""
    received = Received()

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            received.n_requests += 1
            body = self.rfile.read(int(self.headers["Content-Length"]))
            status = answer(received.n_requests)
            if status == 0:
                # No answer at all.
                self.connection.close()
                return
            if status // 100 == 2 or status == 409:
                received.bodies.append(json.loads(body))
                received.raw.append(body)
                received.keys.append(self.headers["Idempotency-Key"])
                received.headers.append(dict(self.headers))
            self.send_response(status)
            if status // 100 == 3:
                self.send_header("Location", f"http://127.0.0.1:{received.port}/elsewhere")
            self.send_header("Content-Length", "0")
            self.end_headers()

        def log_message(self, *_: object) -> None:
            pass

    http = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    received.port = http.server_address[1]
    thread = threading.Thread(target=http.serve_forever, daemon=True)
    thread.start()
    try:
        yield received
    finally:
        http.shutdown()
        http.server_close()


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("log") / "fleet.jsonl"
    path.write_text("".join(line for _, line in fleet(120, 180)))
    return path


@pytest.fixture(scope="module")
def folder(log: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("session") / "out"
    with closing(File(log, 2500)) as source:
        live.Session(out, FLEET).run(source)
    return out


@pytest.fixture(autouse=True)
def _without_a_place(folder: Path) -> Iterator[None]:
    yield
    (folder / journal.SENT).unlink(missing_ok=True)


@pytest.fixture(autouse=True)
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(webhook, "FIRST_WAIT_S", 0.01)
    monkeypatch.setattr(webhook, "LONGEST_WAIT_S", 0.05)


def listed(folder: Path) -> list[str]:
    """Keys of all transitions, as the session listed them."""
    return [json.loads(line)["key"] for line in (folder / journal.EVENTS).read_text().splitlines()]


def sent(folder: Path, received: Received, **target: Any) -> tuple[Webhook, list[str]]:
    spoken: list[str] = []
    sender = Webhook(folder, Target(received.url, **target), say=spoken.append)
    sender.run(stop=lambda: False)
    return sender, spoken


def test_every_transition_is_taken_once_in_order(folder: Path) -> None:
    with server() as received:
        sender, spoken = sent(folder, received)
    assert received.keys == listed(folder)
    assert len(received.keys) > 50
    assert [body["key"] for body in received.bodies] == received.keys
    assert (sender.n_sent, sender.n_waiting, spoken) == (len(received.keys), 0, [])


def test_a_server_that_fails_in_every_way_gets_them_in_order_all_the_same(folder: Path) -> None:
    """Errors, silence, a redirect and conflicts by turns; a taken one whose answer is lost comes again with the same key."""
    answers = (500, 0, 302, 204, 409, 429, 200)
    with server(lambda n: answers[n % len(answers)]) as received:
        _, spoken = sent(folder, received)
    assert received.keys == listed(folder)
    assert received.n_requests > 2 * len(received.keys)
    assert any("status 302, a redirect, which is not followed" in sentence for sentence in spoken)
    assert any("status 500" in sentence for sentence in spoken)


def test_a_server_that_wants_no_more_is_left_alone(folder: Path) -> None:
    with server(lambda n: 204 if n <= 5 else 410) as received:
        sender, spoken = sent(folder, received)
    assert (received.n_requests, sender.n_sent) == (6, 5)
    assert f"{len(listed(folder)) - 5} transitions are not sent" in spoken[-1]


def test_who_sends_is_killed_again_and_again(folder: Path) -> None:
    """Killed by the system at no chosen point; at most the one whose answer was under way comes twice, and then with its own key."""
    program = (
        "import sys, pathlib\nfrom navbound.live.sinks import webhook\n"
        "webhook.FIRST_WAIT_S = 0.01\n"
        "w = webhook.Webhook(pathlib.Path(sys.argv[1]), webhook.Target(sys.argv[2]))\n"
        "print('ready', flush=True)\nw.run(stop=lambda: False)\n"
    )
    n_killed, keys = 0, listed(folder)

    def slowly(_: int) -> int:
        time.sleep(0.002)
        return 204

    with server(slowly) as received:
        for _ in range(200):
            child = subprocess.Popen([sys.executable, "-c", program, str(folder), received.url], stdout=subprocess.PIPE)
            assert child.stdout is not None
            child.stdout.readline()
            before = len(set(received.keys))
            # Some more were taken, and then it is killed.
            while child.poll() is None and len(set(received.keys)) < before + len(keys) // 6 + 1:
                time.sleep(0.001)
            if child.poll() is None:
                os.kill(child.pid, signal.SIGKILL)
                n_killed += 1
            child.wait()
            child.stdout.close()
            if child.returncode == 0:
                break
    assert n_killed >= 3
    assert list(dict.fromkeys(received.keys)) == keys
    assert len(received.keys) - len(keys) <= n_killed


def test_the_signature_is_that_of_the_body(folder: Path, tmp_path: Path) -> None:
    file = tmp_path / "secret"
    file.write_bytes(SECRET + b"\n")
    with server() as received:
        sent(folder, received, secret=secret_of(file))
    for body, headers in zip(received.raw, received.headers, strict=True):
        assert headers["X-Navbound-Signature"] == f"sha256={hmac.new(SECRET, body, hashlib.sha256).hexdigest()}"
        assert headers["Content-Type"] == "application/json"


def test_the_address_and_the_secret_are_kept_nowhere(folder: Path) -> None:
    with server() as received:
        _, spoken = sent(folder, received, secret=SECRET)
        kept = (folder / journal.SENT).read_text() + "".join(spoken)
    assert "token" not in kept
    assert SECRET.decode() not in kept


def test_the_place_of_another_address_or_session_is_refused(folder: Path) -> None:
    with server() as received:
        sent(folder, received)
    with pytest.raises(FormatError, match="belongs to another address"):
        Webhook(folder, Target("https://192.0.2.1/other"))
    place = json.loads((folder / journal.SENT).read_text())
    (folder / journal.SENT).write_text(json.dumps(place | {"last_key": "A/1/caution/5/raised"}))
    with pytest.raises(FormatError, match="belongs to another session"):
        Webhook(folder, Target(received.url)).poll()
    (folder / journal.SENT).write_text(json.dumps(place | {"n_sent": place["n_sent"] + 3}))
    with pytest.raises(FormatError, match=r"is ahead of out\.nvj by 3 transitions"):
        Webhook(folder, Target(received.url)).poll()


@pytest.mark.parametrize("content", [b"", b"{}", b"[1]", b'{"n_sent": -1, "last_key": "a", "target_sha256": "b"}', b"\xff", b"[" * 100_000])
def test_a_damaged_place_is_refused(folder: Path, content: bytes) -> None:
    (folder / journal.SENT).write_bytes(content)
    with pytest.raises(FormatError, match="move it away"):
        Webhook(folder, Target("https://192.0.2.1/"))


@pytest.mark.parametrize(
    ("url", "says"),
    [
        ("ftp://host/", "https://host/path"),
        ("http://192.0.2.1/hook", "http is for this host alone"),
        ("http://localhost.example.org/", "http is for this host alone"),
        ("https://user:password@host/", "without a name and a password"),
        ("https:///nothing", "https://host/path"),
        ("https://host:99999/", "an address"),
        ("https://host/a b", "https://host/path"),
        ("https://host/\r\nX: 1", "https://host/path"),
        ("", "https://host/path"),
    ],
)
def test_addresses_that_are_refused(url: str, says: str) -> None:
    with pytest.raises(InputError) as refusal:
        Target(url)
    assert says in str(refusal.value)
    assert "password@" not in str(refusal.value)


def test_a_short_or_missing_secret_is_refused(tmp_path: Path) -> None:
    (tmp_path / "short").write_text("abc\n")
    with pytest.raises(FormatError, match="holds 3 bytes: a secret has 16 or more"):
        secret_of(tmp_path / "short")
    with pytest.raises(FormatError, match="cannot be read"):
        secret_of(tmp_path / "none")


def command(*arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "navbound", "live", *map(str, arguments)], capture_output=True, text=True, timeout=120, check=False
    )


def test_a_session_sends_while_it_runs_and_the_command_goes_on_with_the_rest(log: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    with server() as received:
        ended = command("watch", log, "--out", out, "--webhook", received.url, "--period-s", 1)
        assert ended.returncode == 0, ended.stderr
        assert received.keys == listed(out)
        again = command("send", out, "--webhook", received.url)
        assert again.returncode == 0
        assert f"{len(received.keys)} transitions taken by http://127.0.0.1:{received.port}, 0 wait." in again.stdout
        assert received.n_requests == len(received.keys)
    # The session is the same as one that sends nothing.
    alone = command("watch", log, "--out", tmp_path / "alone", "--period-s", 1)
    assert alone.returncode == 0
    assert command("compare", out, tmp_path / "alone").returncode == 0


def test_a_wrong_use_of_the_command_is_refused(log: Path, tmp_path: Path) -> None:
    assert "--secret-file" in command("watch", log, "--out", tmp_path / "a", "--secret-file", "x").stderr
    refused = command("watch", log, "--out", tmp_path / "b", "--webhook", "http://192.0.2.1/")
    assert refused.returncode == 2
    assert not (tmp_path / "b").exists()
    assert command("send", tmp_path, "--webhook", "https://192.0.2.1/").returncode == 3
