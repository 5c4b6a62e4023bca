"""Scenario files: those that ship with navbound, and your own."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from navbound.errors import FormatError, InputError, NotFoundError
from navbound.scenario.models import Scenario
from navbound.scenario.sensors import grades, with_grade
from navbound.scenario.taxi import Taxi
from navbound.scenario.units import Place, RepeatedKeyError, Written, to_si

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

_SHIPPED = Path(__file__).parent / "shipped"
KINDS: dict[str, type[Scenario] | type[Taxi]] = {"flight": Scenario, "taxi": Taxi}
"""What ``kind`` of a scenario may be, and its shape; a file without one is a flight."""
_FOLDERS = (_SHIPPED, _SHIPPED / "taxiing")
_FAULT_KINDS = {
    "lateral-ramp",
    "degraded-ranging",
    "satellite-step",
    "satellite-outage",
    "station-outage",
    "satellite-ramp",
    "interference",
    "spoofing",
    "dme-bias",
    "imu-bias-jump",
    "imu-trouble",
    "baro-blockage",
    "range-step",
    "range-ramp",
}
"""Kinds of faults; the checker puts them into its locations, where the file has nothing."""


def shipped() -> list[str]:
    """Names of the scenarios that ship with navbound."""
    return sorted(_shipped())


def _shipped() -> dict[str, Path]:
    return {path.stem: path for folder in _FOLDERS for path in folder.glob("*.toml")}


def find(name_or_path: str | Path) -> Path:
    """File of a scenario, by the name of a shipped one or by its path.

    Raises
    ------
    InputError
        Neither a shipped name nor a file.
    """
    ours = _shipped().get(str(name_or_path))
    if ours is not None:
        return ours
    path = Path(name_or_path)
    if not path.is_file():
        raise NotFoundError("scenario", str(name_or_path), "file and no shipped scenario", shipped())
    return path


def load(name_or_path: str | Path) -> Scenario:
    """Read a scenario of a flight.

    Raises
    ------
    InputError, FormatError
        As :func:`read`; and a scenario of another kind.
    """
    loaded = read(name_or_path)
    if not isinstance(loaded, Scenario):
        raise FormatError(find(name_or_path), f"{loaded.kind!r} is not a flight", field="kind")
    return loaded


def read(name_or_path: str | Path) -> Scenario | Taxi:
    """Read a scenario of any kind.

    Parameters
    ----------
    name_or_path : str or Path
        Name of a shipped scenario, or path of a TOML file. A file may name a shipped scenario as its ``base`` and give only what differs.

    Returns
    -------
    Scenario or Taxi
        By its ``kind``, in SI units, checked.

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
        scenario = _kind(path, table).model_validate(table)
        scenario.check()
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


def of_record(record: dict[str, object]) -> Scenario | Taxi:
    """The scenario of a run record, in SI units already."""
    return KINDS[str(record["kind"])].model_validate_json(json.dumps(record))


def _kind(path: Path, table: dict[str, Any]) -> type[Scenario] | type[Taxi]:
    kind = table.get("kind", "flight")
    if not isinstance(kind, str) or kind not in KINDS:
        raise FormatError(path, f"{kind!r} is not one of the kinds ({', '.join(KINDS)})", field="kind")
    return KINDS[kind]


def _table(path: Path) -> dict[str, Any]:
    """Table of a file, laid over the shipped scenario that it names as its ``base``."""
    table = tomllib.loads(path.read_text(encoding="utf-8"))
    base = table.pop("base", None)
    if base is None:
        return table
    ours = _shipped()
    if base not in ours:
        raise FormatError(path, f"{base!r} is not one of the shipped scenarios ({', '.join(sorted(ours))})", field="base")
    return _laid_over(_table(ours[base]), table)


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
    place = tuple(part for part in error["loc"] if part not in _FAULT_KINDS)
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
