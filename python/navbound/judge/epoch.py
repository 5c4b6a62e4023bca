"""The judge of one aircraft, epoch by epoch."""

from __future__ import annotations

import difflib
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

from navbound import _core
from navbound import status as status_list
from navbound.errors import InputError
from navbound.judge.settings import ALERTS
from navbound.rnp import Acceptance, Alert, Counters, Event
from navbound.table import columns
from navbound.table.arguments import nanoseconds, number_or_nan
from navbound.table.arrays import shown

if TYPE_CHECKING:
    from collections.abc import Mapping

    from navbound.judge.settings import Settings

_COLUMNS = _core.judge_columns()
_KEYS = tuple(dict.fromkeys(("time_ns", "status", *_COLUMNS)))
_KNOWN = frozenset({*_KEYS, *(column.name for column in columns.EPOCHS)})
_STATUS = {id_: code for code, id_ in enumerate(status_list.STATUSES)}
_STATUSES = list(status_list.STATUSES)


@dataclass(frozen=True)
class Judged:
    """What was decided of one epoch.

    Attributes
    ----------
    numbers : dict
        The columns of :attr:`Settings.columns`; None where there is no number. [m, 1]
    status : str
        Status of the epoch: its own, or that of the reason why it cannot be judged.
    reason_id, reason : str, optional
        That reason and its sentence; None where the epoch was judged, and where its own status forbids it.
    state : str, optional
        The tightest RNP state that the error is beyond with at most the accuracy risk.
    alert : str
        The alert in force after it.
    acceptance : str
        Whether its time was accepted, as :class:`navbound.rnp.Step` says.
    began, ended : list of Event
        Events whose alert was raised here, and that ended here. A silence that this epoch ends is in both.
    """

    numbers: dict[str, float | None]
    status: str
    reason_id: str | None
    reason: str | None
    state: str | None
    alert: Alert
    acceptance: Acceptance
    began: list[Event]
    ended: list[Event]


def _refuse_unknown(epoch: Mapping[str, Any]) -> None:
    for key in epoch:
        if key not in _KNOWN:
            near = difflib.get_close_matches(shown(key), _KEYS, 1)
            meant = f"; did you mean {near[0]}?" if near else ""
            domain = f"columns of the epoch table (judged are {', '.join(_KEYS)}){meant}"
            raise InputError("key of the epoch", shown(key), domain=domain)


class Judge:
    """The judge of one aircraft: errors, bounds, risks, state, status and alert, epoch by epoch.

    Parameters
    ----------
    settings : Settings
        How it judges.
    with_levels : bool, optional
        Whether every epoch whose status is ``ok`` should have a protection level. Without it they should from the first epoch on that has
        the key ``hpl_m``, be its value a number or not.
    """

    def __init__(self, settings: Settings, *, with_levels: bool | None = None) -> None:
        self.settings = settings
        self._declared_by_key = with_levels is None
        self._core = settings.plan.judge(bool(with_levels))

    def step(self, epoch: Mapping[str, Any]) -> Judged:
        """Judge one epoch. One that is dropped for its time counts as one sample period of silence.

        Parameters
        ----------
        epoch : mapping
            Values under the names of the epoch table (docs/notation.md): ``time_ns``, ``status`` (``ok`` where it is absent), and what is
            known of ``course_rad``, ``path_angle_rad``, ``fte_m``, ``fte_v_m``, ``rnp_m``, ``cov_*_m2``, ``nse_*_m``, ``hpl_m``. None and
            NaN are absent values. Other columns of the epoch table are not looked at. [SI]

        Raises
        ------
        InputError
            A key that is no column of the epoch table: it might hold what speaks against the epoch.
            No time, a status that is none, or a value that is no number.
        """
        _refuse_unknown(epoch)
        time_ns, numbers = nanoseconds("time_ns", epoch.get("time_ns")), [number_or_nan(name, epoch.get(name)) for name in _COLUMNS]
        code = _STATUS.get(cast("str", epoch.get("status", "ok")))
        if code is None:
            raise InputError("status", shown(epoch.get("status")), domain=", ".join(_STATUS))
        values, status, why, state, alert, acceptance, ended, began = self._core.step(
            time_ns, code, numbers, self._declared_by_key and "hpl_m" in epoch
        )
        reason_id, reason = why or (None, None)
        return Judged(
            numbers={name: None if math.isnan(x) else x for name, x in zip(self.settings.columns, values, strict=True)},
            status=_STATUSES[status],
            reason_id=reason_id,
            reason=reason,
            state=self.settings.state(state),
            alert=cast("Alert", ALERTS[alert]),
            acceptance=cast("Acceptance", acceptance),
            began=[Event(*event) for event in began],
            ended=[Event(*event) for event in ended],
        )

    def tick(self, time_ns: int) -> tuple[Alert, Event | None]:
        """Time passes without an epoch: the alert in force, and the loss of monitoring that was raised here.

        ``time_ns`` is the arrival clock, GPS nanoseconds.

        Raises
        ------
        InputError
            A time that is no whole number of nanoseconds in 64 bits.
        """
        alert, began = self._core.tick(nanoseconds("time_ns", time_ns))
        return cast("Alert", alert), None if began is None else Event(*began)

    @property
    def open_events(self) -> list[Event]:
        """Alerts in force."""
        return [Event(*event) for event in self._core.open_events()]

    @property
    def counters(self) -> Counters:
        """What `step` and `tick` saw so far."""
        return Counters(**self._core.counters())

    def to_bytes(self) -> bytes:
        """The whole state with its settings: fixed length, little-endian, version first, CRC-32C last."""
        return self._core.to_bytes()

    @classmethod
    def from_bytes(cls, state: bytes, settings: Settings, *, with_levels: bool | None = None) -> Judge:
        """The judge of a state, which takes the same steps to the bit.

        Parameters
        ----------
        state : bytes
            From :meth:`to_bytes`.
        settings : Settings
            Those under which it was written; methods beside may differ.
        with_levels : bool, optional
            As the judge was made.

        Raises
        ------
        InputError
            Bytes that are damaged, of another version or written under other settings.
        """
        judge = cls.__new__(cls)
        judge.settings = settings
        judge._declared_by_key = with_levels is None
        try:
            judge._core = settings.plan.resumed(bytes(state))
        except ValueError as e:
            raise InputError("state", f"{len(state)} bytes", domain=f"a state that was written under these settings: {e}") from e
        return judge
