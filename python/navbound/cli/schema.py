"""`navbound schema`: what `--json` of a command prints, as JSON Schema, from the records themselves."""

from __future__ import annotations

import json as encoder
import sys
from functools import reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any

import typer

from navbound.cli.choices import Selectable
from navbound.errors import NotFoundError

if TYPE_CHECKING:
    from collections.abc import Callable

    Schema = dict[str, Any]

DIALECT = "https://json-schema.org/draft/2020-12/schema"


def _summary() -> Any:
    from navbound.records.run import Summary  # noqa: PLC0415

    return Summary


def _map() -> Any:
    from navbound.records.maps import MapSummary  # noqa: PLC0415

    return MapSummary


def _prediction() -> Any:
    from navbound.records.prediction import Prediction  # noqa: PLC0415

    return Prediction


def _flight() -> Any:
    from navbound.records.prediction import ExpectedFlight  # noqa: PLC0415

    return ExpectedFlight


def _assessed() -> Any:
    from navbound.records.prediction import Assessment  # noqa: PLC0415

    return Assessment


def _comparison() -> Any:
    from navbound.records.comparison import Comparison  # noqa: PLC0415

    return Comparison


def _levels() -> Any:
    from navbound.records.performance import Level  # noqa: PLC0415

    return list[Level]


def _studies() -> Any:
    from navbound.studies.registry import RECORDS as OF_STUDIES  # noqa: PLC0415

    # One of them, by the study; a record has no field that is not declared, so that no other fits.
    return reduce(or_, OF_STUDIES.values())


def _methods() -> Any:
    from navbound.cli.printed import Methods  # noqa: PLC0415

    return Methods


def _scenarios() -> Any:
    from navbound.cli.printed import ListedScenario  # noqa: PLC0415

    return list[ListedScenario]


def _verified() -> Any:
    from navbound.cli.printed import Verified  # noqa: PLC0415

    return list[Verified]


def _procedures(name: str) -> Callable[[], Any]:
    def record() -> Any:
        from navbound.cli import procedure_records  # noqa: PLC0415

        return getattr(procedure_records, name)

    return record


_PRINTED: dict[str, Callable[[], Any]] = {
    "methods": _methods,
    "scenarios": _scenarios,
    "verify": _verified,
    "procedures-list": _procedures("ProcedureList"),
    "procedures-show": _procedures("ShownProcedure"),
    "procedures-check": _procedures("CheckedProcedures"),
}
RECORDS: dict[str, Callable[[], Any]] = {
    **dict.fromkeys(("analyze", "evaluate", "fly", "show"), _summary),
    "map": _map,
    "predict": _prediction,
    "predict-flight": _flight,
    "assess": _assessed,
    "levels": _levels,
    "compare": _comparison,
    "study": _studies,
    **_PRINTED,
}
"""Commands and the record that their `--json` prints."""


def of(name: str) -> Schema:
    """The schema of what `--json` of a command prints.

    Raises
    ------
    NotFoundError
        A command that prints no record.
    """
    if name == "live":
        from importlib.resources import files  # noqa: PLC0415

        live: Schema = encoder.loads(files("navbound.live").joinpath("schemas/transition.json").read_text(encoding="utf-8"))
        return live
    if name not in RECORDS:
        raise NotFoundError("command", name, "record", (*RECORDS, "live"))
    from pydantic import TypeAdapter  # noqa: PLC0415

    made: Schema = TypeAdapter(RECORDS[name]()).json_schema(mode="serialization")
    return {"$schema": DIALECT} | (_whole(made) if name in _PRINTED else made)


def _whole(made: Any) -> Any:
    """What is printed of plain classes: every field, no other one, and null for a number that does not exist."""
    if isinstance(made, list):
        return [_whole(each) for each in made]
    if not isinstance(made, dict) or {"type": "null"} in made.get("anyOf", []):
        return made
    if made.get("type") == "number":
        return {"anyOf": [made, {"type": "null"}]}
    inside = {key: _whole(each) for key, each in made.items()}
    if "additionalProperties" not in made and isinstance(made.get("properties"), dict):
        inside |= {"additionalProperties": False, "required": list(made["properties"])}
    return inside


def schema_command(
    command: Annotated[str, typer.Argument(help=f"Whose --json: {', '.join(RECORDS)}, live."), Selectable(words=(*RECORDS, "live"))],
) -> None:
    """Print the JSON Schema of what --json of a command prints."""
    sys.stdout.write(encoder.dumps(of(command), indent=1) + "\n")
