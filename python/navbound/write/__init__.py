"""The epoch table, measurements and broadcast records to files of other programs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import _core
from navbound.errors import ConflictError, InputError
from navbound.table.arguments import checked, whole
from navbound.table.columns import COVARIANCE
from navbound.words.plurals import counted
from navbound.write.geographic import Shape, geojson, kml, shapes
from navbound.write.measurements import WrittenLog, navigation, observations, ubx
from navbound.write.sbas import Sent, ems

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Sent", "Shape", "Written", "WrittenLog", "ems", "geojson", "kml", "navigation", "observations", "rtklib", "shapes", "ubx"]

_PARTS = {
    "a time": ("time_ns",),
    "a position": ("est_lat_rad", "est_lon_rad"),
    "a height": ("est_h_m",),
    "a horizontal covariance": tuple(name for name in COVARIANCE if "u" not in name),
    "a vertical covariance": tuple(name for name in COVARIANCE if "u" in name),
}
"""What an epoch of a solution file has, and the columns that hold it."""


@dataclass(frozen=True)
class Written:
    """A file that was written.

    Attributes
    ----------
    path : Path
        Where.
    n_rows : int
        Positions in it. [1]
    n_left_out : int
        Epochs without a position or without a full covariance: the format has no word for what is absent. [1]
    """

    path: Path
    n_rows: int
    n_left_out: int


@checked
def rtklib(epochs: pl.DataFrame, path: str | Path, *, track: str | None = None, quality: int = 5) -> Written:
    """Write the epoch table as an RTKLIB solution file (`.pos`), which :func:`navbound.read.read` reads back.

    Parameters
    ----------
    epochs : DataFrame
        Epoch table with time, position and the six columns of the covariance; ``n_sv`` where it has it. Velocities are not written.
    path : str or Path
        The file.
    track : str, optional
        Which track; needed where the table holds several.
    quality : int, optional
        The program's word for the kind of position: 1 fix, 2 float, 3 SBAS, 4 differential, 5 single, 6 precise point.

    Returns
    -------
    Written
        Latitude and longitude are rounded to 1e-9 degrees, height and the roots of the covariance to 0.1 mm.

    Raises
    ------
    InputError
        Columns that are missing, several tracks, a quality that is none, a number outside its domain, or not one epoch to write.
    """
    quality = whole("quality", quality, 1, 7)
    tracks = epochs["track"].unique(maintain_order=True).to_list() if "track" in epochs.columns else []
    if track is not None:
        if track not in tracks:
            raise InputError("track", track, domain=f"one of {', '.join(map(str, tracks))}")
        epochs = epochs.filter(pl.col("track") == track)
    elif len(tracks) > 1:
        because = f"a solution file holds one track, and there are {', '.join(map(str, tracks[:8]))}"
        raise ConflictError("epochs", needs=("track",), because=because)
    there = {part: _there(epochs, names) for part, names in _PARTS.items()}
    kept = epochs.filter(pl.all_horizontal(there.values()))
    if kept.is_empty():
        raise InputError("epochs", _lacking(epochs, there), domain=_COMPLETE)
    count = kept["n_sv"].fill_null(0).cast(pl.UInt32) if "n_sv" in kept.columns else pl.zeros(kept.height, pl.UInt32, eager=True)
    text = _core.write_rtklib(
        f"navbound {_core.__version__}",
        np.ascontiguousarray(kept["time_ns"].to_numpy(), dtype=np.int64),
        _floats(kept, "est_lat_rad"),
        _floats(kept, "est_lon_rad"),
        _floats(kept, "est_h_m"),
        np.ascontiguousarray(np.column_stack([_floats(kept, c) for c in COVARIANCE])),
        np.ascontiguousarray(count.to_numpy(), dtype=np.uint32),
        quality,
    )
    place = Path(path)
    place.write_text(text, encoding="ascii")
    return Written(place, kept.height, epochs.height - kept.height)


_COMPLETE = f"{', '.join(list(_PARTS)[:-1])} and {list(_PARTS)[-1]} together in one epoch at least; .geojson and .kml need no covariance"


def _there(epochs: pl.DataFrame, names: tuple[str, ...]) -> pl.Expr:
    """Whether an epoch has a finite number in each of these columns."""
    if not set(names) <= set(epochs.columns):
        return pl.lit(value=False)
    return pl.all_horizontal(pl.col(name).is_not_null() & pl.col(name).is_finite() for name in names)


def _lacking(epochs: pl.DataFrame, there: dict[str, pl.Expr]) -> str:
    """A table of which no epoch is complete, by what its epochs lack."""
    n_without = {part: epochs.height - epochs.filter(has).height for part, has in there.items()}
    lacks = [f"{n} without {part} ({', '.join(_PARTS[part])})" for part, n in n_without.items() if n]
    return ", ".join([f"a table of {counted(epochs.height, 'epoch')}", *lacks])


def _floats(frame: pl.DataFrame, column: str) -> NDArray[np.float64]:
    return np.ascontiguousarray(frame[column].to_numpy(), dtype=np.float64)
