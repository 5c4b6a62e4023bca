"""What several tests share: one short judged flight, and the folder of real data (skipped aloud where it is absent)."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import settings

import navbound
from navbound.run.directory import Run

ROOT = Path(__file__).parents[1]
SHARED = ROOT.parent / "shared"

# The same cases in every run, as for the property tests in Rust; `--hypothesis-profile=default` draws new ones.
settings.register_profile("repeatable", derandomize=True)
settings.load_profile("repeatable")


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
