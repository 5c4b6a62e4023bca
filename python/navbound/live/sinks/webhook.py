"""Transitions of a session to a webhook, one POST each, in order, until each is taken.

The outbox is the journal out: a process of its own reads it, with a place of its own that is kept beside it. So a server that is slow or
gone delays neither the monitor nor a display, and nothing is lost where this process is killed: a transition whose answer was not heard is
sent again with the same key.
"""

from __future__ import annotations

import hashlib
import hmac
import http.client
import json
import random
import ssl
import time
from dataclasses import dataclass
from http import HTTPStatus
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from navbound import __version__, _core
from navbound.errors import FormatError, InputError
from navbound.live import journal
from navbound.live.session import origin_of
from navbound.live.settings import load
from navbound.live.sinks import transition
from navbound.live.tail import Tail
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

ANSWER_S = 5.0
"""Time within which a server must take a transition. [s]"""
FIRST_WAIT_S, LONGEST_WAIT_S = 1.0, 60.0
"""Wait after a failure, doubled each time; a tenth of it at random. [s]"""
TICK_S = 0.2
LEAST_SECRET = 16
"""Bytes of a secret. [B]"""
_LOOPBACK = ("127.0.0.1", "::1", "localhost")


@dataclass(frozen=True)
class Target:
    """Where transitions go.

    Attributes
    ----------
    url : str
        ``https``, or ``http`` to this host.
    secret : bytes, optional
        Key of the signature, HMAC-SHA-256 of the body in ``X-Navbound-Signature``.

    Raises
    ------
    InputError
        Another kind of address, or one with a name and a password in it.
    """

    url: str
    secret: bytes | None = None

    def __post_init__(self) -> None:
        try:
            parts = urlsplit(self.url)
            host, _ = parts.hostname, parts.port
        except ValueError as e:
            raise InputError("webhook", self.url, domain=f"an address ({e})") from e
        if parts.scheme not in {"http", "https"} or not host or not self.url.isascii() or any(c.isspace() for c in self.url):
            raise InputError("webhook", self.url, domain="https://host/path, or http:// to this host")
        if parts.scheme == "http" and host not in _LOOPBACK:
            raise InputError("webhook", self.url, domain="https:// for another host: http is for this host alone")
        if parts.username is not None or parts.password is not None:
            raise InputError("webhook", f"{parts.scheme}://...@{host}", domain="an address without a name and a password")

    @property
    def name(self) -> str:
        """Scheme and host, for a person: the path may be a secret."""
        parts = urlsplit(self.url)
        return f"{parts.scheme}://{parts.netloc}"

    @property
    def digest(self) -> str:
        """What tells one address from another without saying it."""
        return hashlib.sha256(self.url.encode()).hexdigest()

    def post(self, body: bytes, key: str) -> int:
        """Status of one POST. Redirects are not followed.

        Raises
        ------
        OSError, http.client.HTTPException
            No answer.
        """
        parts = urlsplit(self.url)
        kind = http.client.HTTPSConnection if parts.scheme == "https" else http.client.HTTPConnection
        more: dict[str, Any] = {"context": ssl.create_default_context()} if parts.scheme == "https" else {}
        line = kind(str(parts.hostname), parts.port, timeout=ANSWER_S, **more)
        headers = {"Content-Type": "application/json", "Idempotency-Key": key, "User-Agent": f"navbound/{__version__}"}
        if self.secret is not None:
            headers["X-Navbound-Signature"] = f"sha256={hmac.new(self.secret, body, hashlib.sha256).hexdigest()}"
        try:
            line.request("POST", (parts.path or "/") + (f"?{parts.query}" if parts.query else ""), body, headers)
            return line.getresponse().status
        finally:
            line.close()


def secret_of(path: Path) -> bytes:
    """The secret in a file, without the blanks at its ends.

    Raises
    ------
    FormatError
        It cannot be read, or is too short.
    """
    try:
        secret = path.read_bytes().strip()
    except OSError as e:
        raise FormatError(path, f"cannot be read: {e.strerror or e}") from e
    if len(secret) < LEAST_SECRET:
        raise FormatError(path, f"holds {len(secret)} bytes: a secret has {LEAST_SECRET} or more")
    return secret


