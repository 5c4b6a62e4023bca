"""The slope method by whole inversions and forty-digit chi-square laws: nothing shared with navbound. Prints its vector files.

python oracle/raim_scipy.py levels > vectors/raim.toml
python oracle/raim_scipy.py factors > vectors/raim-factors.toml
"""

from __future__ import annotations

import json
import math
import sys
from functools import cache
from typing import TYPE_CHECKING

import mpmath as mp
import numpy as np
from scipy import integrate, stats

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

FALSE_ALARM, MISSED, FAULT_FREE = 3.33e-7, 1e-3, 1e-7
mp.mp.dps = 40


def noncentral_head(dof: int, noncentrality: mp.mpf, x: mp.mpf) -> mp.mpf:
    """Poisson mixture of central laws."""
    half, total, largest, j = noncentrality / 2, mp.mpf(0), mp.mpf(0), 0
    while True:
        weight = mp.exp(-half + j * mp.log(half) - mp.loggamma(j + 1))
        term = weight * mp.gammainc(mp.mpf(dof) / 2 + j, 0, x / 2, regularized=True)
        total, largest, j = total + term, max(largest, term), j + 1
        if j > half and term < largest * mp.mpf(10) ** -36:
            return total


@cache
def factors(dof: int, false_alarm: float = FALSE_ALARM, missed: float = MISSED) -> tuple[float, float]:
    """Root of the threshold, root of the non-centrality."""
    start = float(stats.chi2.isf(false_alarm, dof))
    square = mp.findroot(lambda x: mp.gammainc(mp.mpf(dof) / 2, x / 2, mp.inf, regularized=True) - mp.mpf(false_alarm), start)
    guess = (math.sqrt(start) + float(stats.norm.isf(missed))) ** 2
    root = mp.findroot(lambda v: mp.log(noncentral_head(dof, v, square) / mp.mpf(missed)), (guess, guess + 2), tol=1e-30)
    return float(mp.sqrt(square)), float(mp.sqrt(root))


def levels(unit: Floats, systems: list[int], sigma: Floats) -> dict[str, float]:
    """Levels of detection, held and published, by the whole normal equation."""
    clocks = sorted(set(systems))
    h = np.hstack([-unit, np.array([[float(s == c) for c in clocks] for s in systems])])
    if len(systems) <= h.shape[1]:
        return dict.fromkeys(("hpl_m", "vpl_m", "hpl_slope_m", "vpl_slope_m"), math.inf)
    w = np.diag(1 / sigma**2)
    p = np.linalg.inv(h.T @ w @ h)
    gain = p @ h.T @ w
    parity = np.diag(w - w @ h @ gain)
    bias = factors(len(systems) - h.shape[1])[1]
    slope_h, slope_v = np.hypot(gain[0], gain[1]) / np.sqrt(parity), np.abs(gain[2]) / np.sqrt(parity)
    noise_h, noise_v = math.sqrt(p[0, 0] + p[1, 1]), math.sqrt(p[2, 2])
    k, k_ff = float(stats.norm.isf(MISSED / 2)), float(stats.norm.isf(FAULT_FREE / 2))
    return {
        "hpl_m": max(k_ff * noise_h, bias * slope_h.max() + k * noise_h),
        "vpl_m": max(k_ff * noise_v, bias * slope_v.max() + k * noise_v),
        "hpl_slope_m": bias * slope_h.max(),
        "vpl_slope_m": bias * slope_v.max(),
    }


def exclusion(unit: Floats, systems: list[int], sigma: Floats) -> dict[str, float]:
    """The largest level after the exclusion of any one satellite."""
    whole = levels(unit, systems, sigma)
    hel, vel = whole["hpl_m"], whole["vpl_m"]
    for out in range(len(systems)):
        kept = [i for i in range(len(systems)) if i != out]
        after = levels(unit[kept], [systems[i] for i in kept], sigma[kept])
        hel, vel = max(hel, after["hpl_m"]), max(vel, after["vpl_m"])
    return {"hel_m": hel, "vel_m": vel}


def worst_joint(dof: int, level: float, slope: float, sigma: float) -> float:
    """Largest risk, over all sizes of a fault, that it is missed and the error upwards or downwards exceeds the level."""
    square = factors(dof)[0] ** 2
    bias = np.linspace(0.0, 2.0 * factors(dof)[1], 4001)
    missed = stats.ncx2.cdf(square, dof, np.maximum(bias, 1e-9) ** 2)
    beyond = stats.norm.sf((level - slope * bias) / sigma) + stats.norm.sf((level + slope * bias) / sigma)
    return float((missed * beyond).max())


