"""The transport of one host: a folder, with a folder for each lane. Each is a session's: `navbound live judge` and `compare` take it."""

from __future__ import annotations

import fcntl
import json
import os
import time
import uuid
from pathlib import Path
from typing import Any

from navbound import _core
from navbound.errors import FormatError
from navbound.live import journal
from navbound.live.fleet.transport import WAIT_S, FencedError

FLEET = "fleet.json"
STATES, STATUS = "states.nvj", "status.json"
PREVIOUS = f"{journal.SNAPSHOT}.before"
WORKERS = "workers"
READ_BYTES = 1 << 20
"""Bytes that are read at once. [B]"""


class FileLog:
    """A journal that one process writes and others read.

    Parameters
    ----------
    path : Path
        Of the file.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._journal: journal.Journal | None = None
        self._end = 0

    def end(self) -> int:
        """Position behind the last whole frame: as :class:`navbound.live.fleet.transport.Log` says."""
        if self._journal is not None:
            return self._journal.length
        # Who only reads cuts nothing off: another process may be writing there.
        while frames := self.read(self._end):
            self._end += len(frames)
        return self._end

    def _writer(self) -> journal.Journal:
        # What a killed writer left torn is cut off by the next one, not by who reads.
        if self._journal is None:
            self._journal = journal.Journal(self._path)
        return self._journal

    def append(self, frames: bytes, at: int) -> None:
        """Write frames: as :class:`navbound.live.fleet.transport.Log` says."""
        written = self._writer()
        # A writer that repeats itself may have more to write by now.
        stands = written.content(at)[: len(frames)] if at < written.length else b""
        if at > written.length or stands != frames[: len(stands)]:
            raise FencedError(f"{self._path} holds other frames at byte {at}: another process writes there")
        if len(stands) < len(frames):
            written.append(frames[len(stands) :])

    def read(self, begin: int) -> bytes:
        """Frames from a position on: as :class:`navbound.live.fleet.transport.Log` says."""
        try:
            with self._path.open("rb") as file:
                size = os.fstat(file.fileno()).st_size
                if size <= begin:
                    return b""
                file.seek(begin)
                content = file.read(READ_BYTES)
                ends, behind = _core.live_frames(content)
                if not ends and len(content) == READ_BYTES:
                    content += file.read(journal.LONGEST_FRAME)
                    ends, behind = _core.live_frames(content)
        except FileNotFoundError:
            return b""
        if behind == "damaged":
            raise FormatError(self._path, f"a frame is damaged at byte {begin + (ends[-1] if ends else 0)}")
        return content[: ends[-1]] if ends else b""

    def sync(self) -> None:
        """To the disk."""
        if self._journal is not None:
            self._journal.sync()

    def close(self) -> None:
        """Leave the file as it is."""
        if self._journal is not None:
            self._journal.close()


class Files:
    """A folder: as :class:`navbound.live.fleet.transport.Transport` says."""

    def __init__(self, folder: Path, record: dict[str, Any], n_lanes: int) -> None:
        self.folder, self.record, self.n_lanes, self.name = folder, record, n_lanes, str(folder)
        self._logs: list[FileLog] = []
        self._current: dict[int, int] = {}
        self._shown: dict[int, int] = {}
        self._member: int | None = None
        self._me = uuid.uuid4().hex

    @classmethod
    def create(cls, name: str, record: dict[str, Any], n_lanes: int) -> Files:
        """Begin a fleet in a folder."""
        folder = Path(name)
        known = {"record": record, "n_lanes": n_lanes}
        if (folder / FLEET).exists():
            return cls._same(folder, known)
        if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
            raise FormatError(folder, "holds files that are not a fleet's; choose another folder")
        for lane in range(n_lanes):
            place = folder / f"lane-{lane:02d}"
            place.mkdir(parents=True, exist_ok=True)
            journal.put(place / journal.SETTINGS, json.dumps(record, indent=1).encode())
        (folder / WORKERS).mkdir(exist_ok=True)
        # The last file: a folder without it is no fleet yet.
        journal.put(folder / FLEET, json.dumps(known, indent=1).encode())
        return cls(folder, record, n_lanes)

    @classmethod
    def _same(cls, folder: Path, known: dict[str, Any]) -> Files:
        entry = _read(folder)
        if entry["record"]["settings"] != known["record"]["settings"] or entry["n_lanes"] != known["n_lanes"]:
            raise FormatError(folder, "holds a fleet of other settings or another number of lanes; choose another folder")
        return cls(folder, entry["record"], entry["n_lanes"])

    @classmethod
    def connect(cls, name: str, patience_s: float) -> Files:
        """Open a fleet in a folder."""
        folder, until = Path(name), time.monotonic() + patience_s
        while not (folder / FLEET).exists() and time.monotonic() < until:
            time.sleep(WAIT_S)
        entry = _read(folder)
        return cls(folder, entry["record"], entry["n_lanes"])

    def lane(self, lane: int) -> Path:
        """Folder of a lane."""
        return self.folder / f"lane-{lane:02d}"

    def _log(self, lane: int, name: str) -> FileLog:
        log = FileLog(self.lane(lane) / name)
        self._logs.append(log)
        return log

    def came_in(self, lane: int) -> FileLog:
        """What the feeder wrote."""
        return self._log(lane, journal.IN)

    def went_out(self, lane: int) -> FileLog:
        """What the worker wrote."""
        return self._log(lane, journal.OUT)

    def keep(self, lane: int, snapshot: bytes) -> None:
        """Keep a snapshot, and the one before it."""
        newest = self.lane(lane) / journal.SNAPSHOT
        if newest.exists():
            newest.replace(self.lane(lane) / PREVIOUS)
        journal.put(newest, snapshot)

    def kept(self, lane: int) -> list[bytes]:
        """Snapshots, the newest first."""
        places = (self.lane(lane) / name for name in (journal.SNAPSHOT, PREVIOUS))
        return [place.read_bytes() for place in places if place.exists()]

    def show(self, lane: int, status: bytes, states: list[bytes]) -> None:
        """Newest states."""
        # Where nothing is new the newest states stay, for a page that is opened later.
        if states:
            journal.put(self.lane(lane) / STATES, b"".join(states))
        journal.put(self.lane(lane) / STATUS, status)

    def shown(self, lane: int) -> list[tuple[bytes, bytes]]:
        """Status and states where they are new."""
        place = self.lane(lane) / STATUS
        try:
            written = place.stat().st_mtime_ns
            if written == self._shown.get(lane):
                return []
            self._shown[lane] = written
            states = self.lane(lane) / STATES
            return [(place.read_bytes(), states.read_bytes() if states.exists() else b"")]
        except FileNotFoundError:
            return []

    def claim(self, lane: int) -> bool:
        """Become the only worker of a lane. The system gives it back when this process ends, however it does."""
        self._be_counted()
        descriptor = os.open(self.lane(lane), os.O_RDONLY)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(descriptor)
            return False
        self._current[lane] = descriptor
        return True

    def renew(self) -> list[int]:
        """A lock of the system needs no renewal, and nobody takes it over."""
        return []

    def release(self, lane: int) -> None:
        """Give a lane back."""
        os.close(self._current.pop(lane))

    def _be_counted(self) -> None:
        if self._member is None:
            place = self.folder / WORKERS / self._me
            self._member = os.open(place, os.O_RDWR | os.O_CREAT, 0o600)
            fcntl.flock(self._member, fcntl.LOCK_EX)

    def n_workers(self) -> int:
        """Workers that hold the lock of their own file; a file of one that is gone is removed."""
        n = 0
        for place in (self.folder / WORKERS).iterdir():
            if place.name == self._me:
                n += self._member is not None
                continue
            descriptor = os.open(place, os.O_RDWR)
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                place.unlink(missing_ok=True)
            except OSError:
                n += 1
            finally:
                os.close(descriptor)
        return n

    def wait(self) -> None:
        """Files do not say when they grow."""
        time.sleep(WAIT_S)

    def close(self) -> None:
        """Give everything back."""
        for log in self._logs:
            log.close()
        for lane in list(self._current):
            self.release(lane)
        if self._member is not None:
            os.close(self._member)
            (self.folder / WORKERS / self._me).unlink(missing_ok=True)


def _read(folder: Path) -> dict[str, Any]:
    path = folder / FLEET
    try:
        entry = json.loads(path.read_text(encoding="utf-8"))
        if isinstance(entry["record"]["settings"], dict) and isinstance(entry["n_lanes"], int):
            return dict(entry)
    except FileNotFoundError as e:
        raise FormatError(folder, f"holds no fleet ({FLEET} is missing); begin one with navbound live feed SOURCE --to {folder}") from e
    except (OSError, ValueError, KeyError, TypeError) as e:
        raise FormatError(path, f"not the description of a fleet: {e}") from e
    raise FormatError(path, "not the description of a fleet")
