"""How a live session judges: everything that its results depend on, in one record that is kept beside the journal."""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

from navbound import _core, delays
from navbound.errors import ConflictError, FormatError, InputError
from navbound.live import statements, zones
from navbound.live.zones import path_of
from navbound.read.categories import NIC_RC_M, SIL_RISK, nacp_sigma_m
from navbound.read.checks.limits import Limits
from navbound.read.formats import MESSAGES

if TYPE_CHECKING:
    from pathlib import Path as FilePath

LINES = ("json", "readsb", "avr")
"""Lines of text: ours, ADS-B states as readsb writes them, and messages of Mode S in hexadecimal digits."""
UNDATED = ("beast", "avr")
"""Messages of Mode S: their time is that of their arrival."""
FLEET = ("json", "readsb", *UNDATED)
"""What names its aircraft, many of them."""
CLAIMED = ("readsb", *UNDATED)
"""What states the accuracy of every aircraft in categories."""
FORMATS = (*FLEET, *MESSAGES)
"""What a source may send: of many aircraft, or the messages of a receiver."""
METHODS = ("tse-exact", "anp-circle")
COMPUTING_S = 0.2
"""Share of the way to the crew: from the arrival of bytes to the alert. Provenance: inferred. [s]"""


@dataclass(frozen=True)
class Settings:
    """What a lane is set to.

    Attributes
    ----------
    format : {"json", "readsb", "beast", "avr", "ubx", "sbf", "novatel", "nmea"}
        What the source sends.
    rnp_m : float
        RNP value in force where a record states none. [m]
    path : str, optional
        Runway (``LFPG/08R``) or route file. Without one the flight technical error is the record's own.
    method : {"tse-exact", "anp-circle"}, optional
        Whose bound is compared with RNP. Default: the first with a path and for every track from its first record on that states a flight
        technical error, the second otherwise.
    track : str
        Name of a receiver's track.
    sigma_m : float, optional
        Standard deviation of each horizontal axis, the caller's claim, where the source states no accuracy; where it states one, or stated
        one last, the larger counts. Not for ADS-B, whose aircraft claim their own. [m]
    risk_accuracy, risk_integrity : float
        Risks of the bounds that are compared with RNP and with twice RNP. [1]
    sample_period_s, time_to_alert_s, raise_delay_s, clear_delay_s, clear_ratio, stale_after_s : float
        Of the monitor: docs/methods/rnp-monitor.md. [s; 1]
    transport_s, display_s : float
        Shares of the way from the error to the crew. The allowed lateness counts as well. [s]
    lateness_s : float
        How long the order of a track is waited for. [s]
    ahead_s, retention_s : float
        How much later or earlier than its arrival the time of a record may be. [s]
    expiry_s : float, optional
        Silence after which a track is forgotten; None: never. [s]
    max_tracks : int
        Most tracks that are watched.
    standing : bool
        The receivers are known to stand: a position that repeats is no old one.
    rnp_table : str, optional
        File with RNP values by area and by track (:mod:`navbound.live.zones`).
    rnp_table_digest : str
        Of that file, since its content decides; filled in where it is not stated.
    """

    format: str
    rnp_m: float
    path: str | None = None
    method: str = ""
    track: str = "receiver"
    sigma_m: float | None = None
    risk_accuracy: float = 0.05
    risk_integrity: float = 1e-5
    sample_period_s: float = 1.0
    time_to_alert_s: float = delays.TIME_TO_ALERT_S
    raise_delay_s: float = delays.RAISE_DELAY_S
    clear_delay_s: float = delays.CLEAR_DELAY_S
    clear_ratio: float = delays.CLEAR_RATIO
    stale_after_s: float | None = None
    transport_s: float = 0.5
    display_s: float = 0.3
    lateness_s: float = 0.0
    ahead_s: float = 2.0
    retention_s: float = 3600.0
    expiry_s: float | None = None
    max_tracks: int = 50_000
    standing: bool = False
    rnp_table: str | None = None
    rnp_table_digest: str = ""

    def __post_init__(self) -> None:
        if self.format not in FORMATS:
            raise InputError("format", self.format, domain=f"one of {', '.join(FORMATS)}")
        if self.method and self.method not in METHODS:
            raise InputError("method", self.method, domain=f"one of {', '.join(METHODS)}")
        if self.sigma_m is not None:
            self._check_assumed(self.sigma_m)
        if not 0 < self.rnp_m < float("inf"):
            raise InputError("rnp_m", self.rnp_m, "m", "(0, inf)")
        for name in ("lateness_s", "ahead_s", "retention_s", "transport_s", "display_s"):
            if not 0 <= getattr(self, name) < 1e6:
                raise InputError(name, getattr(self, name), "s", "[0, 1e6)")
        if self.rnp_table is not None:
            content = zones.digest(self.rnp_table)
            if self.rnp_table_digest not in {"", content}:
                raise InputError("rnp_table", self.rnp_table, domain="the file that the session began with; its content has changed")
            object.__setattr__(self, "rnp_table_digest", content)
        if self.expiry_s is not None and not 0 < self.expiry_s < 1e9:
            raise InputError("expiry_s", self.expiry_s, "s", "(0, 1e9)")
        if not 0 < self.max_tracks <= 1_000_000:
            raise InputError("max_tracks", self.max_tracks, "1", "[1, 1000000]")

    def _check_assumed(self, sigma_m: float) -> None:
        if not 0 < sigma_m < float("inf"):
            raise InputError("sigma_m", sigma_m, "m", "(0, inf)")
        if self.format in CLAIMED:
            raise ConflictError(
                "sigma_m", because=f"aircraft state their own accuracy in {self.format}, and what they do not claim is not completed"
            )

    @property
    def assumed(self) -> str:
        """What the user assumes of the accuracy, in words; empty where nothing is."""
        if self.sigma_m is None:
            return ""
        return f"assuming a sigma of {self.sigma_m:g} m in each axis, typed by the user, where the source states no larger accuracy"

    @property
    def methods(self) -> tuple[str, str]:
        """Method of a track, and of one that states a flight technical error."""
        total, navigation = METHODS
        return (self.method, self.method) if self.method else (total if self.path is not None else navigation, total)

    @property
    def stale_s(self) -> float:
        """Silence after which monitoring is lost [s]."""
        if self.stale_after_s is not None:
            return self.stale_after_s
        chain = [self.sample_period_s, 0.0, 0.0, 0.0, 0.0, math.inf]
        return _core.RnpMonitor(chain, self.raise_delay_s, self.clear_delay_s, self.clear_ratio, None).stale_after_s

    def text(self) -> str:
        """The record as JSON, one form for one content."""
        return json.dumps(asdict(self), sort_keys=True, indent=1)

    def core(self) -> _core.LiveSettings:
        """The lane's settings.

        Raises
        ------
        InputError
            A value outside its domain, or a chain of times that is longer than the time to alert.
        """
        # Transport and lateness delay an exceedance and a silence alike, as computing does: the monitor's sums hold it in both.
        computing_s = COMPUTING_S + self.transport_s + self.lateness_s
        chain = [self.sample_period_s, 0.0, 0.0, computing_s, self.display_s, self.time_to_alert_s]
        nanoseconds = (_ns(self.lateness_s), _ns(self.ahead_s), _ns(self.retention_s))
        text = self.text()
        path = None if self.path is None else path_of(self.path)
        try:
            return _core.LiveSettings(
                (self.format, self.track, *self.methods),
                (self.risk_accuracy, self.risk_integrity),
                (chain, self.raise_delay_s, self.clear_delay_s, self.clear_ratio, self.stale_s),
                self.rnp_m,
                asdict(Limits(moving_mps=math.inf) if self.standing else Limits()),
                None if path is None else path._core,
                (zones.Zones() if self.rnp_table is None else zones.load(self.rnp_table)).core(),
                self._claims(),
                statements.for_core(),
                nanoseconds,
                None if self.expiry_s is None else _ns(self.expiry_s),
                self.max_tracks,
                hashlib.sha256(text.encode()).digest(),
            )
        except KeyError as e:
            raise InputError("track", self.track, domain="1 to 32 printable ASCII characters without blanks and '/'") from e

    def _claims(self) -> tuple[list[float], list[float], int, float | None]:
        """Standard deviation of an axis by NACp, radius of containment by NIC, least SIL whose risk is small enough, `sigma_m`. [m]."""
        sigma_of = nacp_sigma_m()
        sigma_m = [sigma_of.get(category, math.nan) for category in range(12)]
        sure = [level for level, risk in SIL_RISK.items() if risk <= self.risk_integrity]
        # A level above the highest is none: nothing is believed then.
        radii = [NIC_RC_M.get(category, math.nan) for category in range(12)]
        return sigma_m, radii, min(sure, default=max(SIL_RISK) + 1), self.sigma_m

    def changed(self, **values: Any) -> Settings:
        """The same but for some values."""
        return replace(self, **values)


def load(file: FilePath) -> Settings:
    """Settings of a session.

    Raises
    ------
    FormatError
        Not such a file.
    """
    try:
        return Settings(**json.loads(file.read_text(encoding="utf-8"))["settings"])
    except FileNotFoundError as e:
        raise FormatError(file, "is missing: nobody knows how it judged without the settings of a live session; put it back") from e
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as e:
        raise FormatError(file, f"not the settings of a live session: {e}") from e


def _ns(seconds: float) -> int:
    return round(seconds * 1e9)
