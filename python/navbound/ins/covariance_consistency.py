"""Whether the navigation filter is as good as it says; public as `navbound.ins.consistency`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import polars as pl

from navbound import _core
from navbound.errors import InputError
from navbound.ins.settings import FilterSettings, ImuModel, StartSigma, declared_to_core
from navbound.scenario import Scenario, load
from navbound.table.arguments import checked
from navbound.table.columns import CONSISTENCY, REVERSION
from navbound.table.declare import schema


@checked
def consistency(
    scenario: str | Path | Scenario,
    flights: int = 50,
    *,
    first: int = 0,
    seed: int | None = None,
    imu_model: ImuModel | None = None,
    settings: FilterSettings | None = None,
    start: StartSigma | None = None,
    skip_s: float = 120.0,
) -> pl.DataFrame:
    """Fly simulated sensors through the filter and judge it against the truth, a row a flight.

    Flights run on all cores, sample by sample: nothing of them is kept but the sums. The true start errors are drawn from the deviations
    that are declared to the filter, by the flight's number.

    Parameters
    ----------
    scenario : str, Path or Scenario
        With a ``[sensors]`` part.
    flights, first : int
        How many, and the number of the first.
    seed : int, optional
        In place of the scenario's.
    imu_model, settings, start
        What is declared to the filter.
    skip_s : float
        Time from the begin that is not judged. [s]

    Returns
    -------
    polars.DataFrame
        ``flight``; ``n_epochs`` judged, one a second; ``nees``, mean of e' V^-1 e, 3 for a filter that is right; ``p_circle``,
        ``p_sphere``, shares inside the 95 % circle and sphere; ``rms_e_m`` ... of the errors and ``sigma_e_m`` ... that the filter
        says; ``p_gnss`` ... of the modes; ``n_stopped`` epochs after a stop; ``range_mean_square``, ``range_lag_one``,
        ``n_ranges_used``, ``n_ranges_gated`` of the innovations (in the loose form of the solved positions), ``range_memory_max`` the
        largest memory of a minute in standard deviations. With a reversion filter also ``n_compared`` instants at which both filters
        were compared, ``separation_mean_square`` of their horizontal difference, 2 where both are right, ``separation_max_square``,
        ``n_disagreements``, and ``reversion_nees`` ..., the first columns of that filter.

    Raises
    ------
    InputError
        A scenario that has no sensors, or settings outside their domain.
    """
    loaded = scenario if isinstance(scenario, Scenario) else load(scenario)
    for name, value, least in (("flights", flights, 1), ("first", first, 0)):
        if not value >= least:
            raise InputError(name, value, "1", f"[{least}, inf)")
    if not skip_s >= 0.0:
        raise InputError("skip_s", skip_s, "s", "[0, inf)")
    seed_used = loaded.seed if seed is None else seed
    # One generator a flight, by seed and number: the same flight has the same start errors in any batch.
    normals = np.array([np.random.default_rng([seed_used, number]).normal(size=9) for number in range(first, first + flights)])
    words = declared_to_core(imu_model or ImuModel(), settings or FilterSettings(), start or StartSigma(), (1.0, 0.0), None)
    table = _core.ins_consistency(loaded.core_json(), seed_used, first, normals, words, skip_s)
    how = settings or FilterSettings()
    declared = (*CONSISTENCY, *REVERSION) if how.reversion or how.form == "federated" else CONSISTENCY
    numbers = np.column_stack([np.arange(first, first + flights), table])
    return pl.DataFrame({column.name: numbers[:, k] for k, column in enumerate(declared)}).cast(schema(declared))
