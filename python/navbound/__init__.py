"""navbound: how wrong an aircraft's position may be, and when that is not good enough.

The subject modules take and give arrays: :mod:`navbound.tse`, :mod:`navbound.anp`, :mod:`navbound.rnp`, :mod:`navbound.gnss`.
Maps are made by :func:`navbound.maps.make`, long work is cut into tiles by :mod:`navbound.scale`. Whole jobs are functions that return a
:class:`navbound.run.directory.Run`: :func:`fly`, :func:`analyze`, :func:`study`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from navbound._core import __version__
from navbound.errors import FormatError, InputError, InternalError, NavboundError

if TYPE_CHECKING:
    from navbound.run.commands import analyze, fly
    from navbound.studies.run import study

__all__ = ["FormatError", "InputError", "InternalError", "NavboundError", "__version__", "analyze", "fly", "study"]


def __getattr__(name: str) -> object:
    """Load the jobs, and the tables they need, only when one is used."""
    if name in {"fly", "analyze"}:
        from navbound.run import commands  # noqa: PLC0415

        return getattr(commands, name)
    if name == "study":
        from navbound.studies.run import study  # noqa: PLC0415

        return study
    raise AttributeError(f"module 'navbound' has no attribute {name!r}")
