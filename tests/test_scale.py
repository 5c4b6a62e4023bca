"""Tiles: the same bits from every back end, nothing lost with a worker, nothing done twice after a kill."""

from __future__ import annotations

import pickle
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tiles_fixture
from navbound import maps, scale
from navbound.errors import FormatError, InputError, NavboundError
from navbound.maps.orbital import Dop
from navbound.maps.sources import Times
from navbound.maps.statistics import Evaluate, Tile
from navbound.scale import backends

TILES = list(range(8))
Parts = list[dict[str, Any]]


@pytest.fixture(scope="module")
def workers() -> Iterator[dict[str, scale.Workers]]:
    """One Dask cluster for all tests; its workers start again when they are lost."""
    distributed = pytest.importorskip("distributed", reason="SKIPPED ALOUD: Dask is not installed")
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs="CRITICAL") as cluster,
        distributed.Client(cluster) as client,
    ):
        yield {"serial": scale.Workers(), "processes": scale.Workers(2), "dask": scale.Workers(cluster=client)}


def same(first: Parts, second: Parts) -> bool:
    """Bit for bit, in order."""
    return len(first) == len(second) and all(
        a.keys() == b.keys() and all(a[k].dtype == b[k].dtype and a[k].tobytes() == b[k].tobytes() for k in a)
        for a, b in zip(first, second, strict=True)
    )


@pytest.mark.parametrize("backend", ["processes", "dask"])
def test_a_map_has_the_same_bits_whoever_works_it_off(backend: str, workers: dict[str, scale.Workers]) -> None:
    job = Dop(times=Times(step_s=7200.0))
    evaluate = Evaluate(job.levels(), ("pdop", "hdop"), (("pdop", 6.0),))
    lat, lon = maps.Grid.degrees(30.0).points()
    tiles = [Tile(lat[s], lon[s]) for s in (slice(0, 20), slice(20, 50), slice(50, len(lat)))]
    alone = scale.map_tiles(evaluate, tiles)
    assert same(scale.map_tiles(evaluate, tiles, backend=backend, workers=workers[backend]), alone)
    # Another cut of the same users: no number depends on who stands in the same tile.
    whole = scale.map_tiles(evaluate, [Tile(lat, lon)])[0]
    assert all(np.concatenate([part[k] for part in alone]).tobytes() == whole[k].tobytes() for k in whole)


@pytest.fixture(scope="module")
def jobs(shared_data: Path) -> list[tuple[Evaluate, Tile]]:
    """Two tiles of every kind of map."""
    options: dict[str, dict[str, Any]] = {kind: {"times": Times(duration_s=21_600.0, step_s=3_600.0)} for kind in maps.KINDS}
    navigation = (shared_data / "sbas" / "gps_2025046_17h_rinex3.nav",)
    options |= {"dme": {}, "sbas": {"messages": shared_data / "sbas" / "msas137_2025046_17h.ems", "navigation": navigation}}
    lat, lon = maps.Grid.degrees(4.0, (28.0, 44.0, 128.0, 144.0)).points()
    tiles = [Tile(lat[s], lon[s]) for s in (slice(0, 7), slice(7, None))]
    listed = []
    for kind in maps.KINDS.values():
        job = kind.options(**options[kind.id])
        causes, columns = tuple(c.name for c in kind.causes), tuple(c.name for c in kind.columns)
        evaluate = Evaluate(job.levels(), columns, tuple((one.column, one.limit) for one in job.limits()), causes)
        listed += [(evaluate, tile) for tile in tiles]
    return listed


