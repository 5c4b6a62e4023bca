//! Detection and exclusion: which satellites to leave out when the solutions disagree, and the levels that hold whatever is decided.
//!
//! Every decision (exclude nothing, or the satellites of one likely fault mode) takes an equal share of the integrity risk that is left
//! after the unmonitored modes: the union over decisions then stays inside it. The rule is ours; the published algorithms leave the
//! split of the risk between decisions to the designer.

use super::modes::{Book, FaultModes, MOST_SATELLITES, NoModes};
use super::separation::Separation;
use super::service::Service;
use super::{Levels, Monitor, Solver, Terms};
use crate::bound::{NoLevels, Sight};
use crate::quantity::{Metres, Unavailable};
use crate::signal::Constellation;
use nalgebra::Vector3;

/// How exclusion shares the risk; provenance *ours*.
pub const SOURCE: &str = "navbound, docs/methods/araim.md: equal shares of the integrity risk for every decision (ours)";

/// Fault modes that are tried for exclusion at most, the most suspicious first.
const MOST_TRIED: usize = 16;
/// Fault modes that may be excluded at most: every satellite and some constellations.
const MOST_DECISIONS: usize = MOST_SATELLITES + 8;

/// What was decided about an epoch's ranges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Decision {
    /// All solutions agree within their thresholds.
    Nothing,
    /// Some disagreed; without the satellites excluded the rest agree.
    Excluded,
    /// Some disagreed, and no exclusion that was tried brought agreement: the position is not to be used.
    NotExcluded,
}

/// An epoch after detection and exclusion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Monitored {
    /// What was decided.
    pub decision: Decision,
    /// Levels of the solution with the satellites that are left.
    pub levels: Levels,
    /// That solution from the place where the residuals were taken, east, north, up.
    pub step: [Metres; 3],
    /// Satellites excluded, bit i for satellite i.
    pub excluded: u64,
    /// Largest separation before exclusion, against its threshold.
    pub worst_ratio: f64,
}

/// Levels by detection alone.
///
/// # Errors
/// [`NoLevels`].
#[inline(always)]
pub fn detected(monitor: &mut Monitor, book: &mut impl Book, sights: &[Sight], service: &Service) -> Result<Levels, NoLevels> {
    let modes = some(book, sights, service)?;
    Ok(monitor.levels(sights, modes, service)?)
}

/// Levels that are promised beforehand where faults may be excluded: the largest of those without exclusion and of those after excluding any
/// one likely fault mode. Everything but the levels is that of the epoch without exclusion.
///
/// # Errors
/// [`NoLevels`].
#[inline(always)]
pub fn predicted(monitor: &mut Monitor, book: &mut impl Book, sights: &[Sight], service: &Service) -> Result<Levels, NoLevels> {
    let modes = some(book, sights, service)?;
    let mut candidates = Candidates::likely(modes, service)?;
    let share = candidates.share();
    let mut worst = monitor.solver.levels(&mut monitor.every, sights, &[], &Terms { modes, service, share })?;
    monitor.ceiling.fill(&monitor.every);
    candidates.worst_first(|out| monitor.ceiling.damage(out));
    let mut rest = Rest::default();
    for mask in candidates.masks() {
        let (left, _) = rest.without(sights, &[], mask);
        let modes = match some(book, left, service) {
            Ok(modes) => modes,
            Err(e @ NoLevels::Modes(NoModes::OutOfDomain(_))) => return Err(e),
            // The fault cannot be excluded: without these satellites there is no position.
            Err(_) => {
                worst.widen(None);
                continue;
            }
        };
        let terms = Terms { modes, service, share };
        if !monitor.ceiling.holds(&mut monitor.every, &mut monitor.solver, mask, &terms, &worst.limits()) {
            worst.widen(monitor.solver.levels(&mut monitor.rest, left, &[], &terms).ok().as_ref());
        }
    }
    Ok(worst)
}

