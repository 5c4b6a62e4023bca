"""The check of dependencies refuses what it is there for, and the lock files pass it."""

from __future__ import annotations

import runpy
import shutil
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def rules() -> dict[str, Any]:
    # Its records are looked up by their module's name.
    sys.modules.setdefault("dependencies", sys.modules[__name__])
    return runpy.run_path(str(ROOT / "docs" / "dependencies.py"), run_name="dependencies")


@pytest.mark.parametrize(
    ("expression", "allowed"),
    [
        ("MIT", True),
        ("GPL-3.0-only", False),
        ("MIT/Apache-2.0", True),
        ("GPL-2.0 OR MIT", True),
        ("MIT AND GPL-2.0", False),
        ("(MIT OR GPL-2.0) AND Unicode-3.0", True),
        ("(GPL-2.0 OR LGPL-2.1) AND MIT", False),
        ("Apache-2.0 WITH LLVM-exception", True),
        ("MPL-2.0", False),
        ("none", False),
    ],
)
def test_a_licence_expression_is_read_as_it_is_meant(rules: dict[str, Any], expression: str, allowed: bool) -> None:
    assert rules["satisfied"](expression, rules["ALLOWED"]) is allowed


def test_what_the_rules_forbid_is_refused(rules: dict[str, Any]) -> None:
    package, crates, npm = rules["Package"], rules["REGISTRIES"]["Rust"], rules["REGISTRIES"]["npm"]
    usual = [package("Rust", name, version, "MIT", crates) for name in rules["SEVERAL"] for version in ("1.0.0", "2.0.0")]
    assert rules["refusals"](usual, {"devDependencies": {"a": "1.2.3"}}) == []

    def refused(*more: Any, **manifest: Any) -> list[str]:
        return list(rules["refusals"]([*usual, *more], manifest))

    assert "GPL-3.0" in refused(package("Rust", "a", "1.0.0", "GPL-3.0", crates))[0]
    assert "its licence is None" in refused(package("npm", "a", "1.0.0", None, npm))[0]
    assert "MPL-2.0" in refused(package("Rust", "new", "1.0.0", "MPL-2.0", crates))[0]
    assert refused(package("Rust", "hifitime", "1.0.0", "MPL-2.0", crates)) == []
    assert "git+https" in refused(package("Rust", "a", "1.0.0", "MIT", "git+https://example.org/a"))[0]
    assert "2 versions" in refused(*(package("Rust", "a", v, "MIT", crates) for v in ("1.0.0", "2.0.0")))[0]
    assert "no exact version" in refused(devDependencies={"a": "^1.2.3"})[0]


@pytest.mark.skipif(shutil.which("cargo") is None, reason="cargo is missing: the dependencies were NOT checked")
def test_the_page_is_what_the_lock_files_say(rules: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["dependencies.py", "--check"])
    assert rules["main"]() == 0
