"""`navbound live feed`, `work`, `fleet`, `alerts`: many aircraft between a feeder, workers and what carries both."""

from __future__ import annotations

import sys
import time
from collections import Counter
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from navbound.cli.live.parts import (
    DisplayPort,
    JsonLines,
    OpenPage,
    ShowDisplay,
    Spec,
    address,
    report_to,
    say,
)
from navbound.cli.parts import out_console, stop_requested
from navbound.errors import InputError
from navbound.exit_status import NO_VERDICT, UNREADABLE
from navbound.words.plurals import agreeing, counted

if TYPE_CHECKING:
    from collections.abc import Callable

    from navbound.live import Settings
    from navbound.live.fleet.transport import Transport
    from navbound.live.source import Source

FleetSource = Annotated[
    str, typer.Argument(help="What many aircraft send: a file, - (standard input), tcp://host:port, udp://host:port, or simulated:N.")
]
To = Annotated[str, typer.Option("--to", help="What carries the fleet: a folder, nats://host:port/NAME or kafka://host:port/NAME.")]
Fleet = Annotated[str, typer.Argument(help="What carries the fleet: a folder, nats://host:port/NAME or kafka://host:port/NAME.")]
Lanes = Annotated[int, typer.Option(help="Lanes that the aircraft are shared out to; fixed for the life of a fleet.")]
LineForm = Annotated[
    str | None,
    typer.Option("--format", help="json, readsb (ADS-B states), beast or avr (Mode S). [default: readsb for simulated:N, else json]"),
]
RnpTable = Annotated[Path | None, typer.Option(help="File with RNP values by area and by track.")]
Spool = Annotated[Path | None, typer.Option(help="Folder in which what was read waits for a broker. [default: out/spool/NAME]")]
Speed = Annotated[float, typer.Option(help="Of a file: times its own pace, 0 or more; 0 is as fast as it goes.")]
Lateness = Annotated[float, typer.Option(help="How long the order of a track is waited for.")]
Expiry = Annotated[float, typer.Option(help="Silence after which a track is forgotten.")]


def register(app: typer.Typer) -> None:
    """Add the commands."""
    for command in (feed, work, fleet, alerts):
        app.command()(command)


@dataclass(frozen=True)
class _Fed:
    """Where a source goes."""

    to: str
    lanes: int
    spool: Path | None
    speed: float


def feed(
    source: FleetSource,
    to: To = "out/fleet",
    lanes: Lanes = 4,
    form: LineForm = None,
    spec: Spec = "RNP 0.3",
    rnp_table: RnpTable = None,
    lateness_s: Lateness = 1.0,
    expiry_s: Expiry = 600.0,
    spool: Spool = None,
    speed: Speed = 0.0,
) -> None:
    """Write the lines of a source down by lane, for workers to judge; before a broker they wait on the disk as long as it is away."""
    settings = _settings(source, form, spec=spec, rnp_table=rnp_table, lateness_s=lateness_s, expiry_s=expiry_s)
    _feed(source, settings, _Fed(to, lanes, spool, speed), stop=stop_requested(), look=lambda: None)


def work(fleet: Fleet, json: JsonLines = False) -> None:
    """Judge lanes of a fleet until the command is stopped; several workers share them, and take over those of one that is gone."""
    from navbound.live.fleet import FencedError, Worker, connect  # noqa: PLC0415

    stop = stop_requested()
    with connect(fleet, patience_s=10.0) as transport:
        worker = Worker(transport, report=report_to(json=json), say=say)
        try:
            worker.run(stop=stop)
        except FencedError as e:
            say(f"{e}; this worker ends, and nothing of it is lost")
            raise typer.Exit(UNREADABLE) from e
        _sum(worker.n_epochs, worker.n_transitions, transport.name, json=json)


