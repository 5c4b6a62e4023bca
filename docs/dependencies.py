"""Check what navbound depends on, and write docs/dependencies.md from it: licences, sources, several versions, exact pins.

`./dev docs` writes, `--check` compares and refuses. It needs `cargo` and the three lock files, and no network.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tomllib
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
PAGE = Path(__file__).parent / "dependencies.md"

ALLOWED = {
    "MIT",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "ISC",
    "Zlib",
    "Unicode-3.0",
    "Unlicense",
    "0BSD",
}
"""Licences that ask for a notice at most."""

NAMED = {
    "hifitime": "time scales in crates/formats; compiled into the module, unchanged. Its source is on crates.io",
    "lightningcss": "part of the bundler, on the developer's machine alone; nothing of it is in the bundle",
}
"""Packages under MPL-2.0 (whoever gives them on says where their source is), with their use; names of parts begin with these."""

SEVERAL = {
    "glam": "nalgebra takes one version a feature of its conversions; none is compiled",
    "syn": "macros of two generations; at build time alone",
}
"""Crates of which there are several versions, with the reason."""

REGISTRIES = {
    "Rust": "registry+https://github.com/rust-lang/crates.io-index",
    "npm": "https://registry.npmjs.org/",
    "Python": "https://pypi.org/simple",
}


@dataclass(frozen=True)
class Package:
    """A package of a lock file; the lock file of Python states no licence."""

    kind: str
    name: str
    version: str
    licence: str | None
    source: str


def rust() -> list[Package]:
    """Crates of the workspace's lock file, without our own."""
    command = ["cargo", "metadata", "--format-version", "1", "--locked"]
    data = json.loads(subprocess.run(command, cwd=ROOT, capture_output=True, check=True).stdout)
    return [Package("Rust", p["name"], p["version"], p["license"], p["source"]) for p in data["packages"] if p["source"] is not None]


def npm(lock: dict[str, Any]) -> list[Package]:
    """Packages of the report's lock file, without our own: what has a digest and no address comes from the registry."""
    return [
        Package(
            "npm",
            path.rpartition("node_modules/")[2],
            p["version"],
            p.get("license"),
            p.get("resolved", REGISTRIES["npm"] if "integrity" in p else ""),
        )
        for path, p in lock["packages"].items()
        if path
    ]


def python(lock: dict[str, Any]) -> list[Package]:
    """Packages of the Python lock file, without our own."""
    return [
        Package("Python", p["name"], p["version"], None, p["source"]["registry"] if "registry" in p["source"] else str(p["source"]))
        for p in lock["package"]
        if "editable" not in p["source"]
    ]


def satisfied(expression: str, allowed: set[str]) -> bool:
    """Whether a licence expression (SPDX) leaves a choice that is allowed: AND binds more than OR, brackets more than both."""
    text = expression.replace("/", " OR ")
    while inner := re.search(r"\(([^()]*)\)", text):
        text = text[: inner.start()] + ("MIT" if satisfied(inner[1], allowed) else "none") + text[inner.end() :]
    return any(all(part.strip() in allowed for part in choice.split(" AND ")) for choice in text.split(" OR "))


def refusals(packages: list[Package], manifest: dict[str, Any]) -> list[str]:
    """What is not as this page says."""
    refused = []
    for p in packages:
        if not p.source.startswith(REGISTRIES[p.kind]):
            refused.append(f"{p.kind} {p.name}: comes from {p.source or 'nowhere'}, not from {REGISTRIES[p.kind]}")
        named = any(p.name == name or p.name.startswith(f"{name}-") for name in NAMED)
        if p.kind != "Python" and not satisfied(p.licence or "none", ALLOWED | ({"MPL-2.0"} if named else set())):
            refused.append(f"{p.kind} {p.name}: its licence is {p.licence}; allowed are {', '.join(sorted(ALLOWED))}, and MPL-2.0 by name")
    versions = defaultdict(set)
    for p in packages:
        if p.kind == "Rust":
            versions[p.name].add(p.version)
    several = {name for name, of in versions.items() if len(of) > 1}
    refused += [f"Rust {name}: {len(versions[name])} versions" for name in sorted(several - SEVERAL.keys())]
    refused += [f"Rust {name}: has one version; take it off the list" for name in sorted(SEVERAL.keys() - several)]
    declared = {**manifest.get("dependencies", {}), **manifest.get("devDependencies", {})}
    return refused + [
        f"npm {name}: {version} is no exact version" for name, version in declared.items() if not re.fullmatch(r"\d+\.\d+\.\d+", version)
    ]


