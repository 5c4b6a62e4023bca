"""The RNP-state classifier; public as `navbound.rnp.StateClassifier`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from navbound import _core
from navbound.errors import InputError
from navbound.table.arguments import checked
from navbound.table.arrays import flatten, unflatten
from navbound.units import METRES_PER_NM

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray


@checked
def nse_boundary(tse_m: ArrayLike, fte_m: ArrayLike) -> NDArray[np.float64]:
    """Navigation error (95 %) left of a total system error after the flight technical error, ``sqrt(tse² - fte²)``.

    Parameters
    ----------
    tse_m, fte_m : array_like, shape (...)
        95 % values; independent zero-mean Gaussian parts, no path definition error. [m]

    Returns
    -------
    ndarray, shape (...)
        [m]

    Raises
    ------
    InputError
        A value that is negative or not finite, or fte above tse: nothing is left then, and 0 would be a lie.
    """
    shape, (tse, fte) = flatten(tse_m=(tse_m, ()), fte_m=(fte_m, ()))
    return unflatten(_core.nse_boundary(tse, fte), shape)


class StateClassifier:
    """The RNP level a navigation error still supports (Ostroumov and Kuzmenko 2018, in a form that is safe).

    State ``k`` owns the errors up to ``boundary_m[k]``; the last is "out of RNP". Classes count from 0.

    Parameters
    ----------
    levels_nm : sequence of float
        RNP levels, tightest first, at most 12. [NM]
    fte_nm : float or sequence of float
        Flight technical error (95 %) of each level; the source's values are not known. [NM]
    require_order : bool
        Refuse levels for which the most likely state does not only get worse as the error grows. If False, such a classifier
        decides by threshold, and posteriors are only reported.

    Attributes
    ----------
    names : list of str
        ``"RNP 0.3"``, ..., ``"out of RNP"``.
    boundary_m : ndarray, shape (n,)
        Largest error of each level. [m]
    mean_m, sigma_m : ndarray, shape (n + 1,)
        Of each state's density. [m]
    density_at_boundary : ndarray, shape (n,)
        Density there, the neighbour's too. [1/m]
    ordered : bool
        Whether the most likely state may decide.

    Raises
    ------
    InputError
        Boundaries that do not increase, a step too wide for the densities to cross at the boundary, or an order that is broken.

    Notes
    -----
    With equal priors the most likely state is the threshold rule (docs/methods/rnp-state.md): what is gained is the graded posterior,
    priors and memory. As probabilities of the state use `probabilities`, which comes from the law of the error.
    """

    @checked
    def __init__(self, levels_nm: Sequence[float], fte_nm: float | Sequence[float] = 0.0, *, require_order: bool = True) -> None:
        shape, (levels, fte) = flatten(levels_nm=(levels_nm, ()), fte_nm=(fte_nm, ()))
        if len(shape) != 1:
            raise InputError("levels_nm", f"shape {shape}", domain="shape (n,)")
        boundary_m = nse_boundary(levels * METRES_PER_NM, fte * METRES_PER_NM)
        self._set(boundary_m, [f"RNP {level:g}" for level in levels], require_order)

    @classmethod
    @checked
    def of_boundaries(cls, boundary_m: ArrayLike, names: Sequence[str] | None = None, *, require_order: bool = True) -> StateClassifier:
        """Build the classifier of given boundaries of navigation error.

        Parameters
        ----------
        boundary_m : array_like, shape (n,)
            Strictly increasing. [m]
        names : sequence of str, optional
            Of the levels.
        require_order : bool
            As in the constructor.
        """
        shape, (boundary,) = flatten(boundary_m=(boundary_m, ()))
        if len(shape) != 1:
            raise InputError("boundary_m", f"shape {shape}", domain="shape (n,)")
        new = cls.__new__(cls)
        new._set(boundary, [f"within {b:g} m" for b in boundary] if names is None else list(names), require_order)
        return new

    def _set(self, boundary_m: NDArray[np.float64], names: list[str], require_order: bool) -> None:
        self._core = _core.RnpStates(boundary_m.tolist())
        if len(names) != len(boundary_m):
            raise InputError("names", len(names), "1", "one name a boundary")
        if require_order and not self._core.ordered:
            domain = "levels whose most likely state only gets worse as the error grows (require_order=False decides by threshold)"
            raise InputError("levels", ", ".join(names), domain=domain)
        self.names = [*names, "out of RNP"]
        self.boundary_m = self._core.boundary_m
        self.mean_m = self._core.mean_m
        self.sigma_m = self._core.sigma_m
        self.density_at_boundary = np.asarray(self._core.density_at_boundary, dtype=np.float64)
        self.ordered = self._core.ordered

    def log_posterior(self, nse_m: ArrayLike, prior: ArrayLike | None = None) -> NDArray[np.float64]:
        """Logarithm of each state's posterior; the last state's density is held at its peak beyond its mean.

        Parameters
        ----------
        nse_m : array_like, shape (...)
            Navigation error; its magnitude counts. [m]
        prior : array_like, shape (n + 1,), optional
            Equal if not given.

        Returns
        -------
        ndarray, shape (..., n + 1)
            NaN where the error is.
        """
        shape, (x,) = flatten(nse_m=(nse_m, ()))
        return unflatten(self._core.ln_posterior(x, _prior(prior)), shape)

    def posterior(self, nse_m: ArrayLike, prior: ArrayLike | None = None) -> NDArray[np.float64]:
        """Each state's posterior; arguments and shape as `log_posterior`, which keeps the digits of the unlikely states."""
        return np.exp(self.log_posterior(nse_m, prior))

    def log_posterior_as_printed(self, nse_m: ArrayLike, prior: ArrayLike | None = None) -> NDArray[np.float64]:
        """Give the same without holding the last state's density: an exhibit, unsafe where the last level is narrow."""
        shape, (x,) = flatten(nse_m=(nse_m, ()))
        return unflatten(self._core.ln_posterior_as_printed(x, _prior(prior)), shape)

    def classify(self, nse_m: ArrayLike, prior: ArrayLike | None = None) -> NDArray[np.int64]:
        """Decide the state: the most likely one if `ordered`, else the threshold rule's; a NaN error is out of RNP.

        Returns
        -------
        ndarray of int, shape (...)
            Index into `names`.
        """
        shape, (x,) = flatten(nse_m=(nse_m, ()))
        return self._core.classes(x, _prior(prior)).reshape(shape)

    def tightest(self, probability: ArrayLike, risk: float) -> list[str | None]:
        """The tightest level that an error is beyond with at most a risk.

        Parameters
        ----------
        probability : array_like, shape (n, len(names))
            Of each state, as `probabilities` gives them.
        risk : float
            Allowed to be beyond the level. [1]

        Returns
        -------
        list of str
            Names; None for a row that holds a NaN.
        """
        table = np.asarray(probability, dtype=np.float64)
        beyond = 1.0 - np.cumsum(table, axis=1)
        places = np.argmax(beyond <= risk, axis=1).tolist()
        known: list[bool] = np.asarray(~np.isnan(table).any(axis=1)).tolist()
        return [self.names[k] if ok else None for k, ok in zip(places, known, strict=True)]

    def threshold_class(self, nse_m: ArrayLike) -> NDArray[np.int64]:
        """Give the first state whose boundary the error does not exceed; a NaN error is out of RNP."""
        shape, (x,) = flatten(nse_m=(nse_m, ()))
        return self._core.threshold_classes(x).reshape(shape)

    def joint(self, lateral_m: ArrayLike, longitudinal_m: ArrayLike, prior: ArrayLike | None = None) -> NDArray[np.float64]:
        """Probabilities of the worse of the lateral and the longitudinal state, each judged by itself.

        Returns
        -------
        ndarray, shape (..., n + 1)
            Differences of the product of both cumulative posteriors.
        """
        shape, (x, y) = flatten(lateral_m=(lateral_m, ()), longitudinal_m=(longitudinal_m, ()))
        return unflatten(self._core.joint(x, y, _prior(prior)), shape)

    def remember(self, nse_m: ArrayLike, stay: float = 0.95, prior: ArrayLike | None = None) -> NDArray[np.float64]:
        """Posteriors of a sequence, each remembering the one before: predict, then update.

        Parameters
        ----------
        nse_m : array_like, shape (m,)
            Navigation error of one track, in order. A NaN leaves its row NaN and the memory as it was. [m]
        stay : float
            Probability of staying in the state from one epoch to the next; the others share the rest.
        prior : array_like, shape (n + 1,), optional
            Before the first epoch; equal if not given.

        Returns
        -------
        ndarray, shape (m, n + 1)
        """
        shape, (x,) = flatten(nse_m=(nse_m, ()))
        if len(shape) != 1:
            raise InputError("nse_m", f"shape {shape}", domain="shape (m,): one track in order")
        return self._core.remembered(x, stay, _prior(prior))

    def probabilities(self, offset_m: ArrayLike, sigma_m: ArrayLike) -> NDArray[np.float64]:
        """Probability of each state from the law of the error itself: the default to report.

        Parameters
        ----------
        offset_m : array_like, shape (...)
            Known mean of the error, e.g. the lateral deviation where the boundaries are of the total system error; 0 for a centred
            navigation error. NaN together with `sigma_m` is refused, not guessed. [m]
        sigma_m : array_like, shape (...)
            Its standard deviation, in (0, inf). [m]

        Returns
        -------
        ndarray, shape (..., n + 1)
            ``r(B_{k-1}) - r(B_k)`` of the exceedance risk r; each row sums to 1.

        Raises
        ------
        InputError
            An offset or deviation outside its domain.
        """
        shape, (offset, sigma) = flatten(offset_m=(offset_m, ()), sigma_m=(sigma_m, ()))
        return unflatten(self._core.of_error(offset, sigma), shape)

    def probabilities_from_residuals(self, sum_of_squares_m2: ArrayLike, n: ArrayLike) -> NDArray[np.float64]:
        """Probability of each state of the 95 % navigation error, given residuals of known zero mean (Jeffreys prior).

        Parameters
        ----------
        sum_of_squares_m2 : array_like, shape (...)
            Of the residuals. [m²]
        n : array_like, shape (...)
            How many.

        Returns
        -------
        ndarray, shape (..., levels + 1)
        """
        shape, (s, count) = flatten(sum_of_squares_m2=(sum_of_squares_m2, ()), n=(n, ()))
        return unflatten(self._core.of_residuals(s, count), shape)

    def paper_bivariate(self, lateral_m: ArrayLike, longitudinal_m: ArrayLike, prior: ArrayLike | None = None) -> NDArray[np.float64]:
        """Logarithm of the bivariate posterior as published: an exhibit, never a decision.

        Its means sit on the diagonal, so off it the state is too good: (0, 7) NM is named RNP 5 although out of RNP. Use `joint`.
        """
        shape, (x, y) = flatten(lateral_m=(lateral_m, ()), longitudinal_m=(longitudinal_m, ()))
        return unflatten(self._core.ln_paper_bivariate(x, y, _prior(prior)), shape)