def fleet(
    source: FleetSource = "simulated:5000",
    to: To = "out/fleet",
    lanes: Lanes = 4,
    workers: Annotated[int, typer.Option(help="Processes that judge.")] = 2,
    form: LineForm = None,
    spec: Spec = "RNP 0.3",
    rnp_table: RnpTable = None,
    lateness_s: Lateness = 1.0,
    expiry_s: Expiry = 600.0,
    spool: Spool = None,
    speed: Speed = 0.0,
    display: ShowDisplay = False,
    port: DisplayPort = 0,
    open_page: OpenPage = False,
    json: JsonLines = False,
) -> None:
    """Feed and judge a fleet with one command: a feeder, workers that are started again when they end, and a page with table and map."""
    from navbound.live.fleet.crew import Crew  # noqa: PLC0415

    if not 1 <= workers <= 64:
        raise InputError("workers", workers, "1", "[1, 64]")
    settings = _settings(source, form, spec=spec, rnp_table=rnp_table, lateness_s=lateness_s, expiry_s=expiry_s)
    stop, counted, report = stop_requested(), [0], report_to(json=json)

    def took(record: dict[str, Any]) -> None:
        counted[0] += 1
        report(record)

    with _Begun(source, settings, to, lanes) as transport, Crew(to, workers, report=took, say=say) as crew:
        name = transport.name
        # From here on the lanes of a broker are heard.
        for lane in range(lanes):
            transport.shown(lane)
        with _Screen(to, port if display or open_page else None, json=json, opened=open_page) as screen:
            _feed(source, settings, _Fed(to, lanes, spool, speed), stop=stop, look=crew.look)
            crew.finish(stop)
            _say_refused(transport)
            screen.hold(stop)
    _sum(None, counted[0], name, json=json)


def alerts(fleet: Fleet, follow: Annotated[bool, typer.Option("--follow", help="Wait for more.")] = False) -> None:
    """Print every transition of a fleet, one JSON object each, from what its workers wrote; each once, in the order of its lane."""
    from navbound.live.fleet import connect  # noqa: PLC0415
    from navbound.live.fleet.reading import records  # noqa: PLC0415
    from navbound.live.sinks import transition  # noqa: PLC0415

    stop = stop_requested()
    with connect(fleet) as transport:
        for record in records(transport, stop=stop, follow=follow):
            sys.stdout.write(transition.line(record) + "\n")
            sys.stdout.flush()
        if not follow and (behind := [str(lane) for lane in range(transport.n_lanes) if _is_behind(transport, lane)]):
            say(f"not all is judged: lanes {', '.join(behind)} hold more; navbound live work {fleet} goes on")


def _settings(source: str, form: str | None, *, spec: str, rnp_table: Path | None, **others: Any) -> Settings:
    from navbound import live  # noqa: PLC0415
    from navbound.live.fleet import pretend  # noqa: PLC0415
    from navbound.live.settings import FLEET  # noqa: PLC0415
    from navbound.rnp.requirement import requirement  # noqa: PLC0415

    known = form or ("readsb" if pretend.is_name(source) else "json")
    if known not in FLEET:
        raise InputError("format", known, domain=f"one of {', '.join(FLEET)}: what names its aircraft")
    table = None if rnp_table is None else str(rnp_table)
    settings = live.Settings(format=known, rnp_m=requirement(spec).rnp_m, rnp_table=table, **others)
    settings.core()
    return settings


def _record(source: str, settings: Settings, *, live_source: bool, speed: float | None) -> dict[str, Any]:
    from navbound import __version__  # noqa: PLC0415
    from navbound.live import Origin  # noqa: PLC0415

    origin = Origin("live" if live_source else "recording", source, speed)
    return {"navbound_version": __version__, "settings": asdict(settings), "origin": asdict(origin)}


def _opened(source: str, form: str) -> Source:
    from navbound import live  # noqa: PLC0415
    from navbound.live.fleet import pretend  # noqa: PLC0415
    from navbound.live.settings import LINES, UNDATED  # noqa: PLC0415

    if pretend.is_name(source):
        return pretend.Pretend(source)
    return live.open_source(source, lines=form in LINES, undated=form in UNDATED)


def _is_live(source: str) -> bool:
    from navbound.live.source import is_stream  # noqa: PLC0415

    return is_stream(source) or source.startswith("simulated:")


class _Begun:
    """The fleet of a source, begun or gone on with; a context."""

    def __init__(self, source: str, settings: Settings, to: str, lanes: int) -> None:
        from navbound.live.fleet import create  # noqa: PLC0415

        live_source = _is_live(source)
        record = _record(source, settings, live_source=live_source, speed=None if live_source else 0.0)
        self._opened = create(to, record, lanes)

    def __enter__(self) -> Transport:
        return self._opened.__enter__()

    def __exit__(self, *_: object) -> None:
        self._opened.__exit__(None, None, None)


