//! ARAIM levels of many epochs: geometry given, or users and orbits.

use crate::araim_modes::Known;
use crate::outlook::{Outcome, Outlook, at_desk, predicted, refusal, rows};
use crate::parallel;
use nalgebra::Vector3;
use navbound_core::bound::araim::exclusion::{self, Monitored};
use navbound_core::bound::araim::modes::MOST_SATELLITES;
use navbound_core::bound::araim::service::Service;
use navbound_core::bound::araim::single::Requirement;
use navbound_core::bound::araim::{Detail, Levels, Monitor};
use navbound_core::bound::{NoLevels, Sight};
use navbound_core::quantity::{Metres, OutOfDomain};
use navbound_core::signal::Constellation;
use navbound_path::AtIndex;
use pulp::Arch;
use std::cell::RefCell;

/// Epochs in one task of the pool: each takes tens of microseconds, and a desk is made once.
const EPOCHS_PER_TASK: usize = 32;

/// Satellites in many solutions: rows are epochs, columns satellites; one whose line of sight is NaN is not used.
#[derive(Debug, Clone, Copy)]
pub struct Sights<'a> {
    /// East, north, up of each unit vector, three numbers a satellite.
    pub unit_enu: &'a [f64],
    /// Standard deviation of each range for integrity \[m\].
    pub sigma_int_m: &'a [f64],
    /// For accuracy and continuity \[m\].
    pub sigma_acc_m: &'a [f64],
    /// Nominal bias for integrity \[m\].
    pub bias_m: &'a [f64],
    /// For continuity \[m\].
    pub bias_continuity_m: &'a [f64],
    /// Prior of each satellite.
    pub p_sat: &'a [f64],
    /// Constellation of each column.
    pub constellation: &'a [Constellation],
    /// Prior of each constellation.
    pub p_const: [f64; Constellation::ALL.len()],
}

impl Sights<'_> {
    /// Epochs.
    pub fn len(&self) -> usize {
        self.sigma_int_m.len().checked_div(self.constellation.len()).unwrap_or(0)
    }
    /// None.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// One epoch's result.
pub type Row = crate::outlook::Row<Detail>;

/// Which monitoring the levels are those of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rule {
    /// Fault modes with priors, satellites and constellations.
    Araim(Service),
    /// One satellite at a time, no priors.
    Raim(Requirement),
}

/// What makes levels of satellites, and keeps what it worked out for the next.
struct Worker {
    monitor: Box<Monitor>,
    known: Known,
}

impl Worker {
    fn new(p_const: [f64; Constellation::ALL.len()], uniform: bool) -> Self {
        Self { monitor: Box::default(), known: Known::new(p_const, uniform) }
    }

    /// Levels of satellites; with exclusion the worst of what may be left after one. In the widest instructions that the processor has:
    /// they are compiled here alone, once for each width, which takes as long as half of this crate.
    #[inline(never)]
    fn levels(&mut self, sights: &[Sight], rule: &Rule, exclusion: bool) -> Result<Levels, NoLevels> {
        let Self { monitor, known } = self;
        let arch = Arch::new();
        match (rule, exclusion) {
            (Rule::Araim(service), false) => arch.dispatch(
                #[inline(always)]
                || exclusion::detected(monitor, known, sights, service),
            ),
            (Rule::Araim(service), true) => arch.dispatch(
                #[inline(always)]
                || exclusion::predicted(monitor, known, sights, service),
            ),
            (Rule::Raim(requested), false) => arch.dispatch(
                #[inline(always)]
                || monitor.single_levels(sights, requested),
            ),
            (Rule::Raim(requested), true) => arch.dispatch(
                #[inline(always)]
                || monitor.single_levels_after_exclusion(sights, requested),
            ),
        }
    }
}

/// What a thread keeps from epoch to epoch.
pub(crate) struct Desk {
    worker: Worker,
    /// The satellites of the epoch at hand.
    pub(crate) sights: Vec<Sight>,
}

impl Desk {
    pub(crate) fn new(p_const: [f64; Constellation::ALL.len()], uniform: bool) -> Self {
        Self { worker: Worker::new(p_const, uniform), sights: Vec::new() }
    }

    /// Detection and exclusion on the desk's satellites.
    pub(crate) fn monitored(&mut self, residuals_m: &[f64], service: &Service) -> Result<Monitored, NoLevels> {
        let Worker { monitor, known } = &mut self.worker;
        exclusion::monitored(monitor, known, &self.sights, residuals_m, service)
    }

    /// Levels of a row's satellites.
    fn row(&mut self, sights: &Sights<'_>, row: usize, rule: &Rule, exclusion: bool) -> Result<Row, OutOfDomain> {
        self.take(sights, row, |_| ());
        Row::of(self.sights.len(), self.worker.levels(&self.sights, rule, exclusion))
    }

