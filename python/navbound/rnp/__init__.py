"""Required navigation performance: specifications as data, the monitor, what its risk means over an hour, and the state classifier."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, cast

import numpy as np
import polars as pl

from navbound import _core
from navbound import status as status_list
from navbound.delays import CLEAR_DELAY_S, CLEAR_RATIO, RAISE_DELAY_S, TIME_TO_ALERT_S
from navbound.errors import InputError
from navbound.methods import EXTRACTION_LABEL, method
from navbound.risks import checked_risk
from navbound.rnp.catalogue import Specification, specification, specifications
from navbound.rnp.exposure import PER_EPOCH, ExposureBasis, PerEpoch, PerHour, per_epoch_risk, per_hour_risk
from navbound.rnp.states import StateClassifier, StateOfError, StateOfErrors, nse_boundary, state_of_error, state_of_errors, states_of_track
from navbound.table.arguments import checked, nanoseconds, number_or_nan
from navbound.table.columns import EVENTS
from navbound.table.declare import schema as schema_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from navbound.methods import Method

__all__ = [
    "PER_EPOCH",
    "Counters",
    "Event",
    "ExposureBasis",
    "Monitor",
    "MonitorRun",
    "PerEpoch",
    "PerHour",
    "Specification",
    "StateClassifier",
    "StateOfError",
    "StateOfErrors",
    "Step",
    "TrackMonitors",
    "nse_boundary",
    "per_epoch_risk",
    "per_hour_risk",
    "specification",
    "specifications",
    "state_of_error",
    "state_of_errors",
    "states_of_track",
]

Alert = Literal["normal", "caution", "warning", "unavailable"]
Acceptance = Literal["accepted", "duplicate", "late", "clock_set_back"]

USABLE = status_list.USABLE
"""Words of `status` with which an epoch is judged."""
UNUSABLE = status_list.UNUSABLE
"""Words of `status` with which monitoring is lost."""


class Event(NamedTuple):
    """An alert from onset to clear; times are GPS nanoseconds.

    ``clear_ns`` is None while it lasts. ``peak_m`` is the largest bound, ``min_margin_m`` the least limit minus bound and ``limit_m``
    the limit there; NaN when no bound was a number.
    """

    kind: str
    onset_ns: int
    annunciation_ns: int
    clear_ns: int | None
    peak_m: float
    limit_m: float
    min_margin_m: float


class Step(NamedTuple):
    """What one epoch changed: the alert in force, whether the epoch was judged, events that ended, and events whose alert was raised.

    A silence that this epoch ends is in ``began`` and in ``ended``.
    """

    alert: Alert
    acceptance: Acceptance
    ended: list[Event]
    began: list[Event]


@dataclass(frozen=True)
class Counters:
    """What the monitor saw and did; counts of epochs and alerts.

    ``n_withdrawn`` are exceedances that ended before an alert was raised. ``n_nan`` are usable epochs with a bound that is not a number or
    an RNP value outside (0, inf). ``alerts_per_hour`` counts cautions and warnings over the time
    under watch: under nominal conditions it is the rate of false alerts, reported beside integrity. NaN when nothing was watched.
    """

    n_accepted: int
    n_duplicate: int
    n_late: int
    n_clock_set_back: int
    n_gaps: int
    n_unusable: int
    n_nan: int
    n_withdrawn: int
    n_cautions: int
    n_warnings: int
    n_unavailable: int
    watched_s: float
    alerts_per_hour: float


@dataclass(frozen=True)
class MonitorRun:
    """What the monitor decided in a table.

    Attributes
    ----------
    alert : Series of str
        The alert in force after each row: normal, caution, warning, unavailable. A dropped row shows what was in force.
    integrity_compared_m : Series of float
        What was compared with twice RNP in each row, null where it is not known. [m]
    events : DataFrame
        ``track``, ``kind``, ``onset_ns``, ``annunciation_ns``, ``clear_ns``, ``peak_m``, ``limit_m``, ``min_margin_m``.
    counters : Counters
        All tracks together.
    track_counters : dict
        Each track's own.
    """

    alert: pl.Series
    integrity_compared_m: pl.Series
    events: pl.DataFrame
    counters: Counters
    track_counters: dict[str, Counters]


class Monitor:
    r"""The RNP monitor: caution, warning and loss of monitoring, epoch by epoch.

    A caution is raised when NOT (accuracy bound <= RNP) has lasted ``raise_delay_s``, a warning at once when NOT (integrity bound <=
    2 RNP); so NaN raises and equality does not. An exceedance that comes and goes adds up: what ``raise_delay_s`` outside fill,
    ``clear_delay_s`` inside empty. Both alerts end after the bound has been within ``clear_ratio`` of the limit for ``clear_delay_s``. An
    unusable status, or silence, is ``unavailable``, and so is everything before the first epoch. The alert falls to ``normal`` only at an
    epoch inside both limits. ``docs/methods/rnp-monitor.md`` says what the delays promise.

    The monitor takes bounds of methods that may feed an alert, by the method's id. Where there are protection levels (``hpl_m``), the
    larger of the integrity bound and \|FTE\| + ``hpl_m`` is compared with 2 RNP.

    Parameters
    ----------
    sample_period_s : float
        Nominal time between epochs. [s]
    time_to_alert_s : float
        The most the whole chain may take; ``specification(...).time_to_alert_s``. ``math.inf`` where nobody is to be alerted, as with
        a recorded flight. [s]
    raise_delay_s, clear_delay_s : float
        Waiting before a caution, and before an alert ends. [s]
    clear_ratio : float
        Share of the limit, in (0, 1].
    stale_after_s : float, optional
        Silence after which monitoring is lost; two sample periods, at least 2 s, if not given. [s]
    sensor_latency_s, filter_s, computing_s, display_s : float
        The other parts of the chain. [s]
    integrity_risk : float
        Risk of the integrity requirement, counted as `integrity_basis` says.
    integrity_basis : PerEpoch or PerHour
        What the integrity risk is counted over.

    Raises
    ------
    InputError
        A setting outside its domain, or a chain that takes longer than the time to alert.
    """

    @checked
    def __init__(
        self,
        *,
        sample_period_s: float = 1.0,
        time_to_alert_s: float = TIME_TO_ALERT_S,
        raise_delay_s: float = RAISE_DELAY_S,
        clear_delay_s: float = CLEAR_DELAY_S,
        clear_ratio: float = CLEAR_RATIO,
        stale_after_s: float | None = None,
        sensor_latency_s: float = 0.0,
        filter_s: float = 0.0,
        computing_s: float = 0.0,
        display_s: float = 0.0,
        integrity_risk: float = 1e-5,
        integrity_basis: ExposureBasis = PER_EPOCH,
    ) -> None:
        chain = (sample_period_s, sensor_latency_s, filter_s, computing_s, display_s, time_to_alert_s)
        self._core = _core.RnpMonitor(list(chain), raise_delay_s, clear_delay_s, clear_ratio, stale_after_s)
        self.sample_period_s = sample_period_s
        self.integrity_risk = checked_risk("integrity_risk", integrity_risk)
        self.integrity_basis = integrity_basis
        self.integrity_risk_per_epoch = integrity_basis.per_epoch(integrity_risk, sample_period_s)
        """The risk at which the integrity bounds given to this monitor must be evaluated."""

    @property
    def time_to_crew_s(self) -> float:
        """Time from an exceedance to the crew: the sum of the chain, in seconds."""
        return self._core.time_to_crew_s

    @property
    def stale_after_s(self) -> float:
        """Silence after which monitoring is lost, in seconds."""
        return self._core.stale_after_s

    @property
    def exposure(self) -> str:
        """The integrity risk in words, on both bases."""
        return self.integrity_basis.words(self.integrity_risk, self.sample_period_s)

    def step(self, record: Mapping[str, Any], *, accuracy: str = "tse-exact", integrity: str | None = None) -> Step:
        """Judge one epoch. A record that is dropped for its time counts as one sample period of silence.

        Parameters
        ----------
        record : mapping
            ``time_ns``, ``rnp_m``, both bounds under the names of their methods' columns and, where there are any, ``status``, ``fte_m``
            and ``hpl_m``. A bound that is None is a NaN, and alerts.

            **A level that is due and missing alerts.** A record with the key ``hpl_m`` declares that its source has protection levels,
            whatever stands there: from the first such record on every epoch with status ``ok`` owes one, and one that is None, NaN or
            absent is no integrity bound and raises the warning at once. Only a source whose records never have the key is judged by its
            bounds alone.
        accuracy, integrity : str
            Ids of the methods that made the two bounds, of those that may feed an alert; ``tse-exact`` is read from ``tse_exact_m`` and
            ``tse_exact_integrity_m``. The integrity bound is of the same method unless another is named.

        Raises
        ------
        InputError
            A method that may not feed an alert, a missing key, or a status that is none.
        """
        first, second = _alerting("accuracy", accuracy), _alerting("integrity", integrity or accuracy)
        try:
            time_ns = record["time_ns"]
            accuracy_m, integrity_m, rnp_m = (number_or_nan(key, record[key]) for key in (first.column, second.integrity_column, "rnp_m"))
            fte_m = number_or_nan("fte_m", record.get("fte_m"))
            hpl_m = number_or_nan("hpl_m", record["hpl_m"]) if "hpl_m" in record else None
        except KeyError as e:
            raise InputError("record", "a mapping without it", domain=f"records with {e.args[0]}") from e
        nanoseconds("time_ns", time_ns)
        status = record.get("status", "ok")
        if not isinstance(status, str) or status not in USABLE + UNUSABLE:
            raise InputError("status", repr(status), domain=", ".join(USABLE + UNUSABLE))
        alert, acceptance, ended, began = self._core.step(
            time_ns, (first.id, accuracy_m), (second.id, integrity_m), fte_m, hpl_m, rnp_m, (status in USABLE, status == "ok")
        )
        return Step(cast("Alert", alert), cast("Acceptance", acceptance), [Event(*e) for e in ended], [Event(*e) for e in began])

    def tick(self, time_ns: int) -> Alert:
        """Time passes without an epoch: the alert in force, ``unavailable`` after a silence.

        ``time_ns`` is the arrival clock, GPS nanoseconds. The silence is measured against the time of the last epoch and, because that may
        be wrong, also from tick to tick.

        Raises
        ------
        InputError
            A time that is no whole number of nanoseconds in 64 bits.
        """
        nanoseconds("time_ns", time_ns)
        return cast("Alert", self._core.tick(time_ns))

    @property
    def open_events(self) -> list[Event]:
        """Alerts in force."""
        return [Event(*e) for e in self._core.open_events()]

    @property
    def counters(self) -> Counters:
        """What `step` and `tick` saw so far."""
        return Counters(**self._core.counters())

    def run(
        self,
        table: pl.DataFrame | Mapping[str, Any],
        *,
        accuracy: str = "tse-exact",
        integrity: str | None = None,
    ) -> MonitorRun:
        """Judge a table, each track by a fresh monitor with these settings; `step`'s own state is left alone.

        The rows are the arrival clock: one that is dropped for its time counts as one sample period of silence.

        Parameters
        ----------
        table : DataFrame or mapping of columns
            ``time_ns``, ``rnp_m``, both bounds under the names of their methods' columns and, where there are any, ``status``, ``track``,
            ``fte_m`` and ``hpl_m``. A null bound of a row whose status is ``ok`` is a NaN, and alerts; so is its null ``hpl_m``: a table
            with this column declares that the source of every track has protection levels. Tracks without belong in a table without it, or
            are named by :meth:`tracks`.
        accuracy, integrity : str
            Ids of the methods that made the two bounds, of those that may feed an alert; ``tse-exact`` is read from ``tse_exact_m`` and
            ``tse_exact_integrity_m``. The integrity bound is of the same method unless another is named.

        Raises
        ------
        InputError
            A method that may not feed an alert, a missing column, a null time, or a status that is none.
        """
        frame = _frame(table)
        names, _ = _tracks(frame)
        tracks = self.tracks(dict.fromkeys(names, "hpl_m" in frame.columns), accuracy=accuracy, integrity=integrity)
        alert, compared_m = tracks.judge(frame)
        events, total, each = tracks.decided()
        return MonitorRun(alert, compared_m, events, total, each)

    def tracks(self, with_levels: Mapping[str, bool], *, accuracy: str = "tse-exact", integrity: str | None = None) -> TrackMonitors:
        """Fresh monitors with these settings, one for each track, for a table that comes in pieces.

        Parameters
        ----------
        with_levels : mapping of str to bool
            Every track, and whether its source has protection levels (``hpl_m``): then every epoch with status ``ok`` owes one, and one
            without is outside. Of a track that is named without, the first level is the beginning of levels that are due.
        accuracy, integrity : str
            As in :meth:`run`.

        Raises
        ------
        InputError
            A method that may not feed an alert.
        """
        methods = (_alerting("accuracy", accuracy), _alerting("integrity", integrity or accuracy))
        return TrackMonitors(self._core.tracks(list(with_levels.values())), tuple(with_levels), methods)


class TrackMonitors:
    """One monitor for each track; made by :meth:`Monitor.tracks`. The pieces of a table of any length give what the whole gives at once."""

    def __init__(self, monitors: _core.RnpMonitors, names: tuple[str, ...], methods: tuple[Method, Method]) -> None:
        self._core, self._names, self._methods = monitors, names, methods

    def judge(self, frame: pl.DataFrame) -> tuple[pl.Series, pl.Series]:
        """Judge the next rows: ``alert`` and ``integrity_compared_m`` of :class:`MonitorRun`.

        Raises
        ------
        InputError
            As :meth:`Monitor.run`; a track that was not named.
        """
        first, second = self._methods
        for name in ("time_ns", "rnp_m", first.column, second.integrity_column):
            if name not in frame.columns:
                raise InputError("table", f"columns {', '.join(frame.columns)}", domain=f"tables with {name}")
        if frame["time_ns"].null_count():
            raise InputError("time_ns", "null", domain="times", index=frame["time_ns"].is_null().arg_max())
        usable = _usable(frame)
        words, compared_m = self._core.judge(
            _times(frame),
            (first.id, _numbers(frame, first.column)),
            (second.id, _numbers(frame, second.integrity_column)),
            _numbers(frame, "fte_m") if "fte_m" in frame.columns else None,
            _numbers(frame, "hpl_m") if "hpl_m" in frame.columns else None,
            _numbers(frame, "rnp_m"),
            (usable, _level_due(frame)),
            track_index(frame, self._names),
        )
        return pl.Series("alert", words, dtype=pl.String), pl.Series("integrity_compared_m", compared_m, nan_to_null=True)

    def decided(self) -> tuple[pl.DataFrame, Counters, dict[str, Counters]]:
        """Events, counters of all tracks together and of each, of the rows so far."""
        rows, each, total = self._core.decided()
        return events_table(list(self._names), rows), Counters(**total), {n: Counters(**c) for n, c in zip(self._names, each, strict=True)}


@cache
def _alerting(argument: str, method_id: str) -> Method:
    """The method of a bound that the monitor takes; the core's list says which may feed an alert."""
    allowed = _core.alerting_methods()
    if method_id not in allowed:
        raise InputError(
            argument, method_id, domain=f"a method that may feed an alert, of {', '.join(allowed)}; any other bound is {EXTRACTION_LABEL}"
        )
    return method(method_id)


