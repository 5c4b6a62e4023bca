"""Scenario files: those that ship with navbound, and your own."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from navbound import _core
from navbound.errors import FormatError, InputError, NotFoundError
from navbound.scenario import taxi
from navbound.scenario.models import Scenario
from navbound.scenario.sensors import grades, with_grade
from navbound.scenario.units import Place, RepeatedKeyError, Written, to_si

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

_FOLDER = Path(__file__).parent / "shipped"
_KINDS = {
    "lateral-ramp",
    "degraded-ranging",
    "satellite-step",
    "satellite-ramp",
    "interference",
    "spoofing",
    "dme-bias",
    "imu-bias-jump",
    "imu-trouble",
    "baro-blockage",
}
"""Kinds of faults; the checker puts them into its locations, where the file has nothing."""


def shipped() -> list[str]:
    """Names of the scenarios that ship with navbound."""
    return sorted(path.stem for path in _FOLDER.glob("*.toml"))


def find(name_or_path: str | Path) -> Path:
    """File of a scenario, by the name of a shipped one or by its path.

    Raises
    ------
    InputError
        Neither a shipped name nor a file.
    """
    if str(name_or_path) in shipped():
        return _FOLDER / f"{name_or_path}.toml"
    path = Path(name_or_path)
    if not path.is_file():
        raise NotFoundError("scenario", str(name_or_path), "file and no shipped scenario", [*shipped(), *taxi.shipped()])
    return path


def load(name_or_path: str | Path) -> Scenario:
    """Read a scenario.

    Parameters
    ----------
    name_or_path : str or Path
        Name of a shipped scenario, or path of a TOML file. A file may name a shipped scenario as its ``base`` and give only what differs.

    Returns
    -------
    Scenario
        In SI units, checked: it can be flown.

    Raises
    ------
    InputError
        Neither a shipped name nor a file.
    FormatError
        Not TOML, a key that is unknown or missing, a value of the wrong type or outside its domain, a route that cannot be flown. It
        names file and key and says what is allowed.
    """
    path = find(name_or_path)
    written: dict[Place, Written] = {}
    try:
        table = to_si(_graded(path, _table(path)), written)
        scenario = Scenario.model_validate(table)
        _core.Outlook.check(scenario.core_json())
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as e:
        raise FormatError(path, f"not TOML: {e}") from e
    except OSError as e:
        raise FormatError(path, f"cannot be read: {e.strerror}") from e
    except ValidationError as e:
        raise _explained(path, e.errors()[0], written) from e
    except RepeatedKeyError as e:
        raise FormatError(path, f"{e.value!r} is outside {e.domain}", field=e.argument) from e
    except InputError as e:
        raise _refused(path, e, written) from e
    return scenario


def _table(path: Path) -> dict[str, Any]:
    """Table of a file, laid over the shipped scenario that it names as its ``base``."""
    table = tomllib.loads(path.read_text(encoding="utf-8"))
    base = table.pop("base", None)
    if base is None:
        return table
    if base not in shipped():
        raise FormatError(path, f"{base!r} is not one of the shipped scenarios ({', '.join(shipped())})", field="base")
    return _laid_over(_table(_FOLDER / f"{base}.toml"), table)


def _graded(path: Path, table: dict[str, Any]) -> dict[str, Any]:
    try:
        return with_grade(table)
    except (KeyError, TypeError) as e:
        raise FormatError(
            path, f"{table['sensors']['imu']['grade']!r} is not one of {', '.join(grades())}", field="sensors.imu.grade"
        ) from e


def _laid_over(below: dict[str, Any], above: dict[str, Any]) -> dict[str, Any]:
    """Merge tables key by key; anything else, lists too, is replaced as a whole."""
    merged = dict(below)
    for key, value in above.items():
        both = isinstance(value, dict) and isinstance(below.get(key), dict)
        merged[key] = _laid_over(below[key], value) if both else value
    return merged


def _explained(path: Path, error: ErrorDetails, written: dict[Place, Written]) -> FormatError:
    place = tuple(part for part in error["loc"] if part not in _KINDS)
    entry = written.get(place)
    key = entry.key if entry else ".".join(str(part) for part in place)
    if error["type"] == "missing":
        return FormatError(path, "is missing (it may end in another unit of the same kind)", field=key)
    if error["type"] == "extra_forbidden":
        return FormatError(path, f"{_shown(entry)} is not a key of a scenario", field=key)
    return FormatError(path, f"{_shown(entry)}: {error['msg']}", field=key)


def _refused(path: Path, error: InputError, written: dict[Place, Written]) -> FormatError:
    """Say it in the file's own key and unit."""
    named = [w for place, w in written.items() if _is_at(place, error)]
    # One name in many phases or faults: the one with this value.
    matching = named if len(named) == 1 else [w for w in named if w.si == error.value]
    if not matching:
        return FormatError(path, str(error))
    inside = f"outside {error.domain}" + (f" [{error.unit}]" if error.unit else "")
    return FormatError(path, f"{_shown(matching[0])} is {inside}", field=matching[0].key)


def _is_at(place: Place, error: InputError) -> bool:
    names = [part for part in place if isinstance(part, str)]
    indices = [part for part in place if isinstance(part, int)]
    if not names or names[-1] != error.argument.rpartition(".")[2]:
        return False
    return error.index is None or error.index in indices


def _shown(entry: Written | None) -> str:
    return "the value" if entry is None else repr(entry.value)[:80]
