"""Maps from what a service in space sends: the algorithms of protection levels that take its messages."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, make_dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from navbound import gnss, sbas
from navbound.errors import ConflictError, InputError
from navbound.maps import sources
from navbound.maps.limits import Limit, limits_of
from navbound.maps.sources import File, Times
from navbound.time import utc_text

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from navbound.algorithms import Sent
    from navbound.maps.kinds import Levels

    Floats = NDArray[np.float64]

WARM_UP_S = 600.0
"""From the first message of a log to the first instant of its map. A receiver that begins with the log needs the masks first and then the
corrections to them, each of which is sent at least every five minutes (DO-229D, table of update intervals; the text was not read). [s]"""
GAP_S = 4.0
"""Messages come every second; a receiver that misses four in a row leaves precision approach. [s]"""
_DO_NOT_USE, _RANGING, _ALMANAC = 0, 9, 17


@dataclass(frozen=True)
class _ServiceLevels:
    entry: Sent
    messages: File
    navigation: tuple[File, ...]
    prn: int | None
    mode: Literal["auto", "pa", "npa"]
    time_ns: NDArray[np.int64]
    mask_rad: float
    h_m: float
    sender: gnss.Orbits | None

    def __call__(self, lat_rad: Floats, lon_rad: Floats) -> dict[str, NDArray[Any]]:
        levels = self.entry(
            sources.messages(self.messages, self.prn),
            [file.path for file in self.navigation],
            self.time_ns[:, None],
            lat_rad=lat_rad,
            lon_rad=lon_rad,
            h_m=self.h_m,
            mode=self.mode,
            mask_rad=self.mask_rad,
        )
        shown = [column.name for column in self.entry.columns]
        columns = {name: np.ascontiguousarray(getattr(levels, name).T, dtype=np.float64) for name in (*shown, "n_sv")}
        deaf = ~self._hears(lat_rad, lon_rad)
        for name in shown:
            columns[name][deaf] = np.nan
        columns["n_sv"][deaf] = 0
        without, deaf = np.isnan(columns[shown[-1]]), deaf[:, None]
        nothing = columns["n_sv"] == 0
        return columns | {
            "p_no_signal": without & deaf,
            "p_no_service": without & ~deaf & nothing,
            "p_too_few": without & ~nothing,
        }

    def _hears(self, lat_rad: Floats, lon_rad: Floats) -> NDArray[np.bool_]:
        """Who has the service's satellite above the mask."""
        if self.sender is None:
            return np.ones(len(lat_rad), dtype=bool)
        _, el_rad = gnss.directions(self.sender, lat_rad, lon_rad, self.h_m, 0.0)
        return np.asarray(el_rad[..., 0] >= self.mask_rad)


@dataclass(frozen=True)
class _Service:
    """Protection levels from the messages that a service sent, for users who can hear them.

    Attributes
    ----------
    messages : str or Path
        Message log.
    navigation : tuple of str or Path
        RINEX navigation files of that day.
    prn : int, optional
        Whose messages, where the log holds several satellites'.
    times : Times
        Instants. Without a start from :data:`WARM_UP_S` after the first message on (a log shorter than twice that: from its first message
        on), without a duration to the last message.
    mode : {"auto", "pa", "npa"}
        What the level is for.
    mask_rad, h_m : float
        Lowest elevation used, also of the service's own satellite, and height of the users. [rad, m]
    """

    ENTRY: ClassVar[Sent]

    messages: str | Path = ""
    navigation: tuple[str | Path, ...] = ()
    prn: int | None = None
    times: Times = field(default_factory=Times)
    mode: Literal["auto", "pa", "npa"] = "pa"
    mask_rad: float = math.radians(5.0)
    h_m: float = 0.0

    def _heard(self) -> sbas.Messages:
        if not self.messages:
            raise ConflictError(
                "kind", needs=("messages",), because=f"{self.ENTRY.name} takes the levels of a message log", value=self.ENTRY.name
            )
        if not self.navigation:
            raise ConflictError("messages", needs=("navigation",), because="the orbits are those of the log's day")
        return sources.messages(File.of(self.messages), self.prn)

    def _instants(self) -> NDArray[np.int64]:
        heard = self._heard()
        first, last = int(heard.time_ns.min()), int(heard.time_ns.max())
        warm_up_ns = round(WARM_UP_S * sources.NS)
        usual = first + (warm_up_ns if last - first >= 2 * warm_up_ns else 0)
        start = usual if self.times.start_ns is None else self.times.start_ns
        requested_s = 0.0 if self.times.duration_s is None else self.times.duration_s
        if start > last or start + requested_s * sources.NS < first:
            raise InputError("start_ns", start, "ns", f"[{first}, {last}], the time of the messages")
        offsets_s = self.times.offsets_s(max(self.times.step_s, (last - start) / sources.NS))
        time_ns = start + np.rint(offsets_s * sources.NS).astype(np.int64)
        return np.asarray(time_ns, dtype=np.int64)

    def levels(self) -> Levels:
        """What works out the numbers."""
        heard = self._heard()
        files = tuple(File.of(path) for path in self.navigation)
        return _ServiceLevels(
            self.ENTRY, File.of(self.messages), files, self.prn, self.mode, self._instants(), self.mask_rad, self.h_m, _sender(heard)
        )

    def n_epochs(self) -> int:
        """Instants. [1]."""
        return len(self._instants())

    def limits(self) -> list[Limit]:
        """What is required without a word of the caller."""
        return limits_of("NPA", vertical=False) if self.mode == "npa" else limits_of("APV-I")

    def assumptions(self) -> list[str]:
        """What the numbers rest on."""
        heard, time_ns = self._heard(), self._instants()
        first, last = int(heard.time_ns.min()), int(heard.time_ns.max())
        outside = int(((time_ns < first) | (time_ns > last)).sum())
        mask = f"{math.degrees(self.mask_rad):g}°"
        reach = (
            f"Users hear it where it stands above {mask}, seen from where it said first that it is; a user who can hears every message."
            if _sender(heard) is not None
            else "Every user hears every message: the log does not say where its satellite is."
        )
        return [
            f"PRN {int(heard.prn[0])}: {log_words(heard)}",
            reach,
            f"Every satellite above {mask}; terrain is not considered; mode {self.mode}.",
            self.times.words(len(time_ns), int(time_ns[0])),
            *([f"{outside} of the instants are outside the log."] if outside else []),
            "What was sent before the log begins is not known: there is no level until the masks and corrections have come again.",
        ]


