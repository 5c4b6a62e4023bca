"""What a log yields while it is decoded."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from importlib import import_module
from io import BytesIO
from typing import TYPE_CHECKING, Any

from navbound.errors import InputError
from navbound.table.columns import COVARIANCE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path
    from types import ModuleType

_KEPT_NOTES = 8


@dataclass
class Log:
    """Rows of positions and a count of what did not become one.

    Attributes
    ----------
    path : Path
        The file.
    needs : str
        Messages that hold a position.
    rows : list of dict
        Columns of docs/notation.md for each position, with ``time_ns`` or, before the scale is known, ``unix_ns``; and ``record``, the
        number of the message from 1.
    n_rows : int
        Positions in the log, used or not.
    left_out : dict
        Reason to count, first record, example and whether the message is damaged.
    columns : dict
        Quantity to the message and field it was read from.
    notes : list of str
        Doubts that a person should settle.
    """

    path: Path
    needs: str
    rows: list[dict[str, Any]] = field(default_factory=list)
    n_rows: int = 0
    left_out: dict[str, tuple[int, int, str, bool]] = field(default_factory=dict)
    columns: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def leave_out(self, reason: str, record: int, example: str, *, damaged: bool = False) -> None:
        """Count a position, or a damaged message, that is not used."""
        count, first, shown, bad = self.left_out.get(reason, (0, record, example, damaged))
        self.left_out[reason] = (count + 1, first, shown, bad)

    def attempt(self, record: int, build: Callable[[], None]) -> None:
        """Make a row of messages; one that is shorter than its definition, and so lacks a field, is counted as damaged."""
        try:
            build()
        except AttributeError as e:
            self.leave_out("damaged message", record, f"a field is missing: {e}", damaged=True)

    def drop_unsound(self) -> None:
        """Take out rows that lie nowhere or at no time, as whole messages with wrong contents give them, and count them."""
        for row in self.rows:
            if not _sound(row):
                shown = {name: row.get(name) for name in ("est_lat_rad", "est_lon_rad", "est_h_m", "time_ns", "unix_ns") if name in row}
                self.leave_out("position or time outside its domain", row["record"], str(shown), damaged=True)
        self.rows = [row for row in self.rows if _sound(row)]

    def note(self, note: str) -> None:
        """Add a note once."""
        if note not in self.notes and len(self.notes) < _KEPT_NOTES:
            self.notes.append(note)


_LATEST_NS = 4_000_000_000_000_000_000
"""GPS or Unix time of the year 2096 or later: none that a log can hold."""
_LOWEST_M, _HIGHEST_M = -20_000.0, 1e8
"""Limits of the readers of positions."""


def _sound(row: dict[str, Any]) -> bool:
    time, h = row.get("time_ns", row.get("unix_ns", -1)), row.get("est_h_m")
    on_earth = abs(row["est_lat_rad"]) <= math.pi / 2 and abs(row["est_lon_rad"]) <= math.tau
    return bool(on_earth and (h is None or _LOWEST_M < h < _HIGHEST_M) and 0 <= time < _LATEST_NS)


def package(name: str, path: Path) -> ModuleType:
    """Import a decoder of the extra `receivers`.

    Raises
    ------
    InputError
        It is not installed.
    """
    try:
        return import_module(name)
    except ImportError as e:
        domain = f"a log that needs the package {name.partition('.')[0]}: install it with pip install 'navbound[receivers]'"
        raise InputError("files", str(path), domain=domain) from e


def messages(
    open_reader: Callable[[BytesIO, Callable[[Exception], None]], Iterator[Any]], content: bytes, log: Log
) -> Iterator[tuple[int, Any]]:
    """Numbered messages of a log; what the decoder refuses, or stumbles over, is counted as damaged.

    Parameters
    ----------
    open_reader : callable
        From a stream and a handler of errors to an iterator of the package.
    content : bytes
        The log.
    log : Log
        Where damage is counted.
    """
    stream, damaged = BytesIO(content), list[str]()
    reader = open_reader(stream, lambda e: damaged.append(str(e)))
    record, at, in_messages = 0, -1, 0
    while True:
        record += 1
        try:
            message = next(reader)
        except StopIteration:
            message = None
        except Exception as e:
            # A decoder of others, fed with damaged bytes, may raise anything; the stream has moved on unless it stands still.
            damaged.append(f"{type(e).__name__}: {e}")
            if stream.tell() == at:
                message = None
            else:
                at = stream.tell()
                continue
        for what in damaged:
            log.leave_out("damaged message", record, what, damaged=True)
        damaged.clear()
        if message is None:
            note_passed_over(log, len(content) - in_messages, len(content))
            return
        in_messages += len(message[0] or b"")
        yield record, message


def note_passed_over(log: Log, n_bytes: int, of: int) -> None:
    """A message whose first or last bytes are lost leaves nothing but bytes that nobody takes."""
    if n_bytes > 0:
        log.notes.append(f"{log.path.name}: {n_bytes} of {of} bytes belong to no message that is read (text, other protocols, or damage)")


def diagonal(e_m: float, n_m: float, u_m: float) -> dict[str, float]:
    """Covariance of standard deviations whose correlations are not known [m²]."""
    return dict(zip(COVARIANCE, (e_m**2, 0.0, n_m**2, 0.0, 0.0, u_m**2), strict=True))
