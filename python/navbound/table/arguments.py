"""What kind of object an argument may be, checked once for every public function, by its annotations.

An argument of a wrong kind (text for a number, an integer that no double holds, a masked or complex array, an object of another class)
is refused before the function starts. Whether a number is inside its domain is the function's own business.
"""

from __future__ import annotations

import ast
import functools
import inspect
import math
import types
import typing
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ParamSpec, TypeGuard, TypeVar

import numpy as np

from navbound import _core
from navbound.errors import InputError, InternalError
from navbound.table.arrays import numbers, shown

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    Labels = ArrayLike

P = ParamSpec("P")
R = TypeVar("R")
C = TypeVar("C")
Check = Callable[[str, Any], object]
"""Refuses a value of a named argument by an `InputError`."""

_INTEGERS = range(-(2**63), 2**63)


def checked(function: Callable[P, R]) -> Callable[P, R]:
    """Refuse arguments of a wrong kind, as the function's annotations say.

    Raises
    ------
    InternalError
        When called, where the core gave up on an invariant of its own.
    InputError
        When called, with the argument's name, what it was and what is expected.
    """

    @functools.cache
    def names() -> list[str]:
        return list(inspect.signature(function).parameters)

    @functools.cache
    def checks() -> dict[str, tuple[Check, bool]]:
        # Not when the module is loaded: names of classes below the function are not known yet.
        annotations = inspect.get_annotations(function)
        pairs = ((name, _check(annotations.get(name), function.__globals__)) for name in names())
        return {name: (check, _takes_floats(check)) for name, check in pairs if check is not None}

    @functools.wraps(function)
    def checking(*args: P.args, **kwargs: P.kwargs) -> R:
        by_name = checks()
        of_numpy = False
        for name, value in [*zip(names(), args, strict=False), *kwargs.items()]:
            if name in by_name:
                check, takes_floats = by_name[name]
                # A plain number is what is passed most, and no check of numbers refuses it.
                if not (takes_floats and type(value) is float):
                    check(name, value)
                    of_numpy |= _is_scalar(value)
        try:
            if of_numpy:
                # Eight bits hold no limit that such a number is compared with.
                return function(*map(_plain, args), **{name: _plain(value) for name, value in kwargs.items()})  # type: ignore[arg-type]
            return function(*args, **kwargs)
        except _core.PanicException as e:
            raise InternalError(f"{function.__module__}.{function.__name__}", e) from e

    return checking


def _plain(value: object) -> object:
    """A number or truth value of NumPy as one of Python."""
    return value.item() if _is_scalar(value) else value


def _is_scalar(value: object) -> TypeGuard[np.generic]:
    return isinstance(value, np.number | np.bool_) or (isinstance(value, np.ndarray) and value.ndim == 0 and value.dtype.kind in "biuf")


def _takes_floats(check: Check) -> bool:
    """Whether a check of kinds lets a number through; it looks at no number's value."""
    try:
        check("", 1.0)
    except InputError:
        return False
    return True


def checked_fields(cls: type[C]) -> type[C]:
    """Refuse fields of a wrong kind when an object of a dataclass is made, as the annotations of the fields say.

    Raises
    ------
    InputError
        When an object is made, with the field's name, what it was and what is expected.
    """
    cls.__init__ = checked(cls.__init__)  # type: ignore[method-assign]
    return cls


def _check(annotation: object, known: Mapping[str, Any]) -> Check | None:
    """The check of an annotation; None where it says nothing that can be checked."""
    if not isinstance(annotation, str):
        return None
    alternatives = [_alternative(node, known) for node in _split(ast.parse(annotation, mode="eval").body)]
    if None in alternatives:
        return None
    understood = [a for a in alternatives if a is not None]
    if len(understood) == 1:
        return understood[0]

    def either(name: str, value: Any) -> None:
        refusals = []
        for check in understood:
            try:
                check(name, value)
                return
            except InputError as e:
                refusals.append(e)
        raise InputError(name, shown(value), domain=" or ".join(dict.fromkeys(e.domain for e in refusals)))

    return either


def _split(node: ast.expr) -> list[ast.expr]:
    if isinstance(node, ast.BinOp):
        return [*_split(node.left), *_split(node.right)]
    return [node]


def _alternative(node: ast.expr, known: Mapping[str, Any]) -> Check | None:
    if isinstance(node, ast.Constant) and node.value is None:
        return _kind("None", lambda value: value is None)
    if isinstance(node, ast.Name):
        return _NAMED.get(node.id) or _resolved(known.get(node.id))
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
        return _resolved(getattr(known.get(node.value.id), node.attr, None))
    if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name):
        return _subscripted(node.value.id, ast.unparse(node.slice), node.slice)
    return None


def _subscripted(name: str, of: str, inner: ast.expr) -> Check | None:
    if name == "Literal":
        return _one_of(ast.literal_eval(inner) if isinstance(inner, ast.Tuple) else (ast.literal_eval(inner),))
    if name == "tuple" and of == "(float, ...)":
        return _row_of_numbers
    if name == "tuple" and set(of) <= set("(float, )"):
        return _tuple_of_numbers(of.count("float"))
    if (name, of) in _OF_NUMBERS:
        return _OF_NUMBERS[name, of]
    return _SUBSCRIPTED.get(name)


