"""The path of a table in pieces: none, a route, or approaches to runways."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import polars as pl

from navbound.read.approaches import cross_track_of, seek
from navbound.read.pieces.order import Pieces
from navbound.read.routes import follow
from navbound.storage.frames import Frames
from navbound.storage.tables import numbers, tracks

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from navbound.read.approaches import Gates, Landings
    from navbound.read.routes import Route
    from navbound.read.runways import Runway
    from navbound.records.run import CrossTrack


class Way(Protocol):
    """Where the epochs of a table should have been.

    Attributes
    ----------
    named : bool
        Whether there is a path.
    along_tracks : bool
        Whether it is followed along whole tracks.
    """

    named: bool
    along_tracks: bool

    def on_path(self, parts: Iterator[pl.DataFrame]) -> Iterator[pl.DataFrame]:
        """The epochs that are judged, with the path, in the order of track and time."""


def without_path(epochs: pl.DataFrame) -> pl.DataFrame:
    """Epochs of which nobody says where they should have been."""
    absent = (pl.lit(None, pl.Float64).alias(c) for c in ("course_rad", "fte_m"))
    return epochs.with_columns(*absent, pl.lit("recorded track").alias("phase"))


class NoWay:
    """Nobody says where the epochs should have been."""

    named = False
    along_tracks = False

    def on_path(self, parts: Iterator[pl.DataFrame]) -> Iterator[pl.DataFrame]:
        """All epochs."""
        return (without_path(part) for part in parts)


class OnRoute:
    """Epochs along a route.

    Attributes
    ----------
    n_beyond : int
        Those before its start and beyond its end.
    """

    named = True
    along_tracks = True

    def __init__(self, route: Route) -> None:
        self.route, self.n_beyond = route, 0

    def on_path(self, parts: Iterator[pl.DataFrame]) -> Iterator[pl.DataFrame]:
        """Epochs between its ends."""
        for part in parts:
            followed, n_beyond = follow(part, self.route)
            self.n_beyond += n_beyond
            if not followed.is_empty():
                yield followed

    def cross_track(self, epochs: Frames) -> CrossTrack:
        """Statistics of its epochs: one column of numbers is held."""
        means = [
            part.group_by("track", maintain_order=True).agg(pl.col("fte_m").mean())["fte_m"] for part in tracks(epochs, ["track", "fte_m"])
        ]
        return cross_track_of(self.route.name, numbers(epochs, "fte_m"), pl.concat(means))


class OnApproach:
    """Epochs on approaches to runways.

    Attributes
    ----------
    stated : str
        The path as it was given.
    landings : Landings
        The approaches.
    n_recorded, n_judged : int
        All epochs, and those on an approach.
    """

    named = True
    along_tracks = False
    landings: Landings

    def __init__(self, stated: str, runways: Sequence[Runway] | None, gates: Gates, piece_rows: int) -> None:
        self.stated = stated
        self._runways, self._gates, self._piece_rows = runways, gates, piece_rows
        self.n_recorded = self.n_judged = 0

    def on_path(self, parts: Iterator[pl.DataFrame]) -> Iterator[pl.DataFrame]:
        """Every epoch between the first and the last point of an approach, in the order of approach and time."""
        recorded, judged = Frames(), Frames()
        for part in parts:
            recorded.put(part)
        self.landings = seek(recorded, self._runways, self._gates)
        self.n_recorded = recorded.height
        for piece in recorded:
            between = self.landings.between(piece)
            if not between.is_empty():
                judged.put(between)
        recorded.close()
        self.n_judged = judged.height
        if judged.height == 0:
            return
        starts = self.landings.approaches.select(track="approach", time_ns="start")
        ordered = Pieces(starts["track"].to_list(), starts, max(1, starts.height * self._piece_rows // judged.height))
        for piece in judged:
            ordered.put(piece)
        judged.close()
        yield from ordered
        ordered.close()
