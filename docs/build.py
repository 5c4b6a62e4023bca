"""Write docs/methods/index.md from the lists of methods and of algorithms. `./dev docs` writes, `--check` compares."""

from __future__ import annotations

import sys
from pathlib import Path

from navbound import verify
from navbound.algorithms import algorithms
from navbound.methods import Method, ProtectionMethod, methods

PAGE = Path(__file__).parent / "methods" / "index.md"


def page() -> str:
    """The page as it should be."""
    checked = {file.id: len(file.cases) for file in verify.files()}
    lines = [
        "# Methods",
        "",
        "Written by `./dev docs` from the core's list; `navbound methods` prints the same. A method's column is its id with underscores.",
        "",
    ]
    for m in methods().values():
        lines += _entry(m)
    lines += [
        "# Protection levels",
        "",
        "They need satellites, messages or a filter, so each has a function of its own. The provenance is that of the formulas; priors,",
        "budgets and error models carry their own.",
        "",
    ]
    for algorithm in algorithms().values():
        lines += _levels(algorithm.declared)
    lines += [
        "## Reference vectors",
        "",
        "| file | cases |",
        "|---|---|",
        *(f"| `vectors/{name}.toml` | {n} |" for name, n in checked.items()),
        "",
    ]
    return "\n".join(lines)


def _entry(m: Method) -> list[str]:
    promises = {
        "scales with length": m.scales_with_length,
        "ignores where north is": m.ignores_north,
        "monotone in risk": m.monotone_in_risk,
        "never below the exact bound": m.conservative,
        "may feed an alert": m.may_alert,
    }
    kept = ", ".join(name for name, yes in promises.items() if yes) or "nothing"
    return [
        f"## `{m.id}`: {m.title}",
        "",
        f"- bounds: |`{m.error_column}`|",
        f"- source: {m.source}",
        f"- provenance: {m.provenance}",
        f"- assumes: {m.assumes}",
        f"- promises: {kept}",
        "",
    ]


def _levels(p: ProtectionMethod) -> list[str]:
    return [
        f"## `{p.id}`: {p.title}",
        "",
        f"- function: `{p.function}`",
        f"- source: {p.source}",
        f"- provenance: {p.provenance}",
        f"- covers: {p.covers}",
        f"- assumes: {p.assumes}",
        f"- integrity: {'yes' if p.integrity else 'no, experimental'}",
        "",
    ]


if __name__ == "__main__":
    if "--check" in sys.argv:
        sys.exit(PAGE.read_text(encoding="utf-8") != page() and f"{PAGE} differs from METHODS: run ./dev docs")
    PAGE.write_text(page(), encoding="utf-8")
