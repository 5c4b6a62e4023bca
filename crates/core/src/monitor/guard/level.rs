//! Levels of the filter: from the last snapshot on, of two readings that contradict each other, and the covariance to state with them.

use super::Guard;
use crate::frame::{Covariance, EcefPosition, Enu, ecef_from_geodetic};
use crate::monitor::judgement::{CarriedFacts, Decision, RangesAgree, Reason, SnapshotFacts, Source};
use crate::quantity::{GpsTime, OutOfDomain, Risk};
use crate::solution::ins::Solution;
use crate::solution::snapshot::Snapshot;
use crate::solution::wls::horizontal_axes;
use crate::special::chi::chi_factor;
use crate::special::float::{hypot, sqrt};

/// Inertial faults that the growth covers where no envelope is declared \[m/s²\], \[rad/s\]. Provenance: inferred.
const UNSEEN: [f64; 2] = [0.01, 1e-5];
/// \[m/s²\]
const GRAVITY: f64 = 9.8;

impl Guard {
    /// The covariance to state of a position: its own, and more
    ///
    /// - where two readings contradict each other: so much that its 95 % bounds are the level. The distance of the other reading is no scatter:
    ///   where that one is right the error is as large all the time;
    /// - where nothing checks the filter any more: the last level at the risk of a fault-free level, for what the tests had left unseen by then
    ///   is still in the filter.
    ///
    /// # Errors
    /// As [`chi_factor`].
    pub fn stated(&self, decision: &Decision, own: &Covariance<Enu>) -> Result<Covariance<Enu>, OutOfDomain> {
        let unchecked = decision.source == Source::Filter && decision.reasons.has(Reason::SnapshotMissing);
        let (level, risk) = match (decision.disputed, decision.hpl_m.zip(decision.vpl_m), &self.level) {
            (true, Some((hpl, vpl)), _) => ([hpl, vpl], Risk::ACCURACY.q()),
            (false, _, Some((_, level, _))) if unchecked => (*level, self.settings.requirement.fault_free.q()),
            _ => return Ok(*own),
        };
        let [h, v] = [level[0] / chi_factor(2, risk)?, level[1] / chi_factor(1, risk)?];
        let wide = nalgebra::Matrix3::from_diagonal(&nalgebra::Vector3::new(h * h, h * h, v * v));
        Ok(Covariance::claim_symmetric(own.matrix() + wide))
    }

    /// Distance to another solution and its own bound for the risk of a fault-free level.
    pub(super) fn bound_of(&self, snapshot: &Snapshot, other: &Solution, antenna: &EcefPosition) -> Option<[f64; 2]> {
        let [h, v] = apart(snapshot, antenna)?;
        let q = self.settings.requirement.fault_free.q();
        let sigma_v = sqrt(other.covariance.matrix()[(2, 2)]);
        Some([h + chi_factor(2, q).ok()? * horizontal_axes(&other.covariance).0.m(), v + chi_factor(1, q).ok()? * sigma_v])
    }

    /// The levels of the last epoch that had a snapshot, with what the filter has lost since and what a fault of the unit within the declared
    /// envelope makes of it: sample and truth are each within the envelope. Without an envelope: the faults that the tests leave unseen.
    ///
    /// ```text
    /// HPL(t) = HPL(t0) + K (sigma(t) - sigma(t0)) + a t^2 + g w t^3 / 3
    /// ```
    pub(super) fn carry(&mut self, epoch: GpsTime, snapshot: Option<&SnapshotFacts>, output: Option<&Solution>) -> Option<CarriedFacts> {
        let output = output?;
        let sigma = [horizontal_axes(&output.covariance).0.m(), sqrt(output.covariance.matrix()[(2, 2)])];
        let tested = snapshot.filter(|s| s.time == epoch && s.ranges_agree == RangesAgree::Yes);
        if let Some(([h, v], [dh, dv])) = tested.and_then(|s| s.level_m.zip(s.distance_m)) {
            self.level = Some((epoch, [h + dh, v + dv], sigma));
        }
        let (from, level, before) = self.level?;
        let t = epoch.seconds_since(from);
        let q = self.settings.requirement.fault_free.q();
        let factor = [chi_factor(2, q).ok()?, chi_factor(1, q).ok()?];
        let [force, rate] = core::array::from_fn(|k| {
            let most = self.settings.envelope.most[k];
            if most.is_finite() { most } else { UNSEEN[k] }
        });
        let fault = if t > 0.0 { force * t * t + GRAVITY * rate * t * t * t / 3.0 } else { 0.0 };
        let level_m = core::array::from_fn(|k| level[k] + factor[k] * (sigma[k] - before[k]).max(0.0) + fault);
        Some(CarriedFacts { age_s: t, level_m })
    }
}

