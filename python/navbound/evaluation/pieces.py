"""The evaluations of epochs that come in pieces, in order: with the bits of the whole, and one number an epoch in memory."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from navbound import _core
from navbound.evaluation import Magnitude, Nees, Pit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    _F = NDArray[np.float64]
    _Places = NDArray[np.uint32]

REPLICATES = 2000
"""Resamplings of :func:`navbound.evaluation.bootstrap_coverage`. [1]"""


class Bounds:
    """A bound against the error, as :func:`navbound.evaluation.bound`; see its arguments. What was seen is given away by the score."""

    def __init__(self) -> None:
        self._core = _core.BoundPieces()
        self.n = 0

    def see(self, error_m: _F, bound_m: _F, track: _Places) -> None:
        """The next epochs, with numbers of their tracks."""
        self.n += len(error_m)
        self._core.see(_plain(error_m), _plain(bound_m), track)

    def score(self, risk: float) -> dict[str, float]:
        """Fields of :class:`navbound.evaluation.BoundScore` but for the median."""
        return self._core.score(risk)


class Squares:
    """Normalised squares of the error, as :func:`navbound.evaluation.nees` and :func:`navbound.evaluation.pit`; either gives them away."""

    def __init__(self, dimension: int) -> None:
        self._core = _core.SquarePieces(dimension)

    def see(self, error_m: _F, covariance_m2: _F, track: _Places) -> None:
        """The next epochs: errors of shape (n, d), covariances of shape (n, d, d), numbers of tracks."""
        self._core.see(_plain(error_m).ravel(), _plain(covariance_m2).ravel(), track)

    def nees(self) -> Nees:
        """Their mean against its limits."""
        return Nees(**self._core.nees())

    def pit(self, n_bins: int = 20) -> Pit:
        """The histogram of their transform."""
        return Pit(**self._core.pit(n_bins))


class Sizes:
    """The horizontal error in units of its covariance, as :func:`navbound.evaluation.magnitude`, with the effective size of one axis."""

    def __init__(self, axis: int) -> None:
        self._core = _core.SizePieces(axis)

    def see(self, error_m: _F, covariance_m2: _F, track: _Places) -> None:
        """The next epochs: errors of shape (n, 2), covariances of shape (n, 2, 2), numbers of tracks."""
        self._core.see(_plain(error_m).ravel(), _plain(covariance_m2).ravel(), track)

    def magnitude(self) -> Magnitude:
        """Of what was seen, which is given away."""
        return Magnitude(**self._core.magnitude())


class Series:
    """A correlated series, as :func:`navbound.evaluation.effective_size`."""

    def __init__(self) -> None:
        self._core = _core.SeriesPieces()
        self.n = 0

    def see(self, values: _F, track: _Places) -> None:
        """The next values, with numbers of their tracks."""
        self.n += len(values)
        self._core.see(_plain(values), track)

    def effective_size(self, *, about_zero: bool = False) -> float:
        """Epochs that the mean of what was seen is worth; it is given away."""
        return self._core.effective_size(about_zero)


class TrackCounts:
    """Epochs within a bound, track by track, for :meth:`bootstrap`."""

    def __init__(self) -> None:
        self._n, self._n_within = np.zeros(0, dtype=np.uint64), np.zeros(0, dtype=np.uint64)
        self._all = 0

    def see(self, error_m: _F, bound_m: _F, track: _Places) -> None:
        """The next epochs, with numbers of their tracks."""
        judged = ~(np.isnan(error_m) | np.isnan(bound_m))
        self._all += len(error_m)
        length = max(len(self._n), int(track.max()) + 1 if len(track) else 0)
        self._n.resize(length, refcheck=False)
        self._n_within.resize(length, refcheck=False)
        self._n += np.bincount(track[judged], minlength=length).astype(np.uint64)
        self._n_within += np.bincount(track[judged & (np.abs(error_m) <= bound_m)], minlength=length).astype(np.uint64)

    @property
    def share(self) -> float:
        """Of the epochs within; one without a number is not."""
        return int(self._n_within.sum()) / self._all

    def bootstrap(self, n_replicates: int = REPLICATES, seed: int = 0) -> tuple[float, float]:
        """The interval of :func:`navbound.evaluation.bootstrap_coverage`."""
        return _core.bootstrap_coverage_of_counts(self._n, self._n_within, n_replicates, seed)


def _plain(values: _F) -> _F:
    return np.ascontiguousarray(values, dtype=np.float64)
