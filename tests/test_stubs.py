"""Every name the compiled module exports has a type, and every typed name exists."""

from __future__ import annotations

import ast
from pathlib import Path

from navbound import _core

STUB = Path(__file__).parents[1] / "python" / "navbound" / "_core.pyi"


def test_stub_and_module_list_the_same_names() -> None:
    tree = ast.parse(STUB.read_text(encoding="utf-8"))
    typed = {node.name for node in tree.body if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    typed |= {node.target.id for node in tree.body if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name)}
    typed = {name for name in typed if not name.startswith("_") or name == "__version__"}
    exported = {name for name in dir(_core) if not name.startswith("_")} | {"__version__"}
    assert exported, "the module exports nothing: this test would prove nothing"
    assert typed == exported
