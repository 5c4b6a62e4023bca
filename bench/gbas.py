"""Speed of navbound.gbas and navbound.rraim: one sky, one coasting phase, the filter, and the whole grid of the surface-movement study."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clock import Row, seconds, show
from navbound import gbas, rraim
from navbound.gbas.modes import MODES
from navbound.studies.surface_movement import grid as grids
from navbound.studies.surface_movement import scenario as surface
from navbound.studies.surface_movement import sky as skies

if TYPE_CHECKING:
    pass


def measure() -> list[Row]:
    """One row a measurement."""
    config = surface.load()
    # Three days of ten-minute geometries: 432, by 3 modes, 5 sub-phases, 8 coasting times and 6 biases.
    config = config.model_copy(update={"geometry": config.geometry.model_copy(update={"duration_s": 3 * 86_400.0})})
    rules = grids.rules(config)
    sky = skies.look(config)
    own = {mode.id: sky.of(mode.systems) for mode in MODES}
    both, n = own["F2"], len(sky.az_rad)
    sigma_td = gbas.carrier_sigma(both.el_now_rad[3], 10.0, 60.0, gbas.carriers()["dual"])
    levels = seconds(lambda: gbas.protection_levels(both.az_rad, both.el_rad, both.systems, service="F"))
    arguments = (both.az_rad, both.el_rad, both.az_now_rad[3], both.el_now_rad[3], sigma_td, both.systems)
    coasting = seconds(lambda: rraim.protection_levels(*arguments, service="F", p_const={0: 1e-8, 2: 1e-4}))
    filtered = seconds(lambda: gbas.aided_covariance(both.az_rad[:2], both.el_rad[:2], both.systems, lat_rad=0.72, service="F"), repeats=3)

    def grid() -> None:
        for mode in MODES:
            grids.coasting(config, rules, mode, "A", own[mode.id], covariance_m2=None)

    cells = n * 3 * 5 * 8 * 6
    whole = seconds(grid, repeats=2)
    of_grid = f"a cell; the whole grid in {whole:.2f} s of one core"
    return [
        Row("gbas levels, GPS and Galileo", levels / n, n, "a sky"),
        Row("rraim levels, single and multi fault", coasting / n, n, "a coasting phase of 60 s"),
        Row("inertially aided covariance, 900 s", filtered / 2, 2, "a run"),
        Row("surface-movement grid", whole / cells, cells, of_grid, goal_s=10.0 / cells),
    ]


if __name__ == "__main__":
    show(measure())
