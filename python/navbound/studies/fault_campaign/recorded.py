"""The fault campaign on recorded drives and flights: faults in the recorded samples and positions, and `ins.fuse` on them.

There is no path, so no alert: what is counted is the status. A recording that has no level of its own gets a declared one; a fault of the
receiver is then a fault of that level too.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from navbound import ins
from navbound.errors import InputError
from navbound.studies.fault_campaign.measures import Outcome, promised
from navbound.studies.fault_campaign.records import Study, summed

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Times = NDArray[np.int64]

SECOND_NS = 1_000_000_000
ONSETS = (0.15, 0.3, 0.45, 0.6, 0.75)
"""Begin of a fault as a share of the recording. [1]"""
OUTPUT_S = 0.5
HEALTHY = "healthy"


@dataclass(frozen=True)
class Recording:
    """What a recording gives to the filter, and the truth at some times.

    Attributes
    ----------
    imu, fixes, start, model
        As `navbound.ins.fuse` takes them. The fixes have a declared level, for a risk of 1e-5.
    truth_ns : ndarray of int, shape (n,)
        [ns]
    truth : ndarray, shape (n, 3)
        Latitude, longitude, height. [rad, rad, m]
    """

    imu: ins.Imu
    fixes: ins.Fixes
    start: ins.Start
    model: ins.ImuModel
    truth_ns: Times
    truth: Floats

    @property
    def metres(self) -> Floats:
        """Lengths of a unit of latitude, longitude and height on a sphere: 0.4 % of an error, not of a position. [m/rad, m/rad, 1]."""
        return np.array([6.37e6, 6.37e6 * np.cos(self.truth[0, 0]), 1.0])

    def since_s(self, time_ns: object) -> Floats:
        """Seconds since the start."""
        since: Floats = (np.asarray(time_ns) - self.start.time_ns) / SECOND_NS
        return since


@dataclass(frozen=True)
class Kind:
    """A kind of fault in a recording: ``change`` takes the recording, the size and the onset [s]."""

    id: str
    family: str
    unit: str
    sizes: tuple[float, ...]
    change: Callable[[Recording, float, float], Recording]


def _unit(r: Recording, **change: object) -> Recording:
    return replace(r, imu=replace(r.imu, **change))  # type: ignore[arg-type]


def _fixes(r: Recording, **change: object) -> Recording:
    return replace(r, fixes=replace(r.fixes, **change))  # type: ignore[arg-type]


def _arrays(r: Recording) -> tuple[Floats, Floats, Floats, Floats]:
    """Time since the start [s], increments of angle [rad] and velocity [m/s], and the sampling interval [s]."""
    angle, velocity = np.array(r.imu.angle_rad, dtype=float), np.array(r.imu.velocity_mps, dtype=float)
    interval = np.broadcast_to(np.asarray(r.imu.interval_s, dtype=float), angle.shape[:1])
    return r.since_s(r.imu.time_ns), angle, velocity, interval


def _during(since: Floats, onset_s: float, size: float) -> NDArray[np.bool_]:
    return (since >= onset_s) & (since < onset_s + size)


def _samples(change: Callable[[Floats, Floats, NDArray[np.bool_]], None]) -> Callable[[Recording, float, float], Recording]:
    """Change increments in place while the fault lasts; its size is how long."""

    def changed(r: Recording, size: float, onset_s: float) -> Recording:
        since, angle, velocity, _ = _arrays(r)
        change(angle, velocity, _during(since, onset_s, size))
        return _unit(r, angle_rad=angle, velocity_mps=velocity)

    return changed


def _set(number: float) -> Callable[[Floats, Floats, NDArray[np.bool_]], None]:
    def change(angle: Floats, velocity: Floats, during: NDArray[np.bool_]) -> None:
        angle[during], velocity[during] = number, number

    return change


def _freeze(*, gyroscopes: bool, accelerometers: bool) -> Callable[[Floats, Floats, NDArray[np.bool_]], None]:
    def change(angle: Floats, velocity: Floats, during: NDArray[np.bool_]) -> None:
        first = np.flatnonzero(during)[:1]
        for values, frozen in ((angle, gyroscopes), (velocity, accelerometers)):
            if frozen and first.size:
                values[during] = values[first[0]]

    return change


def _swap(angle: Floats, velocity: Floats, during: NDArray[np.bool_]) -> None:
    for values in (angle, velocity):
        values[during] = values[during][:, [1, 0, 2]]


def _without(r: Recording, size: float, onset_s: float) -> Recording:
    """Samples that are absent."""
    since, angle, velocity, interval = _arrays(r)
    kept = ~_during(since, onset_s, size)
    return _unit(
        r, time_ns=np.asarray(r.imu.time_ns)[kept], angle_rad=angle[kept], velocity_mps=velocity[kept], interval_s=interval[kept].copy()
    )


def _doubled(r: Recording, size: float, onset_s: float) -> Recording:
    """Each sample twice, with the same time."""
    since, angle, velocity, interval = _arrays(r)
    index = np.repeat(np.arange(since.size), np.where(_during(since, onset_s, size), 2, 1))
    time_ns = np.asarray(r.imu.time_ns)[index]
    return _unit(r, time_ns=time_ns, angle_rad=angle[index], velocity_mps=velocity[index], interval_s=interval[index].copy())


def _reversed(r: Recording, size: float, onset_s: float) -> Recording:
    """The increments in the reverse order."""
    since, angle, velocity, _ = _arrays(r)
    during = _during(since, onset_s, size)
    angle[during], velocity[during] = angle[during][::-1].copy(), velocity[during][::-1].copy()
    return _unit(r, angle_rad=angle, velocity_mps=velocity)


def _step(*, gyroscope: bool, axis: int, ramp: bool = False) -> Callable[[Recording, float, float], Recording]:
    def changed(r: Recording, size: float, onset_s: float) -> Recording:
        since, angle, velocity, interval = _arrays(r)
        after = np.maximum(since - onset_s, 0.0) if ramp else (since >= onset_s)
        (angle if gyroscope else velocity)[:, axis] += size * after * interval
        return _unit(r, angle_rad=angle, velocity_mps=velocity)

    return changed


def _scale(*, gyroscope: bool) -> Callable[[Recording, float, float], Recording]:
    def changed(r: Recording, size: float, onset_s: float) -> Recording:
        since, angle, velocity, _ = _arrays(r)
        (angle if gyroscope else velocity)[since >= onset_s] *= 1 + size
        return _unit(r, angle_rad=angle, velocity_mps=velocity)

    return changed


def _noise(r: Recording, size: float, onset_s: float) -> Recording:
    """White noise of a multiple of what the filter declares."""
    since, angle, velocity, interval = _arrays(r)
    draw = np.random.default_rng(0)
    factor = size * np.sqrt(interval) * (since >= onset_s)
    angle += draw.normal(size=angle.shape) * (r.model.gyroscope.white * factor)[:, None]
    velocity += draw.normal(size=velocity.shape) * (r.model.accelerometer.white * factor)[:, None]
    return _unit(r, angle_rad=angle, velocity_mps=velocity)


def _pulse(r: Recording, size: float, onset_s: float) -> Recording:
    since, angle, velocity, interval = _arrays(r)
    velocity[:, 0] += 49.0 * _during(since, onset_s, size) * interval
    return _unit(r, angle_rad=angle, velocity_mps=velocity)


def _clip(r: Recording, size: float, onset_s: float) -> Recording:
    since, angle, velocity, interval = _arrays(r)
    most = np.where(since >= onset_s, size, np.inf)[:, None] * interval[:, None]
    return _unit(r, angle_rad=angle, velocity_mps=np.clip(velocity, -most, most))


def _clock(direction: float) -> Callable[[Recording, float, float], Recording]:
    def changed(r: Recording, size: float, onset_s: float) -> Recording:
        time_ns = np.array(r.imu.time_ns)
        time_ns[r.since_s(time_ns) >= onset_s] += round(direction * size * SECOND_NS)
        return _unit(r, time_ns=time_ns)

    return changed


def _drift(r: Recording, size: float, onset_s: float) -> Recording:
    time_ns = np.array(r.imu.time_ns)
    late = np.maximum(r.since_s(time_ns) - onset_s, 0.0)
    return _unit(r, time_ns=time_ns + np.round(size * late * SECOND_NS).astype(np.int64))


def _moved(r: Recording, east_m: Floats) -> Recording:
    position = np.array(r.fixes.position, dtype=float)
    position[:, 1] += east_m / r.metres[1]
    return _fixes(r, position=position)


def _fix_step(r: Recording, size: float, onset_s: float) -> Recording:
    return _moved(r, np.where(r.since_s(r.fixes.time_ns) >= onset_s, size, 0.0))


def _fix_ramp(r: Recording, size: float, onset_s: float) -> Recording:
    return _moved(r, size * np.maximum(r.since_s(r.fixes.time_ns) - onset_s, 0.0))


def _every_second_fix(r: Recording, size: float, onset_s: float) -> Recording:
    since = r.since_s(r.fixes.time_ns)
    return _moved(r, np.where((since >= onset_s) & (np.arange(since.size) % 2 == 0), size, 0.0))


def _fix_late(r: Recording, size: float, onset_s: float) -> Recording:
    """The tags are later than the positions; what would run backwards stays as it is in the recording, in the order of its lines."""
    time_ns = np.array(r.fixes.time_ns)
    time_ns[r.since_s(time_ns) >= onset_s] += round(size * SECOND_NS)
    return _fixes(r, time_ns=time_ns)


def _fix_frozen(r: Recording, size: float, onset_s: float) -> Recording:
    during = _during(r.since_s(r.fixes.time_ns), onset_s, size)
    position = np.array(r.fixes.position, dtype=float)
    if during.any():
        position[during] = position[np.flatnonzero(during)[0]]
    return _fixes(r, position=position)


def _fix_index(r: Recording, index: NDArray[np.int64]) -> Recording:
    f, n = r.fixes, np.asarray(r.fixes.time_ns).size
    taken = {
        name: np.broadcast_to(np.asarray(value, dtype=float), (n, *np.shape(value)[1:]))[index]
        for name, value in vars(f).items()
        if name != "time_ns" and value is not None
    }
    return _fixes(r, time_ns=np.asarray(f.time_ns)[index], **taken)


def _fix_outage(r: Recording, size: float, onset_s: float) -> Recording:
    return _fix_index(r, np.flatnonzero(~_during(r.since_s(r.fixes.time_ns), onset_s, size)))


def _fix_repeated(r: Recording, size: float, onset_s: float) -> Recording:
    since = r.since_s(r.fixes.time_ns)
    return _fix_index(r, np.repeat(np.arange(since.size), np.where(_during(since, onset_s, size), 20, 1)))


def _fix_sigma(r: Recording, size: float, onset_s: float) -> Recording:
    small = np.where(r.since_s(r.fixes.time_ns) >= onset_s, size**-2, 1.0)
    return _fixes(r, covariance_enu_m2=np.asarray(r.fixes.covariance_enu_m2) * small[:, None, None])


def _declared(factor: float, r: Recording) -> Recording:
    noises = (replace(n, white=n.white * factor, bias=n.bias * factor) for n in (r.model.gyroscope, r.model.accelerometer))
    return replace(r, model=ins.ImuModel(*noises))


LENGTHS_S = (0.1, 0.5, 1.0, 10.0, 60.0, 1e4)
DURATIONS_S = (1.0, 3.0, 10.0, 30.0, 100.0, 1e4)
CLOCKS_S = (0.05, 0.1, 0.3, 1.0, 10.0, 120.0)
FORCES = (0.05, 0.2, 0.5, 2.0, 10.0, 50.0)
RATES = (1e-4, 1e-3, 1e-2, 0.1, 1.0, 5.0)
METRES = (3.0, 10.0, 30.0, 100.0, 300.0, 3000.0)

KINDS = (
    Kind("imu-nan", "inertial", "s", LENGTHS_S, _samples(_set(np.nan))),
    Kind("imu-zeros", "inertial", "s", DURATIONS_S, _samples(_set(0.0))),
    Kind("imu-silent", "inertial", "s", LENGTHS_S, _without),
    Kind("imu-frozen", "inertial", "s", DURATIONS_S, _samples(_freeze(gyroscopes=True, accelerometers=True))),
    Kind("imu-frozen-gyroscopes", "inertial", "s", DURATIONS_S, _samples(_freeze(gyroscopes=True, accelerometers=False))),
    Kind("imu-frozen-accelerometers", "inertial", "s", DURATIONS_S, _samples(_freeze(gyroscopes=False, accelerometers=True))),
    Kind("imu-swapped-axes", "inertial", "s", DURATIONS_S, _samples(_swap)),
    Kind("imu-repeated", "inertial", "s", DURATIONS_S, _doubled),
    Kind("imu-reversed", "inertial", "s", DURATIONS_S, _reversed),
    *(Kind(f"accelerometer-{name}-step", "inertial", "m/s²", FORCES, _step(gyroscope=False, axis=k)) for k, name in enumerate("xyz")),
    *(Kind(f"gyroscope-{name}-step", "inertial", "rad/s", RATES, _step(gyroscope=True, axis=k)) for k, name in enumerate("xyz")),
    Kind("accelerometer-ramp", "inertial", "m/s³", (1e-4, 1e-3, 1e-2, 0.1, 0.3, 1.0), _step(gyroscope=False, axis=0, ramp=True)),
    Kind("gyroscope-ramp", "inertial", "rad/s²", (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1), _step(gyroscope=True, axis=2, ramp=True)),
    Kind("accelerometer-scale", "inertial", "1", (0.003, 0.01, 0.03, 0.1, 0.3, 1.0), _scale(gyroscope=False)),
    Kind("gyroscope-scale", "inertial", "1", (0.003, 0.01, 0.03, 0.1, 0.3, 1.0), _scale(gyroscope=True)),
    Kind("imu-noise", "inertial", "1", (3.0, 10.0, 30.0, 100.0, 300.0, 1000.0), _noise),
    Kind("imu-pulse-5g", "inertial", "s", (0.1, 0.3, 1.0, 3.0, 10.0, 60.0), _pulse),
    Kind("imu-clip", "inertial", "m/s²", (1.0, 5.0, 9.0, 9.6, 9.80665, 10.5), _clip),
    Kind("imu-clock-back", "inertial", "s", CLOCKS_S, _clock(-1.0)),
    Kind("imu-clock-ahead", "inertial", "s", CLOCKS_S, _clock(1.0)),
    Kind("imu-clock-drift", "inertial", "s/s", (1e-5, 1e-4, 1e-3, 1e-2, 0.05, 0.1), _drift),
    Kind("unit-declared-too-good", "tuning", "1", (2.0, 3.0, 10.0, 30.0, 100.0, 300.0), lambda r, k, _s: _declared(1.0 / k, r)),
    Kind("unit-declared-too-bad", "tuning", "1", (2.0, 3.0, 10.0, 30.0, 100.0, 300.0), lambda r, k, _s: _declared(k, r)),
    Kind("fix-step", "receiver", "m", METRES, _fix_step),
    Kind("fix-ramp", "receiver", "m/s", (0.01, 0.1, 0.3, 1.0, 10.0, 100.0), _fix_ramp),
    Kind("every-second-fix", "receiver", "m", METRES, _every_second_fix),
    Kind("fix-late", "receiver", "s", (0.1, 0.2, 0.5, 1.0, 2.0, 5.0), _fix_late),
    Kind("fix-frozen", "receiver", "s", DURATIONS_S, _fix_frozen),
    Kind("fix-repeated", "receiver", "s", DURATIONS_S, _fix_repeated),
    Kind("fix-outage", "receiver", "s", DURATIONS_S, _fix_outage),
    Kind("fix-sigma-too-small", "receiver", "1", (1.5, 2.0, 3.0, 10.0, 30.0, 100.0), _fix_sigma),
    Kind(
        "outage-and-accelerometer",
        "pair",
        "m/s²",
        FORCES,
        lambda r, a, s: _fix_outage(_step(gyroscope=False, axis=0)(r, a, s), 60.0, s),
    ),
    Kind("step-of-fix-and-nan", "pair", "m", METRES, lambda r, m, s: _fix_step(_samples(_set(np.nan))(r, 1e4, s), m, s + 20.0)),
)
"""Every kind; single faults before pairs."""


def counts(recording: Recording, onset_s: float) -> dict[str, float | str]:
    """Run the filter and count; there is no path, hence no alert."""
    aiding = ins.Aiding(fixes=recording.fixes)
    fused = ins.fuse(recording.imu, aiding, recording.start, imu_model=recording.model, output_period_s=OUTPUT_S)
    truth = np.column_stack([np.interp(fused.time_ns, recording.truth_ns, recording.truth[:, k]) for k in range(3)])
    error = (np.asarray(fused.position) - truth) * recording.metres
    horizontal, vertical = promised(fused.covariance_enu_m2, fused.hpl_m, fused.vpl_m)
    outcome = Outcome(
        since_s=recording.since_s(fused.time_ns),
        period_s=OUTPUT_S,
        ok=np.array(fused.status) == "ok",
        error_h_m=np.hypot(error[:, 0], error[:, 1]),
        error_u_m=np.abs(error[:, 2]),
        horizontal_m=horizontal,
        vertical_m=vertical,
        reasons=[" ".join(reasons) for reasons in fused.reasons],
    )
    return outcome.counted(onset_s, (fused.time_ns >= recording.truth_ns[0]) & (fused.time_ns <= recording.truth_ns[-1]))


def run(
    recordings: Sequence[Recording],
    *,
    kinds: Sequence[str] | None = None,
    sizes: Sequence[int] = range(6),
    onsets: Sequence[int] = range(len(ONSETS)),
) -> Study:
    """Run the filter on every recording with every fault.

    Parameters
    ----------
    recordings : sequence of Recording
        Each stands for a flight.
    kinds : sequence of str, optional
        Ids of `KINDS`; all without it.
    sizes, onsets : sequence of int, optional
        Places in the sizes of a kind and in `ONSETS`. [1]

    Returns
    -------
    Study
        A row for each kind and size; no alerts are counted, and the hours are those of the recordings without a fault.

    Raises
    ------
    InputError
        An unknown kind.
    """
    by_id = {kind.id: kind for kind in KINDS}
    names = list(by_id) if kinds is None else list(kinds)
    for name in names:
        if name not in by_id:
            raise InputError("kinds", name, domain=f"one of {', '.join(by_id)}")
    ends_s = [float(r.since_s(r.truth_ns)[-1]) for r in recordings]
    rows = [((HEALTHY, "none", "", float("nan")), [counts(r, end) for r, end in zip(recordings, ends_s, strict=True)])]
    for kind in (by_id[name] for name in names):
        for size in (kind.sizes[place] for place in sizes):
            cut = [(r, ONSETS[onset] * end) for onset in onsets for r, end in zip(recordings, ends_s, strict=True)]
            if kind.family == "tuning":
                cut = [(r, 0.0) for r in recordings]
            tables = [counts(kind.change(r, size, onset_s), onset_s) for r, onset_s in cut]
            rows.append(((kind.id, kind.family, kind.unit, size), tables))
    return summed([(key, pl.DataFrame(table)) for key, table in rows], flights=len(recordings), n_tiles=len(rows))
