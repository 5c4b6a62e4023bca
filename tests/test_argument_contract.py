"""Every public function with every abuse of one argument: an `InputError` that names it, or the answer that the same numbers give."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import navbound
from navbound import InputError, InternalError, NavboundError, _core, anp, gnss, ins, maps, raim, tse, write
from navbound.table.arguments import checked
from navbound.table.arrays import MOST_BYTES, flatten
from public_calls import CALLS, MODULES
from public_classes import CLASSES
from test_nan_contract import changed, differs, outputs, public

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

ARGUMENTS = {name: set(inspect.signature(call.function).parameters) for name, call in CALLS.items()}
"""Columns of a table are no arguments: what a table may hold is the table's own contract."""
PAIRS = [(name, argument) for name, call in CALLS.items() for argument in [*call.numbers, *call.fixed] if argument in ARGUMENTS[name]]
NUMBERS = [(name, argument) for name, call in CALLS.items() for argument in call.numbers if argument in ARGUMENTS[name]]
FLAGS = {("kpi.continuity", "available")}
"""Takes truth values; numbers are what it has to refuse."""
REAL = [pair for pair in NUMBERS if pair not in FLAGS and np.asarray(CALLS[pair[0]].numbers[pair[1]]).dtype.kind == "f"]


def first_replaced(by: float) -> Callable[[Any], Any]:
    return lambda value: changed(value, lambda _: by)


NUMBERS_OF_ANY_SIZE: dict[str, Callable[[Any], Any]] = {
    "nan": first_replaced(np.nan),
    "inf": first_replaced(np.inf),
    "minus inf": first_replaced(-np.inf),
    "zero": first_replaced(0.0),
    "denormal": first_replaced(5e-324),
    "1e300": first_replaced(1e300),
    "-1e300": first_replaced(-1e300),
    "2^53 + 2": first_replaced(2.0**53 + 2.0),
    "empty": lambda value: np.zeros((0, *np.shape(value)[1:])),
    "another shape": lambda _: np.ones((7, 5, 3)),
    "True": lambda _: True,
    "2^70": lambda _: 2**70,
}
"""Which of these is right depends on the function; none may bring a foreign exception."""

NO_NUMBERS: dict[str, Callable[[Any], Any]] = {
    "None": lambda _: None,
    "object": lambda _: object(),
    "dict": lambda _: {"a": 1.0},
    "set": lambda _: {1.0},
    "class": lambda _: float,
    "function": lambda _: len,
    "text": lambda _: "abc",
    "number as text": lambda _: "1.5",
    "bytes": lambda _: b"1.5",
    "integer of 400 digits": lambda _: 10**400,
    "integer of 5000 digits": lambda _: 10**5000,
    "list with an integer of 400 digits": lambda _: [10**400, 1],
    "rows of different lengths": lambda _: [[1.0], [1.0, 2.0]],
    "array of objects": lambda _: np.array([object(), 1.0], dtype=object),
    "complex": lambda value: np.asarray(value) * 1j,
    "dates": lambda value: np.full(np.shape(value), np.datetime64("2026-01-01", "ns")),
    "forty axes": lambda _: np.zeros((1,) * 40),
    "masked": lambda value: np.ma.masked_array(np.asarray(value, dtype=np.float64), mask=np.ones(np.shape(value), dtype=bool)),
    "a broadcast of 74 GiB": lambda value: np.broadcast_to(np.asarray(value, dtype=np.float64).ravel()[0], (10**10,)),
}
"""None of these is what a number may be: always refused."""


def outcome(call: Any, argument: str, value: Any) -> str:
    """``ok``, ``refused``, or the name of an exception that is not ours."""
    try:
        call(**{argument: value})
    except InputError:
        return "refused"
    except Exception as e:
        return f"{type(e).__name__}: {e}"
    return "ok"


@pytest.mark.parametrize(("name", "argument"), PAIRS)
def test_an_abused_argument_brings_no_foreign_exception(name: str, argument: str) -> None:
    call = CALLS[name]
    value = call.numbers.get(argument, call.fixed.get(argument))
    abuses = (
        NO_NUMBERS | NUMBERS_OF_ANY_SIZE
        if argument in call.numbers
        else {k: v for k, v in NO_NUMBERS.items() if k not in {"complex", "masked", "dates", "a broadcast of 74 GiB"}}
    )
    with np.errstate(all="ignore"):
        results = {abuse: outcome(call, argument, abused(value)) for abuse, abused in abuses.items()}
    assert {abuse: result for abuse, result in results.items() if result not in {"ok", "refused"}} == {}


