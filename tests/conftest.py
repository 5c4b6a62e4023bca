"""What several tests share: one short judged flight, and the folder of real data (skipped aloud where it is absent)."""

from __future__ import annotations

import gc
import os
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import settings

import navbound
from navbound.cli import main as cli
from navbound.cli import parts
from navbound.run.directory import Run

if TYPE_CHECKING:
    from collections.abc import Callable

ROOT = Path(__file__).parents[1]
SHARED = ROOT.parent / "shared"

# The same cases in every run, as for the property tests in Rust; `--hypothesis-profile=default` draws new ones.
settings.register_profile("repeatable", derandomize=True)
settings.load_profile("repeatable")


LONG = ("site", "live_browser", "large_tables", "wheel", "report_browser", "predict_flight", "fused", "fused_integrity", "cli")
"""Files that take a minute and more, the longest first: one that begins last is waited for while the other cores rest."""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """One worker more than cores: browsers, servers and their clocks are waited for, and the core that would rest has another file."""
    return (os.cpu_count() or 1) + 1


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Long files first; the order within a file stays. What was imported and collected stays for good and is not looked through again."""
    gc.freeze()
    place = {f"test_{name}.py": rank for rank, name in enumerate(LONG)}
    items.sort(key=lambda item: place.get(item.path.name, len(LONG)))


@pytest.fixture(scope="session")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """The shipped flight, judged and written once for all tests."""
    return navbound.fly("beijing-shanghai", out=tmp_path_factory.mktemp("fly") / "run")


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Real recorded data; a machine without them skips these tests and says so."""
    folder = SHARED / "data"
    if not folder.is_dir():
        pytest.skip(f"SKIPPED ALOUD: no real data at {folder}")
    return folder


@dataclass(frozen=True)
class Ended:
    """What a command left."""

    status: int
    stdout: str
    stderr: str


@pytest.fixture(name="navbound")
def command(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Callable[..., Ended]:
    """The command line in this process, as it prints to a file: starting Python for each refusal costs more than all the rest."""
    monkeypatch.setattr(parts.out_console, "width", parts.PAPER_WIDTH)

    def run(*arguments: str | Path) -> Ended:
        monkeypatch.setattr(sys, "argv", ["navbound", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        printed = capsys.readouterr()
        return Ended(int(ended.value.code or 0), printed.out, printed.err)

    return run