@pytest.mark.parametrize("backend", ["processes", "dask"])
def test_every_kind_of_map_has_the_same_bits_whoever_works_it_off(
    backend: str, workers: dict[str, scale.Workers], jobs: list[tuple[Evaluate, Tile]]
) -> None:
    alone = scale.map_tiles(tiles_fixture.evaluated, jobs)
    assert len(alone) == 2 * len(maps.KINDS)
    assert all(part["p_available"].max() > 0 for part in alone), "a kind without one level compares nothing"
    assert same(scale.map_tiles(tiles_fixture.evaluated, jobs, backend=backend, workers=workers[backend]), alone)


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="SKIPPED ALOUD: children are found by Linux's /proc")
@pytest.mark.parametrize("backend", ["serial", "processes"])
def test_a_command_that_was_killed_goes_on_and_leaves_no_worker(backend: str, tmp_path: Path) -> None:
    workers = ["--workers", "1"] if backend == "processes" else []
    options = ["--step-deg", "5", "--every-s", "600", "--backend", backend, *workers, "--checkpoint", str(tmp_path / "kept")]
    command = [sys.executable, "-m", "navbound", "map", "araim", *options, "--out", str(tmp_path / "map"), "--json"]
    run = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + 120.0
    while not list((tmp_path / "kept").glob("*.npz")) and time.monotonic() < deadline:
        assert run.poll() is None, "the command ended by itself"
        time.sleep(0.01)
    children = _children(run.pid)
    run.send_signal(signal.SIGKILL)
    run.wait()
    assert bool(children) == (backend == "processes")
    before = {file.name: file.stat().st_mtime_ns for file in (tmp_path / "kept").glob("*.npz")}
    assert 1 <= len(before) < 3, "the command was not killed in the middle"
    assert list((tmp_path / "map").iterdir()) == []
    while any(map(_lives, children)) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not any(map(_lives, children)), "workers outlive the command"
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, timeout=120.0)
    after = {file.name: file.stat().st_mtime_ns for file in (tmp_path / "kept").glob("*.npz")}
    assert len(after) == 3
    assert after.items() >= before.items(), "finished tiles were done again"
    loaded = maps.load(tmp_path / "map")
    whole = _whole()
    assert loaded.points.equals(whole.points)
    assert loaded.summary == whole.summary


@cache
def _whole() -> maps.Map:
    """What the command makes, at once: whoever works it off."""
    return maps.make("araim", times=Times(step_s=600.0))


def _lives(pid: int) -> bool:
    try:
        # Who has ended and was not yet waited for is a zombie.
        return Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def _children(pid: int) -> list[int]:
    """Processes that a process has started."""
    return [int(one) for task in Path(f"/proc/{pid}/task").glob("*/children") for one in task.read_text(encoding="ascii").split()]


@pytest.mark.parametrize("backend", ["processes", "dask"])
def test_a_worker_lost_in_mid_run_loses_nothing(backend: str, workers: dict[str, scale.Workers], tmp_path: Path) -> None:
    function = tiles_fixture.LosesWorker(str(tmp_path), tile=3)
    results = scale.map_tiles(function, TILES, backend=backend, workers=workers[backend])
    assert (tmp_path / "lost").exists(), "no worker was lost: this test tests nothing"
    assert same(results, [tiles_fixture.numbers(t) for t in TILES])


def test_a_tile_that_loses_every_worker_is_an_error(workers: dict[str, scale.Workers], tmp_path: Path) -> None:
    function = tiles_fixture.LosesWorker(str(tmp_path), tile=0, always=True)
    with pytest.raises(NavboundError, match="3 worker processes in a row"):
        scale.map_tiles(function, [0], backend="processes", workers=scale.Workers(1))
    with pytest.raises(NavboundError, match="worker after worker"):
        scale.map_tiles(function, [0], backend="dask", workers=workers["dask"])


def test_a_cluster_without_workers_is_not_waited_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    distributed = pytest.importorskip("distributed", reason="SKIPPED ALOUD: Dask is not installed")
    monkeypatch.setattr(backends, "LOOK_S", 0.2)
    monkeypatch.setattr(backends, "ALONE_S", 0.6)
    with (
        distributed.LocalCluster(n_workers=0, dashboard_address=":0", silence_logs="CRITICAL") as cluster,
        distributed.Client(cluster) as client,
        pytest.raises(NavboundError, match=r"no worker for 0.6\d* s; 2 tiles are not done"),
    ):
        scale.map_tiles(tiles_fixture.numbers, [0, 1], backend="dask", workers=scale.Workers(cluster=client))


