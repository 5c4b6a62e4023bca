"""Live data: what comes out is the same however the journal is read, and the same as the batch monitor says."""

from __future__ import annotations

import gzip
import json
import os
import socket
import subprocess
import sys
import threading
import time
from contextlib import closing
from pathlib import Path

import pytest
from typer.testing import CliRunner

from live_fixture import FLEET, Sent, fleet, frames, generator, recorded, transitions, truth
from navbound import _core, live
from navbound.cli.main import app
from navbound.errors import FormatError, InputError
from navbound.live import journal
from navbound.live.settings import Settings
from navbound.live.sinks import tables, transition
from navbound.live.source import File


def reported_keys(folder: Path) -> tuple[list[str], list[str]]:
    """Raised and cleared alerts of tracks in the form of the reference."""
    reported = [t for t in transitions(folder) if t["track"]]
    raised = [f"{t['track']}/{t['kind']}/{t['annunciation_ns']}/raise" for t in reported if t["transition"] == "raised"]
    cleared = [f"{t['track']}/{t['kind']}/{t['onset_ns']}/clear/{t['clear_ns']}" for t in reported if t["transition"] == "cleared"]
    return raised, cleared


@pytest.mark.parametrize("seed", [1, 2, 7])
def test_a_fleet_gives_the_alerts_of_the_batch_monitor_each_once(tmp_path: Path, seed: int) -> None:
    n, seconds = 200, 60
    source = recorded(tmp_path / "in", frames(fleet(n, seconds, seed), heartbeats=True))
    live.judge(source, tmp_path / "out")
    for reported, expected in zip(reported_keys(tmp_path / "out"), truth(n, seconds, seed), strict=True):
        assert len(expected) > 10
        assert len(reported) == len(set(reported)), "an alert is reported twice"
        assert set(reported) == expected


def test_every_speed_and_every_grouping_give_the_same_bits(tmp_path: Path) -> None:
    source = recorded(tmp_path / "in", frames(fleet(60, 40), 7, heartbeats=True))
    live.judge(source, tmp_path / "batch")
    runs = {f"group-{group}": {"group": group} for group in (1, 7, 1000)} | {"speed-8": {"speed": 8.0}}
    for name, how in runs.items():
        live.replay(source, tmp_path / name, **how)
        result = live.compare(tmp_path / "batch", tmp_path / name)
        assert (result.n_epochs > 700, result.n_transitions > 4, result.n_differing) == (True, True, 0), name


def test_a_comparison_sees_one_bit(tmp_path: Path) -> None:
    sent = fleet(20, 40)
    other = [(t, line.replace('"sigma_m":', '"sigma_m":1') if k == 300 else line) for k, (t, line) in enumerate(sent)]
    for name, records in (("a", sent), ("b", other)):
        live.judge(recorded(tmp_path / f"{name}-in", frames(records)), tmp_path / name)
    assert live.compare(tmp_path / "a", tmp_path / "b").n_differing > 0


def judged(tmp_path: Path, name: str, sent: list[Sent] | tuple[Sent, ...]) -> tuple[Path, dict[str, float]]:
    session = live.judge(recorded(tmp_path / f"{name}-in", frames(sent, 1)), tmp_path / name)
    return tmp_path / name, session.counters()


def clean(n: int, seconds: int) -> list[Sent]:
    """The fleet without its own repeats and late records."""
    seen, kept = set[str](), list[Sent]()
    for _, line in fleet(n, seconds):
        time_ns = json.loads(line)["time_ns"]
        if line not in seen:
            kept.append((time_ns, line))
        seen.add(line)
    return sorted(kept)


