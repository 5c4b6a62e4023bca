"""navbound: how wrong an aircraft's position may be, and when that is not good enough.

The subject modules take and give arrays: :mod:`navbound.tse`, :mod:`navbound.anp`, :mod:`navbound.rnp`, :mod:`navbound.gnss`.
Maps are made by :func:`navbound.maps.make`, long work is cut into tiles by :mod:`navbound.scale`. Whole jobs are functions that return a
:class:`navbound.run.directory.Run`: :func:`fly`, :func:`analyze`, :func:`evaluate`, :func:`study`. Subjects and jobs are loaded when they
are first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from navbound._core import __version__
from navbound.errors import FormatError, InputError, InternalError, NavboundError

if TYPE_CHECKING:
    from navbound.run.commands import analyze, evaluate, fly
    from navbound.studies.run import study

SUBJECTS = (
    *(
        "anp",
        "araim",
        "dme",
        "evaluation",
        "gbas",
        "gnss",
        "ins",
        "judge",
        "kpi",
        "path",
        "procedures",
        "raim",
        "rnp",
        "rraim",
        "sbas",
        "tse",
        "vertical",
    ),
    *("algorithms", "maps", "methods", "plot", "scale", "scenario", "status", "time", "units", "verify", "write"),
)
"""Modules that a caller uses, by name."""
_JOBS = {**dict.fromkeys(("analyze", "evaluate", "fly"), "navbound.run.commands"), "study": "navbound.studies.run"}

__all__ = ["SUBJECTS", "FormatError", "InputError", "InternalError", "NavboundError", "__version__", "analyze", "evaluate", "fly", "study"]


def __getattr__(name: str) -> object:
    """Load a subject, or a job and the tables it needs, only when one is used."""
    if name in SUBJECTS:
        return import_module(f"navbound.{name}")
    if name in _JOBS:
        return getattr(import_module(_JOBS[name]), name)
    raise AttributeError(f"module 'navbound' has no attribute {name!r}")


def __dir__() -> list[str]:
    """What a caller uses: jobs, errors and subjects."""
    return sorted({*__all__, *SUBJECTS})
