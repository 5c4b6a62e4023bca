"""What every record of a run is: immutable, and complete as declared."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict


class Record(BaseModel):
    """Immutable, with no field that is not declared."""

    model_config = ConfigDict(frozen=True, extra="forbid")
