"""A finished run as a source: its epochs as JSON lines, in the order of time."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import polars as pl

from navbound.errors import FormatError
from navbound.storage.folders import require_whole
from navbound.table.columns import COVARIANCE

if TYPE_CHECKING:
    from pathlib import Path

EPOCHS = "epochs.parquet"
_SHOWN = ("fte_v_m", "vpl_m", "hal_m", "val_m", "n_sv", "nav_mode")
_MOTION = ("est_lat_rad", "est_lon_rad", "est_h_m", "fte_m", "course_rad", "ground_speed_mps", "ground_track_rad")
_NUMBERS = (*_MOTION, *COVARIANCE, "hpl_m", "rnp_m", *_SHOWN)


def has_path(run: Path) -> bool:
    """Whether a run knows how far its aircraft were from a path."""
    try:
        names = pl.read_parquet_schema(run / EPOCHS)
        return "fte_m" in names and pl.read_parquet(run / EPOCHS, columns=["fte_m"])["fte_m"].is_not_null().any()
    except (OSError, pl.exceptions.PolarsError):
        return False


class Recording:
    """Lines of a run directory. A number that is absent there is absent in the line; bytes have no time of arrival."""

    live = False
    up = True
    size: int | None = None

    def __init__(self, run: Path, chunk: int) -> None:
        require_whole(run, [EPOCHS], "a run's directory")
        try:
            epochs = pl.read_parquet(run / EPOCHS)
        except (OSError, pl.exceptions.PolarsError) as e:
            raise FormatError(run / EPOCHS, f"cannot be read: {e}") from e
        names = [name for name in ("track", "time_ns", "status", *_NUMBERS) if name in epochs.columns]
        # A name of a live track is part of keys: it has no blanks and no slashes.
        plain = pl.col("track").str.replace_all("[ /]", "_")
        self._rows = epochs.sort("time_ns", "track", maintain_order=True).select(names).with_columns(plain)
        self._chunk, self._at, self._left = chunk, 0, b""

    def read(self, timeout_s: float) -> bytes | None:
        """Take the next bytes: as :class:`navbound.live.source.Source` says."""
        del timeout_s
        while len(self._left) < self._chunk and self._at < self._rows.height:
            rows = self._rows.slice(self._at, 100)
            self._at += rows.height
            self._left += b"".join(_line(row) for row in rows.iter_rows(named=True))
        taken, self._left = self._left[: self._chunk], self._left[self._chunk :]
        return taken or None

    def skip(self, n_bytes: int) -> None:
        """Leave out what was read by a session before."""
        chunk, self._chunk = self._chunk, n_bytes
        if n_bytes:
            self.read(0.0)
        self._chunk = chunk

    def close(self) -> None:
        """Nothing is open."""


def _line(row: dict[str, Any]) -> bytes:
    known = {name: value for name, value in row.items() if value is not None}
    return json.dumps({"v": 1, **known}, separators=(",", ":")).encode() + b"\n"