def bundled(notices: str) -> list[tuple[str, str, str]]:
    """Name, version and licence of what is in the report's bundle, as the bundler wrote it."""
    return re.findall(r"^## (\S+) - (\S+) \(([^)]+)\)$", notices, re.MULTILINE)


def page(packages: list[Package], notices: str) -> str:
    """The page as it should be."""
    licences = defaultdict(list)
    for p in packages:
        if p.kind != "Python":
            licences[p.kind, p.licence or "none stated"].append(p.name)
    lines = [
        "# Dependencies",
        "",
        "Written by `./dev docs`; `./dev check` refuses what differs from it.",
        "The rules stand in `docs/dependencies.py`, the reasons in decision 33.",
        "",
        "## In the bundles of the pages",
        "",
        "These libraries are part of `python/navbound/_web/report.js`, some of `live.js`; `third-party.md` beside it has their notices.",
        "",
        "| library | version | licence |",
        "|---|---|---|",
        *(f"| {name} | {version} | {licence} |" for name, version, licence in bundled(notices)),
        "",
        "`coastline.txt` beside it is made from world-atlas (ISC), whose coastline is Natural Earth's (public domain).",
        "",
        "## Under MPL-2.0",
        "",
        *(f"- **{name}**: {what}." for name, what in NAMED.items()),
        "",
        "## Crates of several versions",
        "",
        *(f"- **{name}**: {why}." for name, why in SEVERAL.items()),
        "",
        "## Licences",
        "",
        "| lock file | licence | packages |",
        "|---|---|---|",
        *(f"| {kind} | {licence} | {', '.join(sorted(set(names)))} |" for (kind, licence), names in sorted(licences.items())),
        "",
        "Python's lock file states no licence; what is installed beside navbound is not given on with it.",
        "",
        "`tests/kafka/pom.xml` names the broker of `./dev test kafka` (Apache-2.0), which nothing else needs and no package holds.",
        "",
        "## Pins and updates",
        "",
        "- `Cargo.lock`, `web/package-lock.json` and `uv.lock` are committed; `./dev` builds with `--locked` and `npm ci`.",
        "- `web/package.json` names exact versions, since the bundle is committed and built again without drift.",
        "- Once a month, and when an advisory names a package of a lock file: `cargo update`, `npm --prefix web update`,",
        "  `uv lock --upgrade`, then `./dev web`, `./dev docs`, `./dev check`, `./dev test`. Vectors and small outputs keep their digits;",
        "  an update that moves one goes in alone, with its line under *Numbers changed*.",
        "- Advisories and unmaintained crates need a network and are not part of `./dev check`: `cargo deny check advisories`,",
        "  `npm --prefix web audit` and `pip-audit` are run with the monthly update.",
        "",
    ]
    return "\n".join(lines)


def main() -> int:
    """Write the page, or compare it; refuse what the rules forbid."""
    packages = [
        *rust(),
        *npm(json.loads((ROOT / "web" / "package-lock.json").read_text(encoding="utf-8"))),
        *python(tomllib.loads((ROOT / "uv.lock").read_text(encoding="utf-8"))),
    ]
    refused = refusals(packages, json.loads((ROOT / "web" / "package.json").read_text(encoding="utf-8")))
    for refusal in refused:
        sys.stderr.write(f"dependencies: {refusal}\n")
    text = page(packages, (ROOT / "python" / "navbound" / "_web" / "third-party.md").read_text(encoding="utf-8"))
    if "--check" not in sys.argv:
        PAGE.write_text(text, encoding="utf-8")
    elif not PAGE.is_file() or PAGE.read_text(encoding="utf-8") != text:
        sys.stderr.write(f"{PAGE} differs from the lock files: run ./dev docs\n")
        return 1
    return 1 if refused else 0


if __name__ == "__main__":
    raise SystemExit(main())
