"""Data that are still arriving: sources, journal, loop. The judgement is the lane of `crates/live`; nothing here computes.

`settings` says how; `source` reads bytes; `journal` keeps what came in and what came out; `session` joins them and survives being killed;
`replay` reads a journal again and compares two runs; `sinks` are where transitions go; `display` shows a session in a browser; `child` runs
either beside a session.
"""

from navbound.live.replay import compare, judge, replay
from navbound.live.session import Origin, Session
from navbound.live.settings import Settings
from navbound.live.source import open_source

__all__ = ["Origin", "Session", "Settings", "compare", "judge", "open_source", "replay"]
