//! The ranges of one instant by themselves: position, velocity, test and level.

use super::{Guard, Looked};
use crate::bound::araim::exclusion::Decision as Exclusion;
use crate::monitor::judgement::RangesAgree;
use crate::quantity::{GpsTime, Unavailable};
use crate::signal::{SatelliteId, SatelliteRange};
use crate::solution::snapshot::{RANGES_MOST, Ranges, Snapshot, SnapshotVelocity, rate_sights, velocity};
use crate::solution::wls::WeightedSight;
use crate::special::float::hypot;

impl Guard {
    /// One range of each satellite, and none that is the last one again to the bit: a receiver that has stopped measures nothing.
    pub(super) fn fresh(&mut self, ranges: &Ranges) -> Ranges {
        let before = core::mem::replace(&mut self.last, ranges.clone());
        let repeated =
            |m: &SatelliteRange| before.iter().any(|b| b.satellite == m.satellite && b.range == m.range && b.rate_mps == m.rate_mps);
        let mut named = [None; RANGES_MOST];
        let kept = ranges.iter().filter(|m| {
            let known = named.contains(&Some(m.satellite));
            if let (false, Some(place)) = (known, named.iter_mut().find(|n| n.is_none())) {
                *place = Some(m.satellite);
            }
            !known && !repeated(m)
        });
        let mut all = [None; RANGES_MOST];
        kept.zip(all.iter_mut()).for_each(|(m, place)| *place = Some(*m));
        Ranges::of(all.iter().flatten())
    }

    /// Position, test and level of the ranges; the one that is left out leaves the set.
    pub(super) fn look(&mut self, time: GpsTime, ranges: &mut Ranges) -> Result<(Looked, Option<SatelliteId>), Unavailable> {
        let mut snapshot = self.solver.position(time, ranges)?;
        let (sights, residuals, n) = sights(&snapshot);
        let monitored = self.raim.monitored(&sights[..n], &residuals[..n])?;
        let (mut level_m, mut excluded) = ([monitored.levels.hpl.m(), monitored.levels.vpl_m()], None);
        let ranges_agree = match monitored.decision {
            Exclusion::Nothing if monitored.levels.detail.redundancy > 0 => RangesAgree::Yes,
            Exclusion::Nothing => RangesAgree::Untestable,
            Exclusion::Excluded => {
                excluded = monitored.excluded.and_then(|k| snapshot.members().nth(k)).map(|m| m.satellite);
                RangesAgree::Yes
            }
            Exclusion::NotExcluded => RangesAgree::No,
        };
        if let Some(satellite) = excluded {
            *ranges = ranges.without(satellite);
            snapshot = self.solver.position(time, ranges)?;
        }
        let velocity = self.velocity(&snapshot, ranges);
        let speed = velocity.map_or(0.0, |v| hypot(v.enu_mps.x, v.enu_mps.y));
        level_m[0] += 3.0 * self.settings.age_sigma_s * speed;
        Ok((Looked { snapshot, velocity, ranges_agree, level_m }, excluded))
    }

    /// The velocity by rates that agree, one left out at most.
    fn velocity(&mut self, snapshot: &Snapshot, ranges: &Ranges) -> Option<SnapshotVelocity> {
        let (mut sights, mut residuals, _, mut n) = rate_sights(snapshot, ranges);
        let monitored = self.rates.monitored(&sights[..n], &residuals[..n]).ok()?;
        match (monitored.decision, monitored.excluded) {
            (Exclusion::Nothing, _) => {}
            (Exclusion::Excluded, Some(k)) => {
                sights.copy_within(k + 1..n, k);
                residuals.copy_within(k + 1..n, k);
                n -= 1;
            }
            _ => return None,
        }
        velocity(&sights[..n], &residuals[..n])
    }

    pub(super) fn note_acceleration(&mut self, before: Option<&Looked>, now: &Looked) {
        let between = |b: &Looked| {
            let dt = now.snapshot.time.seconds_since(b.snapshot.time);
            let change = (now.velocity?.enu_mps - b.velocity?.enu_mps).norm();
            (dt > 0.0 && dt <= 1.5).then(|| change / dt)
        };
        self.acceleration_mps2 = before.and_then(between);
    }
}

/// Directions, weights and residuals of a snapshot's ranges.
fn sights(snapshot: &Snapshot) -> ([WeightedSight; RANGES_MOST], [f64; RANGES_MOST], usize) {
    let none = WeightedSight { unit: nalgebra::Vector3::zeros(), weight: 0.0, constellation: crate::signal::Constellation::Gps };
    let (mut sights, mut residuals, mut n) = ([none; RANGES_MOST], [0.0; RANGES_MOST], 0);
    for member in snapshot.members() {
        (sights[n], residuals[n]) = (member.sight, member.residual_m);
        n += 1;
    }
    (sights, residuals, n)
}
