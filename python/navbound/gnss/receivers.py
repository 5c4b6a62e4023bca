"""Positions solved from receivers' files.

Broadcast orbits, clocks and group delays by the interface documents of the systems (standard); weights and residual test:
docs/methods/gnss-positions.md.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import polars as pl

from navbound import _core
from navbound.errors import InputError
from navbound.gnss.files import Navigation, Observations
from navbound.gnss.precise import PreciseOrbits
from navbound.gnss.signal_choice import smaller_covariance
from navbound.table.arguments import checked
from navbound.table.arrays import flatten
from navbound.table.columns import HEARD
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


SYSTEMS = {"G": "GPS", "E": "Galileo", "C": "BeiDou"}
"""Constellations a position can be solved from, by their letter."""

UNUSED: dict[str, str] = dict(_core.unused_reasons())
"""Why a satellite may not be in a solution: the id of tables, and its words."""

FATES: dict[str, str] = dict(_core.satellite_fates()) | UNUSED
"""What may become of a satellite that was heard: the id of tables, and its words."""

USED = next(iter(FATES))
"""The id of a satellite in the position."""

SIGNALS = ("auto", "single", "dual")
"""Which pseudoranges make a range."""

IONOSPHERES = ("auto", "broadcast", "galileo", "climatology", "none")
"""Models of the ionosphere that single pseudoranges can use."""


MASK_RAD = float(np.radians(5.0))
"""Lowest elevation of satellites that positions are solved from, where none is named: that of the common engines and of the airborne
standards (DO-229), so that positions compare with theirs. [rad]"""


@dataclass(frozen=True)
class Positions:
    """Solved positions and what they rest on.

    Attributes
    ----------
    epochs : DataFrame
        The epoch table (docs/notation.md): ``track``, ``time_ns``, ``est_lat_rad``, ``est_lon_rad``, ``est_h_m``, covariance,
        ``ground_speed_mps``, ``n_sv``, ``hdop``, ``vdop``, ``status``, ``reason``, with truth also ``truth_*`` and ``nse_*``; beyond it
        ``vel_e_mps``, ``vel_n_mps``, ``vel_u_mps``, ``n_excluded``, ``n_redundant``, ``p_residual``. Null where there is none.
    unused : dict of str to int
        Satellite-epochs of the requested systems that were not used, by the id of the reason in :data:`UNUSED`.
    codes : dict of str to list of str
        Pseudoranges used, by system, in order of preference.
    models : dict of str to str
        Every model by name, for the record of a run.
    ranges : DataFrame, optional
        The ranges of each position: ``time_ns``, ``sv``, ``az_rad``, ``el_rad``, ``sigma_m`` (of the covariance in force: a failed
        test and contradicting surroundings have widened it), ``residual_m`` (measured less computed at the position, receiver clock
        included), ``shared_1_m`` to ``shared_4_m`` (errors that all ranges have in common: the vertical ionosphere, its gradient east and
        north, the zenith troposphere). Where it was requested.
    used : DataFrame, optional
        Ranges by satellite: ``sv``, ``signals`` (``E1-E5a``), ``message`` whose orbit and clock were used, ``n_ranges``; those below the
        mask and those excluded afterwards are among them.
    heard : DataFrame, optional
        What became of every satellite heard at every epoch: the columns `navbound.table.columns.HEARD`. Where ranges were requested.
    """

    epochs: pl.DataFrame
    unused: dict[str, int]
    codes: dict[str, list[str]]
    models: dict[str, str]
    ranges: pl.DataFrame | None = None
    used: pl.DataFrame | None = None
    heard: pl.DataFrame | None = None


def used_satellites(rows: list[tuple[str, str, str, int]]) -> pl.DataFrame:
    """Ranges by satellite: ``sv``, ``signals``, ``message``, ``n_ranges``."""
    schema = {"sv": pl.String, "signals": pl.String, "message": pl.String, "n_ranges": pl.Int64}
    return pl.DataFrame(rows, schema=schema, orient="row")


def signal_words(used: pl.DataFrame) -> str:
    """Which signals and messages the ranges of each constellation are of, with their number."""
    system = pl.col("sv").str.slice(0, 1).alias("system")
    kinds = used.group_by(system, "signals", "message", maintain_order=True).agg(pl.col("n_ranges").sum(), pl.len().alias("n_sv"))
    each = [
        f"{SYSTEMS.get(system, system)} {signals} with {message} ({n_ranges} ranges of {n_sv} satellites)"
        for system, signals, message, n_ranges, n_sv in kinds.iter_rows()
    ]
    return "; ".join(each) or "none"


def unused_words(unused: dict[str, int]) -> str:
    """Satellite-epochs that were not used, by reason."""
    return "; ".join(f"{UNUSED[why]} at {count}" for why, count in unused.items()) or "none"


@checked
def solve(
    observations: Observations,
    navigation: Navigation,
    *,
    systems: str = "GEC",
    signals: Literal["auto", "single", "dual"] = "single",
    ionosphere: Literal["auto", "broadcast", "galileo", "climatology", "none"] = "auto",
    mask_rad: float = MASK_RAD,
    false_alarm: float = 1e-4,
    most_excluded: int = 6,
    range_factor: float = 1.0,
    shared_factor: float = 1.0,
    orbits: PreciseOrbits | None = None,
    smoothing_s: float | None = None,
    smoothing: Literal["hatch", "divergence-free"] = "divergence-free",
    truth_ecef_m: ArrayLike | None = None,
    track: str | None = None,
    keep_ranges: bool = False,
) -> Positions:
    """Positions of every epoch by robust weighted least squares on pseudoranges, with their covariance.

    Parameters
    ----------
    observations : Observations
        From :func:`read_observations`.
    navigation : Navigation
        From :func:`read_navigation`.
    systems : str, optional
        Letters of :data:`SYSTEMS`.
    signals : {"auto", "single", "dual"}, optional
        L1, E1, B1I; or ionosphere-free pairs: L1-L2; E1-E5a or E1-E5b, B1I-B3I or B1I-B2I, whichever the file and its broadcast messages
        serve more often, the same for all satellites of a constellation (docs/methods/gnss-positions.md); or of both solutions the one
        whose declared covariance is the smaller over the whole file.
    ionosphere : {"auto", "broadcast", "galileo", "climatology", "none"}, optional
        Model of single pseudoranges; pairs need none. ``broadcast``: the GPS message. ``galileo``: NTCM-G by Galileo's message.
        ``climatology``: NTCM-G at the long-run mean of solar activity. ``none``: no correction; its whole size is error. ``auto`` is the
        first of the first three that the navigation files have within two days of the observations.
    mask_rad : float, optional
        Lowest elevation, from 0 to below pi/2. Ranges from low satellites weigh less, by the noise, the troposphere and the ionosphere that
        they pass (docs/methods/gnss-positions.md). [rad]
    false_alarm : float, optional
        Risk of a false alarm of the residual test, an epoch. [1]
    most_excluded : int, optional
        Satellites that may be excluded in one epoch. [1]
    range_factor, shared_factor : float, optional
        Factors on the standard deviations of single ranges, and of the errors of the ionosphere that they share; other than 1 for a
        calibration of your own (docs/methods/gnss-positions.md). [1]
    orbits : PreciseOrbits, optional
        From :func:`read_orbits`: orbits and clocks instead of the broadcast ones. Health and group delays remain those broadcast.
        Positions are of mass centres: the antennas' offsets (0.5 to 3 m towards the Earth) are not applied.
    smoothing_s : float, optional
        Time constant of carrier smoothing; without it the pseudoranges are used as measured. The weights do not count on it. [s]
    smoothing : {"divergence-free", "hatch"}, optional
        Phase of two carriers, whose smoothing leaves the ionosphere as it is; or of one, which parts from the code as the ionosphere
        changes.
    truth_ecef_m : array_like, shape (3,) or (n_epochs, 3), optional
        True position, Earth-fixed; NaN where it is not known. [m]
    track : str, optional
        Name of the track; by default the marker's or the file's.
    keep_ranges : bool, optional
        Whether ``ranges`` and ``heard`` are filled.

    Returns
    -------
    Positions
        ``status`` is ``degraded`` where the residuals contradict the weights, where the ranges of the past minute do (several satellites
        excluded), where an exclusion cannot be confirmed or a fault could not be seen (the covariance then holds every reading of the
        ranges), where no range checks the others, and where no message describes the ionosphere; ``not_available`` where there is no
        position, or one that cannot be true: a height outside -1 to 100 km, a position dilution above 30, a jump
        (docs/methods/gnss-exclusion.md).

    Raises
    ------
    InputError
        Systems that are not there, a broadcast ionosphere that no file gives, numbers outside their domain, no epoch of measurements.
    """
    if not systems or any(s not in SYSTEMS for s in systems):
        raise InputError("systems", systems, domain=f"letters of {''.join(SYSTEMS)}")
    if signals not in SIGNALS:
        raise InputError("signals", signals, domain=", ".join(SIGNALS))
    if ionosphere not in IONOSPHERES:
        raise InputError("ionosphere", ionosphere, domain=", ".join(IONOSPHERES))
    if most_excluded < 0:
        raise InputError("most_excluded", most_excluded, "1", "[0, inf)")
    if smoothing not in {"hatch", "divergence-free"}:
        raise InputError("smoothing", smoothing, domain="hatch, divergence-free")
    observations.require_epochs()
    if signals == "auto":
        return smaller_covariance(
            lambda kind: solve(
                observations,
                navigation,
                systems=systems,
                signals=kind,  # type: ignore[arg-type]
                ionosphere=ionosphere,
                mask_rad=mask_rad,
                false_alarm=false_alarm,
                most_excluded=most_excluded,
                range_factor=range_factor,
                shared_factor=shared_factor,
                orbits=orbits,
                smoothing_s=smoothing_s,
                smoothing=smoothing,
                truth_ecef_m=truth_ecef_m,
                track=track,
                keep_ranges=keep_ranges,
            )
        )
    try:
        positions = _core.solve_positions(
            observations._core,
            navigation._core,
            systems,
            dual=signals == "dual",
            ionosphere=ionosphere,
            mask_rad=mask_rad,
            false_alarm=false_alarm,
            most_excluded=most_excluded,
            range_factor=range_factor,
            shared_factor=shared_factor,
            precise=None if orbits is None else orbits._core,
            smoothing_s=smoothing_s,
            divergence_free=smoothing == "divergence-free",
            keep_ranges=keep_ranges,
        )
    except LookupError as e:
        domain = "auto, climatology, none, dual signals, or navigation files with that message within two days of the observations"
        raise InputError("ionosphere", ionosphere, domain=domain) from e
    kept, heard = positions.pop("ranges"), positions.pop("heard")
    used = used_satellites(positions.pop("used"))
    unused, codes, weights = positions.pop("unused"), positions.pop("codes"), positions.pop("weights")
    share, model = positions.pop("smoothed_share"), positions.pop("ionosphere")
    compared = positions.pop("compared")
    name = track or observations.marker or observations.path.name
    columns = {"track": [name] * observations.n_epochs, "time_ns": observations.time_ns, **positions}
    epochs = pl.DataFrame(columns).with_columns(pl.col("reason", "reason_id").replace({"": None}))
    floats = [c for c, kind in epochs.schema.items() if kind == pl.Float64]
    epochs = epochs.with_columns(pl.col(floats).fill_nan(None))
    if truth_ecef_m is not None:
        epochs = with_errors(epochs, truth_ecef_m)
    models = {
        "orbits and clocks": _orbit_words(orbits),
        "signals": f"{'ionosphere-free pairs' if signals == 'dual' else 'one pseudorange'}: {signal_words(used)}",
        "smoothing": "none" if smoothing_s is None else f"{smoothing}, {smoothing_s:g} s; {100 * share:.1f} % of the pseudoranges",
        "ionosphere": "ionosphere-free pairs" if signals == "dual" else _ionosphere_words(*model),
        "mask": f"elevation {np.degrees(mask_rad):g} deg and more",
        "troposphere": "Saastamoinen, standard atmosphere, 50 % humidity; mapping of DO-229",
        "weights": weights if weights != "scaled" else f"calibrated-2020 times {range_factor:g} (ranges), {shared_factor:g} (shared)",
        "residual test": f"chi-square, false alarm {false_alarm:g} an epoch",
        "codes led off": compared_words(compared, observations.n_epochs),
    }
    ranges = None if kept is None else _with_times(kept, observations.time_ns)
    return Positions(epochs, unused, codes, models, ranges, used, _heard(heard, ranges, name, observations.time_ns))


def compared_words(compared: tuple[int, int], n_epochs: int) -> str:
    """At how many epochs codes were compared with their phases: at the others nothing shows that all of them are led off together."""
    n, n_dropped = compared
    dropped = (
        f"; hardly any phase went on {counted(n_dropped, 'time')} during a lead, and what it was before is not seen" if n_dropped else ""
    )
    return (
        f"codes compared with carrier phases at {n} of {counted(n_epochs, 'epoch')}; at the others a lead of all codes is not seen{dropped}"
    )


def _ionosphere_words(name: str, activity_sfu: float) -> str:
    """A model of the ionosphere as run records state it."""
    return {
        "broadcast": "Klobuchar, GPS message",
        "galileo": f"NTCM-G, Galileo message, effective ionisation level {activity_sfu:.0f} sfu",
        "climatology": f"climatology, no message: NTCM-G at {activity_sfu:.0f} +- 70 sfu; heights can be wrong by metres",
        "none": "none; its whole size counts as error",
    }[name]


def _with_times(kept: dict[str, Any], time_ns: NDArray[np.int64]) -> pl.DataFrame:
    instants = time_ns[kept.pop("epoch")]
    # A list without a satellite has no type.
    return pl.DataFrame({"time_ns": instants, **kept}, schema_overrides={name: pl.String for name in ("sv",) if name in kept})


def _heard(heard: dict[str, Any] | None, ranges: pl.DataFrame | None, track: str, time_ns: NDArray[np.int64]) -> pl.DataFrame | None:
    """Every satellite heard, with the residuals of those that were used.

    The weighted residuals of a constellation sum to nought beside its clock (normal equations of least squares), so the weighted mean of
    what the ranges keep is the clock.
    """
    if heard is None or ranges is None:
        return None
    every = _with_times(heard, time_ns).with_columns(pl.lit(track).alias("track"))
    of_used = ranges.select("time_ns", "sv", _without_clock(pl.col("sigma_m")), "sigma_m")
    joined = every.join(of_used, on=["time_ns", "sv"], how="left", maintain_order="left")
    return joined.select(column.name for column in HEARD).with_columns(pl.selectors.float().fill_nan(None))


def _without_clock(sigma_m: pl.Expr) -> pl.Expr:
    """Residuals less the clock of their constellation, by the ranges that have such a deviation. [m]."""
    weight = sigma_m**-2
    return pl.col("residual_m") - ((pl.col("residual_m") * weight).sum() / weight.sum()).over("time_ns", pl.col("sv").str.slice(0, 1))


def heard_by_monitor(heard: dict[str, Any] | None, track: str, time_ns: NDArray[np.int64]) -> pl.DataFrame | None:
    """Every satellite that a monitor heard, with the residuals of those that it tested; its clocks are those of the satellites it keeps."""
    if heard is None:
        return None
    every = _with_times(heard, time_ns).with_columns(pl.selectors.float().fill_nan(None), pl.lit(track).alias("track"))
    every = every.with_columns(_without_clock(pl.when(pl.col("fate") == USED).then("sigma_m")))
    return every.select(column.name for column in HEARD)


def _orbit_words(orbits: PreciseOrbits | None) -> str:
    if orbits is None:
        return "broadcast, nearest record inside its fit interval"
    step = "" if orbits.clock_step_s is None else f" every {orbits.clock_step_s:g} s"
    return (
        f"{', '.join(sorted(orbits.agencies))}: polynomial of order 10, mass centres; clocks of the {orbits.clock_source}{step}, linear; "
        "health and group delays broadcast"
    )


def with_errors(epochs: pl.DataFrame, truth_ecef_m: ArrayLike) -> pl.DataFrame:
    """The epochs with their truth, Earth-fixed, of shape (3,) or (n_epochs, 3) [m], and the error against it."""
    truth = np.asarray(truth_ecef_m, dtype=np.float64)
    if truth.shape not in {(3,), (epochs.height, 3)}:
        raise InputError("truth_ecef_m", f"shape {truth.shape}", domain=f"shape (3,) or ({epochs.height}, 3)")
    place = geodetic(np.broadcast_to(truth, (epochs.height, 3)))
    estimate = np.column_stack([epochs[c].fill_null(np.nan).to_numpy() for c in ("est_lat_rad", "est_lon_rad", "est_h_m")])
    error = _core.navigation_error(np.ascontiguousarray(estimate), place)
    names = ("truth_lat_rad", "truth_lon_rad", "truth_h_m", "nse_e_m", "nse_n_m", "nse_u_m")
    values = np.hstack([place, error])
    return epochs.hstack(pl.DataFrame({name: values[:, k] for k, name in enumerate(names)}).with_columns(pl.all().fill_nan(None)))


@checked
def geodetic(ecef_m: ArrayLike) -> NDArray[np.float64]:
    """Latitude, longitude and height of Earth-fixed positions, WGS-84.

    Parameters
    ----------
    ecef_m : array_like, shape (..., 3)
        Positions. [m]

    Returns
    -------
    ndarray, shape (..., 3)
        Latitude and longitude [rad], height above the ellipsoid [m]; NaN where a position holds a NaN.

    Raises
    ------
    InputError
        A position within 50 km of the Earth's centre, or an infinite one.
    """
    shape, (flat,) = flatten(ecef_m=(ecef_m, (3,)))
    return _core.geodetic_from_ecef(flat).reshape(*shape, 3)
