"""A number that is no number never becomes a reassuring one: a contract over every public function of the subject modules."""

from __future__ import annotations

import dataclasses
import inspect
from typing import Any

import numpy as np
import pytest

from navbound import InputError, gbas
from navbound.status import USABLE
from public_calls import CALLS, MODULES, WITHOUT

MOST_WITHOUT = 32
"""Functions without a sample; may only shrink."""


def public() -> set[str]:
    names = set()
    for module_name, module in MODULES.items():
        listed = getattr(module, "__all__", None) or [n for n, o in vars(module).items() if getattr(o, "__module__", "") == module.__name__]
        names |= {f"{module_name}.{n}" for n in listed if not n.startswith("_") and inspect.isfunction(getattr(module, n))}
    return names


def test_every_public_function_has_a_sample_call_or_a_reason() -> None:
    assert len(public()) > 100
    assert public() == set(CALLS) | set(WITHOUT)
    assert not set(CALLS) & set(WITHOUT)
    assert all(WITHOUT.values())
    assert len(WITHOUT) <= MOST_WITHOUT


def outputs(result: Any, name: str = "result") -> dict[str, np.ndarray[Any, Any]]:
    """Every array or number of a result, by its place."""
    if isinstance(result, dict):
        return {k: v for key, part in result.items() for k, v in outputs(part, f"{name}.{key}").items()}
    if dataclasses.is_dataclass(result) and not isinstance(result, type):
        return {k: v for f in dataclasses.fields(result) for k, v in outputs(getattr(result, f.name), f"{name}.{f.name}").items()}
    if isinstance(result, tuple) and hasattr(result, "_fields"):
        return {k: v for f in result._fields for k, v in outputs(getattr(result, f), f"{name}.{f}").items()}
    if isinstance(result, tuple | list) and not all(isinstance(part, float | int | str) for part in result):
        return {k: v for i, part in enumerate(result) for k, v in outputs(part, f"{name}[{i}]").items()}
    if isinstance(result, np.ndarray | float | int | bool | str | list | tuple):
        return {name: np.asarray(result)}
    return {}


def changed(value: Any, new: Any) -> Any:
    """The argument with its first entry replaced."""
    if isinstance(value, float):
        return new(value)
    array = np.array(value, dtype=np.float64)
    array.flat[0] = new(float(array.flat[0]))
    return array


def first(array: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """What belongs to the first item: everything of a result without two items."""
    return array[0] if array.ndim and array.shape[0] == 2 else array


def differs(a: np.ndarray[Any, Any], b: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    if a.shape != b.shape:
        return np.ones(a.shape, dtype=bool)
    if a.dtype.kind == "f":
        return np.asarray(~((a == b) | (np.isnan(a) & np.isnan(b))))
    return np.asarray(a != b)


def nudged(call: Any, argument: str) -> list[dict[str, np.ndarray[Any, Any]]]:
    """Results with the argument's first entry moved a little to either side, to see what depends on it."""
    moved = []
    for factor in (1.01, 0.99):
        try:
            moved.append(outputs(call(**{argument: changed(call.numbers[argument], lambda v, f=factor: v * f if v else f - 1.0)})))
        except InputError:
            continue
    return moved


def reassuring(name: str, argument: str, bad: float) -> list[str]:
    """Places of a result that depend on an argument and are finite numbers although the argument is not."""
    call = CALLS[name]
    try:
        result = outputs(call(**{argument: changed(call.numbers[argument], lambda _: bad)}))
    except InputError:
        return []
    base, moved = outputs(call()), nudged(call, argument)
    listed = []
    for place, array in result.items():
        at, before = first(array), first(base[place]) if place in base else first(array)
        depends = np.zeros(at.shape, dtype=bool)
        for other in moved:
            if place in other and first(other[place]).shape == at.shape == before.shape:
                depends |= differs(first(other[place]), before)
        if at.dtype.kind == "f" and (np.isfinite(at) & depends).any():
            listed.append(place)
    declared = [a for place, array in result.items() if place.endswith(".status") for a in np.atleast_1d(first(array)).tolist()]
    return [] if declared and not set(declared) & set(USABLE) else listed


_SERIES = "a statistic of a series: epochs without an error or a bound are left out, and their number is in the result"
ALLOWED = {
    ("evaluation.bound", "error_m"): _SERIES,
    ("evaluation.bound", "bound_m"): _SERIES,
    **{(name, argument): _SERIES for name in ("evaluation.magnitude", "evaluation.nees") for argument in ("error_m", "covariance_m2")},
    ("dme.solve", "slant_m"): "a range that is NaN was not received: the position is that of the others, whose number is in the result",
}
"""Finite results that stand although an argument is no number, with the reason."""

PAIRS = [(name, argument) for name, call in CALLS.items() for argument in call.numbers]


@pytest.mark.parametrize(("name", "argument"), PAIRS)
def test_no_number_makes_no_finite_result(name: str, argument: str) -> None:
    assert reassuring(name, argument, np.nan) == [] or (name, argument) in ALLOWED


UNBOUNDED = ("sigma", "covariance", "bias", "fte", "error", "residual", "scale")
"""Arguments whose infinite value makes every bound infinite: parts of their names."""


@pytest.mark.parametrize(("name", "argument"), [p for p in PAIRS if any(part in p[1] for part in UNBOUNDED)])
def test_an_infinite_error_or_deviation_makes_no_finite_result(name: str, argument: str) -> None:
    assert reassuring(name, argument, np.inf) == [] or (name, argument) in ALLOWED | INFINITE


_CURVE = "the curve of the ground monitors is constant for large errors: its value is the limit"
INFINITE = {
    **{(name, argument): _SERIES for name in ("evaluation.magnitude", "evaluation.nees") for argument in ("error_m", "covariance_m2")},
    ("gbas.missed_by_monitor", "error_m"): _CURVE,
    ("gbas.missed_detection_limit", "error_m"): _CURVE,
}
"""Finite results that stand although an error is infinite, with the reason."""


def test_an_exception_is_one() -> None:
    assert {pair for pair in ALLOWED if reassuring(*pair, np.nan)} == set(ALLOWED)
    assert {pair for pair in INFINITE if reassuring(*pair, np.inf)} == set(INFINITE)


def test_the_contract_sees_a_function_that_swallows_a_nan(monkeypatch: pytest.MonkeyPatch) -> None:
    from public_calls import Call  # noqa: PLC0415

    monkeypatch.setitem(CALLS, "toy.level", Call(lambda sigma_m: np.fmax(5.0 * sigma_m, 1.0), {"sigma_m": np.array([1.0, 2.0])}))
    assert reassuring("toy.level", "sigma_m", np.nan) == ["result"]


def test_an_error_that_is_no_number_is_missed_with_no_known_probability() -> None:
    assert np.isnan(gbas.missed_by_monitor(np.nan))
    limit = gbas.missed_detection_limit(
        np.nan, containment_m=8.0, sigma_tse_m=1.0, projection=2.0, allotted_risk=1e-9, p_fault=1e-6, bias_hor_m=0.1
    )
    assert np.isnan(limit)
