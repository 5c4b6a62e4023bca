"""Frames on the disk, in a file without a name: whatever ends the process, nothing of them stays."""

from __future__ import annotations

import io
import tempfile
import weakref
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import polars as pl
from polars.io.plugins import register_io_source

from navbound.errors import FormatError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray


class Spool:
    """Frames that are put away one after the other and taken by their place."""

    def __init__(self) -> None:
        self._file = tempfile.TemporaryFile(prefix="navbound-")  # noqa: SIM115 - it lives as long as the spool
        weakref.finalize(self, self._file.close)

    def put(self, frame: pl.DataFrame) -> tuple[int, int]:
        """Write a frame; its place.

        Raises
        ------
        FormatError
            The folder of temporary files is full.
        """
        content = io.BytesIO()
        frame.write_ipc_stream(content, compression="lz4")
        try:
            at = self._file.seek(0, io.SEEK_END)
            self._file.write(content.getbuffer())
        except OSError as e:
            where = Path(tempfile.gettempdir())
            raise FormatError(where, f"cannot hold the pieces of a large table: {e.strerror} (TMPDIR names another place)") from e
        return at, content.tell()

    def get(self, place: tuple[int, int]) -> pl.DataFrame:
        """A frame that was put away."""
        self._file.seek(place[0])
        return pl.read_ipc_stream(io.BytesIO(self._file.read(place[1])))

    def close(self) -> None:
        """Give the disk back."""
        self._file.close()


class Frames:
    """A table in pieces, column by column on the disk.

    Attributes
    ----------
    height : int
        Rows of all pieces.
    schema : Schema
        Of every piece.
    """

    def __init__(self) -> None:
        self.height = 0
        self.schema = pl.Schema()
        self._spool = Spool()
        self._places = list[dict[str, tuple[int, int]]]()
        self._tracks = list[tuple[str, str]]()

    def put(self, piece: pl.DataFrame) -> None:
        """Put the next piece away, all with the same columns."""
        self.schema = self.schema or piece.schema
        self._places.append({name: self._spool.put(piece.select(name)) for name in self.schema})
        self._tracks.append((piece["track"][0], piece["track"][-1]))
        self.height += piece.height

    @property
    def columns(self) -> list[str]:
        """Names of the columns."""
        return self.schema.names()

    def __iter__(self) -> Iterator[pl.DataFrame]:
        """Every piece, in order."""
        return self.select(self.columns)

    def select(self, names: Sequence[str]) -> Iterator[pl.DataFrame]:
        """Some columns of every piece, in order."""
        for places in self._places:
            yield pl.concat([self._spool.get(places[name]) for name in names], how="horizontal")

    def piece(self, index: int) -> pl.DataFrame:
        """One piece by its place."""
        places = self._places[index]
        return pl.concat([self._spool.get(places[name]) for name in self.columns], how="horizontal")

    def track(self, name: str, columns: Sequence[str]) -> Iterator[pl.DataFrame]:
        """Some columns of the rows of one track, of a table in the order of tracks."""
        for places, (first, last) in zip(self._places, self._tracks, strict=True):
            if first <= name <= last:
                of_track = self._spool.get(places["track"])["track"] == name
                yield pl.concat([self._spool.get(places[column]).filter(of_track) for column in columns], how="horizontal")

    def first(self, name: str) -> Any:
        """The first value of a column."""
        return self._spool.get(self._places[0][name])[name][0]

    def write_parquet(self, path: str | Path, compression: Literal["zstd"], metadata: dict[str, str] | None = None) -> None:
        """Write one file, a row group for each piece."""

        def pieces(*_: object) -> Iterator[pl.DataFrame]:
            # All columns and rows are requested: nothing stands between the pieces and the file.
            yield from self

        register_io_source(pieces, schema=self.schema).sink_parquet(path, compression=compression, metadata=metadata, engine="streaming")

    def numbers(self, name: str) -> NDArray[np.float64]:
        """The numbers of a column that are finite, in order."""
        finite, n = np.empty(self.height), 0
        for piece in self.select([name]):
            values = piece[name].cast(pl.Float64).fill_null(np.nan).to_numpy()
            known = values[np.isfinite(values)]
            finite[n : n + len(known)] = known
            n += len(known)
        return finite[:n]

    def frame(self) -> pl.DataFrame:
        """The whole table in memory."""
        return pl.concat(list(self)) if self._places else pl.DataFrame(schema=self.schema)

    def close(self) -> None:
        """Give the disk back."""
        self._spool.close()
