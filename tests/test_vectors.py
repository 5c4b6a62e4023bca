"""The reference vectors: all pass, none is empty, no method is without one, and a wrong value is noticed."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from navbound import verify
from navbound._core import methods
from navbound.errors import FormatError

if TYPE_CHECKING:
    from pathlib import Path

FILES = list(verify.files())
PROVENANCE = {"printed", "re-derived", "standard", "ours", "inferred"}

# Methods whose vectors stand in a file of another name.
ELSEWHERE = {
    "tse-ltem-as-printed": "tse-as-printed",
    **{f"anp-{direction}": "anp-directional" for direction in ("along", "cross", "vertical")},
    **{f"anp-ellipsoid-{direction}": "anp-ellipsoid" for direction in ("east", "north", "up", "along", "cross")},
}


@pytest.mark.parametrize("file", FILES, ids=lambda f: f.id)
def test_every_value_is_met(file: verify.VectorFile) -> None:
    outcome = verify.run(file)
    assert outcome.checked > 0
    assert not outcome.failures, "\n".join(outcome.failures)


@pytest.mark.parametrize("file", FILES, ids=lambda f: f.id)
def test_every_file_says_where_its_numbers_come_from(file: verify.VectorFile) -> None:
    assert file.provenance in PROVENANCE
    assert file.source
    ids = [case.id for case in file.cases]
    assert len(set(ids)) == len(ids), "a case twice"


def test_every_method_has_its_vectors() -> None:
    ids = {file.id for file in FILES}
    without = {m["id"] for m in methods() if ELSEWHERE.get(m["id"], m["id"]) not in ids}
    assert not without


@pytest.mark.parametrize("file", FILES, ids=lambda f: f.id)
def test_a_wrong_value_is_noticed(file: verify.VectorFile) -> None:
    """Each expected number moved by a thousandth of itself must fail: no tolerance is so wide that nothing can."""
    for case in file.cases:
        for key, expected in case.expect.items():
            wrong = _moved(expected, 100 * case.tolerance.absolute)
            if wrong is None:
                continue
            outcome = verify.run(replace(file, cases=[replace(case, expect={**case.expect, key: wrong})]))
            assert outcome.failures, f"{case.id}: {key} = {wrong} passes for {expected}"


def _moved(value: object, beyond: float) -> object:
    """The value with every number wrong; None where there is none to move."""
    if isinstance(value, list):
        moved = [_moved(v, beyond) for v in value]
        return None if any(m is None for m in moved) else moved
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return value + 1
    try:
        number = float(value) if isinstance(value, (str, float)) else None
    except ValueError:
        return f"not {value}"
    if number is None or not math.isfinite(number):
        return None
    return repr(number * 1.001 + beyond + (1e-9 if number == 0 else 0.0))


def test_what_is_not_a_vector_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "x.toml"
    for text, word in [
        ("call = 1 2", "Expected"),
        ('call = "tse.exact"', "needs call"),
        (
            'call = "tse.exact"\nsource = "s"\nprovenance = "ours"\n'
            'case = [{ id = "a", input = {}, expect = {}, tolerance = { rel = 0.5, because = "x" } }]',
            "can hardly fail",
        ),
    ]:
        path.write_text(text)
        with pytest.raises(FormatError, match=word):
            verify.load(path)


def test_a_refusal_can_be_expected(tmp_path: Path) -> None:
    path = tmp_path / "x.toml"
    head = 'call = "tse.exact"\nsource = "s"\nprovenance = "ours"\ntolerance = { rel = 1e-12, because = "x" }\n'
    path.write_text(head + 'case = [{ id = "a", input = { fte_m = 1.0, sigma_m = -1.0, risk = 0.05 }, expect = { error = "sigma_m" } }]')
    assert not verify.run(verify.load(path)).failures
    path.write_text(head + 'case = [{ id = "a", input = { fte_m = 1.0, sigma_m = 1.0, risk = 0.05 }, expect = { error = "sigma_m" } }]')
    assert verify.run(verify.load(path)).failures
