"""A study by its name: the one way in for Python and for the command line."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from navbound.errors import ConflictError, NotFoundError
from navbound.run import directory
from navbound.studies.registry import PAGES, REPORTS, STUDIES
from navbound.table.arguments import checked

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Unpack

    from navbound.scale import Work
    from navbound.studies.registry import Study


@checked
def study(name: str, files: Sequence[str | Path] = (), *, out: str | Path | None = None, **work: Unpack[Work]) -> Study:
    """Run a study by its name.

    Parameters
    ----------
    name : str
        Which.
    files : sequence of str or Path
        Recorded data, for a study that needs some.
    out : str or Path, optional
        Directory to write: a run with its report for a study of a flight, records and a page for one that has a page.
    **work
        ``backend``, ``checkpoint`` and ``workers`` of :func:`navbound.scale.map_tiles` for a study that is cut into tiles; ``progress`` for
        any.

    Raises
    ------
    InputError
        No such study; the message lists those that exist. Files for a study that needs none, a directory for one without a flight, a back
        end for one that is not cut into tiles.
    FormatError
        A file that is not there or cannot be read, or a run directory that cannot be written.
    """
    if name not in STUDIES:
        raise NotFoundError("study", name, "study", STUDIES)
    if out is not None and name not in REPORTS and name not in PAGES:
        raise ConflictError("out", because=f"only the studies {', '.join([*REPORTS, *sorted(PAGES)])} write a directory")
    outcome = STUDIES[name](files, **work)
    if out is not None and name in REPORTS:
        with directory.own(out) as folder:
            directory.write(REPORTS[name](), folder)
    elif out is not None:
        from navbound.studies import pages  # noqa: PLC0415 - loaded only where a page is due

        pages.write(outcome, Path(out))
    return outcome
