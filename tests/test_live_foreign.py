"""Files of a session that are lost, exchanged or damaged: restored where they can be, otherwise a sentence that names the file."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from live_fixture import fleet, frames, recorded, transitions
from navbound import _core, live
from navbound.cli.main import app
from navbound.errors import FormatError
from navbound.exit_status import UNREADABLE
from navbound.live import journal
from navbound.live.session import Session
from navbound.live.settings import load


@pytest.fixture(scope="module")
def sessions(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Two finished sessions of different data."""
    folder = tmp_path_factory.mktemp("sessions")
    for name, n, seconds, seed in (("a", 8, 60, 7), ("b", 6, 50, 2)):
        live.judge(recorded(folder / f"{name}-in", frames(fleet(n, seconds, seed), heartbeats=True)), folder / name)
    return folder / "a", folder / "b"


def copied(source: Path, to: Path) -> Path:
    shutil.copytree(source, to)
    return to


def resumed(folder: Path, settings: Path) -> list[str]:
    """What a session says when it goes on."""
    sentences: list[str] = []
    Session(folder, load(settings / journal.SETTINGS), resume=True, say=sentences.append).finish(ended=False)
    return sentences


def test_a_removed_list_of_events_is_restored_and_reported(sessions: tuple[Path, Path], tmp_path: Path) -> None:
    whole, folder = sessions[0], copied(sessions[0], tmp_path / "x")
    expected = (whole / journal.EVENTS).read_bytes()
    n = len(expected.splitlines())
    assert n > 20
    (folder / journal.EVENTS).unlink()
    assert f"events.jsonl: {n} of {n} transitions were missing and are restored from out.nvj" in resumed(folder, whole)
    assert (folder / journal.EVENTS).read_bytes() == expected
    # Lines that were cut out, or damaged, too; what is whole is not touched.
    lines = expected.splitlines(keepends=True)
    (folder / journal.EVENTS).write_bytes(b"".join([*lines[:3], b'{"key":\n', *lines[7:]]))
    assert f"events.jsonl: 4 of {n} transitions were missing and are restored from out.nvj" in resumed(folder, whole)
    assert (folder / journal.EVENTS).read_bytes() == expected
    assert not [each for each in resumed(folder, whole) if "events" in each]


def test_a_list_of_events_that_is_removed_while_the_session_runs_is_restored(sessions: tuple[Path, Path], tmp_path: Path) -> None:
    came_in = journal.read(sessions[0] / journal.IN)
    ends, _ = _core.live_frames(came_in)
    half = ends[len(ends) // 2]
    sentences: list[str] = []
    session = Session(tmp_path / "x", load(sessions[0] / journal.SETTINGS), say=sentences.append)
    session.take(came_in[:half])
    assert (tmp_path / "x" / journal.EVENTS).is_file()
    (tmp_path / "x" / journal.EVENTS).unlink()
    session.snapshot()
    session.take(came_in[half:])
    session.finish(ended=False)
    assert any("restored from out.nvj" in each for each in sentences)
    listed, expected = ([(t["key"], t["transition"]) for t in transitions(folder)] for folder in (tmp_path / "x", sessions[0]))
    assert listed == expected


def frame_of(payload: bytes) -> bytes:
    """A whole frame around a payload."""
    crc = 0xFFFFFFFF
    for byte in payload:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x82F63B78 if crc & 1 else 0)
    return len(payload).to_bytes(4, "little") + (crc ^ 0xFFFFFFFF).to_bytes(4, "little") + payload


def in_frames(path: Path) -> list[bytes]:
    content = path.read_bytes()
    ends, _ = _core.live_frames(content)
    return [content[begin:end] for begin, end in zip([0, *ends], ends, strict=False)]


def changed(name: str, change: Callable[[list[bytes]], list[bytes]]) -> Callable[[Path, Path], object]:
    """A journal whose frames are changed."""
    return lambda folder, _: (folder / name).write_bytes(b"".join(change(in_frames(folder / name))))


def folder_for_snapshot(folder: Path, _: Path) -> None:
    (folder / journal.SNAPSHOT).unlink()
    (folder / journal.SNAPSHOT).mkdir()


