"""Error Extraction: a velocity-aided smoother of SBAS positions and its bound; **experimental, not integrity**.

Source: Vassilev and Vassileva 2012 (Annual of Navigation 19, part 2). What is printed, re-derived and ours, and where the bound fails,
stands in docs/methods/error-extraction.md.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Literal

import numpy as np
import polars as pl

from navbound import _core
from navbound.errors import InputError
from navbound.methods import EXTRACTION_LABEL, EXTRACTION_MARK
from navbound.sbas.gains import extraction_gains, whole
from navbound.table.arguments import checked
from navbound.table.arrays import flatten, unflatten

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

_DECLARED = _core.ee_declaration()


_RESETS = np.array(["", "start", "gap", "satellites"])


@dataclass(frozen=True)
class ErrorExtraction:
    """What Error Extraction makes of a series of positions: **experimental, not integrity**.

    Arrays have the shape of the epochs. Lengths are NaN where there is no solution; sums and bounds also until the window is full.

    Attributes
    ----------
    ee_error_enu_m : ndarray, shape (..., 3)
        Extracted error u. [m]
    ee_position_enu_m : ndarray, shape (..., 3)
        Corrected position, the given one minus u. [m]
    ee_size_h_m, ee_size_v_m : ndarray
        E, the size of the error. [m]
    ee_sum_h_m, ee_sum_v_m : ndarray
        S, the weighted sum of E over the window. [m]
    ee_noise_h_m, ee_noise_v_m : ndarray
        Noise part of the bound. [m]
    ee_bound_h_m, ee_bound_v_m : ndarray
        EE bound (experimental, not integrity): noise part plus bias part; NaN also without a bias part. [m]
    n_ee_age : ndarray of int
        Samples since the last reset; -1 without a solution.
    reset : ndarray of str
        Why the filter began anew here: ``start``, ``gap``, ``satellites``, or empty.
    new_satellites : ndarray of bool
        The set of satellites is another than at the solution before.
    status : ndarray of str
        ``ok``; ``degraded`` while the filter warms up (age below ``n_warm_up``); ``not_available`` without a solution.
    period_s : float
        Nominal sample period that was used. [s]
    n_warm_up : int
        Samples after which the answer to a step stays below 1 %.
    beta : float
        Factor from sd(u) to sd(position error) that was assumed.
    label : str
        What stands beside every number here.
    may_alert : bool
        Always False.
    """

    ee_error_enu_m: Floats
    ee_position_enu_m: Floats
    ee_size_h_m: Floats
    ee_size_v_m: Floats
    ee_sum_h_m: Floats
    ee_sum_v_m: Floats
    ee_noise_h_m: Floats
    ee_noise_v_m: Floats
    ee_bound_h_m: Floats
    ee_bound_v_m: Floats
    n_ee_age: NDArray[np.int64]
    reset: NDArray[np.str_]
    new_satellites: NDArray[np.bool_]
    status: NDArray[np.str_]
    period_s: float
    n_warm_up: int
    beta: float
    label: str = field(default=EXTRACTION_LABEL, init=False)
    may_alert: bool = field(default=bool(_DECLARED["may_alert"]), init=False)

    @property
    def n_resets(self) -> int:
        """How often the filter began anew, the starts included."""
        return int(np.count_nonzero(self.reset != ""))

    def table(self) -> pl.DataFrame:
        """Columns of docs/notation.md, each with the mark ``ee_``; null where there is no number.

        Raises
        ------
        InputError
            More than one series.
        """
        if self.n_ee_age.ndim != 1:
            raise InputError("series", f"shape {self.n_ee_age.shape}", domain="one series, shape (n,)")
        axes = {f"ee_error_{axis}_m": self.ee_error_enu_m[:, k] for k, axis in enumerate("enu")}
        lengths = {f.name: getattr(self, f.name) for f in fields(self) if f.name.startswith(EXTRACTION_MARK) and "_enu_" not in f.name}
        return pl.DataFrame(axes | lengths).with_columns(pl.all().fill_nan(None)).with_columns(pl.Series("n_ee_age", self.n_ee_age))


@checked
def error_extraction(
    time_ns: ArrayLike,
    position_enu_m: ArrayLike,
    velocity_enu_mps: ArrayLike,
    *,
    bias_h_m: ArrayLike | None = None,
    bias_v_m: ArrayLike | None = None,
    satellites: ArrayLike | None = None,
    rho: float = 0.98,
    window: int = 50,
    weight: float = 0.5,
    beta: float = 1.2,
    horizontal_beta: Literal["outside", "printed"] = "outside",
    noise_bound: Literal["cfar_sum", "as_printed"] = "cfar_sum",
    risk_h: float = 1e-9,
    risk_v: float = 5e-8,
    period_s: float | None = None,
    gap_most_s: float | None = None,
    reset_on_new_satellites: bool = False,
) -> ErrorExtraction:
    """Split off the fast part of the position error, and bound what is left: **experimental, not integrity**.

    The filter is a second-order complementary one of position with velocity (Vassilev 2012, equations 2 to 4); the bound is a weighted
    sum of the latest extracted errors (equations 5 and 6, read as ``noise_bound`` and ``horizontal_beta`` say) plus a bias part.

    Parameters
    ----------
    time_ns : array_like of int, shape (..., n)
        GPS time, increasing. [ns]
    position_enu_m : array_like, shape (..., n, 3)
        Position east, north, up of a fixed point near by; NaN where there is none. [m]
    velocity_enu_mps : array_like, shape (..., n, 3)
        Velocity of the same instants from Doppler or time-differenced phase, not a filter's output; NaN where there is none. [m/s]
    bias_h_m, bias_v_m : array_like, shape (..., n), optional
        Bias part of the bound: :func:`extraction_bias` or :func:`extraction_bias_dop`. Without it there is no bound, only its noise
        part. [m]
    satellites : array_like of int, shape (..., n), optional
        Anything not negative that changes when the set of satellites does, for instance a bit mask.
    rho : float
        Pole of the filter, in (0, 1).
    window : int
        Samples in the window, even, 2 to 1024.
    weight : float
        Weight of the older half, in [0, 1]; the newer half has 2 - weight.
    beta : float
        Factor from sd(u) to sd(position error). 1.2 is the paper's at rho 0.98, right for errors that forget in 15.7 s at 1 Hz; see
        :func:`extraction_beta`.
    horizontal_beta : {"outside", "printed"}
        beta outside the root, as in the vertical, or under it, as equation 6 prints.
    noise_bound : {"cfar_sum", "as_printed"}
        The multiplier on the sum, where it belongs, or on the mean, as equation 5 prints.
    risk_h, risk_v : float
        Stated risks. They are not held (docs/methods/error-extraction.md).
    period_s : float, optional
        Nominal sample period; the median step if not given. [s]
    gap_most_s : float, optional
        Longest step over which the state is carried; three periods if not given. [s]
    reset_on_new_satellites : bool
        Begin anew when the satellites change.

    Returns
    -------
    ErrorExtraction
        With ``may_alert`` False.

    Raises
    ------
    InputError
        A number outside its domain, times that do not increase, shapes that do not fit, a reading that does not exist.
    """
    _check_choice("horizontal_beta", horizontal_beta, ("outside", "printed"))
    _check_choice("noise_bound", noise_bound, ("cfar_sum", "as_printed"))
    instants = whole("time_ns", time_ns, "whole nanoseconds")
    nothing = np.nan
    shape, (_, position, velocity, bias_h, bias_v) = flatten(
        time_ns=(np.zeros(instants.shape), ()),
        position_enu_m=(position_enu_m, (3,)),
        velocity_enu_mps=(velocity_enu_mps, (3,)),
        bias_h_m=(nothing if bias_h_m is None else bias_h_m, ()),
        bias_v_m=(nothing if bias_v_m is None else bias_v_m, ()),
    )
    if not shape or shape[-1] == 0:
        raise InputError("time_ns", f"shape {instants.shape}", domain="shape (..., n) with at least one epoch")
    instants = np.ascontiguousarray(np.broadcast_to(instants, shape)).astype(np.int64)
    period = _median_step_s(instants) if period_s is None else float(period_s)
    extracted = _core.ee_extract(
        {
            "epochs": shape[-1],
            "time_ns": instants.reshape(-1),
            "position": position,
            "velocity": velocity,
            "satellites": _sets(satellites, shape),
            "bias": np.column_stack([bias_h, bias_v]),
            "rho": float(rho),
            "period_s": period,
            "gap_most_s": float(_DECLARED["gap_periods"]) * period if gap_most_s is None else float(gap_most_s),
            "reset_on_new_satellites": reset_on_new_satellites,
            "window": int(whole("window", window, "a whole number")),
            "weight": float(weight),
            "beta": float(beta),
            "horizontal_printed": horizontal_beta == "printed",
            "noise_printed": noise_bound == "as_printed",
            "risk_h": float(risk_h),
            "risk_v": float(risk_v),
        }
    )
    n_warm_up = extraction_gains(rho).n_settle_1_percent
    age = extracted["age"]
    status = np.where(age < 0, "not_available", np.where(age < n_warm_up, "degraded", "ok"))
    error = extracted["error"]
    return ErrorExtraction(
        ee_error_enu_m=unflatten(error, shape),
        ee_position_enu_m=unflatten(position - error, shape),
        ee_size_h_m=unflatten(extracted["size_h"], shape),
        ee_size_v_m=unflatten(extracted["size_v"], shape),
        ee_sum_h_m=unflatten(extracted["sum_h"], shape),
        ee_sum_v_m=unflatten(extracted["sum_v"], shape),
        ee_noise_h_m=unflatten(extracted["noise_h"], shape),
        ee_noise_v_m=unflatten(extracted["noise_v"], shape),
        ee_bound_h_m=unflatten(extracted["bound_h"], shape),
        ee_bound_v_m=unflatten(extracted["bound_v"], shape),
        n_ee_age=age.reshape(shape),
        reset=_RESETS[extracted["reset"]].reshape(shape),
        new_satellites=extracted["new_satellites"].reshape(shape),
        status=status.reshape(shape),
        period_s=period,
        n_warm_up=int(n_warm_up),
        beta=float(beta),
    )


def _check_choice(name: str, value: str, choices: tuple[str, ...]) -> None:
    if value not in choices:
        raise InputError(name, repr(value), domain=", ".join(choices))


def _sets(satellites: ArrayLike | None, shape: tuple[int, ...]) -> NDArray[np.uint64] | None:
    if satellites is None:
        return None
    sets = whole("satellites", satellites, "whole numbers that are not negative")
    if sets.dtype.kind == "i" and (sets < 0).any():
        raise InputError("satellites", int(sets.min()), domain="whole numbers that are not negative")
    try:
        return np.ascontiguousarray(np.broadcast_to(sets, shape)).reshape(-1).astype(np.uint64)
    except ValueError as e:
        raise InputError("satellites", f"shape {sets.shape}", domain=f"shapes that broadcast with {shape}") from e


def _median_step_s(instants: NDArray[np.int64]) -> float:
    if instants.shape[-1] < 2:
        raise InputError("period_s", "nothing", domain="a number of seconds where there is one epoch only")
    return float(np.median(np.diff(instants, axis=-1))) / 1e9