class Webhook:
    """What of a session is still to be sent.

    Parameters
    ----------
    folder : Path
        Of a session that runs, or ran.
    target : Target
        Where to.
    say : callable
        Takes sentences on what fails, and when it goes again.

    Attributes
    ----------
    n_sent : int
        Transitions that were taken, those of processes before this one too.

    Raises
    ------
    FormatError
        Not the folder of a session, or its place belongs to another address or another journal.
    """

    def __init__(self, folder: Path, target: Target, *, say: Callable[[str], None] = lambda _: None) -> None:
        self._settings, self._origin = load(folder / journal.SETTINGS), origin_of(folder)
        self._target, self._say, self._place = target, say, folder / journal.SENT
        self._inputs, self._outputs = Tail(folder / journal.IN), Tail(folder / journal.OUT)
        self._waiting: list[dict[str, Any]] = []
        self._ended, self._refused_for_good = False, False
        self.n_sent, self._last_key = self._kept()
        self._skip = self.n_sent

    @property
    def n_waiting(self) -> int:
        """Transitions that are known and were not taken yet."""
        return len(self._waiting)

    def poll(self) -> bool:
        """Read on; whether the session has ended and everything of it is known.

        Raises
        ------
        FormatError
            A journal is damaged, or not the one whose transitions were sent before.
        """
        while True:
            came, went = self._inputs.frames(), self._outputs.frames()
            if came:
                self._ended = _core.live_inputs(came)[-1][0] == "end"
            for record in self._records(went):
                if self._skip == 0:
                    self._waiting.append(record)
                    continue
                self._skip -= 1
                if self._skip == 0 and record["key"] != self._last_key:
                    raise FormatError(self._place, f"belongs to another session: its last transition is not in {journal.OUT}; move it away")
            if not (self._inputs.behind or self._outputs.behind):
                break
        if self._ended and self._skip:
            raise FormatError(
                self._place,
                f"is ahead of {journal.OUT} by {counted(self._skip, 'transition')}: it belongs to another session; move it away",
            )
        return self._ended

    def _records(self, frames: bytes) -> list[dict[str, Any]]:
        return transition.records(frames, self._settings, origin=self._origin) if frames else []

    def run(self, *, stop: Callable[[], bool], until_end: bool = True) -> None:
        """Send until `stop`, until the session ended and everything was taken, or until the server wants no more.

        Raises
        ------
        FormatError
            A journal cannot be read, or the place cannot be kept.
        """
        wait_s = 0.0
        while not stop() and not self._refused_for_good:
            ended = self.poll()
            if not self._waiting:
                if ended and until_end:
                    return
                _pause(TICK_S, stop)
            elif self._send():
                wait_s = 0.0
            elif not self._refused_for_good:
                wait_s = min(LONGEST_WAIT_S, 2 * wait_s) if wait_s else FIRST_WAIT_S
                self._say(f"{counted(len(self._waiting), 'transition waits', 'transitions wait')}; again in {wait_s:.0f} s")
                _pause(wait_s * (1.0 + 0.1 * random.random()), stop)

    def _send(self) -> bool:
        """Send the first that waits; whether it was taken."""
        record = self._waiting[0]
        try:
            status = self._target.post(transition.line(record).encode(), record["key"])
        except (OSError, http.client.HTTPException) as e:
            self._say(f"{self._target.name}: {e or type(e).__name__}")
            return False
        if HTTPStatus.OK <= status < HTTPStatus.MULTIPLE_CHOICES or status == HTTPStatus.CONFLICT:
            self._waiting.pop(0)
            self.n_sent, self._last_key = self.n_sent + 1, record["key"]
            self._keep()
            return True
        if status == HTTPStatus.GONE:
            self._refused_for_good = True
            self._say(
                f"{self._target.name}: status 410, it wants no more; "
                f"{counted(len(self._waiting), 'transition is', 'transitions are')} not sent"
            )
            return False
        moved = ", a redirect, which is not followed" if status // 100 == 3 else ""
        self._say(f"{self._target.name}: status {status}{moved}")
        return False

    def _keep(self) -> None:
        place = {"v": 1, "target_sha256": self._target.digest, "n_sent": self.n_sent, "last_key": self._last_key}
        try:
            journal.put(self._place, json.dumps(place).encode())
        except OSError as e:
            raise FormatError(self._place, f"cannot be written: {e.strerror or e}") from e

    def _kept(self) -> tuple[int, str | None]:
        if not self._place.exists():
            return 0, None
        try:
            place = json.loads(self._place.read_text(encoding="utf-8"))
            n_sent, key, digest = int(place["n_sent"]), str(place["last_key"]), str(place["target_sha256"])
        except (OSError, ValueError, TypeError, KeyError, RecursionError) as e:
            raise FormatError(self._place, "not the place of a webhook, or damaged; move it away to send everything again") from e
        if n_sent < 1:
            raise FormatError(self._place, f"n_sent = {n_sent} is outside [1, inf); move it away to send everything again")
        if digest != self._target.digest:
            raise FormatError(self._place, "belongs to another address; move it away to send everything to this one")
        return n_sent, key


def _pause(wait_s: float, stop: Callable[[], bool]) -> None:
    """Wait, unless it is to stop."""
    until = time.monotonic() + wait_s
    while (left_s := until - time.monotonic()) > 0 and not stop():
        time.sleep(min(left_s, TICK_S))


def beside(folder: Path, target: Target, ready: Callable[[str], None], say: Callable[[str], None], stop: Callable[[], bool]) -> None:
    """Send in a process beside a session, until everything was taken or the session is gone."""
    webhook = Webhook(folder, target, say=say)
    ready(target.name)
    webhook.run(stop=stop)
