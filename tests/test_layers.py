"""Who may use whom in the Python package: every file has a layer, and no import goes to a later one, wherever it stands."""

from __future__ import annotations

import ast
from pathlib import Path

PACKAGE = Path(__file__).parents[1] / "python" / "navbound"
LAYERS = (
    ("delays", "errors", "exit_status", "units", "words", "_core"),
    ("risks", "serve", "status", "storage", "table", "time"),
    ("records", "methods", "algorithms", "scenario"),
    (
        "anp",
        "araim",
        "dme",
        "evaluation",
        "gbas",
        "gnss",
        "ground",
        "ins",
        "kpi",
        "path",
        "procedures",
        "raim",
        "rnp",
        "rraim",
        "sbas",
        "tse",
        "verify",
        "vertical",
    ),
    ("judge", "read", "write"),
    ("scale", "report"),
    ("maps", "run"),
    ("studies", "plot"),
    ("examples",),
    ("live", "workbench"),
    ("cli",),
)
"""Parts of the package from what all others use to what shows. A part may import from its own layer and from those before it."""
EXCEPTIONS: dict[str, set[str]] = {}
"""Modules and the later parts that they still import. This list may only shrink."""
PLAIN = {"__init__.py", "__main__.py", "_core.pyi"}
MOST_FILES = 12


def modules() -> dict[str, Path]:
    """Files of the package by the names of their modules."""
    dotted = {path: ".".join(("navbound", *path.relative_to(PACKAGE).with_suffix("").parts)) for path in PACKAGE.rglob("*.py")}
    return {name.removesuffix(".__init__"): path for path, name in dotted.items()}


def part(module: str) -> str:
    """The part of the package that a module is in: ``navbound.run.judge`` is in ``run``."""
    return module.removeprefix("navbound").removeprefix(".").partition(".")[0]


def ours(module: str | None) -> bool:
    return module is not None and (module == "navbound" or module.startswith("navbound."))


def imports(text: str) -> set[str]:
    """Modules and names of ours that a text imports: at its top, in functions, and for types alone."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom) and ours(node.module):
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names if ours(alias.name)}
    return names


def layer(name: str) -> int | None:
    """Place of a part in the order; what stands in the package itself (its version, its errors) is before all."""
    if name.startswith("__") or not name or name[0].isupper():
        return 0
    return next((place for place, parts in enumerate(LAYERS) if name in parts), None)


def violations() -> dict[str, set[str]]:
    """Modules and the parts of later layers that they import."""
    later: dict[str, set[str]] = {}
    for name, path in modules().items():
        own = layer(part(name))
        if part(name) in {"", "__main__"}:
            continue
        assert own is not None, f"{name} has no layer"
        for target in imports(path.read_text(encoding="utf-8")):
            place = layer(part(target))
            assert place is not None, f"{name} imports {target}, which has no layer"
            if place > own:
                later.setdefault(name.removeprefix("navbound."), set()).add(part(target))
    return later


def test_every_import_goes_to_an_earlier_layer() -> None:
    assert violations() == EXCEPTIONS


def test_the_search_sees_imports_in_functions_and_for_types() -> None:
    text = (
        "def f():\n    from navbound.report import render\n\nif TYPE_CHECKING:\n    import navbound.cli.main\n    from polars import col\n"
    )
    assert imports(text) == {"navbound.report.render", "navbound.cli.main"}
    assert len(imports((PACKAGE / "run" / "judge.py").read_text(encoding="utf-8"))) > 10


def test_a_file_of_no_layer_fails() -> None:
    assert layer("attic") is None


def test_no_file_name_begins_with_an_underscore() -> None:
    names = [path for path in PACKAGE.rglob("*") if path.suffix in {".py", ".pyi"} and path.name.startswith("_")]
    assert {path.name for path in names} <= PLAIN


def test_files_that_share_a_prefix_are_a_folder() -> None:
    for folder in {path.parent for path in modules().values()}:
        stems = [path.stem for path in folder.glob("*.py") if path.name not in PLAIN]
        shared = {(a, b) for a in stems for b in stems if b.startswith(f"{a}_")}
        assert not shared, f"{folder.name}: {shared}"


def test_folders_are_small_and_say_what_is_in_them() -> None:
    for folder in {path.parent for path in modules().values()}:
        # The command line has one file a command.
        assert folder.name == "cli" or len(list(folder.glob("*.py"))) <= MOST_FILES, folder
        words = ast.get_docstring(ast.parse((folder / "__init__.py").read_text(encoding="utf-8")))
        assert words, f"{folder} says nothing of what is in it"


def test_no_file_has_the_name_of_what_its_folder_defines() -> None:
    """The first import of a file puts it under its name into the folder, in the place of a function of that name."""
    for folder in {path.parent for path in modules().values()}:
        tree = ast.parse((folder / "__init__.py").read_text(encoding="utf-8"))
        defined = {node.name for node in tree.body if isinstance(node, ast.FunctionDef | ast.ClassDef)}
        assert not defined & {path.stem for path in folder.glob("*.py")}, folder
