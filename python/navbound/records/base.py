"""What every record of a run is: immutable, and complete as declared."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, model_validator

from navbound.errors import visible


class Record(BaseModel):
    """Immutable, with no field that is not declared; every text in it is fit to be shown."""

    # Of forty kinds a run has ten: each is built when the first of it is made.
    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    @model_validator(mode="before")
    @classmethod
    def _visible(cls, fields: Any) -> Any:
        return _shown(fields)


_NO_TEXT = frozenset({float, int, bool, type(None)})


def _shown(value: Any) -> Any:
    """Texts without what is not seen, in lists and mappings too; the rest as it is."""
    if type(value) in _NO_TEXT:
        return value
    if isinstance(value, str):
        return visible(value)
    if isinstance(value, dict):
        return {_shown(key): _shown(part) for key, part in value.items()}
    if type(value) in {list, tuple}:
        # Long lists are of numbers.
        return type(value)([part if type(part) in _NO_TEXT else _shown(part) for part in value])
    return value
