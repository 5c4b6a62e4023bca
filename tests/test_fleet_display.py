"""The page of a fleet is made of what the workers wrote and showed; it says when nobody works, and names no aircraft in its counts."""

from __future__ import annotations

from pathlib import Path

from fleet_fixture import RECORD, fed, made, reported, worked
from live_fixture import fleet
from navbound import _core
from navbound.live import session
from navbound.live.display import fleet as shown
from navbound.live.fleet import Worker, connect, create
from navbound.serve.hub import Hub


def column(name: str) -> int:
    return shown.FIELDS.index(name)


def test_rows_are_the_newest_states_and_alerts_in_force_those_of_the_workers(tmp_path: Path) -> None:
    name = str(tmp_path / "fleet")
    with made(name) as transport:
        fed(transport, fleet(60, 40, 2))
        worked(transport)
    with connect(name) as transport:
        watch = shown.FleetWatch(transport)
        news = watch.poll()
        while watch.poll():
            pass
        assert len(watch.rows) == len(news.states) == 60
        raised = {t["key"].rpartition("/")[0] for t in reported(name) if t["transition"] == "raised"}
        cleared = {t["key"].rpartition("/")[0] for t in reported(name) if t["transition"] != "raised"}
        assert set(watch.open) == raised - cleared
        for track, row in watch.rows.items():
            kinds = {alert.split("/")[2] for alert in watch.open if alert.startswith(f"{track}/")}
            assert set(row[column("alerts")]) == {shown.LETTERS[kind] for kind in kinds}
            assert row[column("rnp_m")] == 555.6
        counted = watch.status()
        assert sum(counted["counts"].values()) == counted["n_tracks"] == 60
        assert counted["feed"] == "ended"
        text = watch.metrics(3)
        assert "navbound_tracks 60" in text
        assert 'kind="caution",transition="raised"' in text
        assert not any(track in text for track in watch.rows), "a label names an aircraft"


def test_a_fleet_without_workers_or_without_a_feeder_is_lost(tmp_path: Path) -> None:
    record = RECORD | {"origin": {"kind": "live", "source": "a test", "speed": None}}
    now, clock = session.now_ns(), [100.0]
    line = f'{{"v":1,"track":"a","time_ns":{now},"fte_m":0,"sigma_m":5}}\n'
    with create(str(tmp_path / "fleet"), record, 1) as transport:
        transport.came_in(0).append(_core.live_input("chunk", now, line.encode()), 0)
        watch = shown.FleetWatch(transport, clock=lambda: clock[0])
        assert (watch.feed(), watch.health()[0]) == ("lost", True)
        rounds = [3]

        def stop() -> bool:
            rounds[0] -= 1
            return rounds[0] < 0

        Worker(transport).run(stop=stop)
        watch.poll()
        assert watch.feed() == "live"
        assert watch.status()["lanes"][0]["worked"]
        clock[0] += 2.6
        assert watch.feed() == "lost", "the worker speaks, and nothing comes from the feeder"
        clock[0] += 1.0
        assert not watch.status()["lanes"][0]["worked"]
        lost, report = watch.health()
        assert (lost, report["status"], report["lanes_without_worker"]) == (True, "lost", [0])


def test_a_slow_page_gets_the_newest_state_of_each_track_once() -> None:
    client = Hub().enter(None, 0.0)
    assert client is not None
    for k in range(500):
        client.merge({"a": ["a", k], "b": ["b", k]}, {"feed": "live"})
    assert list(client._states.values()) == [["a", 499], ["b", 499]]
