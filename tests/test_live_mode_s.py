"""Messages of Mode S to positions with the bounds that the aircraft claims. The encoder here is the test's own."""

from __future__ import annotations

import json
import math
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from live_fixture import recorded
from navbound import _core, live
from navbound.live.sinks import tables
from navbound.read import formats

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    import polars as pl

    from conftest import Ended

ROOT = Path(__file__).parents[1]
REFERENCE = ROOT.parent / "shared" / "reference" / "ref-surveillance.json"
NM = 1852.0
T0_NS = 1_450_000_000_000_000_000


def parity(bits: int) -> int:
    """Remainder of 88 bits by the polynomial, bit by bit."""
    rest = bits << 24
    for k in range(111, 23, -1):
        if rest >> k & 1:
            rest ^= 0x1FFF409 << (k - 24)
    return rest


def message(address: int, field: int, *, df: int = 17, ca: int = 5) -> bytes:
    head = ((df << 3 | ca) << 24 | address) << 56 | field
    return (head << 24 | parity(head)).to_bytes(14, "big")


def half(lat_deg: float, lon_deg: float, *, odd: bool) -> tuple[int, int]:
    """Doc 9871, C.2.6, forwards."""
    zone = 360 / (60 - odd)
    yz = math.floor(2**17 * (lat_deg % zone) / zone + 0.5)
    lat = zone * (yz / 2**17 + math.floor(lat_deg / zone))
    n = math.floor(2 * math.pi / math.acos(1 - (1 - math.cos(math.pi / 30)) / math.cos(math.radians(abs(lat))) ** 2))
    width = 360 / max(n - odd, 1)
    return yz % 2**17, math.floor(2**17 * (lon_deg % width) / width + 0.5) % 2**17


def airborne(lat_deg: float, lon_deg: float, *, odd: bool, code: int = 11, b: int = 0, feet: float = 10_000) -> int:
    steps = round((feet + 1000) / 25)
    altitude = (steps >> 4) << 5 | 0x10 | steps & 0xF
    yz, xz = half(lat_deg, lon_deg, odd=odd)
    return code << 51 | b << 48 | altitude << 36 | int(odd) << 34 | yz << 17 | xz