def _feed(source: str, settings: Settings, fed: _Fed, *, stop: Callable[[], bool], look: Callable[[], None]) -> None:
    """Feed a source into its fleet until it ends or the command is stopped."""
    from contextlib import ExitStack, closing  # noqa: PLC0415

    from navbound.live import journal  # noqa: PLC0415
    from navbound.live.fleet import Feeder  # noqa: PLC0415
    from navbound.live.fleet.feeder import paced, time_of  # noqa: PLC0415

    if not 0 <= fed.speed < float("inf"):
        raise InputError("speed", fed.speed, "1", "[0, inf)")
    with ExitStack() as all_opened:
        opened = all_opened.enter_context(closing(_opened(source, settings.format)))
        target = all_opened.enter_context(_Begun(source, settings, fed.to, fed.lanes))
        place = Path(fed.to) if "://" not in fed.to else fed.spool or Path("out/spool") / fed.to.rpartition("/")[2]
        spool = target if "://" not in fed.to else all_opened.enter_context(_Begun(source, settings, str(place), fed.lanes))
        all_opened.enter_context(journal.alone(place))

        def looking() -> bool:
            look()
            return stop()

        feeder = Feeder(spool, settings, target=None if spool is target else target, say=say)
        pace = paced(fed.speed, time_of(settings.format), looking) if fed.speed else lambda _: None
        feeder.run(opened, stop=looking, pace=pace)
        say(f"{counted(feeder.n_bytes, 'byte')} of {source} {agreeing(feeder.n_bytes, 'is', 'are')} in {target.name}")


class _Screen:
    """The page of a fleet in a process beside it, or none."""

    def __init__(self, to: str, port: int | None, *, json: bool, opened: bool) -> None:
        self._to, self._port, self._json, self._opened = to, port, json, opened
        self._child: Any = None

    def __enter__(self) -> _Screen:
        import webbrowser  # noqa: PLC0415

        from navbound.live.child import Child  # noqa: PLC0415
        from navbound.live.display import Options, beside_fleet  # noqa: PLC0415

        if self._port is not None:
            self._child = Child(beside_fleet, Path(), (self._to, Options(self._port)), "the page of the fleet cannot be shown")
            address(self._child.text, json=self._json)
            if self._opened and not webbrowser.open(self._child.text):
                say("no browser was found on this machine: open the address in one")
        return self

    def __exit__(self, *_: object) -> None:
        if self._child is not None:
            self._child.end()

    def hold(self, stop: Callable[[], bool]) -> None:
        """Leave it open behind the end of the data, until the command is stopped."""
        if self._child is not None and not stop():
            say("the data have ended; the page stays open until Ctrl-C")
            while not stop():
                time.sleep(0.1)


def _is_behind(transport: Transport, lane: int) -> bool:
    """Whether a lane holds more than what its worker has shown as judged; where nobody has shown anything that is not known."""
    from navbound.live.fleet.reading import newest_status  # noqa: PLC0415

    shown = newest_status(transport, lane)
    return bool(shown) and shown["position"] < transport.came_in(lane).end()


def _say_refused(transport: Transport) -> None:
    """What was refused of the lines, by reason; what the lanes showed last counts."""
    from navbound.live.fleet.reading import newest_status  # noqa: PLC0415

    n: Counter[str] = Counter()
    for lane in range(transport.n_lanes):
        counters = newest_status(transport, lane).get("counters", {})
        n.update({name.removeprefix("refused_"): int(each) for name, each in counters.items() if name.startswith("refused_") and each})
    if n:
        say(f"refused of what was fed: {', '.join(f'{count} {reason}' for reason, count in sorted(n.items()))}")


def _sum(n_epochs: int | None, n_transitions: int, name: str, *, json: bool) -> None:
    epochs = "" if n_epochs is None else f"{counted(n_epochs, 'epoch')}, "
    sentence = f"{epochs}{counted(n_transitions, 'transition')}; fleet in {name}"
    if json:
        say(sentence)
    else:
        out_console.print(sentence, markup=False, highlight=False, soft_wrap=True)
    if n_epochs == 0:
        raise typer.Exit(NO_VERDICT)
