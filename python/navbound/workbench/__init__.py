"""The workbench: a page of this host on which files are dropped, jobs of the command line started and stopped, and their reports read.

`forms` says what can be requested, as the command line declares it, and writes the command line of it; `files` knows the files of the
folder and takes new ones; `recognise` says what each is; `jobs` runs command lines as processes of their own; `runs` lists what earlier
ones left; `server` puts them on the page, by the server of :mod:`navbound.serve`.
"""

from __future__ import annotations

from navbound.workbench.forms import Field, Form
from navbound.workbench.server import Server, Settings, serve

__all__ = ["Field", "Form", "Server", "Settings", "serve"]
