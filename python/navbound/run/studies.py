"""The studies: published evaluations repeated, each with a verdict on every number."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from navbound.errors import InputError
from navbound.run import (
    study_anp_comparison,
    study_decorrelation_time,
    study_error_extraction,
    study_multipath_time_constants,
    study_surface_movement,
    study_tse_coverage,
    study_ukraine_rnav,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from rich.console import RenderableType

    from navbound.run.directory import Run


class Study(Protocol):
    """What a study gives: records, and a table of them."""

    def model_dump_json(self, *, indent: int | None = None) -> str:
        """The records as JSON."""
        ...

    def table(self) -> RenderableType:
        """The records for a terminal."""
        ...


def _alone(files: Sequence[str | Path]) -> None:
    if files:
        raise InputError("files", len(files), "1", "{0}: this study makes its own data")


def _anp_comparison(files: Sequence[str | Path]) -> Study:
    _alone(files)
    return study_anp_comparison.run()


def _tse_coverage(files: Sequence[str | Path]) -> Study:
    _alone(files)
    return study_tse_coverage.run()


def _ukraine_rnav(files: Sequence[str | Path]) -> Study:
    _alone(files)
    return study_ukraine_rnav.run()


STUDIES: dict[str, Callable[[Sequence[str | Path]], Study]] = {
    "anp-comparison": _anp_comparison,
    "decorrelation-time": study_decorrelation_time.run,
    "error-extraction": study_error_extraction.run,
    "multipath-time-constants": study_multipath_time_constants.run,
    "surface-movement": study_surface_movement.run,
    "tse-coverage": _tse_coverage,
    "ukraine-rnav": _ukraine_rnav,
}
"""Every study by its command-line name; each is given the files of the command line."""

REPORTS: dict[str, Callable[[], Run]] = {"ukraine-rnav": study_ukraine_rnav.fly}
"""Studies of a flight: that flight as a judged run, for a run directory with its report."""

PAGES = frozenset({"surface-movement"})
"""Studies with a page of their own."""
