"""What a recording is judged against: a procedure of a file, and what its heights are compared with."""

from __future__ import annotations

import hashlib
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from navbound import procedures, vertical
from navbound.errors import InputError
from navbound.procedures.names import parts
from navbound.records.run import InputFile

if TYPE_CHECKING:
    from navbound.procedures import Procedure, VerticalPath
    from navbound.procedures.vertical import Shape

UNDULATION_M = (-120.0, 100.0)
"""Undulations on Earth lie between -107 and +86 m. [m]"""


@dataclass(frozen=True)
class Loaded:
    """A procedure with its vertical path, and what is said of the latter."""

    procedure: Procedure
    path: VerticalPath | None
    words: str


@dataclass(frozen=True)
class Flown:
    """Which procedure a recording is judged against.

    Attributes
    ----------
    database : path
        Navigation database of ARINC 424.
    name : str
        ``KDEN/H26-Z:FUZZZ``.
    line : str, optional
        Line of minima that is flown, such as ``RNP 0.3``.
    defaults, missed : bool
        As in :func:`navbound.path.procedure`.
    shape : {"barometric", "straight"}
        Vertical path: a constant slope over the curved Earth (baro-VNAV), or a straight ray (ILS, LPV, GLS).
    setting_hpa : float, optional
        Altimeter setting, which overrules those of the recording. [hPa]
    undulation_m : float, optional
        Ellipsoid below the sea, which overrules that of the runway's own two heights. [m]
    """

    database: str | Path
    name: str
    line: str | None = None
    defaults: bool = False
    missed: bool = False
    shape: Shape = "barometric"
    setting_hpa: float | None = None
    undulation_m: float | None = None

    def __post_init__(self) -> None:
        if self.setting_hpa is not None:
            vertical.setting_offset(self.setting_hpa)
        low, high = UNDULATION_M
        if self.undulation_m is not None and not low <= self.undulation_m <= high:
            raise InputError("undulation_m", self.undulation_m, "m", f"[{low:g}, {high:g}]")

    @property
    def settings(self) -> dict[str, object]:
        """For the run record."""
        return asdict(self) | {"database": str(self.database)}

    def source(self) -> InputFile:
        """The database as an input, without its text in memory."""
        with Path(self.database).open("rb") as stream:
            digest = hashlib.file_digest(stream, "sha256").hexdigest()
            return InputFile(path=str(self.database), sha256=digest, n_bytes=stream.tell(), n_rows=None)

    def load(self) -> Loaded:
        """The procedure of the file."""
        airport, ident, transition = parts(self.name)
        base = procedures.read(self.database)
        procedure = base.procedure(airport, ident, transition, missed=self.missed, line=self.line, defaults=self.defaults)
        return Loaded(procedure, *procedures.vertical_path(base, procedure, self.shape))