def _frame(table: pl.DataFrame | Mapping[str, Any]) -> pl.DataFrame:
    if isinstance(table, pl.DataFrame):
        return table
    try:
        return pl.DataFrame(dict(table))
    except (TypeError, ValueError, OverflowError, pl.exceptions.PolarsError) as e:
        raise InputError("table", str(e)[:120], domain="columns of numbers, all of one length") from e


def _times(frame: pl.DataFrame) -> NDArray[np.int64]:
    try:
        return np.ascontiguousarray(frame["time_ns"].cast(pl.Int64).to_numpy())
    except pl.exceptions.PolarsError as e:
        raise InputError("time_ns", f"a column of {frame['time_ns'].dtype}", "ns", "[-2^63, 2^63), whole") from e


def _numbers(frame: pl.DataFrame, name: str) -> NDArray[np.float64]:
    try:
        column = frame[name].cast(pl.Float64)
    except pl.exceptions.PolarsError as e:
        raise InputError(name, f"a column of {frame[name].dtype}", "m", "numbers") from e
    return np.ascontiguousarray(column.fill_null(math.nan).to_numpy(), dtype=np.float64)


def _level_due(frame: pl.DataFrame) -> NDArray[np.bool_]:
    """Rows that should have a protection level: none vouches for an epoch that is degraded, and its status says so."""
    if "status" not in frame.columns:
        return np.ones(frame.height, dtype=np.bool_)
    return np.ascontiguousarray((frame["status"] == "ok").fill_null(value=False).to_numpy())