OF_ANY_KIND: dict[str, Any] = {
    "True": True,
    "3": 3,
    "a half": 0.5,
    "NaN": np.nan,
    "eight bits": np.uint8(1),
    "200 in eight bits": np.uint8(200),
    "single precision": np.float32(0.5),
    "two truth values": np.array([True, False]),
    "object": object(),
    "text": "abc",
    "bytes": b"1",
    "None": None,
    "nothing": [],
    "a number in a list": [1.0],
    "dict": {},
}
"""For arguments that are no numbers, or seldom passed: some kind is right, none brings a foreign exception."""
ALL_CALLS = {name: (call, call.function) for name, call in CALLS.items()} | {
    name: (call, call.made_of or call.function) for name, call in CLASSES.items()
}


@pytest.mark.parametrize("name", ALL_CALLS)
def test_no_argument_of_any_kind_brings_a_foreign_exception(name: str) -> None:
    call, function = ALL_CALLS[name]
    foreign: dict[tuple[str, str], str] = {}
    for parameter in inspect.signature(function).parameters.values():
        if parameter.kind not in {parameter.VAR_KEYWORD, parameter.VAR_POSITIONAL}:
            with np.errstate(all="ignore"):
                results = {kind: outcome(call, parameter.name, value) for kind, value in OF_ANY_KIND.items()}
            foreign |= {(parameter.name, kind): result for kind, result in results.items() if result not in {"ok", "refused"}}
    assert foreign == {}


NONE_ALLOWED = {
    *(("rnp.Monitor.step", name) for name in ("rnp_m", "tse_exact_m", "tse_exact_integrity_m", "fte_m", "hpl_m")),
    ("ins.Imu", "interval_s"),
    ("kpi.Campaign", "period_s"),
}
"""An absent number of a record is a NaN, which alerts; an absent interval or period is that of the times."""


@pytest.mark.parametrize(("name", "argument"), [(name, argument) for name, call in CLASSES.items() for argument in call.numbers])
def test_an_abused_field_or_argument_of_a_class_is_refused(name: str, argument: str) -> None:
    call = CLASSES[name]
    call()
    with np.errstate(all="ignore"):
        refusable = {abuse: outcome(call, argument, abused(call.numbers[argument])) for abuse, abused in NO_NUMBERS.items()}
        sized = {abuse: outcome(call, argument, abused(call.numbers[argument])) for abuse, abused in NUMBERS_OF_ANY_SIZE.items()}
    allowed = {"None": "ok"} if (name, argument) in NONE_ALLOWED else {}
    assert {abuse: result for abuse, result in refusable.items() if result != "refused"} == allowed
    assert {abuse: result for abuse, result in sized.items() if result not in {"ok", "refused"}} == {}


OPTIONAL = {
    (name, argument) for name, argument in NUMBERS if "None" in str(inspect.signature(CALLS[name].function).parameters[argument].annotation)
}


@pytest.mark.parametrize(("name", "argument"), NUMBERS)
def test_what_is_no_number_is_refused(name: str, argument: str) -> None:
    call = CALLS[name]
    accepted = [abuse for abuse, abused in NO_NUMBERS.items() if outcome(call, argument, abused(call.numbers[argument])) != "refused"]
    assert accepted == [a for a in accepted if a == "None" and (name, argument) in OPTIONAL]


def same(a: dict[str, Any], b: dict[str, Any]) -> bool:
    return a.keys() == b.keys() and not any(differs(a[place], b[place]).any() for place in a)


