//! The grid of the surface-movement study: geometries by coasting times by sub-phases by sizes of the nominal bias.

use crate::gbas::{Skies, covariance};
use crate::parallel;
use crate::rraim::Room;
use navbound_core::bound::gbas::range::carrier_sigma;
use navbound_core::bound::gbas::snapshot::Snapshot;
use navbound_core::bound::rraim::coast::{Coast, Followed};
use navbound_core::bound::rraim::modes::Priors;
use navbound_core::bound::rraim::multiple::Budget;
use navbound_core::bound::rraim::single::{Fix, Multipliers, Settings, SingleFault};
use navbound_core::geometry::Direction;
use navbound_core::quantity::{Metres, OutOfDomain, Radians};
use navbound_core::spec::gbas::CarrierModel;
use navbound_path::AtIndex;

/// Skies in one task of the pool: each takes a tenth of a millisecond and more.
const SKIES_PER_TASK: usize = 4;

/// What one sub-phase asks.
#[derive(Debug, Clone, Copy)]
pub struct Demand {
    /// Speed over the ground \[m/s\].
    pub speed_mps: f64,
    /// Single-fault settings.
    pub single: Settings,
    /// Multi-fault risks.
    pub budget: Budget,
    /// Share of the budget below which faults together need no monitoring.
    pub unmonitored: f64,
}

/// The grid.
#[derive(Debug, Clone, Copy)]
pub struct Grid<'a> {
    /// Skies at the fix.
    pub fix: Skies<'a>,
    /// Covariance of each fix with an inertial system, nine numbers \[m²\].
    pub aided_m2: Option<&'a [f64]>,
    /// Azimuths after each coasting time, one block of skies each \[rad\]; NaN for a satellite that was lost.
    pub az_rad: &'a [f64],
    /// Elevations likewise \[rad\].
    pub el_rad: &'a [f64],
    /// Coasting times \[s\].
    pub coasting_s: &'a [f64],
    /// Sub-phases.
    pub demands: &'a [Demand],
    /// Sizes of the nominal bias \[m\].
    pub bias_m: &'a [f64],
    /// Phase differenced in time.
    pub carrier: CarrierModel,
    /// Rates of satellite faults and of constellation faults \[1/h\], by constellation index.
    pub rates: ([f64; CLOCKS], [f64; CLOCKS]),
    /// How long a fault lasts \[s\] where it may have begun before: its prior is then rate times duration. Without, it must begin while
    /// coasting: rate times coasting time.
    pub fault_lasts_s: Option<f64>,
}

const CLOCKS: usize = navbound_core::signal::Constellation::ALL.len();

/// Accuracy, single-fault and multi-fault level; NaN where there is none.
pub type Cell = [f64; 3];

/// Every cell: skies, coasting times, sub-phases, biases, the last fastest.
///
/// # Errors
/// [`AtIndex`] for the first number outside its domain.
pub fn cells(grid: &Grid<'_>) -> Result<Vec<Cell>, AtIndex> {
    let rows: Result<Vec<Vec<Cell>>, AtIndex> =
        parallel::map_with(grid.fix.len(), SKIES_PER_TASK, Room::default, |room, sky| of_sky(grid, sky, room)).into_iter().collect();
    Ok(rows?.concat())
}

fn of_sky(grid: &Grid<'_>, sky: usize, room: &mut Room) -> Result<Vec<Cell>, AtIndex> {
    let at = |error| AtIndex { index: sky, error };
    let ranges = grid.fix.ranges(sky)?;
    let block = grid.demands.len() * grid.bias_m.len();
    let nothing = vec![[f64::NAN; 3]; block * grid.coasting_s.len()];
    let Ok(snapshot) = Snapshot::new(&ranges.iter().map(|r| r.1).collect::<Vec<_>>()) else { return Ok(nothing) };
    let aided = grid.aided_m2.map(|all| covariance(all, sky)).transpose().map_err(at)?;
    let mut cells = Vec::with_capacity(nothing.len());
    for (k, coasting_s) in grid.coasting_s.iter().enumerate() {
        let places = places(grid, k, sky, &ranges)?;
        for demand in grid.demands {
            let followed: Result<Vec<Followed>, OutOfDomain> = places
                .iter()
                .map(|(f, el)| Ok(Followed { sigma: carrier_sigma(&grid.carrier, *el, demand.speed_mps, *coasting_s)?, ..*f }))
                .collect();
            let coast = Coast::new(&followed.map_err(at)?).map_err(at)?;
            let fix = aided.map_or_else(|| Fix::of(&snapshot), |p| Fix::aided(&snapshot, p, demand.single.form));
            of_demand(grid, demand, *coasting_s, &fix, &coast, room, &mut cells).map_err(at)?;
        }
    }
    Ok(cells)
}

/// Satellites followed, with their elevation now.
fn places(
    grid: &Grid<'_>,
    time: usize,
    sky: usize,
    ranges: &[(usize, navbound_core::bound::Sight)],
) -> Result<Vec<(Followed, Radians)>, AtIndex> {
    let width = grid.fix.constellation.len();
    let start = (time * grid.fix.len() + sky) * width;
    let used = ranges.iter().filter(|(c, _)| !(grid.az_rad[start + c].is_nan() && grid.el_rad[start + c].is_nan()));
    used.map(|(column, range)| {
        let index = start + column;
        let direction = Direction::new(Radians::new(grid.az_rad[index]), Radians::new(grid.el_rad[index]));
        let direction = direction.map_err(|error| AtIndex { index, error })?;
        let followed = Followed { before: range.unit, now: direction.unit(), constellation: range.constellation, sigma: Metres::new(0.0) };
        Ok((followed, direction.elevation()))
    })
    .collect()
}

fn of_demand(
    grid: &Grid<'_>,
    demand: &Demand,
    coasting_s: f64,
    fix: &Fix<'_>,
    coast: &Coast,
    room: &mut Room,
    cells: &mut Vec<Cell>,
) -> Result<(), OutOfDomain> {
    let seconds = grid.fault_lasts_s.unwrap_or(coasting_s);
    let during = |rates: [f64; CLOCKS]| rates.map(|per_hour| per_hour * seconds / 3600.0);
    let threshold = demand.unmonitored * demand.budget.allotted.q();
    let priors = Priors { satellite: during(grid.rates.0), constellation: during(grid.rates.1), threshold }.check()?;
    let settings = &demand.single;
    let bound = SingleFault::new(fix, coast, settings.form, settings.ordering).and_then(|single| {
        room.fill(fix, coast, &priors)?;
        Ok(single)
    });
    let Ok(single) = bound else {
        cells.resize(cells.len() + grid.bias_m.len(), [f64::NAN; 3]);
        return Ok(());
    };
    let multipliers = Multipliers::new(settings, coast.len(), priors.of_satellites(coast))?;
    for bias_m in grid.bias_m {
        let bias = crate::gbas::size_of_bias(*bias_m)?;
        let levels = single.levels(bias, Metres::new(0.0), &multipliers, settings.biased_threshold);
        let multiple = room.levels(bias, &demand.budget);
        cells.push([single.accuracy(bias).m(), levels.hpl.m(), multiple.map_or(f64::NAN, |m| m[2].m())]);
    }
    Ok(())
}