/// Distance between a snapshot and another position of the antenna, horizontal and vertical \[m\].
pub(super) fn apart(snapshot: &Snapshot, antenna: &EcefPosition) -> Option<[f64; 2]> {
    let d = antenna.minus(&ecef_from_geodetic(&snapshot.position)).to_enu(&snapshot.position.point);
    let distance = [hypot(d.vector().x, d.vector().y), d.vector().z.abs()];
    distance.iter().all(|x| x.is_finite()).then_some(distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Displacement, Geodetic, LatLon};
    use crate::quantity::{Metres, Radians};
    use nalgebra::{Matrix3, Vector3};

    #[test]
    fn the_distance_of_two_positions_is_level_and_upwards() {
        let point = LatLon::new(Radians::new(0.7), Radians::new(2.0)).unwrap();
        let place = Geodetic { point, height: Metres::new(1000.0) };
        let snapshot = Snapshot::solved(GpsTime::default(), place, Covariance::claim_symmetric(Matrix3::identity()));
        let at = |enu: Vector3<f64>| apart(&snapshot, &ecef_from_geodetic(&place.moved(&Displacement::<Enu>::from_vector(enu)).unwrap()));
        let [h, v] = at(Vector3::new(30.0, -40.0, -7.0)).unwrap();
        // Fifty metres of a sphere of 6400 km bend by 0.2 mm.
        assert!((h - 50.0).abs() < 1e-3 && (v - 7.0).abs() < 1e-3, "{h} {v}");
        assert!(apart(&snapshot, &EcefPosition::from_vector(Vector3::new(f64::NAN, 0.0, 0.0))).is_none());
    }

    /// The bound of the other reading: the distance, and the quantiles of a fault-free level of the other's own deviations, the longest
    /// horizontal one by the roots of its two by two.
    #[test]
    fn the_bound_of_the_other_reading_is_its_distance_and_its_own_deviations() {
        use super::super::{Envelope, Settings};
        use crate::bound::araim::single::Requirement;
        use crate::frame::ecef_from_geodetic;
        use crate::solution::ins::{Attitude, Fusion, ImuModel, NavState, SensorNoise, Settings as FilterSettings, StartSigma};
        let point = LatLon::new(Radians::new(0.7), Radians::new(2.0)).unwrap();
        let place = Geodetic { point, height: Metres::new(1000.0) };
        let noise = SensorNoise { white: 1e-3, bias: 1e-3, bias_time_s: 3600.0 };
        let sigma = StartSigma { position: [Metres::new(5.0); 3], velocity_mps: 0.1, attitude: [Radians::new(1e-3); 3] };
        let level = Attitude { roll: Radians::new(0.0), pitch: Radians::new(0.0), heading: Radians::new(0.0) };
        let start = NavState::new(GpsTime::default(), &place, Vector3::zeros(), &level).unwrap();
        let settings = FilterSettings::of(ImuModel { gyroscope: noise, accelerometer: noise });
        let mut filter = Fusion::new(start, &sigma, settings).unwrap();
        let solution = filter.solution(GpsTime::default()).unwrap();
        let wide = Matrix3::new(9.0, 6.0, 1.0, 6.0, 25.0, 2.0, 1.0, 2.0, 49.0);
        let other = Solution { covariance: Covariance::claim_symmetric(wide), ..solution };
        let requirement = Requirement::RAIM;
        let settings =
            Settings { envelope: Envelope::NONE, requirement, age_sigma_s: 0.1, gap_most_s: 0.5, age_most_s: 2.0, restart_after_s: 5.0 };
        let guard = Guard::new(settings).unwrap();
        let snapshot = Snapshot::solved(GpsTime::default(), place, Covariance::claim_symmetric(Matrix3::identity()));
        let antenna = ecef_from_geodetic(&place.moved(&Displacement::<Enu>::from_vector(Vector3::new(30.0, -40.0, -7.0))).unwrap());
        let [h, v] = guard.bound_of(&snapshot, &other, &antenna).unwrap();
        let q = requirement.fault_free.q();
        // (9 + 25) / 2 and the root of 8^2 + 6^2: variances 7 and 27. Two degrees of freedom in closed form, one by both tails.
        let horizontal = 50.0 + (-2.0 * q.ln()).sqrt() * 27.0_f64.sqrt();
        let vertical = 7.0 + crate::special::two_sided_factor(q) * 7.0;
        // Fifty metres of a sphere of 6400 km bend by 0.2 mm.
        assert!((h - horizontal).abs() < 1e-3 && (v - vertical).abs() < 1e-3, "{h} {horizontal} {v} {vertical}");
        assert!(guard.bound_of(&snapshot, &other, &EcefPosition::from_vector(Vector3::repeat(f64::NAN))).is_none());
    }
}