def spread(array: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """The same numbers, no two of them neighbours in memory, the last axis backwards."""
    room = np.zeros(tuple(2 * n for n in array.shape), dtype=array.dtype)
    view = room[tuple(slice(None, None, 2) for _ in array.shape)]
    view = view[..., ::-1] if array.ndim else view
    view[...] = array
    return view


SAME_NUMBERS: dict[str, Callable[[np.ndarray[Any, Any]], Any]] = {
    "not contiguous": spread,
    "columns first": np.asfortranarray,
    "big-endian": lambda array: array.astype(">f8"),
    "nested lists": lambda array: array.tolist(),
    "objects": lambda array: array.astype(object),
    "masked array without a mask": np.ma.masked_array,
    "read-only": lambda array: np.broadcast_to(array, array.shape),
}


@pytest.mark.parametrize(("name", "argument"), [p for p in REAL if np.ndim(CALLS[p[0]].numbers[p[1]]) > 0])
def test_the_same_numbers_give_the_same_answer_however_they_lie(name: str, argument: str) -> None:
    call = CALLS[name]
    array = np.asarray(call.numbers[argument])
    base = outputs(call())
    for form in SAME_NUMBERS.values():
        assert same(outputs(call(**{argument: form(array)})), base)
    # Of single precision: what its numbers are in double precision.
    single = array.astype(np.float32)
    kept = np.asarray(single, dtype=np.float64)
    assert outcome(call, argument, single) == outcome(call, argument, kept)
    if outcome(call, argument, kept) == "ok":
        assert same(outputs(call(**{argument: single})), outputs(call(**{argument: kept})))


@pytest.mark.parametrize(("name", "argument"), REAL)
def test_whole_numbers_give_the_answer_of_the_same_numbers_with_a_point(name: str, argument: str) -> None:
    call = CALLS[name]
    whole = np.ceil(np.abs(np.asarray(call.numbers[argument]))).astype(np.int64)
    with_point: Any = whole.astype(np.float64)
    written: Any = whole
    if not whole.ndim:
        with_point, written = float(with_point), int(whole)
    assert outcome(call, argument, written) == outcome(call, argument, with_point)
    if outcome(call, argument, written) == "ok":
        assert same(outputs(call(**{argument: written})), outputs(call(**{argument: with_point})))


JOBS = {"fly": navbound.fly, "analyze": navbound.analyze, "study": navbound.study, "maps.make": maps.make}
WRITERS = {f"write.{name}": each for name, each in vars(write).items() if name in write.__all__ and inspect.isfunction(each)}
FUNCTIONS = JOBS | WRITERS | {name: getattr(MODULES[name.split(".")[0]], name.split(".")[1]) for name in sorted(public())}
UNCHECKED = {("analyze", "levels"), ("kpi.evaluate", "levels"), ("maps.make", "grid"), ("maps.make", "workers")}
"""Arguments whose kind the job itself refuses."""
PARAMETERS = [
    (name, p.name)
    for name, function in FUNCTIONS.items()
    for p in inspect.signature(function).parameters.values()
    if p.kind is not p.VAR_KEYWORD
]


def test_the_contract_covers_every_public_function() -> None:
    assert len(FUNCTIONS) > 130
    assert len(PARAMETERS) > 550


@pytest.mark.parametrize(("name", "argument"), [p for p in PARAMETERS if p not in UNCHECKED])
def test_an_object_of_a_wrong_kind_is_refused_by_the_argument_s_name(name: str, argument: str) -> None:
    with pytest.raises(InputError) as refusal:
        FUNCTIONS[name](**{argument: object()})
    assert refusal.value.argument == argument


def test_orbits_of_a_wrong_kind_are_refused() -> None:
    observations, navigation = (object.__new__(c) for c in (gnss.Observations, gnss.Navigation))
    with pytest.raises(InputError, match="PreciseOrbits"):
        gnss.solve(observations, navigation, orbits=object())  # type: ignore[arg-type]


def test_a_broadcast_that_no_memory_holds_is_refused_before_it_is_tried() -> None:
    side = int((MOST_BYTES / 8) ** 0.5) + 1
    with pytest.raises(InputError, match="GiB when broadcast"):
        tse.exact(np.ones((side, 1)), np.ones((1, side)), 1e-5)
    with pytest.raises(InputError, match="16 GiB"):
        anp.cep(np.broadcast_to(np.eye(2), (10**10, 2, 2)))
    assert flatten(a=(np.ones((3, 1)), ()), b=(np.ones((1, 4)), ()))[0] == (3, 4)


def test_a_mask_is_not_taken_for_good_values() -> None:
    with pytest.raises(InputError, match="NaN stands for an absent number"):
        tse.exact(np.ma.masked_array([30.0, 40.0], mask=[False, True]), 8.0, 1e-5)


def test_a_panic_of_the_core_is_one_class_that_says_it_is_our_bug(monkeypatch: pytest.MonkeyPatch) -> None:
    def gives_up(*_: object) -> None:
        raise _core.PanicException("index out of bounds")

    monkeypatch.setattr(_core, "tse_exact", gives_up)
    with pytest.raises(InternalError, match=r"tse[\w.]*\.exact: this is a bug in navbound, please report it: index out of bounds") as bug:
        tse.exact(30.0, 8.0, [1e-5, 1e-7])
    assert isinstance(bug.value, NavboundError)
    assert not isinstance(bug.value, InputError)


def test_the_contract_sees_a_function_that_lets_a_foreign_exception_through() -> None:
    def unchecked(x: float) -> float:
        return float(x) + 1.0

    assert outcome(unchecked, "x", "abc").startswith("ValueError")
    assert outcome(checked(unchecked), "x", "abc") == "refused"
    assert outcome(checked(unchecked), "x", 1.5) == "ok"


def test_annotations_that_are_words_are_checked_as_such() -> None:
    with pytest.raises(InputError, match="one of"):
        raim.watch(signals="triple")  # type: ignore[call-arg, arg-type]
    with pytest.raises(InputError, match="text"):
        gnss.nominal(2.656e7, 0.96, 0.0, 0.0, system=7)  # type: ignore[arg-type]


NO_TIMES: dict[str, Any] = {
    "not a number": [0.0, np.nan],
    "infinite": [0.0, np.inf],
    "beyond 2^63": [0, 2**64],
    "beyond 2^63, as doubles": [0.0, 2.0**63],
    "unsigned beyond 2^63": np.array([0, 2**63], dtype=np.uint64),
    "half a nanosecond": [0.0, 0.5],
    "text": ["a", "b"],
    "dates": np.array(["2026-01-01", "2026-01-02"], dtype="datetime64[ns]"),
    "400 digits": [10**400, 1],
    "rows of different lengths": [[1], [1, 2]],
    "nothing": None,
    "an object": object(),
}

THREE = np.zeros((2, 3))
TIMED: dict[str, Callable[[Any], Any]] = {
    "Imu": lambda t: ins.Imu(t, THREE, THREE).columns(),
    "BaroHeights": lambda t: ins.BaroHeights(t, np.zeros(2), np.ones(2), np.ones(2), np.ones(2)).table(),
}


@pytest.mark.parametrize("what", NO_TIMES)
@pytest.mark.parametrize("record", TIMED)
def test_what_is_no_time_is_refused(record: str, what: str) -> None:
    with pytest.raises(InputError) as refusal:
        TIMED[record](NO_TIMES[what])
    assert refusal.value.argument == "time_ns"
    TIMED[record]([0.0, 1e9])


@pytest.fixture(scope="module")
def read_files(shared_data: Path) -> dict[str, Callable[..., Any]]:
    """Methods of what was read from files, with their arguments."""
    day = shared_data / "gnss" / "taroz_static"
    navigation, observations = gnss.read_navigation(day / "base.nav"), gnss.read_observations(day / "rover.obs.gz")
    orbits = gnss.read_orbits(shared_data / "gnss" / "igs_2010_182" / "igs15904.sp3")
    at: dict[str, Any] = {"system": "gps", "time_ns": int(observations.time_ns[0])}
    code: dict[str, Any] = {"system": "G", "code": "C1C"}
    state: dict[str, Any] = {"satellite": orbits.satellites[0], "time_ns": at["time_ns"]}
    return {
        "Navigation.orbits": lambda **a: navigation.orbits(**at | a),
        "Navigation.nearest_age_s": lambda **a: navigation.nearest_age_s(**at | a),
        "Observations.column": lambda **a: observations.column(**code | a),
        "PreciseOrbits.states": lambda **a: orbits.states(**state | a),
    }


@pytest.mark.parametrize(
    ("name", "argument", "text"),
    [
        ("Navigation.orbits", "system", True),
        ("Navigation.orbits", "time_ns", False),
        ("Navigation.nearest_age_s", "system", True),
        ("Navigation.nearest_age_s", "time_ns", False),
        ("Observations.column", "system", True),
        ("Observations.column", "code", True),
        ("PreciseOrbits.states", "satellite", True),
        ("PreciseOrbits.states", "time_ns", False),
    ],
)
def test_an_abused_argument_of_what_was_read_is_refused(
    read_files: dict[str, Callable[..., Any]], name: str, argument: str, *, text: bool
) -> None:
    read_files[name]()
    value = 1_000_000_000
    abuses = NO_NUMBERS | (NUMBERS_OF_ANY_SIZE if text else {})
    with np.errstate(all="ignore"):
        results = {abuse: outcome(read_files[name], argument, abused(value)) for abuse, abused in abuses.items()}
        sized = {abuse: outcome(read_files[name], argument, abused(value)) for abuse, abused in NUMBERS_OF_ANY_SIZE.items()}
    assert {abuse: result for abuse, result in results.items() if result != "refused"} == {}
    assert {abuse: result for abuse, result in sized.items() if result not in {"ok", "refused"}} == {}
