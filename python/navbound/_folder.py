"""Folders that a job writes: nothing of anyone else's is touched, and what the disk refuses is a sentence."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

from navbound.errors import FormatError

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator
    from pathlib import Path


@contextmanager
def own(out: Path, ours: Collection[str], whose: str) -> Iterator[None]:
    """Make a folder and write in it.

    Parameters
    ----------
    out : Path
        Which.
    ours : collection of str
        Names that may stand in it already.
    whose : str
        In the refusal of anything else: "a run's".

    Raises
    ------
    FormatError
        The folder holds something else; or it, or a file written inside the ``with``, cannot be written.
    """
    try:
        out.mkdir(parents=True, exist_ok=True)
        strangers = sorted(p.name for p in out.iterdir() if p.name not in ours)
        if strangers:
            raise FormatError(out, f"holds files that are not {whose} ({', '.join(strangers[:3])}); choose another --out")
        yield
    except OSError as e:
        raise FormatError(out, f"cannot be written: {e.strerror}") from e