def _resolved(meaning: Any) -> Check | None:
    """A class, or an alias of classes or of words."""
    if typing.get_origin(meaning) is typing.Literal:
        return _one_of(typing.get_args(meaning))
    if isinstance(meaning, types.UnionType):
        meaning = typing.get_args(meaning)
    classes: tuple[Any, ...] = tuple(typing.get_origin(c) or c for c in (meaning if isinstance(meaning, tuple) else (meaning,)))
    if not all(isinstance(c, type) for c in classes):
        return None
    return _kind(" or ".join(f"an object of class {c.__name__}" for c in classes), lambda value: isinstance(value, classes))


def _kind(expected: str, good: Callable[[Any], bool]) -> Check:
    def check(name: str, value: Any) -> None:
        if not good(value):
            raise InputError(name, shown(value), domain=expected)

    return check


def _one_of(allowed: tuple[Any, ...]) -> Check:
    return _kind(f"one of {', '.join(map(str, allowed))}", lambda value: isinstance(value, str | int) and value in allowed)


def number(name: str, value: Any) -> None:
    """Refuse what is not one real number.

    Raises
    ------
    InputError
        As :func:`navbound.table.arrays.numbers`, or more than one.
    """
    numbers(name, value, expected="a number")
    if np.ndim(value) != 0:
        raise InputError(name, f"shape {np.shape(value)}", domain="one number")


def number_or_nan(name: str, value: Any) -> float:
    """A real number as it is, NaN for None.

    Raises
    ------
    InputError
        As :func:`number`.
    """
    if value is None:
        return math.nan
    if type(value) is not float:
        number(name, value)
    return float(value)


def nanoseconds(name: str, value: Any) -> int:
    """A time as a whole number of nanoseconds.

    Raises
    ------
    InputError
        Anything else, or more than 64 bits.
    """
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or not -(2**63) <= value < 2**63:
        raise InputError(name, shown(value), "ns", "[-2^63, 2^63), whole")
    return int(value)


def whole(name: str, value: Any, low: int, high: int, unit: str = "1") -> int:
    """A whole number, of Python or NumPy, that is no truth value.

    Raises
    ------
    InputError
        Anything else, or a number that is not from `low` to `high`.
    """
    if isinstance(value, bool | np.bool_) or not isinstance(value, int | np.integer) or not low <= int(value) <= high:
        raise InputError(name, shown(value), unit, f"[{low}, {high}], whole")
    return int(value)


def _integer(name: str, value: Any) -> None:
    if not isinstance(value, int | np.integer):
        raise InputError(name, shown(value), domain="a whole number")
    if int(value) not in _INTEGERS:
        raise InputError(name, shown(value), domain="a whole number of at most 63 bits")


def _row_of_whole_numbers(name: str, value: Any) -> None:
    _whole_numbers(name, value)
    if np.ndim(value) != 1:
        raise InputError(name, shown(value), domain="whole numbers in a row")


def _whole_numbers(name: str, value: Any) -> None:
    array = numbers(name, value, expected="whole numbers")
    if array.size and (array.dtype.kind not in "biu" or int(array.max()) not in _INTEGERS):
        raise InputError(name, shown(value), domain="whole numbers of at most 63 bits")


def _labels(name: str, value: Any) -> None:
    """One label an epoch, texts or numbers."""
    try:
        array = np.asarray(value)
    except (TypeError, ValueError) as e:
        raise InputError(name, shown(value), domain="labels, shape (n,)") from e
    if array.ndim != 1 or array.dtype.kind not in "biufUSO":
        raise InputError(name, shown(value), domain="labels, shape (n,)")


def _mapping_of_numbers(name: str, value: Any) -> None:
    if not isinstance(value, Mapping):
        raise InputError(name, shown(value), domain="a mapping")
    for key, part in value.items():
        numbers(f"{name}[{shown(key)}]", part)


def _mapping_of_texts(name: str, value: Any) -> None:
    if not isinstance(value, Mapping) or not all(isinstance(part, str) for pair in value.items() for part in pair):
        raise InputError(name, shown(value), domain="a mapping of texts to texts")


def _tuple_of_numbers(count: int) -> Check:
    def check(name: str, value: Any) -> None:
        numbers(name, value)
        if np.shape(value) != (count,):
            raise InputError(name, shown(value), domain=f"{count} numbers")

    return check


def _row_of_numbers(name: str, value: Any) -> None:
    numbers(name, value)
    if np.ndim(value) != 1:
        raise InputError(name, shown(value), domain="numbers in a row")


_NAMED: dict[str, Check] = {
    "float": number,
    "int": _integer,
    "bool": _kind("True or False", lambda value: isinstance(value, bool | np.bool_)),
    "str": _kind("text", lambda value: isinstance(value, str)),
    "ArrayLike": numbers,
    "Labels": _labels,
}

_OF_NUMBERS: dict[tuple[str, str], Check] = {
    ("NDArray", "np.int64"): _whole_numbers,
    ("NDArray", "np.float64"): numbers,
    ("Sequence", "int"): _row_of_whole_numbers,
    ("Sequence", "float"): _row_of_numbers,
    ("Mapping", "(str, ArrayLike)"): _mapping_of_numbers,
    ("Mapping", "(str, str)"): _mapping_of_texts,
    ("Mapping", "(int, float)"): _mapping_of_numbers,
}
_SUBSCRIPTED: dict[str, Check] = {
    "Sequence": _kind("a sequence", lambda value: isinstance(value, Sequence) and not isinstance(value, str | bytes)),
    "Iterable": _kind("items one by one", lambda value: isinstance(value, Iterable) and not isinstance(value, str | bytes)),
    "Mapping": _kind("a mapping", lambda value: isinstance(value, Mapping)),
    "Callable": _kind("callable", callable),
}
