"""The total system error again, slowly and independently: 50 digits, quadrature where the package has a closed form.

Nothing here is taken from the package. The exact bound is found from the two-dimensional density over the strip between the envelope
lines, as the paper defines it, not from the one-dimensional law it reduces to.
"""

from __future__ import annotations

from typing import Any

import mpmath as mp

mp.mp.dps = 50


def tail(x: Any) -> Any:
    """Upper tail of the standard normal law."""
    return mp.erfc(mp.mpf(x) / mp.sqrt(2)) / 2


def two_tails(bound: Any, mean: Any, sigma: Any) -> Any:
    """Risk that a normal error exceeds a bound in magnitude."""
    bound, mean, sigma = mp.mpf(bound), mp.mpf(mean), mp.mpf(sigma)
    return tail((bound - mean) / sigma) + tail((bound + mean) / sigma)


def quantile(risk: Any) -> Any:
    """One-sided factor, by bisection on the tail."""
    return bisect(lambda u: tail(u) - mp.mpf(risk), mp.mpf(-40), mp.mpf(40))


def bisect(falling: Any, low: Any, high: Any) -> Any:
    """Root of a falling function, by halving alone: slow and sure."""
    for _ in range(180):
        middle = (low + high) / 2
        if falling(middle) > 0:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def exact(fte: Any, sigma: Any, risk: Any) -> Any:
    """Folded-normal quantile, by bisection on the risk."""
    fte, sigma = abs(mp.mpf(fte)), mp.mpf(sigma)
    return bisect(lambda t: two_tails(t, fte, sigma) - mp.mpf(risk), fte - 40 * sigma, fte + 40 * sigma)


def strip_risk(offset: Any, covariance: Any, course: Any, bound: Any) -> Any:
    """Risk outside the strip of half width `bound`, by quadrature of the two-dimensional law.

    The second coordinate is integrated numerically; the first by its conditional law. No projection is used.
    """
    (see, sen), (_, snn) = covariance
    see, sen, snn = mp.mpf(see), mp.mpf(sen), mp.mpf(snn)
    s, c = mp.sin(mp.mpf(course)), mp.cos(mp.mpf(course))
    slope, conditional = sen / snn, mp.sqrt(see - sen * sen / snn)

    def outside(north: Any) -> Any:
        centre = mp.mpf(offset[0]) + slope * (north - mp.mpf(offset[1]))
        # |c e - s n| > bound: two half lines in the east coordinate.
        edges = sorted([(bound + s * north) / c, (-bound + s * north) / c])
        inside = tail((edges[0] - centre) / conditional) - tail((edges[1] - centre) / conditional)
        density = mp.exp(-((north - mp.mpf(offset[1])) ** 2) / (2 * snn)) / mp.sqrt(2 * mp.pi * snn)
        return (1 - inside) * density

    reach = 12 * mp.sqrt(snn)
    points = [mp.mpf(offset[1]) + reach * k / 6 for k in range(-6, 7)]
    with mp.workdps(25):
        return mp.quad(outside, points)


def student_risk(bound: Any, mean: Any, scale: Any, nu: Any) -> Any:
    """Both tails of a Student law, by quadrature of its density."""
    nu = mp.mpf(nu)
    front = mp.gamma((nu + 1) / 2) / (mp.sqrt(nu * mp.pi) * mp.gamma(nu / 2))

    def upper(t: Any) -> Any:
        # t = tan(a) makes the tail a finite interval.
        return mp.quad(lambda a: front * (1 + mp.tan(a) ** 2 / nu) ** (-(nu + 1) / 2) / mp.cos(a) ** 2, [mp.atan(t), mp.pi / 2])

    bound, mean, scale = mp.mpf(bound), mp.mpf(mean), mp.mpf(scale)
    return upper((bound - mean) / scale) + upper((bound + mean) / scale)


def box_risk(mean_l: Any, sigma_l: Any, mean_v: Any, sigma_v: Any, *, rho: Any, limit_l: Any, limit_v: Any) -> Any:
    """Risk outside a box: the side walls, and between them floor and ceiling by the conditional law, by quadrature."""
    rho = mp.mpf(rho)
    conditional = mp.sqrt(1 - rho * rho)
    right, left = (mp.mpf(limit_l) - mp.mpf(mean_l)) / mp.mpf(sigma_l), (mp.mpf(limit_l) + mp.mpf(mean_l)) / mp.mpf(sigma_l)
    above, below = (mp.mpf(limit_v) - mp.mpf(mean_v)) / mp.mpf(sigma_v), (mp.mpf(limit_v) + mp.mpf(mean_v)) / mp.mpf(sigma_v)

    def integrand(x: Any) -> Any:
        over = tail((above - rho * x) / conditional) + tail((below + rho * x) / conditional)
        return mp.npdf(x) * over

    low, high = max(-left, mp.mpf(-16)), min(right, mp.mpf(16))
    steps = 12
    points = [low + (high - low) * k / steps for k in range(steps + 1)]
    with mp.workdps(22):
        return tail(right) + tail(left) + mp.quad(integrand, points)


def farthest(x: float, y: float, a: float, b: float) -> Any:
    """Farthest point of an ellipse: all stationary points from the quartic in tan(t/2), the largest distance of them and of t = 0, pi."""
    x, y, a, b = (mp.mpf(v) for v in (x, y, a, b))
    # d/dt |.|^2 / 2 = (b^2 - a^2) sin t cos t - a x sin t + b y cos t = 0, with w = tan(t/2).
    gap = b * b - a * a
    coefficients = [-b * y, -2 * gap - 2 * a * x, 0, 2 * gap - 2 * a * x, b * y]
    while coefficients and coefficients[0] == 0:
        coefficients.pop(0)
    angles = [mp.mpf(0), mp.pi]
    if len(coefficients) > 1:
        angles += [2 * mp.atan(mp.re(root)) for root in mp.polyroots(coefficients[::-1], maxsteps=500, extraprec=400, asc=True)]
    return max(mp.hypot(x + a * mp.cos(t), y + b * mp.sin(t)) for t in angles)