    /// Take up a row's satellites; `each` receives the column of every one.
    fn take(&mut self, sights: &Sights<'_>, row: usize, mut each: impl FnMut(usize)) {
        self.sights.clear();
        for (column, constellation) in sights.constellation.iter().enumerate() {
            let i = row * sights.constellation.len() + column;
            let unit = Vector3::new(sights.unit_enu[3 * i], sights.unit_enu[3 * i + 1], sights.unit_enu[3 * i + 2]);
            if unit.iter().all(|x| x.is_nan()) {
                continue;
            }
            each(column);
            self.sights.push(Sight {
                unit,
                constellation: *constellation,
                integrity_m2: squared(sights.sigma_int_m[i]),
                accuracy_m2: squared(sights.sigma_acc_m[i]),
                receiver_faulty_m2: squared(sights.sigma_int_m[i]),
                bias: Metres::new(sights.bias_m[i]),
                bias_continuity: Metres::new(sights.bias_continuity_m[i]),
                p_sat: sights.p_sat[i],
            });
        }
    }
}

/// Levels of every epoch, in the widest instructions the processor has; the bits do not depend on them.
///
/// # Errors
/// [`AtIndex`]: the first epoch with a number outside its domain.
pub fn levels(sights: &Sights<'_>, rule: &Rule, exclusion: bool) -> Result<Vec<Row>, AtIndex> {
    let request = Requested { rule: *rule, p_const: sights.p_const, p_sat: priors(sights) };
    let epoch = |desk: &mut Desk, row: usize| desk.row(sights, row, rule, exclusion);
    if sights.len() > 1 {
        return rows(sights.len(), || request.desk(), epoch);
    }
    KEPT.with_borrow_mut(|kept| {
        let known = kept.take_if(|(before, _)| *before == request);
        let (_, desk) = kept.insert(known.unwrap_or_else(|| (request, request.desk())));
        at_desk(desk, sights.len(), epoch)
    })
}

thread_local! {
    /// The desk of this thread's last single epoch: a program that asks for one epoch after another finds the fault modes worked out.
    static KEPT: RefCell<Option<(Requested, Desk)>> = const { RefCell::new(None) };
}

/// What the fault modes of a desk depend on besides the constellations of the satellites.
#[derive(Clone, Copy, PartialEq)]
struct Requested {
    rule: Rule,
    p_const: [f64; Constellation::ALL.len()],
    /// Prior of the satellites of each constellation; `None` where they differ, and modes are worked out for every epoch.
    p_sat: Option<[Option<f64>; Constellation::ALL.len()]>,
}

impl Requested {
    fn desk(&self) -> Desk {
        Desk::new(self.p_const, self.p_sat.is_some())
    }
}

/// Detection and exclusion at every epoch: `residual_m` holds measured less computed ranges, one a satellite.
///
/// # Errors
/// As [`levels`], and for a residual of a satellite in use that is no number.
pub fn monitored(sights: &Sights<'_>, residual_m: &[f64], service: &Service) -> Result<Vec<Tested>, AtIndex> {
    let uniform = priors(sights).is_some();
    let each = |desk: &mut (Desk, Vec<f64>, Vec<usize>), row: usize| {
        let (desk, residuals, columns) = desk;
        residuals.clear();
        columns.clear();
        desk.take(sights, row, |column| {
            residuals.push(residual_m[row * sights.constellation.len() + column]);
            columns.push(column);
        });
        let monitored = match desk.monitored(residuals, service) {
            Ok(monitored) => monitored,
            Err(e) => return refusal(e).map_or_else(|outcome| Ok(Tested { outcome, monitored: None, excluded: Vec::new() }), Err),
        };
        let out = |i: usize| i < MOST_SATELLITES && monitored.excluded >> i & 1 == 1;
        let excluded = columns.iter().enumerate().filter(|(i, _)| out(*i)).map(|(_, c)| *c).collect();
        Ok(Tested { outcome: Outcome::of(&monitored.levels), monitored: Some(monitored), excluded })
    };
    let desk = || (Desk::new(sights.p_const, uniform), Vec::new(), Vec::new());
    parallel::map_with(sights.len(), EPOCHS_PER_TASK, desk, |desk, index| each(desk, index).map_err(|error| AtIndex { index, error }))
        .into_iter()
        .collect()
}

/// One epoch after detection and exclusion.
#[derive(Debug, Clone, PartialEq)]
pub struct Tested {
    /// Whether there are levels.
    pub outcome: Outcome,
    /// Decision and levels, where the geometry gives any.
    pub monitored: Option<Monitored>,
    /// Columns of the excluded satellites.
    pub excluded: Vec<usize>,
}

/// Levels of every user at every instant: user after user, instant after instant.
///
/// # Errors
/// [`AtIndex`]: the first orbit, instant, user or promise outside its domain.
pub fn predict(outlook: &Outlook<'_>, rule: &Rule, exclusion: bool) -> Result<Vec<Row>, AtIndex> {
    predicted(
        outlook,
        || Worker::new(outlook.promise.support.map(|s| s.p_const), true),
        |worker, sights| worker.levels(sights, rule, exclusion),
    )
}

/// A negative sigma stays negative, so that it is refused.
pub(crate) fn squared(sigma: f64) -> f64 {
    sigma * sigma.abs()
}

/// The prior that all satellites of each constellation share; `None` where those of one do not.
fn priors(sights: &Sights<'_>) -> Option<[Option<f64>; Constellation::ALL.len()]> {
    let mut first = [None; Constellation::ALL.len()];
    let same = |(p, c): (&f64, &Constellation)| *first[c.index()].get_or_insert(*p) == *p;
    sights.p_sat.iter().zip(sights.constellation.iter().cycle()).all(same).then_some(first)
}
