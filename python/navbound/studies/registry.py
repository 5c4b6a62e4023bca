"""The studies: published evaluations repeated, each with a verdict on every number."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from navbound.errors import ConflictError, InputError
from navbound.studies.anp_comparison import study as anp_comparison
from navbound.studies.decorrelation_time import study as decorrelation_time
from navbound.studies.error_extraction import records as error_extraction_records
from navbound.studies.error_extraction import study as error_extraction
from navbound.studies.fault_campaign import healthy as healthy_flights
from navbound.studies.fault_campaign import records as fault_campaign_records
from navbound.studies.fault_campaign import study as fault_campaign
from navbound.studies.multipath_time_constants import study as multipath_time_constants
from navbound.studies.surface_movement import records as surface_movement_records
from navbound.studies.surface_movement import study as surface_movement
from navbound.studies.tse_coverage import study as tse_coverage
from navbound.studies.ukraine_rnav import study as ukraine_rnav
from navbound.studies.vertical_budget import study as vertical_budget

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path
    from typing import Unpack

    from rich.console import RenderableType

    from navbound.run.directory import Run
    from navbound.scale import Work

    Files = Sequence[str | Path]


class Study(Protocol):
    """What a study gives: records, and a table of them."""

    def model_dump_json(self, *, indent: int | None = None) -> str:
        """The records as JSON."""
        ...

    def table(self) -> RenderableType:
        """The records for a terminal."""
        ...


class _Run(Protocol):
    """What runs a study: the files of the command line, and who works."""

    def __call__(self, files: Files, **work: Unpack[Work]) -> Study: ...


def _alone(files: Files) -> None:
    if files:
        raise InputError("files", len(files), "1", "{0}: this study makes its own data")


def _in_one_piece(run: Callable[[Files], Study]) -> _Run:
    """A study of seconds, which nobody shares."""

    def whole(files: Files, **work: Unpack[Work]) -> Study:
        _refuse_tiles(work)
        return run(files)

    return whole


def _refuse_tiles(work: Work) -> None:
    for name in ("backend", "workers", "checkpoint"):
        if name in work:
            raise ConflictError(name, because="this study runs in one process")


def _anp_comparison(files: Files, **work: Unpack[Work]) -> Study:
    _alone(files)
    return anp_comparison.run(**work)


def _fault_campaign(files: Files, **work: Unpack[Work]) -> Study:
    _alone(files)
    return fault_campaign.run(**work)


def _healthy_flights(files: Files, **work: Unpack[Work]) -> Study:
    _alone(files)
    return healthy_flights.run(**work)


def _surface_movement(files: Files, **work: Unpack[Work]) -> Study:
    _refuse_tiles(work)
    return surface_movement.run(files, progress=work.get("progress"))


def _tse_coverage(files: Files, **work: Unpack[Work]) -> Study:
    _alone(files)
    return tse_coverage.run(**work)


def _ukraine_rnav(files: Files) -> Study:
    _alone(files)
    return ukraine_rnav.run()


def _vertical_budget(files: Files) -> Study:
    _alone(files)
    return vertical_budget.run()


STUDIES: dict[str, _Run] = {
    "anp-comparison": _anp_comparison,
    "decorrelation-time": _in_one_piece(decorrelation_time.run),
    "error-extraction": _in_one_piece(error_extraction.run),
    "fault-campaign": _fault_campaign,
    "healthy-flights": _healthy_flights,
    "multipath-time-constants": _in_one_piece(multipath_time_constants.run),
    "surface-movement": _surface_movement,
    "tse-coverage": _tse_coverage,
    "ukraine-rnav": _in_one_piece(_ukraine_rnav),
    "vertical-budget": _in_one_piece(_vertical_budget),
}
"""Every study by its command-line name."""

RECORDS: dict[str, type[Study]] = {
    "anp-comparison": anp_comparison.Study,
    "decorrelation-time": decorrelation_time.Study,
    "error-extraction": error_extraction_records.Study,
    "fault-campaign": fault_campaign_records.Study,
    "healthy-flights": fault_campaign_records.HealthyStudy,
    "multipath-time-constants": multipath_time_constants.Study,
    "surface-movement": surface_movement_records.Study,
    "tse-coverage": tse_coverage.Study,
    "ukraine-rnav": ukraine_rnav.Study,
    "vertical-budget": vertical_budget.Study,
}
"""What each of them gives."""

REPORTS: dict[str, Callable[[], Run]] = {"ukraine-rnav": ukraine_rnav.fly}
"""Studies of a flight: that flight as a judged run, for a run directory with its report."""

PAGES = frozenset({"fault-campaign", "surface-movement"})
"""Studies with a page of their own."""
