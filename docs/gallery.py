"""Write docs/gallery.md from the scripts in examples/gallery. `./dev docs` writes, `--check` compares."""

from __future__ import annotations

import ast
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
        "Written by `./dev docs` from the scripts' first sentences. Each script draws one picture with `navbound.plot`, an extra:",
        "`pip install 'navbound[plot]'`. It runs from the repository's folder and leaves the axes in `ax`; the site draws all of them.",
        "",
    ]
    for script in SCRIPTS:
        number, _, name = script.stem.partition("-")
        words = ast.get_docstring(ast.parse(script.read_text(encoding="utf-8"))) or ""
        lines += [
            f"## {int(number)}: {name.replace('-', ' ')}",
            "",
            words,
            "",
            "```{eval-rst}",
            f".. plot:: ../examples/gallery/{script.name}",
            "```",
            "",
        ]
    return "\n".join(lines)


def main() -> int:
    """Write or compare."""
    if "--check" in sys.argv:
        current = PAGE.exists() and PAGE.read_text(encoding="utf-8") == page()
        sys.stderr.write("" if current else f"{PAGE} is not what ./dev docs writes\n")
        return 0 if current else 1
    PAGE.write_text(page(), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
