"""The studies: published evaluations repeated, each with a verdict on every number."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from navbound.run import study_tse_coverage

if TYPE_CHECKING:
    from collections.abc import Callable

    from rich.console import RenderableType


class Study(Protocol):
    """What a study gives: records, and a table of them."""

    def model_dump_json(self, *, indent: int | None = None) -> str:
        """The records as JSON."""
        ...

    def table(self) -> RenderableType:
        """The records for a terminal."""
        ...


STUDIES: dict[str, Callable[[], Study]] = {"tse-coverage": study_tse_coverage.run}
"""Every study by its command-line name."""
