"""A session that is killed anywhere and resumed leaves what an undisturbed one leaves: nothing lost, nothing twice."""

from __future__ import annotations

import os
import signal
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from live_fixture import FLEET, fleet, generator, transitions
from navbound import _core, live
from navbound.live import journal, session
from navbound.live.source import File

POINTS = ("before-journal", "after-journal", "after-step", "before-commit", "after-commit", "in-snapshot", "before-rename")
CHUNK = 2500


@pytest.fixture
def log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(session, "_SNAPSHOT_S", 0.0)
    path = tmp_path / "fleet.jsonl"
    path.write_text("".join(line for _, line in fleet(60, 60)))
    return path


def outputs(folder: Path) -> list[tuple[int, bytes]]:
    return _core.live_comparable(journal.read(folder / journal.OUT))


def run(log: Path, out: Path, **hooks: Any) -> None:
    with closing(File(log, CHUNK)) as source:
        live.Session(out, FLEET, resume=True, **hooks).run(source)


def undisturbed(log: Path, out: Path) -> list[tuple[int, bytes]]:
    run(log, out)
    outputs_now = outputs(out)
    assert len(outputs_now) > 1000
    return outputs_now


def killed(log: Path, out: Path, point: str, passes: int) -> bool:
    """Run a session in a process that kills itself when it passes a point; whether it did."""
    left = [passes]

    def passed(name: str) -> None:
        if name == point:
            left[0] -= 1
            if left[0] == 0:
                os.kill(os.getpid(), signal.SIGKILL)

    child = os.fork()
    if child == 0:
        try:
            run(log, out, passed=passed)
        finally:
            os._exit(0)
    status = os.waitpid(child, 0)[1]
    return os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGKILL


def resumed(log: Path, out: Path) -> list[tuple[int, bytes]]:
    run(log, out)
    keys = [t["key"] for t in transitions(out) if not t["replayed"]]
    reported = {t["key"] for t in transitions(out)}
    written = [row[0][0] for row in _core.live_transitions(journal.read(out / journal.OUT))]
    assert len(written) == len(set(written))
    assert reported == set(written), "every alert that was written was reported"
    assert len(keys) == len(set(keys)), "reported twice and not marked as a repetition"
    return outputs(out)


@pytest.mark.parametrize("point", POINTS)
def test_a_session_killed_at_a_point_of_its_round_loses_and_doubles_nothing(log: Path, tmp_path: Path, point: str) -> None:
    expected = undisturbed(log, tmp_path / "whole")
    out = tmp_path / "out"
    n_killed = sum(killed(log, out, point, passes) for passes in (1, 2, 5))
    assert n_killed == 3
    assert resumed(log, out) == expected


def test_a_session_killed_fifty_times_loses_and_doubles_nothing(log: Path, tmp_path: Path) -> None:
    expected = undisturbed(log, tmp_path / "whole")
    g, out, n_killed = generator(5), tmp_path / "out", 0
    for _ in range(50):
        n_killed += killed(log, out, POINTS[g.integers(len(POINTS))], int(g.integers(1, 4)))
    assert n_killed == 50
    assert resumed(log, out) == expected


def test_journals_cut_anywhere_are_made_whole_again(log: Path, tmp_path: Path) -> None:
    """As a power failure leaves them: each file at some length of its own."""
    expected = undisturbed(log, tmp_path / "whole")
    g = generator(6)
    for case in range(12):
        out = tmp_path / f"cut-{case}"
        assert killed(log, out, "before-journal", 40)
        for name in (journal.IN, journal.OUT):
            size = (out / name).stat().st_size
            os.truncate(out / name, int(g.integers(size // 2, size + 1)))
        assert resumed_from_cut(log, out) == expected, case


def resumed_from_cut(log: Path, out: Path) -> list[tuple[int, bytes]]:
    run(log, out)
    written = [row[0][0] for row in _core.live_transitions(journal.read(out / journal.OUT))]
    assert len(written) == len(set(written))
    return outputs(out)


def test_a_damaged_snapshot_is_refused_aloud_and_the_state_built_anew(log: Path, tmp_path: Path) -> None:
    expected = undisturbed(log, tmp_path / "whole")
    g = generator(8)
    for case in range(10):
        out = tmp_path / f"damaged-{case}"
        assert killed(log, out, "before-journal", 30)
        content = bytearray((out / journal.SNAPSHOT).read_bytes())
        if case % 2:
            content = content[: int(g.integers(len(content)))]
        else:
            content[int(g.integers(len(content)))] ^= 1 << int(g.integers(8))
        (out / journal.SNAPSHOT).write_bytes(content)
        messages = list[str]()
        run(log, out, say=messages.append)
        assert any("refused" in sentence for sentence in messages), messages
        assert outputs(out) == expected