def test_faults_within_the_lateness_change_nothing_and_later_ones_are_counted(tmp_path: Path) -> None:
    sent, g = clean(50, 60), generator(3)
    expected, counters = judged(tmp_path, "clean", sent)
    delayed = g.random(len(sent)) < 0.05
    repeated = g.random(len(sent)) < 0.05
    mixed = [(t + (800_000_000 if late else 0), line) for (t, line), late in zip(sent, delayed, strict=True)]
    mixed += [(t + 100_000_000, line) for (t, line), again in zip(sent, repeated, strict=True) if again]
    got, faulty = judged(tmp_path, "mixed", sorted(mixed))
    assert delayed.sum() > 50
    assert repeated.sum() > 50
    assert sorted(reported_keys(got)[0]) == sorted(reported_keys(expected)[0])
    assert sorted(reported_keys(got)[1]) == sorted(reported_keys(expected)[1])
    assert faulty["n_duplicate"] + faulty["n_waiting_duplicate"] == repeated.sum()
    assert faulty["n_late"] == counters["n_late"] == 0
    # Beyond the lateness: the second after it was judged long ago.
    selected = set(range(500, len(sent), 211))
    beyond = sorted((t + (5_000_000_000 if k in selected else 0), line) for k, (t, line) in enumerate(sent))
    late = judged(tmp_path, "late", beyond)[1]
    assert late["n_late"] == len(selected) > 5


def test_what_is_dropped_for_longer_than_the_stale_time_is_raised_once_at_its_time(tmp_path: Path) -> None:
    sent = clean(50, 60)
    frozen = {f"{0x400000 + a:06x}": (20 + a % 5, 23 + a % 5) for a in range(0, 50, 7)}

    def kept(line: str) -> bool:
        record = json.loads(line)
        begin, end = frozen.get(record["track"], (0, 0))
        second = (record["time_ns"] - 1_447_500_000_000_000_000) // 1_000_000_000
        return not begin <= second < end

    expected, _ = judged(tmp_path, "clean", sent)
    left = [each for each in sent if kept(each[1])]
    assert len(sent) - len(left) == 3 * len(frozen)
    got, _ = judged(tmp_path, "dropped", left)
    added = set(reported_keys(got)[0]) - set(reported_keys(expected)[0])
    silences = {key for key in added if "/unavailable/" in key}
    assert len(silences) >= len(frozen) - 1, "a track that was lost already is not lost again"
    for t in transitions(got):
        if f"{t['track']}/{t['kind']}/{t['annunciation_ns']}/raise" in silences and t["transition"] == "raised":
            assert t["annunciation_ns"] == t["onset_ns"] + 2_000_000_000
            assert t["event_ns"] <= t["annunciation_ns"] + 300_000_000, "reported when the watermark passes"
            assert t["arrival_ns"] - t["annunciation_ns"] <= 1_300_000_000


def test_each_transition_has_the_fields_of_the_schema(tmp_path: Path) -> None:
    schema = json.loads((Path(live.__file__).parent / "schemas" / "transition.json").read_text())
    assert tuple(schema["required"]) == transition.FIELDS == tuple(schema["properties"])
    live.judge(recorded(tmp_path / "in", frames(fleet(50, 60))), tmp_path / "out")
    types = {"string": str, "integer": int, "number": float, "null": type(None), "boolean": bool}
    reported = transitions(tmp_path / "out")
    assert reported
    for each in reported:
        assert tuple(each) == transition.FIELDS
        for name, value in each.items():
            rule = schema["properties"][name]
            if "type" in rule:
                allowed = [rule["type"]] if isinstance(rule["type"], str) else rule["type"]
                assert any(isinstance(value, types[t]) for t in allowed), name
            else:
                assert value in rule.get("enum", [rule.get("const")]), name
        key = f"{each['track'] or 'feed:source'}/{each['incarnation']}/{each['kind']}/{each['annunciation_ns']}/{each['transition']}"
        assert each["key"] == key


