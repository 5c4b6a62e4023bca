"""The documentation site: `./dev docs` builds it into out/site, without a network, and runs the commands and pictures of its pages."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

from navbound import __version__

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
