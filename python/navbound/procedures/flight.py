"""One flight against a procedure: results by leg, and the three answers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from navbound import evaluation
from navbound.errors import InputError
from navbound.procedures.legs import Followed, Procedure
from navbound.procedures.strays import ASTRAY, JUDGED, follow
from navbound.table.arguments import checked
from navbound.table.arrays import flatten
from navbound.units import METRES_PER_NM
from navbound.words.plurals import counted

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

CONFIDENCE = 0.95


@dataclass(frozen=True)
class Limits:
    """What following goes by (INFERRED, all of them).

    Attributes
    ----------
    sigma_along_m : float
        Standard deviation of positions along the track; a foot may go back by less than three of it. [m]
    gap_s : float
        After so long without a position the leg is sought again. [s]
    nearer_s : float
        The next leg must be nearer for so long. [s]
    established_s, established_rad : float
        So long within the RNP and within this angle of the course is established. [s], [rad]
    bank_rad : float
        Bank of a nominal fly-by turn: the design bank of RNP AR criteria. [rad]
    """

    sigma_along_m: float = 10.0
    gap_s: float = 30.0
    nearer_s: float = 3.0
    established_s: float = 10.0
    established_rad: float = math.radians(30.0)
    bank_rad: float = math.radians(18.0)

    def __post_init__(self) -> None:
        for name, value in self.__dict__.items():
            if not 0 < value < math.inf:
                raise InputError(name, value, domain="(0, inf)")

    @property
    def values(self) -> tuple[float, float, float, float, float, float]:
        """In the order of the core."""
        return (self.sigma_along_m, self.gap_s, self.nearer_s, self.established_s, self.established_rad, self.bank_rad)


@dataclass(frozen=True)
class LegResult:
    """A flight on one leg.

    Attributes
    ----------
    leg : int
        Index in ``Procedure.legs``.
    fix, terminator, rnp_origin : str
        Its name, type, and where its RNP comes from.
    rnp_m, length_m : float
        Its RNP (NaN where it is unknown) and length. [m]
    n, n_transition : int
        Positions judged, and those in fly-by turns, which are not. [1]
    duration_s : float
        Time from the first to the last of them. [s]
    mean_m, rms_m, p95_m, max_abs_m : float
        Deviation of the recorded positions: mean, root mean square, 95 % of the sizes, largest size; NaN without positions. [m]
    n_inside, n_inside_twice : int
        Positions inside RNP and inside twice RNP; 0 of a leg without an RNP. [1]
    worst_time_s, worst_along_m : float
        When and where along the procedure the deviation was largest. [s], [m]
    """

    leg: int
    fix: str
    terminator: str
    rnp_origin: str
    rnp_m: float
    length_m: float
    n: int
    n_transition: int
    duration_s: float
    mean_m: float
    rms_m: float
    p95_m: float
    max_abs_m: float
    n_inside: int
    n_inside_twice: int
    worst_time_s: float
    worst_along_m: float


@dataclass(frozen=True)
class Flight:
    """A flight on a procedure.

    Attributes
    ----------
    followed : Followed
        Feet and status of every position.
    legs : tuple of LegResult
        Results of the legs with positions.
    n_status : dict
        Positions by status. [1]
    first_time_s : float
        From when on it was judged; NaN if never. [s]
    n, n_inside, n_inside_twice, n_without_rnp : int
        Positions on legs with an RNP, those of them inside RNP and inside twice RNP, and positions on legs without one. [1]
    n_effective : float
        How many independent positions they are worth. [1]
    most_exceeding : float
        Largest share outside RNP that no exceedance in so many positions leaves open at 95 % confidence; NaN where there was one. [1]
    """

    followed: Followed
    legs: tuple[LegResult, ...]
    n_status: dict[str, int]
    first_time_s: float
    n: int
    n_inside: int
    n_inside_twice: int
    n_without_rnp: int
    n_astray: int
    n_effective: float
    most_exceeding: float

    @property
    def verdict(self) -> str:
        """What the recorded positions say, in one sentence."""
        if self.n == 0:
            return "not shown: no position on a leg with an RNP"
        if self.n_inside == self.n and self.n_astray:
            return (
                f"recorded positions within RNP at every position judged, {counted(self.n_astray, 'position')} off the path could "
                "not be judged"
            )
        if self.n_inside == self.n:
            return "recorded positions within RNP at every position judged"
        twice = "within twice RNP" if self.n_inside_twice == self.n else "not within twice RNP"
        return f"not within RNP; {twice}"

    @property
    def words(self) -> list[str]:
        """The answers to whether the flight was inside, without a bound of the total error."""
        counts = f"inside RNP at {self.n_inside} of {self.n}, inside twice RNP at {self.n_inside_twice} of {self.n}"
        a = f"Recorded positions: {counts}; {self.verdict}."
        if self.n == 0:
            return [a]
        c = f"What the data can decide: {counted(self.n, 'position is', 'positions are')} worth {self.n_effective:.1f} independent ones"
        if math.isfinite(self.most_exceeding):
            c += f"; without an exceedance they leave open a share outside RNP of up to {self.most_exceeding:.2g} at 95 % confidence"
        return [a, f"{c}. One flight cannot show 1e-5."]


@checked
def judge(procedure: Procedure, time_s: ArrayLike, lat_rad: ArrayLike, lon_rad: ArrayLike, limits: Limits | None = None) -> Flight:
    """Deviation of one flight from a procedure, leg by leg (ours).

    Judged is every position from the first established one to the end of the procedure, and what strays from the path there as well.
    Those in fly-by turns, where no single path is defined, are counted apart, and so are those on legs without an RNP.

    Parameters
    ----------
    procedure : Procedure
        From :func:`navbound.path.procedure`.
    time_s : array_like, shape (n,)
        Rising times. [s]
    lat_rad, lon_rad : array_like, shape (n,)
        Recorded positions, WGS-84; both NaN for a missing one. [rad]
    limits : Limits, optional
        What following goes by (INFERRED).

    Raises
    ------
    InputError
        A time that does not rise, or a position that is not on the Earth.
    """
    _, (time, lat, lon) = flatten(time_s=(time_s, ()), lat_rad=(lat_rad, ()), lon_rad=(lon_rad, ()))
    followed, flights = follow(procedure, time, (lat, lon), limits)
    due = np.zeros(time.size, dtype=np.bool_)
    for flight in flights:
        due[flight.first : flight.last + 1] = True
    return results(procedure, followed, time, due)


def results(procedure: Procedure, followed: Followed, time_s: NDArray[np.float64], due: NDArray[np.bool_]) -> Flight:
    """Results by leg of positions already followed; `due` are those of a flight along the procedure."""
    judged = np.isin(followed.status, JUDGED)
    rnp = np.array([x.rnp_m for x in procedure.legs] or [np.nan])[followed.leg]
    known = judged & np.isfinite(rnp)
    size = np.abs(followed.cross_m)
    inside, twice = known & (size <= rnp), known & (size <= 2 * rnp)
    n = int(known.sum())
    effective = evaluation.effective_size(followed.cross_m[known]) if n > 1 else float(n)
    open_share = 1.0 - (1.0 - CONFIDENCE) ** (1.0 / effective) if n and inside.sum() == n else math.nan
    present = sorted(set(followed.leg[followed.leg >= 0].tolist()))
    names, counts = np.unique(followed.status, return_counts=True)
    return Flight(
        followed=followed,
        legs=tuple(_leg(procedure, k, followed, time_s, (inside, twice)) for k in present),
        n_status=dict(zip(names.tolist(), counts.tolist(), strict=True)),
        first_time_s=float(time_s[judged][0]) if judged.any() else math.nan,
        n=n,
        n_inside=int(inside.sum()),
        n_inside_twice=int(twice.sum()),
        n_without_rnp=int((judged & ~np.isfinite(rnp)).sum()),
        n_astray=int((due & np.isin(followed.status, ASTRAY)).sum()),
        n_effective=effective,
        most_exceeding=open_share,
    )


def _leg(
    procedure: Procedure,
    index: int,
    followed: Followed,
    time_s: NDArray[np.float64],
    within: tuple[NDArray[np.bool_], NDArray[np.bool_]],
) -> LegResult:
    leg = procedure.legs[index]
    here = followed.leg == index
    on = here & np.isin(followed.status, JUDGED)
    cross, time, along = followed.cross_m[on], time_s[on], followed.along_m[on]
    worst = int(np.argmax(np.abs(cross))) if cross.size else -1
    return LegResult(
        leg=index,
        fix=leg.fix,
        terminator=leg.terminator,
        rnp_origin=leg.rnp_origin,
        rnp_m=leg.rnp_m,
        length_m=leg.length_m,
        n=int(on.sum()),
        n_transition=int((here & (followed.status == "transition")).sum()),
        duration_s=float(time[-1] - time[0]) if cross.size else 0.0,
        mean_m=float(cross.mean()) if cross.size else math.nan,
        rms_m=float(np.sqrt(np.mean(cross**2))) if cross.size else math.nan,
        p95_m=float(np.quantile(np.abs(cross), 0.95, method="higher")) if cross.size else math.nan,
        max_abs_m=float(np.abs(cross[worst])) if cross.size else math.nan,
        n_inside=int((on & within[0]).sum()),
        n_inside_twice=int((on & within[1]).sum()),
        worst_time_s=float(time[worst]) if cross.size else math.nan,
        worst_along_m=float(along[worst]) if cross.size else math.nan,
    )


def rnp_words(rnp_m: float) -> str:
    """An RNP on the screen."""
    return f"RNP {rnp_m / METRES_PER_NM:.3g}" if math.isfinite(rnp_m) else "RNP unknown"
