"""Write docs/gallery.md from the scripts in examples/gallery. `./dev docs` writes, `--check` compares; `--draw DIR` draws every picture."""

from __future__ import annotations

import ast
import runpy
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = Path(__file__).parent / "gallery.md"
SCRIPTS = sorted((ROOT / "examples" / "gallery").glob("*.py"))


def page() -> str:
    """The page as it should be."""
    lines = [
        "# Gallery",
        "",
        "Written by `./dev docs` from the scripts' first sentences. Each script draws one picture with",
        "[`navbound.plot`](../python/navbound/plot/__init__.py), an extra: `pip install 'navbound[plot]'`.",
        "It runs from the repository's folder and leaves the axes in `ax`.",
        "`uv run python docs/gallery.py --draw DIR` draws all of them.",
        "",
        "| script | what one sees |",
        "|---|---|",
    ]
    for script in SCRIPTS:
        words = ast.get_docstring(ast.parse(script.read_text(encoding="utf-8")))
        lines.append(f"| [{script.stem}](../examples/gallery/{script.name}) | {words} |")
    return "\n".join(lines) + "\n"


def draw(folder: Path) -> None:
    """Every picture as a file."""
    import matplotlib as mpl  # noqa: PLC0415 - an extra, and only for this

    mpl.use("Agg")
    folder.mkdir(parents=True, exist_ok=True)
    for script in SCRIPTS:
        runpy.run_path(str(script))["ax"].figure.savefig(folder / f"{script.stem}.png", dpi=120)
        sys.stdout.write(f"{folder / script.stem}.png\n")


def main() -> int:
    """Write, compare or draw."""
    if "--draw" in sys.argv:
        draw(Path(sys.argv[sys.argv.index("--draw") + 1]))
        return 0
    if "--check" in sys.argv:
        current = PAGE.exists() and PAGE.read_text(encoding="utf-8") == page()
        sys.stderr.write("" if current else f"{PAGE} is not what ./dev docs writes\n")
        return 0 if current else 1
    PAGE.write_text(page(), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