/// Detection and exclusion on residuals: measured less computed ranges at one place, clocks of any value in them \[m\].
///
/// Each separation is compared with its threshold; where one exceeds it, modes are tried for exclusion in the order of their largest
/// ratio, and the first is taken without which all solutions agree.
///
/// # Errors
/// [`NoLevels`]; a residual that is no number is [`Unavailable::Invalid`].
pub fn monitored(
    monitor: &mut Monitor,
    book: &mut impl Book,
    sights: &[Sight],
    residuals_m: &[f64],
    service: &Service,
) -> Result<Monitored, NoLevels> {
    if let Some(bad) = residuals_m.iter().find(|r| !r.is_finite()) {
        return Err(Unavailable::Invalid { field: "residual_m", value: *bad, unit: "m", domain: "finite" }.into());
    }
    if residuals_m.len() != sights.len() {
        let (value, domain) = (residuals_m.len() as f64, "one a satellite");
        return Err(Unavailable::Invalid { field: "residual_m", value, unit: "1", domain }.into());
    }
    let modes = some(book, sights, service)?;
    let likely = Candidates::likely(modes, service)?;
    let share = likely.share();
    let Monitor { every, rest: other, solver, .. } = monitor;
    let levels = solver.levels(every, sights, residuals_m, &Terms { modes, service, share })?;
    let suspects = Candidates::suspects(solver, every, modes, service);
    let worst_ratio = suspects.ratio[0];
    let all = Monitored { decision: Decision::Nothing, levels, step: every.step(), excluded: 0, worst_ratio };
    if worst_ratio <= 1.0 {
        return Ok(all);
    }
    let mut rest = Rest::default();
    // Only decisions that have a share of the risk.
    for mask in suspects.masks().filter(|mask| likely.masks().any(|m| m == *mask)) {
        let (sights, residuals_m) = rest.without(sights, residuals_m, mask);
        let Ok(modes) = some(book, sights, service) else { continue };
        let Ok(levels) = solver.levels(other, sights, residuals_m, &Terms { modes, service, share }) else { continue };
        // Where nothing is left to test with, agreement means nothing; the levels are infinite there.
        let tested = levels.finite();
        if tested && Candidates::suspects(solver, other, modes, service).ratio[0] <= 1.0 {
            return Ok(Monitored { decision: Decision::Excluded, levels, step: other.step(), excluded: mask, worst_ratio });
        }
    }
    Ok(Monitored { decision: Decision::NotExcluded, ..all })
}

fn some<'a>(book: &'a mut impl Book, sights: &[Sight], service: &Service) -> Result<&'a FaultModes, NoLevels> {
    if sights.is_empty() {
        return Err(Unavailable::TooFewSatellites { need: 4, have: 0 }.into());
    }
    Ok(book.modes(sights, service)?)
}

/// Fault modes that may be excluded.
struct Candidates {
    mask: [u64; MOST_DECISIONS],
    /// What they are sorted by.
    ratio: [f64; MOST_DECISIONS],
    count: usize,
}

impl Candidates {
    const fn none() -> Self {
        Self { mask: [0; MOST_DECISIONS], ratio: [0.0; MOST_DECISIONS], count: 0 }
    }

    /// Every fault more likely than the integrity risk: those that continuity needs to be excluded.
    ///
    /// # Errors
    /// [`NoModes::TooManyDecisions`].
    fn likely(modes: &FaultModes, service: &Service) -> Result<Self, NoModes> {
        let mut likely = Self::none();
        for mode in modes.iter().skip(1).filter(|m| m.p > service.integrity()) {
            *likely.mask.get_mut(likely.count).ok_or(NoModes::TooManyDecisions { most: MOST_DECISIONS })? = mode.satellites;
            likely.count += 1;
        }
        Ok(likely)
    }

    /// In the order of what they do to the position, so that the first are likely to have the largest levels.
    #[inline(always)]
    fn worst_first(&mut self, damage: impl Fn(u64) -> f64) {
        for k in 0..self.count {
            let (mask, ratio) = (self.mask[k], damage(self.mask[k]));
            let mut place = k;
            while place > 0 && self.ratio[place - 1] < ratio {
                (self.mask[place], self.ratio[place]) = (self.mask[place - 1], self.ratio[place - 1]);
                place -= 1;
            }
            (self.mask[place], self.ratio[place]) = (mask, ratio);
        }
    }

