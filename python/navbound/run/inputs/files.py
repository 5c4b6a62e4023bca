"""Files of one run, distinguished by what they hold."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from navbound import _core
from navbound.errors import ConflictError, UnpairedError
from navbound.read.source import Source, load

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path


@dataclass(frozen=True)
class Files:
    """Files by what they hold; the raw log of a receiver may stand in several lists.

    Attributes
    ----------
    tables : list of Source
        Tables, solution files, and logs of positions.
    observations, navigation, messages : list of Source
        Measurements, orbits and clocks, SBAS messages.
    """

    tables: list[Source] = field(default_factory=list)
    observations: list[Source] = field(default_factory=list)
    navigation: list[Source] = field(default_factory=list)
    messages: list[Source] = field(default_factory=list)

    def require_navigation(self) -> None:
        """Refuse observations without orbits, or orbits without observations.

        Raises
        ------
        UnpairedError
            Naming the file and what is lacking.
        """
        if self.observations and not self.navigation:
            first = self.observations[0].path
            why = "holds observations and no orbits: name a RINEX navigation file of the same time beside it"
            raise UnpairedError("files", first, f"{why} ({first.name} NAVIGATION_FILE){self._taken_for_tables()}")
        if not self.observations and (self.navigation or self.messages):
            first = (self.navigation + self.messages)[0].path
            why = "holds no observations and no positions: name a RINEX observation file of the same time beside it"
            raise UnpairedError("files", first, f"{why} (OBSERVATION_FILE {first.name}){self._taken_for_tables()}")

    def _taken_for_tables(self) -> str:
        names = ", ".join(str(source.path) for source in self.tables)
        if not names:
            return ""
        raw = any(_raw(source) for source in map(load, (source.path for source in self.tables)))
        return f" (taken for tables of positions: {names})" + ("; --solve takes the raw measurements of a receiver's log" if raw else "")

    def unused_words(self) -> list[str]:
        """Files of SBAS messages, where positions are solved without a service."""
        others = {source.path for source in self.tables + self.observations}
        alone = [source.path.name for source in self.messages if source.path not in others]
        words = "messages of an augmentation service are not used here; navbound evaluate corrects positions with them."
        return [f"{name}: {words}" for name in alone]

    def cut_words(self) -> list[str]:
        """Text files of records that end within a line, as files do that were cut."""
        every = {source.path: source for source in self.observations + self.navigation + self.messages if source.open_end}
        return [
            f"{path.name}: the last line has no end, as in a file that was cut; what may have stood after it is not known."
            for path in every
        ]


KEPT_BYTES = 64 << 20
"""Plain bytes of measurements and messages that are kept until they are read: two days of 30 s epochs as plain text. [B] Ours."""


def sort_out(paths: Sequence[str | Path], *, solve: bool = False) -> Files:
    """Tell observations, navigation data, message logs and tables apart by their content.

    Digests and kinds are kept, and as much content as :data:`KEPT_BYTES`; the rest is read again when it is needed.

    Parameters
    ----------
    paths : sequence of paths
        The files.
    solve : bool
        Take the measurements, subframes and SBAS messages of a receiver's raw log, not the positions that it found itself.

    Raises
    ------
    FormatError
        A file that cannot be read.
    InputError
        `solve` where no file holds measurements.
    """
    files, room = Files(), KEPT_BYTES
    for path in paths:
        source = load(path)
        raw = _raw(source) if solve else None
        kinds = raw or [_kind(source)]
        if kinds == ["tables"]:
            source.refuse_unknown()
        # Of a receiver's log the text may be the smallest part.
        open_end = raw is None and not source.content.endswith((b"\n", b"\r", b"\x1a")) and source.content[:200].isascii()
        content = source.content if kinds != ["tables"] and len(source.content) <= room else b""
        room -= len(content)
        kept = Source(source.path, content, source.sha256, source.n_bytes, open_end)
        for kind in kinds:
            getattr(files, kind).append(kept)
    if solve and not files.observations:
        raise ConflictError("solve", needs=("files",), because="a file of raw measurements (RINEX, UBX RXM-RAWX, SBF MeasEpoch)")
    return files


def _raw(source: Source) -> list[str] | None:
    log = _core.raw_log(source.content, str(source.path))
    return None if log is None else [k for k, n in zip(("observations", "navigation", "messages"), log, strict=True) if n]


_LISTS = ("observations", "navigation", "messages")


def _kind(source: Source) -> str:
    """The list that a file of one content belongs to. A log of a receiver may hold all; its own positions are tables."""
    holds = source.format.holds
    if "clocks" in holds:
        # Refused there, as no record of orbits stands in it.
        return "navigation"
    return next((name for name in _LISTS if holds == (name,)), "tables")