def chi_square_of_normals(dof: int, bias: float, x: float) -> float:
    """The non-central law again, by integrating a normal variable against a central one of one degree less."""
    if dof == 1:
        return float(stats.norm.cdf(math.sqrt(x) - bias) - stats.norm.cdf(-math.sqrt(x) - bias))
    inside = integrate.quad(lambda t: stats.norm.pdf(t - bias) * stats.chi2.cdf(x - t * t, dof - 1), -math.sqrt(x), math.sqrt(x), limit=200)
    return float(inside[0])


def sky(n: int, seed: int) -> Floats:
    """Lines of sight above five degrees to twelve digits, of length one to as many."""
    rng = np.random.default_rng(seed)
    az, el = rng.uniform(0, 2 * math.pi, n), np.arcsin(rng.uniform(math.sin(math.radians(5)), 1, n))
    return np.round(np.stack([np.cos(el) * np.sin(az), np.cos(el) * np.cos(az), np.sin(el)], axis=-1), 12)


PUBLISHED = [
    [-0.0225, -0.9951, 0.0966], [-0.675, 0.69, 0.2612], [-0.0723, 0.6601, 0.7477], [0.9398, -0.2553, 0.2269], [0.5907, 0.7539, 0.2877],
    [0.3236, 0.0354, 0.9455], [0.6748, -0.4356, 0.5957], [-0.0938, 0.7004, 0.7075], [-0.5571, -0.3088, 0.7709], [-0.6622, -0.6958, 0.278],
]  # fmt: skip
"""The ten satellites of Blanch et al. 2012, as printed; five of each constellation."""


def print_levels() -> None:
    """vectors/raim.toml."""
    print('call = "raim.protection_levels"')
    document = "whole inversions (NumPy) and forty-digit chi-square laws (mpmath), oracle/raim_scipy.py"
    print(f'source = "{document}; geometry of ten satellites as printed by Blanch et al. 2012"')
    print('provenance = "ours"')
    reason = "inversions of condition below 1e4 lose four of sixteen digits, and the difference 1 - leverage two more"
    print(f'tolerance = {{ rel = 1e-10, because = "{reason}" }}')
    cases: list[tuple[str, Floats, list[int], Floats]] = [
        ("published-ten-satellites", np.array(PUBLISHED), [0] * 5 + [2] * 5, np.array([2.0, 1.2, 0.9, 1.3, 1.2, 0.9, 0.9, 0.9, 0.9, 1.2])),
        ("gps-nine", sky(9, 3), [0] * 9, np.linspace(1.0, 3.0, 9)),
        ("gps-six", sky(6, 8), [0] * 6, np.linspace(2.0, 5.0, 6)),
        ("gps-five-detects-alone", sky(5, 2), [0] * 5, np.full(5, 6.0)),
        ("gps-four-does-neither", sky(4, 5), [0] * 4, np.full(4, 6.0)),
        ("three-systems-sixteen", sky(16, 21), [0] * 7 + [2] * 6 + [3] * 3, np.linspace(0.8, 2.5, 16)),
    ]
    for name, unit, systems, sigma in cases:
        expected = levels(unit, systems, sigma) | exclusion(unit, systems, sigma)
        print(f'\n[[case]]\nid = "{name}"\n[case.input]')
        print(f"unit_enu = {json.dumps(unit.tolist())}\nconstellation = {systems}\nsigma_m = {sigma.tolist()}")
        print("[case.expect]")
        for key, value in expected.items():
            print(f'{key} = "{float(value)!r}"' if math.isfinite(value) else f'{key} = "inf"')
        print(f'status = "{"ok" if math.isfinite(expected["hpl_m"]) else "not_monitored"}"')


def print_factors() -> None:
    """vectors/raim-factors.toml."""
    print('call = "raim.factors"')
    print('source = "forty-digit chi-square laws (mpmath), oracle/raim_scipy.py"')
    print('provenance = "ours"')
    print('tolerance = { rel = 1e-12, because = "the chi-square quantile is exact to the last digit of a logarithm of size 1e2" }')
    dofs = [1, 2, 3, 4, 5, 6, 8, 12, 20, 40, 60]
    computed = [factors(dof) for dof in dofs]
    print(f'\n[[case]]\nid = "false-alarm-3.33e-7-missed-1e-3"\n[case.input]\nn_redundant = {dofs}\n[case.expect]')
    print(f"value = [{[repr(t) for t, _ in computed]}, {[repr(b) for _, b in computed]}]".replace("'", '"'))


if __name__ == "__main__":
    {"levels": print_levels, "factors": print_factors}[sys.argv[1]]()