def _usable(frame: pl.DataFrame) -> NDArray[np.bool_]:
    if "status" not in frame.columns:
        return np.ones(frame.height, dtype=np.bool_)
    status = frame["status"].cast(pl.String)
    known = status.is_in(USABLE + UNUSABLE).fill_null(value=False)
    if not known.all():
        row = int((~known).arg_max() or 0)
        raise InputError("status", repr(status[row]), domain=", ".join(USABLE + UNUSABLE), index=row)
    return np.ascontiguousarray(status.is_in(USABLE).to_numpy())


def _tracks(frame: pl.DataFrame) -> tuple[list[str], NDArray[np.uint32]]:
    if "track" not in frame.columns:
        return [""], np.zeros(frame.height, dtype=np.uint32)
    track = frame["track"].cast(pl.String).fill_null("")
    names = track.unique(maintain_order=True)
    index = track.replace_strict(names, pl.Series(range(len(names)), dtype=pl.UInt32), return_dtype=pl.UInt32)
    return names.to_list(), np.ascontiguousarray(index.to_numpy())


def track_index(frame: pl.DataFrame, names: Sequence[str]) -> NDArray[np.uint32]:
    """Place of each row's track in a list of names; 0 for a table without tracks.

    Raises
    ------
    InputError
        A track that is not in the list.
    """
    if "track" not in frame.columns:
        return np.zeros(frame.height, dtype=np.uint32)
    track = frame["track"].cast(pl.String).fill_null("")
    index = track.replace_strict(
        pl.Series(names, dtype=pl.String), pl.Series(range(len(names)), dtype=pl.UInt32), default=None, return_dtype=pl.UInt32
    )
    if index.null_count():
        raise InputError("track", track.filter(index.is_null())[0], domain="tracks that were named before the first piece")
    return np.ascontiguousarray(index.to_numpy())


def events_table(names: list[str], rows: list[tuple[int, tuple[str, int, int, int | None, float, float, float]]]) -> pl.DataFrame:
    """The table of events (:class:`MonitorRun`) of rows of the core, each with the index of its track's name."""
    without_words = schema_of(column for column in EVENTS if column.name != "words")
    return pl.DataFrame([(names[track], *event) for track, event in rows], schema=without_words, orient="row").fill_nan(None)
