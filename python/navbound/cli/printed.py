"""What `--json` of lists and checks prints: the records, and the one way they are written."""

from __future__ import annotations

import json as encoder
import math
import sys
from dataclasses import asdict, dataclass
from typing import Any

from navbound.methods import Method, ProtectionMethod


@dataclass(frozen=True)
class Methods:
    """Of `navbound methods`."""

    methods: list[Method]
    protection_levels: list[ProtectionMethod]


@dataclass(frozen=True)
class ListedScenario:
    """A row of `navbound scenarios`."""

    name: str
    kind: str
    title: str


@dataclass(frozen=True)
class Verified:
    """A row of `navbound verify`: a file of vectors. Shares are of the tolerance, 1 is the limit; null: the difference is no number."""

    id: str
    function: str
    source: str
    provenance: str
    n_cases: int
    worst_relative: float
    worst_share_of_tolerance: float
    failures: list[str]


def write(record: Any) -> None:
    """Print a record of this file, or a list of them."""
    plain = [asdict(each) for each in record] if isinstance(record, list) else asdict(record)
    sys.stdout.write(encoder.dumps(_finite(plain), indent=1) + "\n")


def _finite(value: Any) -> Any:
    """A number that does not exist is null: JSON has no NaN."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {k: _finite(v) for k, v in value.items()}
    return [_finite(v) for v in value] if isinstance(value, list | tuple) else value