@dataclass(frozen=True)
class StateOfError:
    """What one navigation error says about the state.

    Attributes
    ----------
    names : list of str
        The states.
    state, threshold_state : ndarray of int, shape (...)
        The decided state and the threshold rule's; index into `names`.
    log_posterior, posterior : ndarray, shape (..., n + 1)
        In the safe form.
    log_posterior_as_printed : ndarray, shape (..., n + 1)
        As published; an exhibit.
    """

    names: list[str]
    state: NDArray[np.int64]
    threshold_state: NDArray[np.int64]
    log_posterior: NDArray[np.float64]
    posterior: NDArray[np.float64]
    log_posterior_as_printed: NDArray[np.float64]


@dataclass(frozen=True)
class StateOfErrors:
    """What a lateral and a longitudinal error say about the state.

    Attributes
    ----------
    names : list of str
        The states.
    posterior : ndarray, shape (..., n + 1)
        Of the worse of the two.
    state, threshold_state : ndarray of int, shape (...)
        The most likely one, and the threshold rule's of the larger error; index into `names`.
    paper_log_posterior : ndarray, shape (..., n + 1)
        The bivariate form as published; an exhibit.
    paper_state : ndarray of int, shape (...)
        Its most likely one; an exhibit, too good off the diagonal.
    """

    names: list[str]
    posterior: NDArray[np.float64]
    state: NDArray[np.int64]
    threshold_state: NDArray[np.int64]
    paper_log_posterior: NDArray[np.float64]
    paper_state: NDArray[np.int64]