@cache
def service_of(entry: Sent) -> type[_Service]:
    """The arguments of a map of one algorithm that takes messages."""
    return make_dataclass(entry.name, [], bases=(_Service,), namespace={"ENTRY": entry}, frozen=True)


def _types(heard: sbas.Messages) -> NDArray[np.uint8]:
    # Eight bits of preamble, then six of the type.
    return np.asarray(heard.data[:, 1] >> 2, dtype=np.uint8)


def log_words(heard: sbas.Messages) -> str:
    """How much of a log there is, and what is not: gaps, messages that forbid its use, lines that were refused."""
    times = np.sort(heard.time_ns)
    gaps_s = np.diff(times) / sources.NS
    long = gaps_s[gaps_s > GAP_S]
    stopped = int((_types(heard) == _DO_NOT_USE).sum())
    return (
        ", ".join(
            [
                f"{len(times)} messages from {utc_text(int(times[0]))} to {utc_text(int(times[-1]))} UTC",
                *([f"{len(long)} gaps of more than {GAP_S:g} s, the longest {long.max():g} s"] if len(long) else []),
                *([f"{stopped} of them saying that the service is not to be used (message 0)"] if stopped else []),
                *([f"{len(heard.refused)} lines of the log refused as damaged"] if heard.refused else []),
            ]
        )
        + "."
        + "".join(f" {words[0].upper()}{words[1:]}" for words in heard.tag_words())
    )


def _sender(heard: sbas.Messages) -> gnss.Orbits | None:
    """The geostationary satellite where its first ranging message, or else its almanac, puts it; None where neither was sent."""
    at = np.isin(_types(heard), (_RANGING, _ALMANAC))
    own = sbas.Messages(heard.time_ns[at], heard.prn[at], heard.data[at], heard.format, heard.tag, [])
    places = [
        place["position_ecef_m"]
        for message in sorted(sbas.decode(own), key=lambda one: one.type)
        for place in message.fields.get("entries", [message.fields])
        if place.get("prn", message.prn) == message.prn
    ]
    return _standing(places[0]) if places else None


def _standing(position_ecef_m: list[float]) -> gnss.Orbits:
    """A circular orbit that is at a place at its reference instant: there at its northernmost or southernmost point."""
    x, y, z = position_ecef_m
    radius_m = math.hypot(x, y, z)
    latitude_argument_rad = math.copysign(math.pi / 2, z)
    return gnss.Orbits(
        satellite=("S",),
        constellation=np.array([gnss.CONSTELLATIONS.index("sbas")]),
        semi_major_m=np.array([radius_m]),
        eccentricity=np.zeros(1),
        inclination_rad=np.array([abs(math.asin(z / radius_m))]),
        node_rad=np.array([math.atan2(y, x) - latitude_argument_rad]),
        perigee_rad=np.zeros(1),
        mean_anomaly_rad=np.array([latitude_argument_rad]),
        node_rate_radps=np.zeros(1),
    )
