"""What a session counted, as Prometheus reads it: equal at the display, from the folder, and after another judgement of the journal."""

from __future__ import annotations

import re
import subprocess
import sys
from collections import Counter
from contextlib import closing
from typing import TYPE_CHECKING

import polars as pl
import pytest

from display_fixture import Browser, Fed, served
from live_fixture import FLEET, fleet, transitions
from navbound import live
from navbound.errors import FormatError
from navbound.live.display import Watch
from navbound.live.sinks import metrics
from navbound.live.source import File

if TYPE_CHECKING:
    from pathlib import Path

LINE = re.compile(r'([a-z_]+)(?:\{((?:[a-z_]+="[^"\\\n]*",?)+)\})? (\S+)')


def parsed(text: str) -> dict[tuple[str, str], float]:
    """Every sample by name and labels; every line is a sample of a family that was announced, or its announcement."""
    samples: dict[tuple[str, str], float] = {}
    announced: set[str] = set()
    for line in text.splitlines():
        if line.startswith("# "):
            kind, name = line.split(" ")[1:3]
            assert kind in {"HELP", "TYPE"}
            announced.add(name)
            continue
        match = LINE.fullmatch(line)
        assert match is not None, line
        name, labels, value = match.groups()
        assert re.sub(r"_(bucket|sum|count)$", "", name) in announced or name in announced, line
        assert (name, labels or "") not in samples, line
        samples[name, labels or ""] = float(value)
    assert text.endswith("\n")
    return samples


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A fleet that misbehaves, with lines that are refused."""
    base = tmp_path_factory.mktemp("metrics")
    lines = [line for _, line in fleet(60, 120)]
    lines[100:100] = ["nonsense\n", '{"v": 9}\n', '{"v": 1, "track": "a b", "time_ns": 5}\n']
    (base / "fleet.jsonl").write_text("".join(lines))
    with closing(File(base / "fleet.jsonl", 2500)) as source:
        live.Session(base / "out", FLEET).run(source)
    return base / "out"


def test_counts_are_those_of_the_tables_and_lists_of_the_session(folder: Path) -> None:
    samples = parsed(metrics.of(folder))
    from navbound.live.sinks import tables  # noqa: PLC0415 - writes beside the journals, after they were read

    tables.write(folder)
    statuses = Counter(pl.read_parquet(folder / "epochs.parquet")["status"].to_list())
    assert {labels: n for (name, labels), n in samples.items() if name == "navbound_epochs_total"} == {
        f'status="{status}"': n for status, n in statuses.items()
    }
    turns = Counter((each["kind"], each["transition"]) for each in transitions(folder))
    assert sum(turns.values()) > 10
    assert {labels: n for (name, labels), n in samples.items() if name == "navbound_alerts_total"} == {
        f'kind="{kind}",transition="{turn}"': n for (kind, turn), n in turns.items()
    }
    for kind in {kind for kind, _ in turns}:
        assert samples["navbound_open_alerts", f'kind="{kind}"'] == turns[kind, "raised"] - turns[kind, "cleared"]
    # The three lines that were written between the others.
    refused = {labels: n for (name, labels), n in samples.items() if "refused_" in labels}
    assert sum(refused.values()) == 3
    # A recording claims no latency.
    assert samples["navbound_alert_latency_seconds_count", ""] == 0


def test_another_judgement_of_the_journal_counts_the_same(folder: Path, tmp_path: Path) -> None:
    live.judge(folder, tmp_path / "again")
    assert parsed(metrics.of(tmp_path / "again")) == parsed(metrics.of(folder))


def test_the_display_says_what_the_folder_says(folder: Path) -> None:
    watch = Watch(folder)
    while True:
        watch.poll()
        if not watch.behind:
            break
    of_folder, of_display = parsed(metrics.of(folder)), parsed(watch.metrics(3))
    assert {name: of_display[name] for name in of_folder} == of_folder
    assert of_display["navbound_display_clients", ""] == 3
    # The source has ended.
    assert of_display["navbound_feed_up", ""] == 0


def test_prometheus_asks_the_display_without_a_token_and_learns_no_aircraft(tmp_path: Path) -> None:
    fed = Fed(tmp_path / "session")
    for _ in range(5):
        fed.position(track="SECRET1")
    fed.session.snapshot()
    with served(fed.folder) as display:
        answer = Browser(display).ask("GET", "/metrics")
    assert answer.status == 200
    assert answer.headers["content-type"] == metrics.KIND
    samples = parsed(answer.body)
    assert samples["navbound_epochs_total", 'status="ok"'] >= 1
    assert samples["navbound_tracks", ""] == 1
    assert samples["navbound_feed_up", ""] == 1
    assert 0 <= samples["navbound_event_age_seconds", 'what="newest"'] < 60
    assert "SECRET1" not in answer.body
    fed.session.close()


def test_alerts_are_classed_by_their_latency(tmp_path: Path) -> None:
    """Positions that arrive at once and are outside: what the list says of each latency is in its class."""
    fed = Fed(tmp_path / "session")
    for k in range(40):
        fed.position(fte_m=5.0 if k < 10 else 2000.0)
    latencies = [each["latency_s"] for each in fed.reported if each["latency_s"] is not None]
    assert len(latencies) > 0
    samples = parsed(metrics.of(fed.folder))
    fed.session.close()
    for upper in metrics.LATENCIES_S:
        bucket = samples["navbound_alert_latency_seconds_bucket", f'le="{upper}"']
        assert bucket == sum(latency <= upper for latency in latencies)
    assert samples["navbound_alert_latency_seconds_bucket", 'le="+Inf"'] == len(latencies)
    assert samples["navbound_alert_latency_seconds_sum", ""] == pytest.approx(sum(latencies), rel=1e-12)
    assert samples["navbound_alerts_late_total", ""] == sum(latency > fed.settings.time_to_alert_s for latency in latencies)


def test_the_command_prints_the_same(folder: Path, tmp_path: Path) -> None:
    ended = subprocess.run([sys.executable, "-m", "navbound", "live", "counts", str(folder)], capture_output=True, text=True, check=True)
    assert parsed(ended.stdout) == parsed(metrics.of(folder))
    with pytest.raises(FormatError):
        metrics.of(tmp_path)
