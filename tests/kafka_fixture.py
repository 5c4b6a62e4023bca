"""A broker of Kafka on this host, for tests: Java and the jars that `./dev test kafka` brings; and the one that its client pretends."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from fleet_fixture import Server

JARS = Path(__file__).parents[1] / ".dev" / "kafka" / "jars"
START_S = 120.0
JAVA = ["-Xms128m", "-Xmx384m", "-XX:+UseSerialGC", "-Dorg.slf4j.simpleLogger.defaultLogLevel=warn"]


def need(what: str) -> None:
    """Skip aloud, or fail where the tests are required."""
    text = f"{what}; ./dev test kafka brings a broker (Java 17 and mvn are needed)"
    if os.environ.get("NAVBOUND_NEED_KAFKA") == "1":
        pytest.fail(text)
    pytest.skip(f"SKIPPED ALOUD: {text}")


def _free() -> int:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return int(free.getsockname()[1])


class KafkaServer(Server):
    """One broker that is its own controller, with a private folder, on this host alone."""

    def __init__(self, folder: Path) -> None:
        pytest.importorskip("confluent_kafka", reason="SKIPPED ALOUD: no client of Kafka; pip install 'navbound[kafka]'")
        if shutil.which("java") is None or not JARS.is_dir():
            need("no Java" if shutil.which("java") is None else f"{JARS} is not there")
        self._folder, self.port = folder, _free()
        controller = _free()
        self._settings = folder / "server.properties"
        self._settings.write_text(
            "\n".join(
                [
                    "process.roles=broker,controller",
                    "node.id=1",
                    f"controller.quorum.voters=1@127.0.0.1:{controller}",
                    f"listeners=PLAINTEXT://127.0.0.1:{self.port},CONTROLLER://127.0.0.1:{controller}",
                    f"advertised.listeners=PLAINTEXT://127.0.0.1:{self.port}",
                    "controller.listener.names=CONTROLLER",
                    f"log.dirs={folder / 'logs'}",
                    "offsets.topic.replication.factor=1",
                    "transaction.state.log.replication.factor=1",
                    "transaction.state.log.min.isr=1",
                    "auto.create.topics.enable=false",
                    # One that was killed is let in again once its controller has missed it for so long.
                    "broker.session.timeout.ms=2000",
                    "broker.heartbeat.interval.ms=500",
                    "num.network.threads=2",
                    "num.io.threads=2",
                ]
            )
        )
        # A cluster has an id of 16 bytes; this one is nobody else's.
        self._java("kafka.tools.StorageTool", "format", "-t", "bmF2Ym91bmQtdGVzdHMtMA", "-c", str(self._settings)).wait()
        self.begin()

    def _java(self, *arguments: str) -> subprocess.Popen[bytes]:
        with (self._folder / "kafka.log").open("ab") as log:
            return subprocess.Popen(["java", *JAVA, "-cp", f"{JARS}/*", *arguments], stdout=log, stderr=log, cwd=self._folder)

    def begin(self) -> None:
        """Start it, and wait until it answers."""
        from confluent_kafka import KafkaException, Producer  # noqa: PLC0415

        self.process = self._java("kafka.Kafka", str(self._settings))
        # The client would wait ten seconds between its tries.
        tries = {"reconnect.backoff.ms": 50, "reconnect.backoff.max.ms": 200}
        asks = Producer({"bootstrap.servers": f"127.0.0.1:{self.port}", "log_level": 0, **tries})
        until = time.monotonic() + START_S
        while time.monotonic() < until and self.process.poll() is None:
            try:
                if asks.list_topics(timeout=1.0).brokers:
                    return
            except KafkaException:
                time.sleep(0.05)
        pytest.fail(f"the broker does not answer: {(self._folder / 'kafka.log').read_text()[-3000:]}")

    def name(self, fleet: str) -> str:
        """Of a fleet on it."""
        return f"kafka://127.0.0.1:{self.port}/{fleet}"


@contextmanager
def kafka_serving(folder: Path) -> Iterator[KafkaServer]:
    """A broker for a while."""
    folder.mkdir(parents=True, exist_ok=True)
    server = KafkaServer(folder)
    try:
        yield server
    finally:
        server.process.kill()
        server.process.wait()


class PretendedKafka:
    """The broker that is part of the client's library: no Java, no disk, and topics that are there once somebody asks for them."""

    def __init__(self) -> None:
        client = pytest.importorskip("confluent_kafka", reason="SKIPPED ALOUD: no client of Kafka; pip install 'navbound[kafka]'")
        self._client: Any = client.Producer({"bootstrap.servers": "pretended", "test.mock.num.brokers": 1, "log_level": 0})
        broker = next(iter(self._client.list_topics(timeout=5.0).brokers.values()))
        self._address = f"{broker.host}:{broker.port}"

    def name(self, fleet: str) -> str:
        """Of a fleet on it, whose topics are there."""
        for kind in ("in", "out", "snapshots", "shown", "kept"):
            self._client.list_topics(f"{fleet}-{kind}", timeout=5.0)
        return f"kafka://{self._address}/{fleet}"
