"""The last line of a session: what was judged, what was not, and what to do."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

from navbound.cli.live.parts import say
from navbound.cli.parts import out_console
from navbound.exit_status import NO_VERDICT
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from navbound.live import Session
    from navbound.live.settings import Settings


def _unread(format_id: str) -> str:
    """What a source has to send that is read as this format; a source in which nothing was read may be of another one."""
    from navbound.read.formats import MESSAGES  # noqa: PLC0415

    needs = f"; positions are read of {MESSAGES[format_id]}" if format_id in MESSAGES else ""
    if format_id == "nmea":
        needs += ", dated by RMC or ZDA"
    elif format_id == "json":
        needs = "; a line is an object with at least v (1), track, time_ns, est_lat_rad, est_lon_rad; tables are read by navbound analyze"
    return f"nothing of the source is read as {format_id}{needs}; if it sends something else, --format states what"


def ended(session: Session, settings: Settings, *, json: bool) -> None:
    """Say what a session did and did not, and end with a status that is no success where nothing was judged.

    Raises
    ------
    Exit
        Nothing was judged, no position was used, or the session was left in the middle.
    """
    from navbound.live.sinks import tables  # noqa: PLC0415
    from navbound.live.statements import against, unread  # noqa: PLC0415

    counters = session.counters()
    step_s = tables.usual_step_s(tables.write(session.folder)) if session.n_epochs else None
    refused, unusable = (
        ", ".join(f"{n:g} {name.removeprefix(of)}" for name, n in counters.items() if name.startswith(of) and n)
        for of in ("refused_", "unusable_")
    )
    repeated = sum(counters.get(name, 0) for name in ("n_waiting_duplicate", "n_duplicate"))
    sentence = (
        f"{counted(session.n_epochs, 'epoch')} of {counted(session.n_tracks, 'track')}, {counted(session.n_transitions, 'transition')}; "
        f"refused: {refused or 'nothing'}; positions not used: {unusable or 'none'}; repeated times: {repeated:g}; "
        f"session in {session.folder}"
    )
    # A session that is gone on with and had read its source to the end has nothing new to judge.
    again = not session.n_epochs and counters["n_records"] > 0
    if again:
        sentence += "; nothing new came since the session was left"
    elif not session.n_epochs:
        unreadable = not counters["n_records"] and not counters["refused_too_old"]
        why = f": {_unread(settings.format)}" if unreadable else ""
        sentence += f"; no epoch was judged{why}"
    if settings.assumed:
        sentence += f"; {settings.assumed}"
    if degraded := counters["n_degraded"]:
        sentence += f"; {counted(degraded, 'epoch is', 'epochs are')} degraded"
    if keys := session.against():
        sentence += f"; {against(keys)}"
    if keys := session.passed_over():
        sentence += f"; {unread(keys)}"
    if step_s is not None and step_s > settings.stale_s:
        sentence += (
            f"; positions come every {step_s:g} s, and monitoring is lost after {settings.stale_s:g} s without one: "
            f"--period-s {step_s:g} states their period, and --time-to-alert-s must leave room for it"
        )
    if session.unfinished:
        sentence += f"; {session.unfinished}"
    # A session that was resumed counts the epochs of before among those that are not used.
    unused = session.n_epochs == sum(n for name, n in counters.items() if name.startswith("unusable_"))
    unused = unused and session.n_epochs > 0
    if unused:
        sentence += "; no position was used"
    if json:
        say(sentence)
    else:
        out_console.print(sentence, markup=False, highlight=False, soft_wrap=True)
    if session.unfinished or not (session.n_epochs or again) or unused:
        raise typer.Exit(NO_VERDICT)
