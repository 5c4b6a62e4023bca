//! ARAIM levels of many epochs: geometry given, or users and orbits.

use crate::batch::CHUNK;
use nalgebra::Vector3;
use navbound_core::bound::araim::modes::{FaultModes, MOST_SATELLITES, NoModes, Priors};
use navbound_core::bound::araim::service::Service;
use navbound_core::bound::araim::{Levels, Monitor, Sight};
use navbound_core::quantity::{Metres, OutOfDomain, Unavailable};
use navbound_core::signal::Constellation;
use navbound_path::AtIndex;
use pulp::Arch;
use rayon::prelude::*;
use std::collections::HashMap;

/// Why an epoch has no finite levels; the order is that of [`Outcome::WORDS`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// It has.
    Ok,
    /// Fewer satellites than unknowns.
    TooFewSatellites,
    /// The satellites do not determine the position.
    Singular,
    /// The integrity risk is spent on fault modes that cannot be monitored: the levels are infinite.
    NotMonitored,
    /// More satellites, or more fault modes to monitor, than there is room for.
    TooMany,
}

impl Outcome {
    /// The words of tables.
    pub const WORDS: [&'static str; 5] = ["ok", "too_few_satellites", "singular", "not_monitored", "too_many"];

    fn of(levels: &Levels) -> Self {
        if levels.hpl.m().is_finite() && levels.vpl.m().is_finite() { Self::Ok } else { Self::NotMonitored }
    }
}

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

/// One epoch's result: satellites used, why there are no finite levels, the levels (infinite or absent then).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Satellites used.
    pub n_sv: usize,
    /// Whether there are levels.
    pub outcome: Outcome,
    /// The levels, where the geometry gives any.
    pub levels: Option<Levels>,
}

/// What a thread keeps from epoch to epoch.
struct Desk {
    monitor: Box<Monitor>,
    known: HashMap<[u8; MOST_SATELLITES], Box<FaultModes>>,
    sights: Vec<Sight>,
    p_sat: Vec<f64>,
    systems: Vec<Constellation>,
}

impl Desk {
    fn new() -> Self {
        Self { monitor: Box::default(), known: HashMap::new(), sights: Vec::new(), p_sat: Vec::new(), systems: Vec::new() }
    }

    fn clear(&mut self) {
        self.sights.clear();
        self.p_sat.clear();
        self.systems.clear();
    }

    fn push(&mut self, sight: Sight, p_sat: f64) {
        self.sights.push(sight);
        self.p_sat.push(p_sat);
        self.systems.push(sight.constellation);
    }

    /// Levels of the satellites on the desk. Fault modes depend on the constellations of the satellites and on their priors; where these
    /// are the same for all of a constellation the modes are looked up.
    #[inline(always)]
    fn levels(&mut self, p_const: &[f64; Constellation::ALL.len()], service: &Service, uniform: bool) -> Result<Row, OutOfDomain> {
        let n_sv = self.sights.len();
        if n_sv > MOST_SATELLITES {
            return Ok(Row { n_sv, outcome: Outcome::TooMany, levels: None });
        }
        if n_sv == 0 {
            return Ok(Row { n_sv, outcome: Outcome::TooFewSatellites, levels: None });
        }
        let mut key = [u8::MAX; MOST_SATELLITES];
        for (slot, c) in key.iter_mut().zip(&self.systems) {
            *slot = c.index() as u8;
        }
        if !(uniform && self.known.contains_key(&key)) {
            let priors = Priors { p_sat: &self.p_sat, constellation: &self.systems, p_const: *p_const };
            match FaultModes::new(&priors, service) {
                Ok(modes) => self.known.insert(key, Box::new(modes)),
                Err(NoModes::OutOfDomain(e)) => return Err(e),
                Err(_) => return Ok(Row { n_sv, outcome: Outcome::TooMany, levels: None }),
            };
        }
        let Some(modes) = self.known.get(&key) else { return Ok(Row { n_sv, outcome: Outcome::TooMany, levels: None }) };
        match self.monitor.levels(&self.sights, modes, service) {
            Ok(levels) => Ok(Row { n_sv, outcome: Outcome::of(&levels), levels: Some(levels) }),
            Err(Unavailable::Invalid { field, value, unit, domain }) => Err(OutOfDomain { argument: field, value, unit, domain }),
            Err(Unavailable::TooFewSatellites { .. }) => Ok(Row { n_sv, outcome: Outcome::TooFewSatellites, levels: None }),
            Err(_) => Ok(Row { n_sv, outcome: Outcome::Singular, levels: None }),
        }
    }
}

/// Levels of every epoch, in the widest instructions the processor has; the bits do not depend on them.
///
/// # Errors
/// [`AtIndex`]: the first epoch with a number outside its domain.
pub fn levels(sights: &Sights<'_>, service: &Service) -> Result<Vec<Row>, AtIndex> {
    let width = sights.constellation.len();
    let n = sights.sigma_int_m.len().checked_div(width).unwrap_or(0);
    let uniform = uniform(sights, width);
    rows(
        n,
        #[inline(always)]
        |desk, row| {
            desk.clear();
            for column in 0..width {
                let i = row * width + column;
                let unit = Vector3::new(sights.unit_enu[3 * i], sights.unit_enu[3 * i + 1], sights.unit_enu[3 * i + 2]);
                if unit.iter().all(|x| x.is_nan()) {
                    continue;
                }
                let sight = Sight {
                    unit,
                    constellation: sights.constellation[column],
                    integrity_m2: squared(sights.sigma_int_m[i]),
                    accuracy_m2: squared(sights.sigma_acc_m[i]),
                    bias: Metres::new(sights.bias_m[i]),
                    bias_continuity: Metres::new(sights.bias_continuity_m[i]),
                };
                desk.push(sight, sights.p_sat[i]);
            }
            desk.levels(&sights.p_const, service, uniform)
        },
    )
}

/// A negative sigma stays negative, so that it is refused.
fn squared(sigma: f64) -> f64 {
    sigma * sigma.abs()
}

/// Whether satellites of one constellation share one prior everywhere.
fn uniform(sights: &Sights<'_>, width: usize) -> bool {
    let mut first = [None; Constellation::ALL.len()];
    sights
        .p_sat
        .chunks(width.max(1))
        .all(|row| row.iter().zip(sights.constellation).all(|(p, c)| *first[c.index()].get_or_insert(*p) == *p))
}

/// Every epoch by chunks on all cores.
fn rows(n: usize, epoch: impl Fn(&mut Desk, usize) -> Result<Row, OutOfDomain> + Sync) -> Result<Vec<Row>, AtIndex> {
    let arch = Arch::new();
    let chunk = CHUNK.min(256);
    let done: Result<Vec<Vec<Row>>, AtIndex> = (0..n.div_ceil(chunk))
        .into_par_iter()
        .map_init(Desk::new, |desk, k| {
            let span = k * chunk..n.min((k + 1) * chunk);
            arch.dispatch(Job { desk, span, epoch: &epoch })
        })
        .collect();
    Ok(done?.into_iter().flatten().collect())
}

/// One chunk as a job for [`Arch::dispatch`], which compiles it once for each width of instructions.
struct Job<'a, F> {
    desk: &'a mut Desk,
    span: std::ops::Range<usize>,
    epoch: &'a F,
}

impl<F: Fn(&mut Desk, usize) -> Result<Row, OutOfDomain>> pulp::NullaryFnOnce for Job<'_, F> {
    type Output = Result<Vec<Row>, AtIndex>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        self.span.map(|index| (self.epoch)(self.desk, index).map_err(|error| AtIndex { index, error })).collect()
    }
}
