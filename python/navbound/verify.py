"""Run the reference vectors against the installed navbound: what was each method checked against, and how close is it.

A vector file states once which public function it calls; a case is that function's keyword arguments and the values its result must
have. So the runner knows no method, and a new file is checked by being there.
"""

from __future__ import annotations

import importlib
import math
import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from navbound.errors import FormatError, NavboundError

if TYPE_CHECKING:
    from collections.abc import Iterator

VECTORS = Path(__file__).parent / "vectors"
"""The vector files that ship with the package."""


@dataclass(frozen=True)
class Tolerance:
    """How far a value may be from its reference, and why that far."""

    because: str
    relative: float = 0.0
    absolute: float = 0.0

    def share(self, expected: float, actual: float) -> float:
        """Difference as a share of what is allowed; 1 is the limit, NaN only where one was expected."""
        if math.isnan(expected) or math.isnan(actual):
            return 0.0 if math.isnan(expected) and math.isnan(actual) else math.inf
        if expected == actual:
            return 0.0
        allowed = self.absolute + self.relative * abs(expected)
        return abs(actual - expected) / allowed if allowed > 0 else math.inf


@dataclass(frozen=True)
class Case:
    """One call and what it must give."""

    id: str
    input: dict[str, Any]
    expect: dict[str, Any]
    tolerance: Tolerance


@dataclass(frozen=True)
class VectorFile:
    """All cases of one function."""

    id: str
    call: str
    source: str
    provenance: str
    cases: list[Case]


@dataclass
class Outcome:
    """What one vector file showed."""

    file: VectorFile
    checked: int = 0
    worst_relative: float = 0.0
    worst_share: float = 0.0
    failures: list[str] = field(default_factory=list)


def load(path: Path) -> VectorFile:
    """Read a vector file.

    Raises
    ------
    FormatError
        Not TOML, a missing key, or a tolerance above a tenth of the expected value without a reason.
    """
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        default = data.get("tolerance")
        cases = [
            Case(
                id=str(case["id"]),
                input=case["input"],
                expect=case["expect"],
                tolerance=Tolerance(
                    because=str((tolerance := case.get("tolerance", default))["because"]),
                    relative=float(tolerance.get("rel", 0.0)),
                    absolute=float(tolerance.get("abs", 0.0)),
                ),
            )
            for case in data["case"]
        ]
        loaded = VectorFile(path.stem, data["call"], data["source"], data["provenance"], cases)
    except tomllib.TOMLDecodeError as e:
        raise FormatError(path, str(e)) from e
    except (KeyError, TypeError) as e:
        raise FormatError(path, f"a vector file needs call, source, provenance, tolerance and case: {e}") from e
    for case in loaded.cases:
        if case.tolerance.relative > 0.1 or not case.tolerance.because:
            raise FormatError(path, f"case {case.id}: a tolerance above 10 % can hardly fail, and each needs a reason")
    return loaded


def files(folder: Path = VECTORS) -> Iterator[VectorFile]:
    """Every vector file, in the order of their names."""
    for path in sorted(folder.glob("*.toml")):
        yield load(path)


def run(file: VectorFile) -> Outcome:
    """Call the function once a case and compare every expected value."""
    module, _, name = file.call.rpartition(".")
    function = getattr(importlib.import_module(f"navbound.{module}"), name)
    outcome = Outcome(file)
    for case in file.cases:
        outcome.checked += 1
        arguments = {key: _argument(value) for key, value in case.input.items()}
        if "error" in case.expect:
            _expect_error(outcome, case, function, arguments)
            continue
        try:
            result = function(**arguments)
        except NavboundError as e:
            outcome.failures.append(f"{case.id}: refused: {e}")
            continue
        for key, expected in case.expect.items():
            _compare(outcome, case, key, expected, result if key == "value" else getattr(result, key))
    return outcome


def _expect_error(outcome: Outcome, case: Case, function: Any, arguments: dict[str, Any]) -> None:
    try:
        function(**arguments)
    except NavboundError as e:
        if case.expect["error"] not in str(e):
            outcome.failures.append(f"{case.id}: refused with “{e}”, expected “{case.expect['error']}”")
    else:
        outcome.failures.append(f"{case.id}: accepted, expected a refusal naming “{case.expect['error']}”")


def _compare(outcome: Outcome, case: Case, key: str, expected: Any, actual: Any) -> None:
    if isinstance(expected, (bool, int)) or (isinstance(expected, str) and not _is_number(expected)):
        if actual != expected:
            outcome.failures.append(f"{case.id}: {key} = {actual!r}, expected {expected!r}")
        return
    want = np.asarray(_argument(expected), dtype=np.float64)
    have = np.asarray(actual, dtype=np.float64)
    if want.shape != have.shape:
        outcome.failures.append(f"{case.id}: {key} has shape {have.shape}, expected {want.shape}")
        return
    for e, f in zip(want.ravel().tolist(), have.ravel().tolist(), strict=True):
        share = case.tolerance.share(e, f)
        outcome.worst_share = max(outcome.worst_share, share)
        if e != 0 and math.isfinite(e) and math.isfinite(f):
            outcome.worst_relative = max(outcome.worst_relative, abs(f - e) / abs(e))
        if share > 1:
            outcome.failures.append(f"{case.id}: {key} = {f!r}, expected {e!r} ({case.tolerance.because})")


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _argument(value: Any) -> Any:
    """Numbers written as strings keep all their digits in the file; here they become doubles. A table with a class becomes one of it."""
    if isinstance(value, str):
        return float(value) if _is_number(value) else value
    if isinstance(value, list):
        return [_argument(v) for v in value]
    if isinstance(value, dict) and "class" in value:
        module, _, name = str(value["class"]).rpartition(".")
        made = getattr(importlib.import_module(f"navbound.{module}"), name)
        return made(**{key: _argument(v) for key, v in value.items() if key != "class"})
    return value
