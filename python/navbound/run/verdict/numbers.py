"""Numbers as a navigator says them."""

from __future__ import annotations

from navbound.units import METRES_PER_NM


def length(metres: float) -> str:
    """A length with three significant digits; nautical miles from half a mile up."""
    if abs(metres) >= 0.5 * METRES_PER_NM:
        return f"{metres / METRES_PER_NM:.3g} NM"
    return in_metres(metres)


def in_metres(metres: float) -> str:
    """A length that is never in nautical miles, a height: three significant digits, or all before the point."""
    return f"{metres:.3g} m" if abs(metres) < 100 else f"{metres:.0f} m"


def share(fraction: float) -> str:
    """A share that never rounds up to all or down to none."""
    percent = 100 * fraction
    if fraction in (0.0, 1.0):
        return f"{percent:.0f} %"
    digits = 1
    while digits < 6 and (round(percent, digits) in (0.0, 100.0)):
        digits += 1
    if round(percent, digits) in (0.0, 100.0):
        return "below 0.000001 %" if percent < 50.0 else "above 99.999999 %"
    return f"{percent:.{digits}f} %"


def level(risk: float) -> str:
    """A probability level: 0.05 is 95 %, 1e-5 is 99.999 %."""
    return f"{100 * (1 - risk):.10g} %"


def independent(n_effective: float) -> str:
    """A number of independent epochs: whole from ten on."""
    return f"{n_effective:.0f}" if n_effective >= _WHOLE else f"{n_effective:.2g}"


_WHOLE = 10.0


def duration(seconds: float) -> str:
    """Seconds up to two hours, hours up to two days, then days."""
    if seconds < 2 * 3600.0:
        return f"{seconds:.6g} s"
    return f"{seconds / 3600.0:.3g} hours" if seconds < 2 * 86400.0 else f"{seconds / 86400.0:.4g} days"
