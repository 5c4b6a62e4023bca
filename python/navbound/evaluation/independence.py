"""What a number of correlated epochs is worth where their correlation time is known; `effective_size` estimates it from a series."""

from __future__ import annotations

import math

from navbound.errors import InputError


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