def test_a_source_that_cannot_be_opened_says_what_to_do(tmp_path: Path) -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    for name, words in ((str(tmp_path / "none.ubx"), "cannot be opened"), (f"tcp://127.0.0.1:{port}", "start what sends there")):
        with pytest.raises(FormatError, match=words):
            live.open_source(name)
    for name in ("ftp://a:1", "tcp://host", "tcp://host:x"):
        with pytest.raises(InputError, match="tcp://host:port"):
            live.open_source(name)
    command = [sys.executable, "-m", "navbound", "live", f"tcp://127.0.0.1:{port}", "--format", "json", "--out", str(tmp_path / "o")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert (done.returncode, "start what sends there" in done.stderr.replace("\n", " ")) == (3, True), done.stderr


def test_a_chain_longer_than_the_time_to_alert_is_refused() -> None:
    with pytest.raises(InputError, match="time_to_alert_s"):
        Settings(format="json", rnp_m=100.0, lateness_s=1.0, time_to_alert_s=5.0).core()
    Settings(format="json", rnp_m=100.0, lateness_s=1.0, time_to_alert_s=6.0).core()


def test_a_connection_that_is_lost_is_an_event_and_is_opened_again(tmp_path: Path) -> None:
    server = socket.create_server(("127.0.0.1", 0))
    lines = [json.dumps({"v": 1, "track": "a", "time_ns": 0, "fte_m": 1.0, "sigma_m": 5.0})] * 2

    def serve() -> None:
        for line in lines:
            peer, _ = server.accept()
            stamped = json.loads(line) | {"time_ns": live.session.now_ns()}
            peer.sendall(json.dumps(stamped).encode() + b"\n")
            time.sleep(0.3)
            peer.close()

    threading.Thread(target=serve, daemon=True).start()
    source = live.open_source(f"tcp://127.0.0.1:{server.getsockname()[1]}")
    session = live.Session(tmp_path / "out", FLEET.changed(lateness_s=0.0))
    end = time.monotonic() + 6
    session.run(source, stop=lambda: time.monotonic() > end or session.counters()["n_records"] >= 2)
    source.close()
    server.close()
    kinds = [(t["kind"], t["transition"]) for t in transitions(tmp_path / "out")]
    assert session.counters()["n_records"] == 2
    assert ("source_lost", "raised") in kinds
    assert ("source_lost", "cleared") in kinds


def test_datagrams_are_lines(tmp_path: Path) -> None:
    source = live.open_source("udp://127.0.0.1:0", lines=True)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for k in range(3):
            record = {"v": 1, "track": "a", "time_ns": live.session.now_ns() + k, "fte_m": 1.0, "sigma_m": 5.0}
            sender.sendto(json.dumps(record).encode(), ("127.0.0.1", source.port))  # type: ignore[attr-defined]
    session = live.Session(tmp_path / "out", FLEET.changed(lateness_s=0.0))
    end = time.monotonic() + 5
    session.run(source, stop=lambda: time.monotonic() > end or session.counters()["n_records"] >= 3)
    source.close()
    assert session.counters()["n_records"] == 3


def test_a_folder_has_one_writer_and_belongs_to_its_settings(tmp_path: Path) -> None:
    session = live.Session(tmp_path / "out", FLEET)
    with pytest.raises(FormatError, match="another session writes here"):
        live.Session(tmp_path / "out", FLEET, resume=True)
    session.close()
    with pytest.raises(FormatError, match="--resume"):
        live.Session(tmp_path / "out", FLEET)
    with pytest.raises(InputError, match="rnp_m"):
        live.Session(tmp_path / "out", FLEET.changed(rnp_m=100.0), resume=True)
    (tmp_path / "foreign").mkdir()
    (tmp_path / "foreign" / "thesis.tex").write_text("x")
    with pytest.raises(FormatError, match="not a live session's"):
        live.Session(tmp_path / "foreign", FLEET)


def test_a_journal_that_is_damaged_inside_is_refused(tmp_path: Path) -> None:
    content = bytearray(frames(fleet(20, 40)))
    content[len(content) // 2] ^= 1
    with pytest.raises(FormatError, match="damaged"):
        live.judge(recorded(tmp_path / "in", bytes(content)), tmp_path / "out")


def test_memory_is_bounded_by_the_most_tracks(tmp_path: Path) -> None:
    """What a track costs in a snapshot, and that tracks beyond the cap cost nothing."""
    few = FLEET.changed(max_tracks=100)
    lines = [
        (1_447_500_000_000_000_000, f'{{"v":1,"track":"t{k}","time_ns":1447500000000000000,"fte_m":1,"sigma_m":5}}\n') for k in range(5000)
    ]
    lane = _core.LiveLane(few.core())
    lane.push(frames(lines), 0, 0)
    assert lane.n_tracks == 100
    assert lane.counters()["refused_fleet_full"] == 4900
    assert len(lane.snapshot(0, 0)) < 100 * 1024
    assert (tmp_path / journal.IN).exists() is False


def test_a_command_that_is_ended_judges_what_it_has_and_can_be_resumed(tmp_path: Path) -> None:
    out = tmp_path / "out"
    command = [sys.executable, "-m", "navbound", "live", "-", "--format", "json", "--method", "tse-exact", "--json", "--out", str(out)]
    reported = list[str]()
    for resume in ([], ["--resume"]):
        with subprocess.Popen([*command, *resume], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
            assert process.stdin is not None
            # The record is of now when it is written: the command listens, as its heartbeats in the journal show.
            before = (out / journal.IN).stat().st_size if resume else 0
            end = time.monotonic() + 60
            while time.monotonic() < end and (not (out / journal.IN).exists() or (out / journal.IN).stat().st_size <= before):
                time.sleep(0.05)
            before = (out / journal.IN).stat().st_size
            record = {"v": 1, "track": "a", "time_ns": live.session.now_ns(), "fte_m": 5.0, "sigma_m": 2000.0}
            line = json.dumps(record).encode() + b"\n"
            process.stdin.write(line)
            process.stdin.flush()
            while time.monotonic() < end and (out / journal.IN).stat().st_size < before + len(line):
                time.sleep(0.05)
            begin = time.monotonic()
            process.terminate()
            output, error = process.communicate(timeout=60)
            assert process.returncode == 0, error
            # Five seconds on an idle machine; this one may be shared by ten others.
            assert time.monotonic() - begin < 5 * 10
        reported += output.decode().splitlines()
    transitions_reported = [json.loads(line) for line in reported]
    assert transitions_reported[0]["kind"] == "warning"
    assert transitions_reported[0]["transition"] == "raised"
    assert [t["key"] for t in transitions_reported if not t["replayed"]] == [t["key"] for t in transitions(out) if not t["replayed"]]
    assert len(_core.live_inputs(journal.read(out / journal.IN))) >= 4


def lived_lines(tmp_path: Path, **more: object) -> tuple[set[str], set[str]]:
    """Statuses and alerts of a minute of records with a good covariance, some keys changed or taken away (`...`)."""
    record = {"v": 1, "track": "A", "est_lat_rad": 0.85, "est_lon_rad": 0.03, "ground_speed_mps": 0.0}
    record |= {"cov_ee_m2": 64.0, "cov_en_m2": 0.0, "cov_nn_m2": 64.0}
    record = {name: value for name, value in (record | more).items() if value is not ...}
    tmp_path.mkdir(exist_ok=True)
    log = tmp_path / "log.jsonl"
    log.write_text("".join(json.dumps(record | {"time_ns": 1_317_644_000_000_000_000 + k * 1_000_000_000}) + "\n" for k in range(60)))
    session = live.Session(tmp_path / "out", Settings(format="json", rnp_m=555.6))
    with closing(File(log)) as source:
        session.run(source)
    epochs = tables.epochs(tmp_path / "out")
    return set(epochs["status"]), set(epochs["alert"][10:])


def test_a_record_without_position_and_without_deviation_is_no_input(tmp_path: Path) -> None:
    assert lived_lines(tmp_path, est_lat_rad=..., est_lon_rad=...) == ({"invalid_input"}, {"unavailable"})


def test_a_record_without_position_is_judged_by_its_deviation(tmp_path: Path) -> None:
    assert lived_lines(tmp_path, est_lat_rad=..., est_lon_rad=..., fte_m=5.0, course_rad=0.5) == ({"ok"}, {"normal"})


def test_of_a_covariance_and_a_deviation_the_larger_counts(tmp_path: Path) -> None:
    assert lived_lines(tmp_path / "a", sigma_m=3000.0)[1] == {"warning"}
    assert lived_lines(tmp_path / "b", sigma_m=1.0)[1] == {"normal"}
    assert lived_lines(tmp_path / "c", sigma_m=None)[1] == {"warning"}


def test_a_variance_below_zero_is_none_whatever_deviation_stands_beside_it(tmp_path: Path) -> None:
    assert lived_lines(tmp_path / "alone", cov_ee_m2=-64.0) == ({"invalid_input"}, {"unavailable"})
    assert lived_lines(tmp_path / "beside", cov_ee_m2=-64.0, sigma_m=5.0) == ({"invalid_input"}, {"unavailable"})


@pytest.mark.parametrize("variance_m2", [0.0, 1e-320, -1e-320, 0.99e-8])
def test_a_variance_below_a_tenth_of_a_millimetre_squared_is_zero(variance_m2: float, tmp_path: Path) -> None:
    """In the plane it bounds nothing."""
    assert lived_lines(tmp_path, cov_ee_m2=variance_m2) == ({"not_available"}, {"unavailable"})
    assert lived_lines(tmp_path / "above", cov_ee_m2=1.01e-8)[0] == {"ok"}


def test_a_journal_that_was_cut_says_how_much_is_not_judged(tmp_path: Path) -> None:
    content = frames(fleet(20, 30), heartbeats=True)
    source = recorded(tmp_path / "in", content[:-7])
    messages = list[str]()
    live.judge(source, tmp_path / "out", say=messages.append)
    assert len(messages) == 1
    assert "bytes at its end are no whole frame and are not judged" in messages[0]
    messages.clear()
    live.judge(recorded(tmp_path / "whole", content), tmp_path / "other", say=messages.append)
    assert messages == []


def test_a_position_that_stands_without_a_word_is_old_unless_the_receiver_is_known_to_stand(tmp_path: Path) -> None:
    sentences = json.dumps({"v": 1, "track": "A", "est_lat_rad": 0.85, "est_lon_rad": 0.03, "sigma_m": 5.0})
    log = tmp_path / "log.jsonl"
    times = (1_317_644_000_000_000_000 + k * 1_000_000_000 for k in range(60))
    log.write_text("".join(f'{sentences[:-1]}, "time_ns": {time_ns}}}\n' for time_ns in times))
    for words, alerts in ([], {"unavailable"}), (["--standing"], {"normal"}):
        done = CliRunner().invoke(app, ["live", str(log), "--out", str(tmp_path / "out" / str(len(words))), *words])
        assert done.exit_code == 0, done.output
        assert set(tables.epochs(tmp_path / "out" / str(len(words)))["alert"][10:]) == alerts


def test_a_source_of_which_nothing_is_read_is_no_success(tmp_path: Path) -> None:
    (tmp_path / "track.csv").write_text("time,lat,lon\n1600000000,47,8\n" * 20, encoding="utf-8")
    command = [
        sys.executable,
        "-m",
        "navbound",
        "live",
        "watch",
        str(tmp_path / "track.csv"),
        "--format",
        "json",
        "--out",
        str(tmp_path / "out"),
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 4, done.stderr
    assert "nothing of the source is read as json" in " ".join((done.stdout + done.stderr).split())


def half_read(tmp_path: Path) -> tuple[Path, Path, int]:
    """A log of 300 records, a session of it that was stopped on the way, and how many bytes it has read."""
    record = {"v": 1, "track": "A", "fte_m": 5.0, "course_rad": 0.0, "sigma_m": 3.0}
    log = tmp_path / "log.jsonl"
    log.write_text("".join(json.dumps(record | {"time_ns": 1_317_644_000_000_000_000 + k * 1_000_000_000}) + "\n" for k in range(300)))
    session = live.Session(tmp_path / "out", Settings(format="json", rnp_m=555.6))
    with closing(File(log, chunk=1000)) as source:
        rounds = iter([False] * 7)
        session.run(source, stop=lambda: next(rounds, True))
    return log, tmp_path / "out", session.n_bytes


def test_a_file_that_was_left_in_the_middle_of_a_record_is_read_on_from_there(tmp_path: Path) -> None:
    log, out, n_bytes = half_read(tmp_path)
    assert n_bytes == 7000
    assert log.read_bytes()[:n_bytes][-1:] != b"\n", "the record goes on behind the cut"
    session = live.Session(out, Settings(format="json", rnp_m=555.6), resume=True)
    with closing(File(log)) as source:
        session.run(source)
    assert tables.epochs(out).height == 300
    assert session.counters()["refused_not_a_position"] == 0


def test_another_file_is_not_read_on(tmp_path: Path) -> None:
    log, out, _ = half_read(tmp_path)
    other = tmp_path / "other.jsonl"
    other.write_text(log.read_text(encoding="utf-8").replace('"fte_m": 5.0', '"fte_m": 6.0'), encoding="utf-8")
    session = live.Session(out, Settings(format="json", rnp_m=555.6), resume=True)
    with closing(File(other)) as source, pytest.raises(InputError, match="first 7000 bytes"):
        session.run(source)
    session.close()


def good_lines(path: Path, n: int, **more: object) -> Path:
    """Records of a minute north, some keys added; each line about 200 bytes."""
    record = {"v": 1, "track": "A", "est_lon_rad": 0.03, "ground_speed_mps": 70.0, "sigma_m": 5.0} | more
    first_ns = 1_317_644_000_000_000_000
    moving = [record | {"time_ns": first_ns + k * 1_000_000_000, "est_lat_rad": 0.85 + k * 70 / 6_371_000} for k in range(n)]
    path.write_text("".join(json.dumps(each) + "\n" for each in moving), encoding="utf-8")
    return path


def test_a_recording_that_was_stopped_says_so_wherever_its_journal_is_judged(tmp_path: Path) -> None:
    log, out = good_lines(tmp_path / "log.jsonl", 200), tmp_path / "out"
    session = live.Session(out, Settings(format="json", rnp_m=555.6), origin=live.Origin("recording", str(log)))
    turns = iter([False] * 20)
    with closing(File(log, 512)) as source:
        session.run(source, stop=lambda: next(turns, True))
    expected = f"stopped at byte {20 * 512} of {log.stat().st_size} of the source; the rest was not judged"
    assert session.unfinished == expected
    for command in (["live", "judge", str(out), "--out"], ["live", "replay", str(out), "--speed", "0", "--out"]):
        done = CliRunner().invoke(app, [*command, str(tmp_path / command[1])])
        assert (done.exit_code, expected in " ".join(done.output.split())) == (4, True), done.output
    again = CliRunner().invoke(app, ["live", "judge", str(tmp_path / "judge"), "--out", str(tmp_path / "again")])
    assert again.exit_code == 4, again.output
    whole = CliRunner().invoke(app, ["live", str(log), "--out", str(tmp_path / "whole")])
    assert (whole.exit_code, "stopped" in whole.output) == (0, False), whole.output
    assert CliRunner().invoke(app, ["live", "judge", str(tmp_path / "whole"), "--out", str(tmp_path / "b")]).exit_code == 0


@pytest.mark.parametrize(
    "more",
    [
        {"epu_m": 5000.0}, {"rc_m": 5000.0}, {"nic": 0}, {"nac_p": 0}, {"nucp": 2}, {"hpl": 5000.0}, {"HPL_M": 5000.0}, {"hpl_nm": 3.0},
        {"valid": False}, {"alert": "RAIM FAIL"}, {"alarms": "fail"}, {"integrity": "LOST"}, {"fix": "NO FIX"},
        {"Status": "not_available"}, {"nav_mode": "stopped"}, {"nav_mode": "stale"}, {"hdop": 99.99},
    ],
)  # fmt: skip
def test_what_a_line_says_against_itself_under_another_key_is_heard(tmp_path: Path, more: dict[str, object]) -> None:
    statuses, alerts = lived_lines(tmp_path, **more)
    assert statuses <= {"invalid_input", "not_available"}
    assert alerts == {"unavailable"}


def test_other_keys_are_passed_over_and_counted_by_name(tmp_path: Path) -> None:
    log = good_lines(tmp_path / "log.jsonl", 30, comment="x", squawk=7000, valid=True, fix="3D", alert="none", hdop=0.9)
    done = CliRunner().invoke(app, ["live", str(log), "--out", str(tmp_path / "out")])
    assert done.exit_code == 0, done.output
    assert "keys that nothing reads: 30 comment, 30 squawk" in " ".join(done.output.split())
    assert set(tables.epochs(tmp_path / "out")["status"]) == {"ok"}


def test_a_key_that_may_speak_of_accuracy_is_named_however_many_others_there_are(tmp_path: Path) -> None:
    """Twenty harmless keys hid it."""
    log = good_lines(tmp_path / "log.jsonl", 30, **{f"k{k:02d}": 1 for k in range(30)}, z_error_m=9000.0)
    words = " ".join(CliRunner().invoke(app, ["live", str(log), "--out", str(tmp_path / "out")]).output.split())
    assert "30 k19 and 11 more; by their names these may speak of accuracy or integrity, and nothing is judged by them: z_error_m" in words


def test_another_place_of_the_vehicle_is_not_believed(tmp_path: Path) -> None:
    log = good_lines(tmp_path / "log.jsonl", 30, gps_lat_deg=10.0, gps_lon_deg=10.0)
    done = CliRunner().invoke(app, ["live", str(log), "--out", str(tmp_path / "out")])
    assert done.exit_code == 4
    assert set(tables.epochs(tmp_path / "out")["status"]) == {"invalid_input"}


def test_a_file_that_is_packed_is_refused_by_name(tmp_path: Path) -> None:
    packed = tmp_path / "log.jsonl.gz"
    packed.write_bytes(gzip.compress(good_lines(tmp_path / "log.jsonl", 5).read_bytes()))
    with pytest.raises(FormatError, match="packed"):
        File(packed)


def test_a_pipe_with_a_name_is_a_source(tmp_path: Path) -> None:
    """It could not be sought in, and the session ended as a bug of navbound."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)

    def send() -> None:
        # It opens once somebody reads it: the times are of then.
        with pipe.open("w") as out:
            now_ns = live.session.now_ns()
            for k in range(3):
                out.write(json.dumps({"v": 1, "track": "a", "time_ns": now_ns + k, "fte_m": 1.0, "sigma_m": 5.0}) + "\n")

    threading.Thread(target=send, daemon=True).start()
    command = [sys.executable, "-m", "navbound", "live", str(pipe), "--format", "json", "--out", str(tmp_path / "o")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert "3 epochs of 1 track," in done.stdout
    assert subprocess.run([*command[:4], str(pipe)], capture_output=True, text=True, timeout=120, check=False).returncode == 2


def test_degraded_epochs_and_positions_that_nobody_used_are_in_the_last_line(tmp_path: Path) -> None:
    def ended(name: str, **more: object) -> subprocess.CompletedProcess[str]:
        log = tmp_path / f"{name}.jsonl"
        log.write_text("".join(json.dumps({"v": 1, "track": "a", "time_ns": k * 10**9, "fte_m": 1.0} | more) + "\n" for k in range(5)))
        command = [sys.executable, "-m", "navbound", "live", str(log), "--out", str(tmp_path / name)]
        return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)

    degraded = ended("degraded", sigma_m=5.0, n_sv=0)
    assert (degraded.returncode, "; 5 epochs are degraded" in degraded.stdout) == (0, True)
    unused = ended("unused")
    assert (unused.returncode, "; no position was used" in unused.stdout) == (4, True)


def test_a_file_that_analyze_reads_is_no_stream(tmp_path: Path) -> None:
    pos = tmp_path / "a.pos"
    pos.write_text("%  GPST  latitude(deg) longitude(deg)  height(m)   Q  ns\n2023/07/11 06:05:03.000 35.1 136.8 39.1 5 20\n")
    done = CliRunner().invoke(app, ["live", str(pos), "--out", str(tmp_path / "out")])
    assert isinstance(done.exception, InputError)
    assert "this is RTKLIB solutions, which navbound analyze reads" in str(done.exception)
    flight = tmp_path / "a.igc"
    flight.write_text("AXXX001\r\nHFDTE010526\r\n" + "B1000004854000N00217500EA0030000350\r\n" * 9)
    done = CliRunner().invoke(app, ["live", str(flight), "--out", str(tmp_path / "out")])
    assert isinstance(done.exception, InputError)
    assert "this is flight log of a glider (IGC), which is not read: make a table of it" in str(done.exception)


def test_a_session_that_was_killed_while_its_tables_were_written_goes_on(tmp_path: Path) -> None:
    log, record, out = tmp_path / "log.jsonl", {"v": 1, "track": "A", "fte_m": 5.0, "course_rad": 0.0, "sigma_m": 3.0}, tmp_path / "out"
    log.write_text("".join(json.dumps(record | {"time_ns": 1_317_644_000_000_000_000 + k * 1_000_000_000}) + "\n" for k in range(20)))
    assert CliRunner().invoke(app, ["live", str(log), "--out", str(out)]).exit_code == 0
    (out / "epochs.parquet").rename(out / "epochs.parquet.partial")
    again = CliRunner().invoke(app, ["live", str(log), "--resume", "--out", str(out)])
    assert (again.exit_code, "nothing new came since the session was left" in again.output) == (0, True), again.output
    assert tables.epochs(out).height == 20


@pytest.mark.parametrize(("step_s", "says"), [(1, False), (12, True)])
def test_positions_further_apart_than_monitoring_waits_say_what_to_state(tmp_path: Path, step_s: int, says: bool) -> None:
    log, record = tmp_path / "log.jsonl", {"v": 1, "track": "A", "fte_m": 5.0, "course_rad": 0.0, "sigma_m": 3.0}
    times = (1_317_644_000_000_000_000 + k * step_s * 1_000_000_000 for k in range(20))
    log.write_text("".join(json.dumps(record | {"time_ns": time_ns}) + "\n" for time_ns in times))
    done = CliRunner().invoke(app, ["live", str(log), "--out", str(tmp_path / "out")])
    words = "positions come every 12 s, and monitoring is lost after 2 s without one: --period-s 12 states their period"
    assert (done.exit_code, words in done.output) == (0, says), done.output
    more = ["--period-s", str(step_s), "--time-to-alert-s", "40", "--out", str(tmp_path / "stated")]
    stated = CliRunner().invoke(app, ["live", str(log), *more])
    assert ("0 transitions" in stated.output, "--period-s" in stated.output) == (True, False), stated.output
