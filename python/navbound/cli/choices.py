"""What stands beside an option for a page that offers it: its list, whether a file may stand there, whether it is a folder that is written.

The declaration of an option carries it: `Annotated[str, typer.Option(...), Selectable(...)]`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    Choices = list[tuple[str, str]]
    """(value as it is typed, words)."""

NUMBER = r"-?\d+(\.\d+)?"
_RUNWAY = r"[A-Za-z0-9]{2,7}/[A-Za-z0-9]{1,4}"
RUNWAY = rf"{_RUNWAY}(,{_RUNWAY})*"
POINT = rf"{NUMBER},{NUMBER}(,{NUMBER})?"


@dataclass(frozen=True)
class Selectable:
    """What an option can be chosen from.

    Attributes
    ----------
    words : tuple of str
        Values, where they are few.
    typed : bool
        Whether something else may be typed too.
    first : bool
        Whether a page asks it first, not under more options.
    lists : str
        Name of a list of :data:`LISTS`.
    search : str
        Name of a list that is searched: ``runways``, ``procedures``.
    commas : bool
        Several values in one, with commas between.
    files : bool
        A file may stand there.
    free : str
        Pattern of what else may be typed where a file may stand.
    runs : bool
        A finished run of tracks or levels stands there.
    """

    words: tuple[str, ...] = ()
    typed: bool = False
    first: bool = False
    lists: str = ""
    search: str = ""
    commas: bool = False
    files: bool = False
    free: str = ""
    runs: bool = False


@dataclass(frozen=True)
class Written:
    """A folder that the command writes.

    Attributes
    ----------
    argument : str
        Argument that decides whether it does; empty: it always does.
    lists : str
        Name of the list of its values with which it does.
    """

    argument: str = ""
    lists: str = ""


def _specifications() -> Choices:
    from navbound import rnp  # noqa: PLC0415

    plain = [(f"RNP {value}", f"{value} NM, 95 % of the time") for value in ("0.1", "0.3", "1", "2", "4", "10")]
    return plain + [(name, "") for name in dict.fromkeys(cell.name for cell in rnp.specifications())]


def _methods() -> Choices:
    from navbound.methods import methods  # noqa: PLC0415

    return [(method.id, method.title) for method in methods().values()]


def _levels() -> Choices:
    from navbound import kpi  # noqa: PLC0415

    return [(level.id, level.title) for level in kpi.levels().values()]


def _limits() -> Choices:
    return [*((value, words) for value, words in _specifications() if words), *_levels()]


def _studies() -> Choices:
    from navbound.studies.registry import STUDIES  # noqa: PLC0415

    return [(name, "") for name in STUDIES]


def _with_folder() -> Choices:
    from navbound.studies.registry import PAGES, REPORTS  # noqa: PLC0415

    return [(name, "") for name in (*REPORTS, *sorted(PAGES))]


def _maps() -> Choices:
    from navbound.maps.kinds import kinds  # noqa: PLC0415

    return [(kind.id, kind.title) for kind in kinds().values()]


def _predictions() -> Choices:
    from navbound.algorithms import Place, entries  # noqa: PLC0415

    return [*((name, entry.source) for name, entry in entries(Place).items()), ("flight", "the navigation along a plan")]


def _protection() -> Choices:
    from navbound.algorithms import Recorded, entries  # noqa: PLC0415

    return [
        ("given", "of a table, or of the SBAS messages among the files"),
        *((name, entry.source) for name, entry in entries(Recorded).items()),
    ]


def _models() -> Choices:
    from navbound import raim  # noqa: PLC0415

    return [(model, "") for model in raim.ERROR_MODELS]


LISTS: dict[str, Callable[[], Choices]] = {
    "specifications": _specifications,
    "methods": _methods,
    "levels": _levels,
    "limits": _limits,
    "studies": _studies,
    "studies with a folder": _with_folder,
    "maps": _maps,
    "predictions": _predictions,
    "flights": lambda: [("flight", "")],
    "protection": _protection,
    "models": _models,
    "constellations": lambda: [(name, "nominal, of no date") for name in ("gps", "galileo", "beidou")],
}
"""Lists by their names; each is read where it is maintained."""