def test_a_full_disk_is_named_and_leaves_no_half_tile(tmp_path: Path) -> None:
    program = (
        "import resource, signal, tiles_fixture; from navbound import scale; signal.signal(signal.SIGXFSZ, signal.SIG_IGN); "
        f"resource.setrlimit(resource.RLIMIT_FSIZE, (300, 300)); scale.map_tiles(tiles_fixture.numbers, [0], checkpoint={str(tmp_path)!r})"
    )
    run = subprocess.run([sys.executable, "-B", "-c", program], cwd=Path(__file__).parent, capture_output=True, text=True, check=False)
    assert "cannot keep tile 0: File too large" in run.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_scheduler_that_does_not_answer_is_named() -> None:
    distributed = pytest.importorskip("distributed", reason="SKIPPED ALOUD: Dask is not installed")
    import dask  # noqa: PLC0415

    assert distributed
    with dask.config.set({"distributed.comm.timeouts.connect": "1s"}), pytest.raises(InputError, match="cluster = tcp://127"):
        scale.map_tiles(tiles_fixture.numbers, [0], backend="dask", workers=scale.Workers(cluster="tcp://127.0.0.1:1"))


def test_a_job_that_was_killed_goes_on(tmp_path: Path) -> None:
    log, kept = tmp_path / "log", tmp_path / "kept"
    log.mkdir()
    program = (
        "import tiles_fixture; from navbound import scale; "
        f"scale.map_tiles(tiles_fixture.Logged({str(log)!r}, 0.05), list(range(60)), checkpoint={str(kept)!r})"
    )
    run = subprocess.Popen([sys.executable, "-c", program], cwd=Path(__file__).parent)
    deadline = time.monotonic() + 60.0
    while len(list(kept.glob("*.npz"))) < 3 and time.monotonic() < deadline:
        time.sleep(0.01)
    run.send_signal(signal.SIGKILL)
    run.wait()
    finished = len(list(kept.glob("*.npz")))
    assert 3 <= finished < 60, "the job was not killed in the middle"
    for call in log.iterdir():
        call.unlink()
    reported: list[tuple[int, int]] = []
    # The pause is part of the function and so of the job.
    results = scale.map_tiles(
        tiles_fixture.Logged(str(log), 0.05), list(range(60)), checkpoint=kept, progress=lambda done, all_: reported.append((done, all_))
    )
    assert len(list(log.iterdir())) == 60 - finished
    assert reported[0] == (finished, 60)
    assert reported[-1] == (60, 60)
    assert same(results, [tiles_fixture.numbers(t) for t in range(60)])


def resaved(file: Path, change: Callable[[dict[str, np.ndarray[Any, Any]]], object]) -> None:
    """Write a tile anew, as a hand that knows the format would, with something changed in it."""
    with np.load(file) as archive:
        columns = dict(archive)
    change(columns)
    with file.open("wb") as content:
        np.savez(content, **columns)


