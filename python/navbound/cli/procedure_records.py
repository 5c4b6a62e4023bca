"""What `--json` of `navbound procedures` prints; written by :func:`navbound.cli.printed.write`."""

from __future__ import annotations

from dataclasses import dataclass

from navbound.procedures.database import Entry, Refused
from navbound.procedures.findings import Finding
from navbound.procedures.legs import Leg, LevelOfService
from navbound.procedures.vertical import VerticalPath


@dataclass(frozen=True)
class ProcedureList:
    """Of `navbound procedures list`."""

    file: str
    header: list[str]
    counts: dict[str, int]
    procedures: list[Entry]


@dataclass(frozen=True)
class ObstacleSurface:
    """As :class:`navbound.vertical.Surface`."""

    slope_ratio: float
    origin_m: float
    low_m: float
    roc_low_m: float
    roc_fix_m: float
    threshold_m: float


@dataclass(frozen=True)
class ShownProcedure:
    """Of `navbound procedures show`."""

    name: str
    file: str
    line: str | None
    length_m: float
    legs: list[Leg]
    levels: list[LevelOfService]
    notes: list[str]
    vertical_path: VerticalPath | None
    obstacle_surface: ObstacleSurface | None
    vertical_words: list[str]
    findings: list[Finding]


@dataclass(frozen=True)
class LocatedFinding:
    """A finding of :mod:`navbound.procedures`, and which leg it is about in one word."""

    line: int
    airport: str
    procedure: str
    transition: str
    sequence: int | None
    kind: str
    remark: bool
    published: float
    expected: float
    unit: str
    words: str
    where: str


@dataclass(frozen=True)
class CheckedProcedures:
    """Of `navbound procedures check`; of the refused lines the first ten thousand."""

    file: str
    counts: dict[str, int]
    n_refused: int
    refused: list[Refused]
    findings: list[LocatedFinding]
