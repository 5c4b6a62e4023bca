"""The documentation site: `./dev docs` builds it into out/site, without a network, and runs the commands and pictures of its pages."""

from __future__ import annotations

import contextlib
import io
import os
import re
import shutil
import sys
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer
from sphinxcontrib.programoutput import Command

from navbound import __version__

if TYPE_CHECKING:
    from collections.abc import Callable

    from sphinx.application import Sphinx
    from typer._click.core import Command as Commands

ROOT = Path(__file__).parents[1]
WORK = ROOT / "out" / "site-work"
"""Where the commands of the tutorials run, a folder for each page: empty when the site is built."""

project = "navbound"
author = "the navbound authors"
release = __version__
html_title = f"navbound {release}"
extensions = [
    "matplotlib.sphinxext.plot_directive",
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "sphinxcontrib.programoutput",
]
exclude_patterns = ["_static"]
myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 4
# Links to files of the repository that are no pages stay what they are on the forge; on the site they are text.
# Arguments and attributes of one name are no targets of links.
suppress_warnings = ["myst.xref_missing", "ref.python"]

html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_copy_source = False

# A list of every name beside every page would take half of the build.
toc_object_entries = False
autosummary_generate = False
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
python_use_unqualified_type_names = True
napoleon_numpy_docstring = True
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True

plot_working_directory = str(ROOT)
plot_formats = [("png", 110)]
plot_html_show_formats = False
plot_html_show_source_link = False
plot_include_source = True

programoutput_prompt_template = "$ {command}\n{output}"

# Commands are those of the environment that builds the site, and write as into a file: no colours, lines of 92 columns.
os.environ["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
os.environ.update(COLUMNS="92", NO_COLOR="1", TERM="dumb")
shutil.rmtree(WORK, ignore_errors=True)
for page in ("first-ten-minutes", "pbn-engineer", "gnss-analyst", "doctoral-student"):
    (WORK / page).mkdir(parents=True)


@cache
def command_line() -> Commands:
    """The tree of all commands: to make it for each output takes longer than to print them."""
    from navbound.cli.main import app  # noqa: PLC0415 - consoles take their width from COLUMNS when it is loaded

    return typer.main.get_command(app)


def printed(words: str) -> str:
    """What a command prints as to a file; a command that is none raises."""
    name, *arguments = words.split()
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        command_line().main(arguments, prog_name=name, standalone_mode=False)
    return text.getvalue().rstrip()


def print_all_help(app: Sphinx) -> None:
    """The page of commands has some forty outputs of `--help`: they are printed here, for starting Python so often takes half a minute."""
    for words in re.findall(r"^```{program-output} (navbound.*--help)$", (ROOT / "docs/reference/commands.md").read_text(), re.MULTILINE):
        app.env.programoutput_cache[Command(words, working_directory=app.srcdir)] = (0, printed(words))


def make_examples_once(app: Sphinx) -> None:
    """Three tutorials begin with the same files, which take seconds to make: the command runs in the first one's folder alone."""
    words, first = "navbound example --out data", WORK / "first-ten-minutes"
    ended = Command(words, working_directory=str(first.resolve())).get_output()
    for folder in (first, WORK / "pbn-engineer", WORK / "gnss-analyst"):
        if folder != first:
            shutil.copytree(first / "data", folder / "data")
        app.env.programoutput_cache[Command(words, working_directory=str(folder.resolve()))] = ended


def list_decisions(_app: Sphinx, name: str, source: list[str]) -> None:
    """Decision records are found from their page: beside every page they would be a fifth of the build, and in the way."""
    if name == "decisions":
        records = sorted((ROOT / "docs" / "decisions").glob("*.md"))
        titles = [record.read_text(encoding="utf-8").partition("\n")[0].lstrip("# ") for record in records]
        links = (f"- [{title}](decisions/{record.name})" for title, record in zip(titles, records, strict=True))
        source[0] += "\n" + "\n".join(links) + "\n"
    elif name.startswith("decisions/"):
        source[0] = f"---\norphan: true\n---\n{source[0]}"


def share_trees(_app: Sphinx, name: str, _template: str, context: dict[str, Any], _doctree: object) -> None:
    """The list of all pages beside a decision record is that beside every other one: made once, not a hundred times."""
    if name.startswith("decisions/"):
        context["toctree"] = partial(shared_tree, context["toctree"])


TREES: dict[str, str] = {}


def shared_tree(make: Callable[..., str], **how: object) -> str:
    """The tree of a record; all of them are in one folder, and none is in the tree."""
    key = repr(how)
    if key not in TREES:
        TREES[key] = make(**how)
    return TREES[key]


def setup(app: Sphinx) -> None:
    """Called by Sphinx; the extension has its store of outputs from the same event."""
    app.connect("source-read", list_decisions)
    app.connect("html-page-context", share_trees, priority=100)
    app.connect("builder-inited", print_all_help, priority=900)
    app.connect("builder-inited", make_examples_once, priority=900)
