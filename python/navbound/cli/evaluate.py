"""`navbound evaluate`: errors against protection levels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import typer

import navbound
from navbound.algorithms import Recorded, entries
from navbound.cli import interrupt
from navbound.cli.calls import call
from navbound.cli.choices import Selectable
from navbound.cli.parts import (
    SIGNAL,
    SIGNALS,
    SYSTEMS,
    Bar,
    Columns,
    Files,
    Ionosphere,
    Json,
    Mask,
    OutOfLevels,
    Solve,
    Truth,
    TruthTolerance,
    command_line,
    mapping,
    mask_rad,
    run_folder,
    tolerance,
)
from navbound.cli.show import show
from navbound.errors import ConflictError

if TYPE_CHECKING:
    from pathlib import Path

    from navbound.kpi import SubsetOptions

_LEVELS = "Service levels, separated by commas (APV-I,LPV-200,RNP 0.3,...); see `navbound levels`."
_PRN = "Whose SBAS messages, where a log holds several."
_PERIOD = "Sampling period. [default: the usual step]"
_MISSING = "Absent epochs are not expected."
_ESA = "With observations and --truth: every subset of satellites as a point of its own."
_MIN = "With --stanford-esa: fewest satellites of a subset. [default: 4]"
_MAX = "With --stanford-esa: at most 2 to this power subsets an epoch; beyond, fewer satellites are left out. [default: 14]"
_LISTED = "With --stanford-esa: safety index from which a subset is listed. [default: 0.7]"
_EXPERIMENTAL = "Words beside levels that no integrity rests on ('experimental, not integrity')."
_PROTECTION = (
    f"Protection levels of observations from given (a table, or the SBAS messages among the files), {', '.join(entries(Recorded))}."
)

OldLevels = Annotated[str | None, typer.Option("--levels", hidden=True)]
OldPrn = Annotated[int | None, typer.Option("--prn", hidden=True)]
OldPeriod = Annotated[float | None, typer.Option("--period-s", hidden=True)]
OldExcludeMissing = Annotated[bool, typer.Option("--exclude-missing", hidden=True)]
OldStanfordEsa = Annotated[bool, typer.Option("--stanford-esa", hidden=True)]
OldMin = Annotated[int | None, typer.Option("--min-satellites", hidden=True)]
OldMax = Annotated[int | None, typer.Option("--max-satellites", hidden=True)]
OldListed = Annotated[float | None, typer.Option("--listed-from", hidden=True)]
OldExperimental = Annotated[str, typer.Option("--experimental", hidden=True)]
OldProtection = Annotated[str | None, typer.Option("--protection", hidden=True)]


@dataclass(frozen=True)
class Options:
    """Options that only levels have; `analyze` takes them for one release more."""

    prn: int | None
    period_s: float | None
    exclude_missing: bool
    stanford_esa: bool
    min_satellites: int | None
    max_satellites: int | None
    listed_from: float | None
    experimental: str
    protection: str | None

    def refuse_any(self) -> None:
        """Refuse the first option that was typed, where a track is judged."""
        for name, value in vars(self).items():
            if value not in {None, False, ""}:
                raise ConflictError(name, needs=("levels",), because="it is an option of navbound evaluate")

    def subsets(self) -> SubsetOptions | None:
        """Options of subsets of satellites; refused without subsets, where they would do nothing."""
        typed = {name: getattr(self, name) for name in ("min_satellites", "max_satellites", "listed_from")}
        known = {name: value for name, value in typed.items() if value is not None}
        if self.stanford_esa:
            from navbound.kpi import SubsetOptions  # noqa: PLC0415

            return SubsetOptions(**known)
        for name in known:
            raise ConflictError(name, needs=("stanford_esa",), because="it is a setting of the subsets of satellites")
        return None


def evaluate_command(
    files: Files,
    levels: Annotated[str, typer.Option(help=_LEVELS), Selectable(lists="limits", commas=True)],
    truth: Truth = None,
    truth_tolerance_s: TruthTolerance = None,
    protection: Annotated[str | None, typer.Option(help=_PROTECTION), Selectable(lists="protection")] = None,
    prn: Annotated[int | None, typer.Option(help=_PRN)] = None,
    period_s: Annotated[float | None, typer.Option(help=_PERIOD)] = None,
    exclude_missing: Annotated[bool, typer.Option("--exclude-missing", help=_MISSING)] = False,
    stanford_esa: Annotated[bool, typer.Option("--stanford-esa", help=_ESA)] = False,
    min_satellites: Annotated[int | None, typer.Option(help=_MIN)] = None,
    max_satellites: Annotated[int | None, typer.Option(help=_MAX)] = None,
    listed_from: Annotated[float | None, typer.Option(help=_LISTED)] = None,
    experimental: Annotated[str, typer.Option(help=_EXPERIMENTAL)] = "",
    column: Columns = None,
    solve: Solve = False,
    signals: Annotated[str | None, typer.Option(help=SIGNALS.format("single")), SIGNAL] = None,
    systems: Annotated[str | None, typer.Option(help=SYSTEMS.format("G"))] = None,
    ionosphere: Ionosphere = None,
    mask: Mask = None,
    out: OutOfLevels = None,
    json: Json = False,
) -> None:
    """Evaluate errors and protection levels against service levels: accuracy, integrity, availability, continuity.

    The files are tables with protection levels (any number, joined by time), or RINEX observations with navigation files and, where a
    service corrects them, SBAS message logs; without messages the levels are the position's own and experimental. With --solve a receiver's
    log may be all three. A run that was interrupted goes on when it is started again with the same --out.
    """
    of_levels = Options(prn, period_s, exclude_missing, stanford_esa, min_satellites, max_satellites, listed_from, experimental, protection)
    reading: dict[str, Any] = {
        "truth": truth,
        **tolerance(truth_tolerance_s),
        "columns": mapping(column),
        "solve": solve,
        "signals": signals,
        "systems": systems,
        "ionosphere": ionosphere,
        "mask_rad": mask_rad(mask),
    }
    run(files, levels, of_levels, reading, out, json=json)


def run(files: list[Path], levels: str, of_levels: Options, reading: dict[str, Any], out: Path | None, *, json: bool) -> None:
    """Evaluate, print and end with the status of the verdict."""
    subsets, folder = of_levels.subsets(), run_folder(files, out, "evaluate-")
    interrupt.keep(f"Finished files are kept in {folder}: the same command goes on from there.")
    with Bar("files") as progress:
        evaluated = call(
            "navbound.evaluate",
            navbound.evaluate,
            files,
            levels=levels,
            prn=of_levels.prn,
            period_s=of_levels.period_s,
            exclude_missing=of_levels.exclude_missing,
            stanford_esa=subsets,
            experimental=of_levels.experimental,
            protection=of_levels.protection or "given",
            out=folder,
            progress=progress,
            command=command_line(),
            **reading,
        )
    show(evaluated, json=json)