    /// The modes whose separation is largest against its threshold, in that order.
    fn suspects(solver: &mut Solver, of: &Separation, modes: &FaultModes, service: &Service) -> Self {
        let mut suspects = Self::none();
        solver.ratios(of, modes, service, |mask, ratio| {
            // Insertion into the few that are kept.
            let mut place = suspects.count.min(MOST_TRIED - 1);
            if suspects.count == MOST_TRIED && ratio <= suspects.ratio[place] {
                return;
            }
            while place > 0 && suspects.ratio[place - 1] < ratio {
                (suspects.mask[place], suspects.ratio[place]) = (suspects.mask[place - 1], suspects.ratio[place - 1]);
                place -= 1;
            }
            (suspects.mask[place], suspects.ratio[place]) = (mask, ratio);
            suspects.count = (suspects.count + 1).min(MOST_TRIED);
        });
        suspects
    }

    /// Of the risk for each decision, "nothing" among them.
    fn share(&self) -> f64 {
        1.0 / (1 + self.count) as f64
    }

    fn masks(&self) -> impl Iterator<Item = u64> + '_ {
        self.mask[..self.count].iter().copied()
    }
}

/// The satellites that are left, and their residuals where there are any.
pub(super) struct Rest {
    sights: [Sight; MOST_SATELLITES],
    residuals_m: [f64; MOST_SATELLITES],
}

impl Default for Rest {
    fn default() -> Self {
        let none = Sight::plain(Vector3::new(0.0, 0.0, 1.0), Constellation::Gps, 1.0);
        Self { sights: [none; MOST_SATELLITES], residuals_m: [0.0; MOST_SATELLITES] }
    }
}

impl Rest {
    #[inline(always)]
    pub(super) fn without(&mut self, sights: &[Sight], residuals_m: &[f64], mask: u64) -> (&[Sight], &[f64]) {
        let mut count = 0;
        for (i, sight) in sights.iter().enumerate().take(MOST_SATELLITES).filter(|(i, _)| mask >> i & 1 == 0) {
            self.sights[count] = *sight;
            self.residuals_m[count] = residuals_m.get(i).copied().unwrap_or(0.0);
            count += 1;
        }
        (&self.sights[..count], &self.residuals_m[..count.min(residuals_m.len())])
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{P_CONST, published};
    use super::*;
    use crate::quantity::Risk;

    /// Every pair may be faulty together: more modes than are tried. The ones that are kept are the largest of all, in their order.
    #[test]
    fn the_modes_that_are_tried_are_the_sixteen_with_the_largest_separations() {
        let every = Service { consolidation: 0.0, unmonitored: Risk::constant(1e-12), ..Service::LPV_200 };
        for faulty in 0..10_usize {
            let sights = published(1e-4);
            let residuals: Vec<_> = (0..10_usize).map(|i| (3 * i % 7) as f64 + if i == faulty { 30.0 } else { 0.0 }).collect();
            let modes = every.modes(&sights, &P_CONST).unwrap();
            let (mut solver, mut separation) = (Solver::default(), Separation::default());
            solver.levels(&mut separation, &sights, &residuals, &Terms { modes: &modes, service: &every, share: 1.0 }).unwrap();
            let mut all = Vec::new();
            solver.ratios(&separation, &modes, &every, |mask, ratio| all.push((mask, ratio)));
            assert!(all.len() > 3 * MOST_TRIED, "{}", all.len());
            // A stable sort: of equal ones the first stays first.
            all.sort_by(|a, b| b.1.total_cmp(&a.1));
            let suspects = Candidates::suspects(&mut solver, &separation, &modes, &every);
            assert_eq!(suspects.count, MOST_TRIED);
            let kept: Vec<_> = suspects.mask.iter().copied().zip(suspects.ratio).take(MOST_TRIED).collect();
            assert_eq!(kept, all[..MOST_TRIED]);
        }
    }

    /// As many as may be excluded, and the share of each: every mode likelier than the risk, in the order of the list, and nothing.
    #[test]
    fn a_decision_is_every_mode_that_is_likelier_than_the_risk() {
        let service = Service::LPV_200;
        for p_sat in [1e-5, 1e-7, 1.1e-7] {
            let modes = service.modes(&published(p_sat), &P_CONST).unwrap();
            let likely = Candidates::likely(&modes, &service).unwrap();
            // The whole integrity risk of this service is 1e-7.
            let expected: Vec<_> = modes.iter().skip(1).filter(|m| m.p > service.integrity()).map(|m| m.satellites).collect();
            assert_eq!(likely.masks().collect::<Vec<_>>(), expected);
            assert_eq!(likely.share(), 1.0 / (expected.len() + 1) as f64);
        }
    }
}