FOREIGN: dict[str, tuple[Callable[[Path, Path], object], str]] = {
    "in of another": (lambda x, other: shutil.copy(other / journal.IN, x), "does not belong to in.nvj"),
    "out of another": (lambda x, other: shutil.copy(other / journal.OUT, x), "does not belong to in.nvj"),
    "out for in": (lambda x, _: shutil.copy(x / journal.OUT, x / journal.IN), "in.nvj: not the journal of a session"),
    "in for out": (lambda x, _: shutil.copy(x / journal.IN, x / journal.OUT), "out.nvj: another version"),
    "no in": (lambda x, _: (x / journal.IN).unlink(), "in.nvj: is missing"),
    "empty in": (lambda x, _: (x / journal.IN).write_bytes(b""), "in.nvj: is missing or empty"),
    "lost inputs": (changed(journal.IN, lambda f: f[:2] + f[4:]), "does not belong to in.nvj"),
    "lost outputs": (changed(journal.OUT, lambda f: f[:2] + f[4:]), "in.nvj judged again gives other outputs"),
    "outputs in another order": (changed(journal.OUT, lambda f: f[::-1]), "does not belong to in.nvj"),
    "version in the middle of out": (changed(journal.OUT, lambda f: [*f[:3], frame_of(b"\x09" + f[3][9:]), *f[4:]]), "another version"),
    "empty output": (changed(journal.OUT, lambda f: [*f[:3], frame_of(b""), *f[3:]]), "out.nvj: not the journal of a session"),
    "short output": (changed(journal.OUT, lambda f: [*f[:3], frame_of(f[3][8:-3]), *f[4:]]), "out.nvj: not the journal of a session"),
    "unknown input": (
        changed(journal.IN, lambda f: [*f[:4], frame_of(f[4][8:9] + b"\xff" + f[4][10:]), *f[5:]]),
        "in.nvj: not the journal",
    ),
    "no settings": (lambda x, _: (x / journal.SETTINGS).unlink(), "no live.json, without which it cannot be resumed"),
    "deep settings": (lambda x, _: (x / journal.SETTINGS).write_text("[" * 100_000), "not the settings of a live session"),
    "a folder for a snapshot": (folder_for_snapshot, "snapshot.bin: is no file"),
}


@pytest.mark.parametrize("kind", FOREIGN)
def test_foreign_and_damaged_files_are_a_sentence_and_change_nothing(sessions: tuple[Path, Path], tmp_path: Path, kind: str) -> None:
    change, says = FOREIGN[kind]
    folder = copied(sessions[0], tmp_path / "x")
    change(folder, sessions[1])
    before = {p.name: p.read_bytes() for p in folder.iterdir() if p.is_file()}
    with pytest.raises(FormatError, match=says):
        resumed(folder, sessions[0])
    after = {p.name: p.read_bytes() for p in folder.iterdir() if p.is_file()}
    kept = {journal.IN, journal.OUT, journal.EVENTS} & before.keys()
    assert {name: after[name] for name in kept} == {name: before[name] for name in kept}


def test_a_folder_without_settings_does_not_advise_what_cannot_work(sessions: tuple[Path, Path], tmp_path: Path) -> None:
    folder = copied(sessions[0], tmp_path / "x")
    (folder / journal.SETTINGS).unlink()
    with pytest.raises(FormatError, match="put it back, or choose another --out") as refused:
        Session(folder, load(sessions[0] / journal.SETTINGS))
    assert "--resume" not in str(refused.value)
    with pytest.raises(FormatError, match=r"live\.json: is missing"):
        live.judge(folder, tmp_path / "judged")


@pytest.mark.parametrize("kind", ["out of another", "short output", "empty output", "no settings"])
def test_a_comparison_with_a_foreign_session_is_unreadable_data(sessions: tuple[Path, Path], tmp_path: Path, kind: str) -> None:
    folder = copied(sessions[0], tmp_path / "x")
    FOREIGN[kind][0](folder, sessions[1])
    if kind == "no settings":
        shutil.copy(sessions[1] / journal.OUT, folder)
    done = CliRunner().invoke(app, ["live", "compare", str(sessions[0]), str(folder)])
    assert isinstance(done.exception, FormatError) or done.exit_code == UNREADABLE, (done.output, done.exception)
    # Sessions of other data are no second judgement.
    with pytest.raises(FormatError, match="the two journals in differ"):
        CliRunner().invoke(app, ["live", "compare", *map(str, sessions)], catch_exceptions=False)


def test_the_reference_frame_of_these_tests_is_that_of_a_journal(sessions: tuple[Path, Path]) -> None:
    first = in_frames(sessions[0] / journal.OUT)[0]
    assert frame_of(first[8:]) == first
    assert json.loads((sessions[0] / journal.SETTINGS).read_text())["settings"]