@checked
def state_of_error(
    levels_nm: Sequence[float],
    nse_m: ArrayLike,
    *,
    fte_nm: float | Sequence[float] = 0.0,
    prior: ArrayLike | None = None,
    require_order: bool = True,
) -> StateOfError:
    """Classify navigation errors in one call.

    Parameters
    ----------
    levels_nm, fte_nm, require_order
        As in `StateClassifier`. [NM]
    nse_m : array_like, shape (...)
        Navigation error. [m]
    prior : array_like, shape (n + 1,), optional
        Equal if not given.
    """
    states = StateClassifier(levels_nm, fte_nm, require_order=require_order)
    log_posterior = states.log_posterior(nse_m, prior)
    return StateOfError(
        names=states.names,
        state=states.classify(nse_m, prior),
        threshold_state=states.threshold_class(nse_m),
        log_posterior=log_posterior,
        posterior=np.exp(log_posterior),
        log_posterior_as_printed=states.log_posterior_as_printed(nse_m, prior),
    )


@checked
def state_of_errors(
    levels_nm: Sequence[float],
    lateral_m: ArrayLike,
    longitudinal_m: ArrayLike,
    *,
    fte_nm: float | Sequence[float] = 0.0,
    prior: ArrayLike | None = None,
) -> StateOfErrors:
    """Classify pairs of lateral and longitudinal errors in one call; parameters as `state_of_error`. [m]."""
    states = StateClassifier(levels_nm, fte_nm)
    posterior = states.joint(lateral_m, longitudinal_m, prior)
    paper = states.paper_bivariate(lateral_m, longitudinal_m, prior)
    return StateOfErrors(
        names=states.names,
        posterior=posterior,
        state=np.argmax(posterior, axis=-1),
        threshold_state=states.threshold_class(np.maximum(np.abs(lateral_m), np.abs(longitudinal_m))),
        paper_log_posterior=paper,
        paper_state=np.argmax(paper, axis=-1),
    )


@checked
def states_of_track(
    levels_nm: Sequence[float],
    nse_m: ArrayLike,
    *,
    stay: float,
    fte_nm: float | Sequence[float] = 0.0,
    prior: ArrayLike | None = None,
) -> NDArray[np.float64]:
    """Posteriors of one track's errors, each remembering the one before; see `StateClassifier.remember`. Shape (m, n + 1)."""
    return StateClassifier(levels_nm, fte_nm).remember(nse_m, stay, prior)


def _prior(prior: ArrayLike | None) -> list[float] | None:
    return None if prior is None else np.asarray(prior, dtype=np.float64).ravel().tolist()
