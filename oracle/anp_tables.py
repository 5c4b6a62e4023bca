"""Nodes of the radius kernel's contours and of its quadrature, at 50 digits, as the Rust tables hold them.

``python oracle/anp_tables.py`` prints both tables; tests/test_anp_oracle.py compares the committed files with them.
"""

from __future__ import annotations

from typing import Any

import mpmath as mp

DIGITS = 50

Node = tuple[Any, Any]


def talbot(half: int) -> list[Node]:
    """Talbot's contour (constants of Weideman 2006) with `half` nodes in the upper half plane: (c, a = w/c)."""
    n = 2 * half
    nodes = []
    for k in range(half):
        th = mp.mpf(2 * k + 1) * mp.pi / n
        a = mp.mpf("0.6407") * th
        slope = mp.mpf("0.5017")
        c = n * (slope * th * mp.cot(a) - mp.mpf("0.6122") + mp.mpc(0, "0.2645") * th)
        d = n * (slope * (mp.cot(a) - a / mp.sin(a) ** 2) + mp.mpc(0, "0.2645"))
        nodes.append((c, 2 * mp.exp(c) * d / (mp.mpc(0, 1) * n) / c))
    return nodes


def parabola(half: int) -> list[Node]:
    """Weideman's parabola with `half` nodes in the upper half plane: (c, a = w/c)."""
    n = 2 * half
    nodes = []
    for k in range(half):
        th = mp.mpf(2 * k + 1) * mp.pi / n
        c = n * (mp.mpf("0.1309") - mp.mpf("0.1194") * th**2 + mp.mpc(0, "0.25") * th)
        d = n * (-2 * mp.mpf("0.1194") * th + mp.mpc(0, "0.25"))
        nodes.append((c, 2 * mp.exp(c) * d / (mp.mpc(0, 1) * n) / c))
    return nodes


def gauss_legendre(n: int) -> list[tuple[Any, Any]]:
    """Positive nodes and weights of the n-point rule (n even), ascending."""
    nodes = []
    for k in range(n // 2):
        x = mp.findroot(lambda t: mp.legendre(n, t), mp.cos(mp.pi * (mp.mpf(k) + mp.mpf("0.75")) / (n + mp.mpf("0.5"))))
        slope = n * (x * mp.legendre(n, x) - mp.legendre(n - 1, x)) / (x * x - 1)
        nodes.append((x, 2 / ((1 - x * x) * slope**2)))
    return nodes[::-1]


def contours() -> dict[str, list[Node]]:
    """Return every contour the kernel uses, by the name of its table."""
    return {"TALBOT_8": talbot(8), "TALBOT_14": talbot(14), "PARABOLA_20": parabola(20), "PARABOLA_24": parabola(24)}


def _literal(x: Any) -> str:
    return repr(float(x))


def _print() -> None:
    for name, nodes in contours().items():
        print(f"pub(super) const {name}: [Node; {len(nodes)}] = [")
        for c, a in nodes:
            print(f"    node([{_literal(c.real)}, {_literal(c.imag)}], [{_literal(a.real)}, {_literal(a.imag)}]),")
        print("];")
    print("const GAUSS_32: [(f64, f64); 16] = [")
    for x, w in gauss_legendre(32):
        print(f"    ({_literal(x)}, {_literal(w)}),")
    print("];")


if __name__ == "__main__":
    with mp.workdps(DIGITS):
        _print()
