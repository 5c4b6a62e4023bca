"""Documents run: the README's Python lines give what it says, the method page is what METHODS says, the tree is the tree."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[1]


def test_the_method_page_is_up_to_date() -> None:
    build = runpy.run_path(str(ROOT / "docs" / "build.py"), run_name="docs")
    assert (ROOT / "docs" / "methods" / "index.md").read_text(encoding="utf-8") == build["page"](), "run ./dev docs"


def test_the_readme_says_what_its_lines_give() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    code = re.search(r"```python\n(.*?)```", readme, re.S)
    assert code
    names: dict[str, object] = {}
    checked = 0
    for line in code.group(1).splitlines():
        expression, _, comment = line.partition("#")
        if line.startswith(("from", "import")):
            exec(line, names)
            continue
        if not expression.strip():
            continue
        value = float(np.asarray(eval(expression, names)))
        stated = re.match(r"\s*([0-9.]+) m", comment)
        if stated:
            assert abs(value - float(stated.group(1))) <= 0.005, f"{expression.strip()} gives {value}"
            checked += 1
    assert checked > 0


def test_the_other_lines_of_the_readme_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.S)[1:]
    assert len(blocks) == 2
    names: dict[str, object] = {}
    exec(blocks[0], names)
    assert {"gnss", "coasting"} <= set(names["fused"].mode)  # type: ignore[attr-defined]
    monkeypatch.setattr("matplotlib.figure.Figure.savefig", lambda _, name: names.setdefault("saved", name))
    exec(blocks[1], names)
    assert names["saved"] == "approaches.png"


def test_every_link_of_the_readme_leads_somewhere() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    links = re.findall(r"\]\(([^)#]+)\)", readme)
    assert links
    for link in links:
        assert (ROOT / link).exists(), link


def test_the_tree_of_the_design_is_the_tree() -> None:
    tree = (ROOT / "docs" / "design.md").read_text(encoding="utf-8").split("## 2. The tree")[1].split("## 3.")[0]
    crates = set(re.findall(r"\bnavbound-([a-z]+)\b", tree))
    assert crates == {c.name for c in (ROOT / "crates").iterdir()} - {"python"}
    stages = set(re.findall(r"\bsrc/([a-z]+)/", tree))
    assert stages == {s.name for s in (ROOT / "crates" / "core" / "src").iterdir() if s.is_dir()}
    subjects = next(line for line in tree.splitlines() if "one folder a subject" in line).split("one folder")[0].split()
    assert len(subjects) > 5
    assert all((ROOT / "python" / "navbound" / name / "__init__.py").exists() for name in subjects)