@pytest.mark.parametrize("harm", ["value", "column", "compression", "byte", "short", "empty", "huge"])
def test_a_tile_whose_content_was_changed_is_worked_off_again(tmp_path: Path, harm: str) -> None:
    kept = tmp_path / "kept"
    scale.map_tiles(tiles_fixture.numbers, TILES, checkpoint=kept)
    file = next(kept.glob("tile-000002-*.npz"))
    content = bytearray(file.read_bytes())
    name = next(iter(tiles_fixture.numbers(TILES[2])))
    if harm == "value":
        resaved(file, lambda columns: columns.update({name: columns[name] + 1}))
    elif harm == "column":
        resaved(file, lambda columns: columns.pop(name))
    elif harm == "compression":
        content[8:10] = content[content.index(b"PK\x01\x02") + 10 : content.index(b"PK\x01\x02") + 12] = (99).to_bytes(2, "little")
        file.write_bytes(content)
    elif harm == "huge":
        at = content.index(b"(")
        content[at : at + 4] = b"(9e9"
        file.write_bytes(content)
    else:
        content[len(content) // 2] ^= 1
        file.write_bytes(content[: {"byte": len(content), "short": 30, "empty": 0}[harm]])
    assert same(scale.map_tiles(tiles_fixture.numbers, TILES, checkpoint=kept), [tiles_fixture.numbers(t) for t in TILES])


def test_tiles_of_another_job_and_damaged_ones_are_not_taken(tmp_path: Path) -> None:
    kept, log = tmp_path / "kept", tmp_path / "log"
    log.mkdir()
    first = tiles_fixture.Logged(str(log))
    scale.map_tiles(first, TILES, checkpoint=kept)
    assert len(list(log.iterdir())) == 8
    scale.map_tiles(first, TILES, checkpoint=kept)
    assert len(list(log.iterdir())) == 8, "finished tiles were done again"
    scale.map_tiles(tiles_fixture.Logged(str(log), 0.001), TILES, checkpoint=kept)
    assert len(list(log.iterdir())) == 16, "tiles of another function were taken"
    for file in kept.glob("tile-000002-*.npz"):
        file.write_bytes(file.read_bytes()[:100])
    assert same(scale.map_tiles(first, TILES, checkpoint=kept), [tiles_fixture.numbers(t) for t in TILES])
    assert len(list(log.iterdir())) == 17


def test_a_refusal_crosses_from_a_process_whole() -> None:
    with pytest.raises(InputError) as refused:
        scale.map_tiles(tiles_fixture.refuses, TILES, backend="processes", workers=scale.Workers(1))
    assert (refused.value.argument, refused.value.value, refused.value.index) == ("tile", 2, 7)


def test_a_damaged_file_crosses_from_a_process_whole() -> None:
    refused = pickle.loads(pickle.dumps(FormatError("a.rnx", "no number", 3, "toe")))
    assert (str(refused), refused.path, refused.line, refused.field) == ("a.rnx:3: toe: no number", Path("a.rnx"), 3, "toe")


def test_wrong_calls_are_sentences(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="serial, processes, dask"):
        scale.map_tiles(tiles_fixture.numbers, TILES, backend="threads")
    with pytest.raises(InputError, match="dictionary of arrays"):
        scale.map_tiles(tiles_fixture.wrong, TILES)
    with pytest.raises(InputError, match="count"):
        scale.Workers(0)
    (tmp_path / "file").touch()
    with pytest.raises(NavboundError, match="cannot keep tiles"):
        scale.map_tiles(tiles_fixture.numbers, TILES, checkpoint=tmp_path / "file")
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match="not installed"):
        scale.map_tiles(tiles_fixture.numbers, TILES, backend="dask")


@pytest.mark.parametrize(
    ("n", "each_s", "bytes_each"), [(64_800, 1.7e-4, 0.0), (648, 1e-6, 0.0), (7, 3.0, 0.0), (3, 0.45, 0.0), (1000, 1e-3, 1e7)]
)
def test_a_cut_covers_everything_once(n: int, each_s: float, bytes_each: float) -> None:
    tiles = scale.cut(n, each_s, bytes_each)
    assert [i for t in tiles for i in range(t.start, t.stop)] == list(range(n))
    sizes = [t.stop - t.start for t in tiles]
    if bytes_each == 0.0 and len(tiles) > 1:
        assert min(sizes) * each_s >= 0.2
    # One item more than the share: sizes are whole.
    assert all(size * bytes_each <= 2e8 + bytes_each for size in sizes)


@pytest.mark.parametrize(("n", "each_s"), [(0, 1.0), (5, 0.0), (5, float("nan")), (5, float("inf"))])
def test_nothing_to_cut_is_refused(n: int, each_s: float) -> None:
    with pytest.raises(InputError):
        scale.cut(n, each_s)


def test_arrays_that_start_at_any_byte_are_taken() -> None:
    shifted = np.frombuffer(b"\0" + np.array([0.1, 0.2]).tobytes(), dtype=np.uint8)[1:].view(np.float64)
    assert not shifted.flags.aligned
    levels = maps.KINDS["dop"].options(times=Times(step_s=43_200.0)).levels()(shifted, shifted)
    assert levels["pdop"].shape == (2, 2)