def velocity(east_kt: int, north_kt: int, above_ft: int = 0) -> int:
    east = (int(east_kt < 0) << 10) | (abs(east_kt) + 1)
    north = (int(north_kt < 0) << 10) | (abs(north_kt) + 1)
    difference = int(above_ft < 0) << 7 | (abs(above_ft) // 25 + 1)
    return 19 << 51 | 1 << 48 | east << 31 | north << 20 | difference


def status(version: int = 2, *, a: int = 0, nac_p: int = 9, sil: int = 3) -> int:
    return 31 << 51 | version << 13 | a << 12 | nac_p << 8 | sil << 4


def beast(content: bytes, counter: bytes = b"\x00\x00\x01\x1a\x00\x05") -> bytes:
    kind = {2: b"1", 7: b"2", 14: b"3"}[len(content)]
    return b"\x1a" + kind + (counter + b"\x80" + content).replace(b"\x1a", b"\x1a\x1a")


def avr(content: bytes) -> bytes:
    return b"*" + content.hex().encode() + b";\n"


def flight(address: int, n: int, *, about: int | None = None, code: int = 11, b: int = 0, **how: Any) -> Iterator[tuple[float, bytes]]:
    """Seconds and messages of an aircraft that flies east at 200 kt, two positions a second."""
    for k in range(n):
        t = 0.5 * k
        if k % 4 == 0:
            yield t, message(address, status() if about is None else about, **how)
            yield t, message(address, velocity(200, 0, 150), **how)
        lon = 2.5 + t * 200 * NM / 3600 / (111_195 * math.cos(math.radians(48.9)))
        yield t, message(address, airborne(48.9, lon, odd=k % 2 == 1, code=code, b=b), **how)


def judged(tmp_path: Path, sent: list[tuple[float, bytes]], form: str = "beast", **settings: Any) -> Path:
    """The session of messages that arrived one by one."""
    framed = beast if form == "beast" else avr
    sent = sorted(sent, key=lambda each: each[0])
    # A nanosecond apart: a chunk holds one message.
    inputs = [_core.live_input("chunk", T0_NS + round(t * 1e9) + k, framed(content)) for k, (t, content) in enumerate(sent)]
    how = live.Settings(format=form, rnp_m=0.3 * NM, **settings)
    tmp_path.mkdir(exist_ok=True)
    live.judge(recorded(tmp_path / "in", b"".join(inputs), how), tmp_path / "out")
    return tmp_path / "out"


def epochs_of(tmp_path: Path, sent: list[tuple[float, bytes]], form: str = "beast", **settings: Any) -> pl.DataFrame:
    return tables.epochs(judged(tmp_path, sent, form, **settings))


@pytest.mark.parametrize("form", ["beast", "avr"])
def test_a_heard_aircraft_has_the_bounds_that_it_claims(tmp_path: Path, form: str) -> None:
    epochs = epochs_of(tmp_path, list(flight(0x4CA123, 20)), form)
    # Two pairs of halves that share none: the fourth position is the first that is shown.
    assert epochs.height == 17
    assert set(epochs["track"]) == {"4ca123"}
    assert set(epochs["status"]) == {"ok"}
    # NACp 9 is an EPU of 30 m; type code 11 without supplements a radius of 0.1 NM.
    assert epochs["accuracy_bound_m"].to_list() == pytest.approx([30.0] * 17, rel=1e-9)
    assert epochs["integrity_compared_m"].to_list() == pytest.approx([0.1 * NM] * 17, rel=1e-12)
    assert epochs.select("nic", "nac_p", "sil").unique().rows() == [(8.0, 9.0, 3.0)]
    expected = [math.radians(2.5 + 0.5 * k * 200 * NM / 3600 / (111_195 * math.cos(math.radians(48.9)))) for k in range(3, 20)]
    # A step of the code is 2.1e-6 rad of longitude at most.
    assert epochs["est_lon_rad"].to_list() == pytest.approx(expected, abs=2.1e-6)


def test_radii_are_those_of_the_reference(tmp_path: Path) -> None:
    """Every row of the reference that a position in the air can state, from the message to the compared radius."""
    if not REFERENCE.is_file():
        pytest.skip(f"SKIPPED ALOUD: no reference at {REFERENCE}")
    rows = [row for row in json.loads(REFERENCE.read_text())["nic"] if row["version"] > 0 and 9 <= row["type_code"] <= 22]
    # Supplement B stands in every message of version 2, supplement A in every status.
    rows = [row for row in rows if row["nic_a"] is not None and (row["version"] == 1 or row["nic_b"] is not None or row["type_code"] != 13)]
    assert len(rows) > 30
    sent = list[tuple[float, bytes]]()
    for k, row in enumerate(rows):
        # The smallest of accuracies, so that the radius is the larger bound.
        about = status(row["version"], a=row["nic_a"] or 0, nac_p=11)
        sent += flight(0x100000 + k, 8, about=about, code=row["type_code"], b=row["nic_b"] or 0)
    epochs = epochs_of(tmp_path, sent)
    for k, row in enumerate(rows):
        of = epochs.filter(epochs["track"] == f"{0x100000 + k:06x}")
        assert of.height == 5, row
        if row["rc_m"] is None:
            assert set(of["reason_id"]) == {"no_integrity_claim"}, row
        elif row["nic_b"] is None and row["type_code"] in {11, 13, 16}:
            # The message has a supplement B, and the reference none: at most the reference's radius.
            assert max(of["integrity_compared_m"].to_list()) <= row["rc_m"] * (1 + 1e-12), row
        else:
            assert of["integrity_compared_m"].to_list() == pytest.approx([row["rc_m"]] * 5, rel=1e-12), row
            assert set(of["nic"]) == {row["category"]}, row


def session_of(tmp_path: Path, inputs: list[bytes]) -> live.Session:
    session = live.Session(tmp_path / "out", live.Settings(format="beast", rnp_m=0.3 * NM))
    for frames in inputs:
        session.take(frames)
    return session


def test_what_is_no_claim_of_an_aircraft_is_counted_and_not_shown(tmp_path: Path) -> None:
    sent = [*flight(0xA00001, 8, df=18, ca=2), *flight(0xA00002, 8, about=status(0)), *flight(0xA00003, 8, df=18, ca=1)]
    surface = 6 << 51 | 12345
    damaged = bytearray(message(0xA00004, surface))
    damaged[9] ^= 1
    sent += [(0.1, message(0xA00004, surface)), (0.2, bytes(damaged)), (0.3, b"\x5d\x48\x40\xd6\xf8\xdc\x4e")]
    sent.sort(key=lambda each: each[0])
    session = session_of(tmp_path, [_core.live_input("chunk", T0_NS + round(t * 1e9) + k, beast(m)) for k, (t, m) in enumerate(sent)])
    counters = session.counters()
    session.finish()
    assert counters["n_frames"] == len(sent)
    refused = {name.removeprefix("refused_"): n for name, n in counters.items() if name.startswith("refused_") and n}
    assert refused == {"of_others": 8, "no_position": 1, "damaged_frame": 1, "half_a_position": 6}
    epochs = tables.epochs(tmp_path / "out")
    assert set(epochs["track"]) == {"a00002", "~a00003"}
    assert set(epochs.filter(epochs["track"] == "a00002")["reason_id"]) == {"no_accuracy_category"}
    assert set(epochs.filter(epochs["track"] == "~a00003")["status"]) == {"ok"}


def test_what_multilateration_computed_is_not_the_aircrafts_word(tmp_path: Path) -> None:
    marked = b"".join(beast(content, b"\xff\x00MLAT") for _, content in flight(0x4CA123, 8))
    session = session_of(tmp_path, [_core.live_input("chunk", T0_NS, marked)])
    assert (session.n_epochs, session.counters()["refused_of_others"]) == (0, 12)
    session.close()


def test_a_receiver_that_hears_no_position_is_not_silent(tmp_path: Path) -> None:
    """It was `quiet` until the first aircraft had two pairs of halves; without any message it is."""

    def raised(name: str, until_s: int) -> list[str]:
        short = b"\x5d\x48\x40\xd6\xf8\xdc\x4e"
        inputs = list[bytes]()
        for k in range(20):
            if k < until_s:
                inputs.append(_core.live_input("chunk", T0_NS + k * 1_000_000_000, beast(short)))
            inputs.append(_core.live_input("heartbeat", T0_NS + k * 1_000_000_000 + 1, b""))
        session = session_of(tmp_path / name, inputs)
        session.close()
        events = tmp_path / name / "out" / "events.jsonl"
        return [json.loads(line)["kind"] for line in events.read_text().splitlines()] if events.exists() else []

    assert raised("heard", 20) == []
    assert raised("silent", 10) == ["quiet"]


def test_of_positions_that_arrive_at_once_the_last_counts(tmp_path: Path) -> None:
    sent = list(flight(0x4CA123, 12))
    alone = [(t, content) for t, content in sent if t < 4.0]
    together = b"".join(beast(content) for t, content in sent if t >= 4.0)
    inputs = [_core.live_input("chunk", T0_NS + round(t * 1e9) + k, beast(content)) for k, (t, content) in enumerate(alone)]
    session = session_of(tmp_path, [*inputs, _core.live_input("chunk", T0_NS + 6_000_000_000, together)])
    session.finish()
    assert session.counters()["refused_superseded"] == 3
    assert tables.epochs(tmp_path / "out").height == 6


def test_an_aircraft_that_is_moved_between_two_messages_is_not_shown_hundreds_of_kilometres_away(tmp_path: Path) -> None:
    """Section 2.3 of the specification: 6.5 km north between two halves decode 679 km away."""
    sent = list(flight(0x4CA123, 12))
    sent += [(6.0 + t, content) for t, content in moved(0x4CA123, 12, north_deg=6.5 / 111.195)]
    epochs = epochs_of(tmp_path, sent)
    lat_deg = [math.degrees(lat) for lat in epochs["est_lat_rad"]]
    assert max(abs(lat - 48.9) for lat in lat_deg) < 0.1
    # The place of before, then two pairs of the new one, which the motion of the aircraft does not explain.
    usable = epochs.filter(epochs["status"] == "ok")
    assert max(abs(math.degrees(lat) - 48.9) for lat in usable["est_lat_rad"]) < 1e-3
    assert epochs.height > usable.height


def moved(address: int, n: int, *, north_deg: float) -> Iterator[tuple[float, bytes]]:
    for k in range(n):
        yield 0.5 * k, message(address, airborne(48.9 + north_deg, 2.5 + 0.008, odd=k % 2 == 1))


def test_lanes_part_messages_by_aircraft_and_judge_them_as_one(tmp_path: Path) -> None:
    addresses = (0x4CA123, 0x4CA124, 0xABCDEF)
    sent = sorted((t, content) for address in addresses for t, content in flight(address, 10))
    splitter, how = _core.LiveSplitter("beast", 3), live.Settings(format="beast", rnp_m=0.3 * NM)
    lanes = [list[bytes]() for _ in range(3)]
    for k, (t, content) in enumerate(sent):
        framed = beast(content)
        # In two pieces, as a connection may have them.
        for at, (begin, rest) in enumerate(zip(splitter.push(framed[:5]), splitter.push(framed[5:]), strict=True)):
            if begin + rest:
                lanes[at].append(_core.live_input("chunk", T0_NS + round(t * 1e9) + k, begin + rest))
    assert sum(map(len, lanes)) == len(sent)
    assert sum(1 for lane in lanes if lane) > 1
    of_tracks = dict[str, list[tuple[object, ...]]]()
    for k, lane in enumerate(lane for lane in lanes if lane):
        (tmp_path / f"{k}").mkdir()
        live.judge(recorded(tmp_path / f"{k}" / "in", b"".join(lane), how), tmp_path / f"{k}" / "out")
        judged_alone = tables.epochs(tmp_path / f"{k}" / "out")
        for (track,), alone in judged_alone.group_by("track"):
            assert str(track) not in of_tracks, "an aircraft has one lane"
            of_tracks[str(track)] = alone.sort("time_ns").select("time_ns", "est_lat_rad", "est_lon_rad", "accuracy_bound_m").rows()
    together = epochs_of(tmp_path / "all", sent)
    assert of_tracks.keys() == {f"{address:06x}" for address in addresses}
    for track, rows in of_tracks.items():
        of = together.filter(together["track"] == track).sort("time_ns")
        assert of.select("time_ns", "est_lat_rad", "est_lon_rad", "accuracy_bound_m").rows() == rows


def test_a_file_of_messages_is_refused_with_what_to_do(tmp_path: Path, navbound: Callable[..., Ended]) -> None:
    log = tmp_path / "log.bin"
    log.write_bytes(b"".join(beast(content) for _, content in flight(0x4CA123, 40)))
    assert formats.of(log.read_bytes()).id == "beast"
    assert formats.of(log.read_bytes()[5:]).id == "beast"
    assert formats.of(b"".join(avr(content) for _, content in flight(0x4CA123, 40))).id == "avr"
    ended = navbound("live", log, "--format", "beast", "--out", tmp_path / "out")
    assert ended.status == 2
    assert "no time but that of their arrival" in " ".join(ended.stderr.split())
    assert not (tmp_path / "out").exists()
    ended = navbound("analyze", log)
    assert ended.status == 3
    assert "messages of Mode S in frames of Beast" in " ".join(ended.stderr.split())


def test_a_receiver_on_a_line_is_judged_from_the_command_line(tmp_path: Path) -> None:
    """Two aircraft for four seconds, each at its time; the receiver then goes away, and the command is stopped."""
    server = socket.create_server(("127.0.0.1", 0))
    sent = sorted((t, content) for address in (0x4CA123, 0x4CA124) for t, content in flight(address, 9))

    def send() -> None:
        line, _ = server.accept()
        begun = time.monotonic()
        for t, content in sent:
            time.sleep(max(0.0, begun + t - time.monotonic()))
            line.sendall(beast(content))
        time.sleep(0.5)
        line.close()
        server.close()

    thread = threading.Thread(target=send, daemon=True)
    thread.start()
    out = tmp_path / "out"
    command = [
        sys.executable,
        "-m",
        "navbound",
        "live",
        f"tcp://127.0.0.1:{server.getsockname()[1]}",
        "--format",
        "beast",
        "--out",
        str(out),
    ]
    running = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, cwd=tmp_path)
    thread.join(60)
    running.terminate()
    _, words = running.communicate(timeout=60)
    epochs = tables.epochs(out)
    assert set(epochs["track"]) == {"4ca123", "4ca124"}, words
    usable = epochs.filter(epochs["status"] == "ok")
    # A busy machine may take two positions of an aircraft at once, of which the last is shown.
    assert usable.height >= 6, words
    assert usable["accuracy_bound_m"].to_list() == pytest.approx([30.0] * usable.height, rel=1e-9)
