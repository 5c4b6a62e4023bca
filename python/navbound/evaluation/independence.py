"""What a number of correlated epochs is worth, and what a share of independent ones says."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from navbound.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable

_HALVINGS = 80
"""Of [0, 1]: the last interval is below a spacing of doubles."""


def effective_number(duration_s: float, step_s: float, tau_s: float) -> tuple[float, float]:
    """Independent epochs that a first-order process is worth, for its mean and for its variance.

    ``n / (1 + 2 sum (1 - k/n) rho^k)`` with ``rho = exp(-step / tau)`` for the mean, ``rho²`` for the variance; about ``T / 2 tau`` and
    ``T / tau``. Epochs stand at both ends.

    Parameters
    ----------
    duration_s, step_s, tau_s : float
        Length, time between epochs, correlation time. [s]

    Raises
    ------
    InputError
        One that is not positive, more than 10^7 epochs.
    """
    for name, value in (("duration_s", duration_s), ("step_s", step_s), ("tau_s", tau_s)):
        if not (value > 0 and math.isfinite(value)):
            raise InputError(name, value, "s", "(0, inf)")
    if duration_s / step_s > 1e7:
        raise InputError("step_s", step_s, "s", "steps of which 10^7 are longer than the duration")
    n = math.floor(duration_s / step_s + 1e-9) + 1
    for_mean, for_variance = (_effective(n, math.exp(-power * step_s / tau_s)) for power in (1.0, 2.0))
    return for_mean, for_variance


def _effective(n: int, rho: float) -> float:
    """The sum in closed form."""
    if rho >= 1.0:
        return 1.0
    # sum_{k=1}^{n-1} (1 - k/n) rho^k = rho / (1 - rho) - rho (1 - rho^n) / (n (1 - rho)^2)
    total = rho / (1 - rho) - rho * (1 - rho**n) / (n * (1 - rho) ** 2)
    return n / (1 + 2 * total)


def coverage_interval(n_inside: int, n: int, risk: float = 0.05) -> tuple[float, float]:
    """Limits of a probability from independent trials: Clopper and Pearson (Biometrika 26, 1934), exact.

    Parameters
    ----------
    n_inside, n : int
        Successes and trials.
    risk : float, optional
        That the limits miss it, half on each side. [1]

    Raises
    ------
    InputError
        No trial, more successes than trials, a risk outside (0, 1).
    """
    if not n >= 1:
        raise InputError("n", n, "1", "[1, inf)")
    if not 0 <= n_inside <= n:
        raise InputError("n_inside", n_inside, "1", "[0, n]")
    if not 0 < risk < 1:
        raise InputError("risk", risk, "1", "(0, 1)")
    low = 0.0 if n_inside == 0 else _solve(lambda p: _at_least(n_inside, n, p), risk / 2)
    high = 1.0 if n_inside == n else _solve(lambda p: -_at_most(n_inside, n, p), -risk / 2)
    return low, high


def _solve(rising: Callable[[float], float], target: float) -> float:
    """Where a rising function of a probability meets a value."""
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if rising(middle) < target else (low, middle)
    return (low + high) / 2


def _at_least(k: int, n: int, p: float) -> float:
    return math.fsum(_binomial(i, n, p) for i in range(k, n + 1))


def _at_most(k: int, n: int, p: float) -> float:
    return math.fsum(_binomial(i, n, p) for i in range(k + 1))


def _binomial(k: int, n: int, p: float) -> float:
    if p <= 0.0 or p >= 1.0:
        return float(k == (0 if p <= 0.0 else n))
    log = math.lgamma(n + 1) - math.lgamma(k + 1) - math.lgamma(n - k + 1) + k * math.log(p) + (n - k) * math.log1p(-p)
    return math.exp(log)
