//! Position carried on by phase differenced in time: equations 11 to 15 with the clocks eliminated.
//!
//! ```text
//! P_t = M P' M' + Sd Rd Sd'        bias_t = M S beta        M = I - Sd dH = Sd H_t0
//! ```
//!
//! The differences of the lines of sight have no clock columns, so the position block of M acts on the position block of P' alone and
//! everything is three by three: with d_i the direction less its constellation's weighted mean, N = sum w d d' and G = sum w d u0',
//! Sd Rd Sd' = N^-1 and M = N^-1 G. Taking a satellite away changes both by one outer product.

use crate::bound::gbas::MOST_SATELLITES;
use crate::frame::{Covariance, Enu};
use crate::quantity::{Metres, OutOfDomain, Unavailable};
use crate::signal::Constellation;
use nalgebra::{Matrix3, Vector3};

const CLOCKS: usize = Constellation::ALL.len();
/// Largest product of the traces of N and its inverse, never below the condition number: beyond it the differences of a removal have
/// lost the digits that count.
const CONDITION_LIMIT: f64 = 1e10;

/// A satellite followed without a break since the fix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Followed {
    /// Unit vector to it at the fix, east-north-up.
    pub before: Vector3<f64>,
    /// Unit vector to it now.
    pub now: Vector3<f64>,
    /// Whose clock.
    pub constellation: Constellation,
    /// Standard deviation of its phase differenced over the coasting time.
    pub sigma: Metres,
}

/// How the error of the fix travels, and what the phase adds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Travel {
    /// M: the error of the fix becomes M times it.
    pub carried: Matrix3<f64>,
    /// Sd Rd Sd' \[m²\].
    pub added: Matrix3<f64>,
}

impl Travel {
    /// Covariance after the travel (equation 14).
    pub fn covariance(&self, fix: &Covariance<Enu>) -> Covariance<Enu> {
        Covariance::claim_symmetric(self.carried * fix.matrix() * self.carried.transpose() + self.added)
    }

    /// Covariance of the difference between the travel with all satellites and this one with fewer (same phases, same weights).
    pub fn separation(&self, all: &Self, fix: &Covariance<Enu>) -> Covariance<Enu> {
        let moved = self.carried - all.carried;
        Covariance::claim_symmetric(moved * fix.matrix() * moved.transpose() + self.added - all.added)
    }
}

#[derive(Debug, Clone, Copy)]
struct Group {
    count: usize,
    weight: f64,
    before: Vector3<f64>,
    now: Vector3<f64>,
    information: Matrix3<f64>,
    moved: Matrix3<f64>,
}

const EMPTY: Group =
    Group { count: 0, weight: 0.0, before: Vector3::new(0.0, 0.0, 0.0), now: Vector3::new(0.0, 0.0, 0.0), information: ZERO, moved: ZERO };
const ZERO: Matrix3<f64> = Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);

/// The satellites of a coasting phase, ready to be taken away. No heap.
#[derive(Debug, Clone)]
pub struct Coast {
    count: usize,
    satellites: [(Vector3<f64>, Vector3<f64>, f64, usize); MOST_SATELLITES],
    groups: [Group; CLOCKS],
    information: Matrix3<f64>,
    moved: Matrix3<f64>,
}

/// A set of satellites by their places, bit by bit.
pub type Set = u64;

impl Coast {
    /// From the satellites followed.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a sigma that is not positive, or more than [`MOST_SATELLITES`].
    pub fn new(followed: &[Followed]) -> Result<Self, OutOfDomain> {
        if followed.len() > MOST_SATELLITES {
            return Err(OutOfDomain { argument: "n_sv", value: followed.len() as f64, unit: "1", domain: "[0, 48]" });
        }
        let none = (Vector3::zeros(), Vector3::zeros(), 0.0, 0);
        let mut coast =
            Self { count: followed.len(), satellites: [none; MOST_SATELLITES], groups: [EMPTY; CLOCKS], information: ZERO, moved: ZERO };
        for (slot, f) in coast.satellites.iter_mut().zip(followed) {
            let sigma = f.sigma.m();
            if !(sigma > 0.0 && sigma.is_finite()) {
                return Err(OutOfDomain { argument: "sigma_td_m", value: sigma, unit: "m", domain: "(0, inf)" });
            }
            *slot = (f.before, f.now, 1.0 / (sigma * sigma), f.constellation.index());
        }
        coast.gather();
        Ok(coast)
    }

    fn gather(&mut self) {
        for &(before, now, w, clock) in &self.satellites[..self.count] {
            let g = &mut self.groups[clock];
            g.count += 1;
            g.weight += w;
            g.before += w * before;
            g.now += w * now;
        }
        for g in self.groups.iter_mut().filter(|g| g.count > 0) {
            g.before /= g.weight;
            g.now /= g.weight;
        }
        for &(before, now, w, clock) in &self.satellites[..self.count] {
            let g = &mut self.groups[clock];
            let d = w * (now - g.now);
            g.information += d * (now - g.now).transpose();
            g.moved += d * (before - g.before).transpose();
        }
        self.information = self.groups.iter().map(|g| g.information).sum();
        self.moved = self.groups.iter().map(|g| g.moved).sum();
    }

    /// How many satellites.
    pub const fn len(&self) -> usize {
        self.count
    }
    /// None.
    pub const fn is_empty(&self) -> bool {
        self.count == 0
    }
    /// Constellation of each satellite.
    pub fn constellations(&self) -> impl Iterator<Item = usize> {
        self.satellites[..self.count].iter().map(|s| s.3)
    }

    /// The travel with every satellite.
    ///
    /// # Errors
    /// As [`Self::without`].
    pub fn all(&self) -> Result<Travel, Unavailable> {
        self.without(0)
    }

    /// The travel without a set of satellites.
    ///
    /// # Errors
    /// [`Unavailable::TooFewSatellites`], [`Unavailable::Singular`].
    pub fn without(&self, removed: Set) -> Result<Travel, Unavailable> {
        let (mut information, mut moved) = (self.information, self.moved);
        let (mut have, mut clocks) = (0, 0);
        for (clock, group) in self.groups.iter().enumerate().filter(|(_, g)| g.count > 0) {
            let out = removed & self.members(clock);
            let left = group.count - out.count_ones() as usize;
            have += left;
            if left == 0 {
                information -= group.information;
                moved -= group.moved;
                continue;
            }
            clocks += 1;
            if out != 0 {
                self.take_away(group, out, &mut information, &mut moved);
            }
        }
        let need = if clocks > 0 { 3 + clocks } else { 4 };
        if have < need {
            return Err(Unavailable::TooFewSatellites { need, have });
        }
        let singular = |condition| Unavailable::Singular { condition, limit: CONDITION_LIMIT };
        let added = information.cholesky().ok_or(singular(f64::INFINITY))?.inverse();
        let condition = information.trace() * added.trace();
        if !(condition <= CONDITION_LIMIT) {
            return Err(singular(condition));
        }
        Ok(Travel { carried: added * moved, added })
    }

    /// Places of a constellation's satellites.
    pub fn members(&self, clock: usize) -> Set {
        self.constellations().enumerate().filter(|(_, c)| *c == clock).fold(0, |set, (i, _)| set | 1 << i)
    }

    /// Satellites of one constellation, of which some stay. Each takes `w W / (W - w) d d'` with it, d from the mean of those still there.
    fn take_away(&self, group: &Group, out: Set, information: &mut Matrix3<f64>, moved: &mut Matrix3<f64>) {
        let (mut weight, mut mean_before, mut mean_now) = (group.weight, group.before, group.now);
        let mut rest = out;
        while rest != 0 {
            let i = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            let (before, now, w, _) = self.satellites[i];
            let (d, d0) = (now - mean_now, before - mean_before);
            let left = weight - w;
            let taken = w * weight / left * d;
            *information -= taken * d.transpose();
            *moved -= taken * d0.transpose();
            mean_now -= d * (w / left);
            mean_before -= d0 * (w / left);
            weight = left;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Direction;
    use crate::quantity::Radians;
    use nalgebra::SMatrix;
    use proptest::prelude::*;

    fn unit(az_deg: f64, el_deg: f64) -> Vector3<f64> {
        Direction::new(Radians::degrees(az_deg), Radians::degrees(el_deg)).unwrap().unit()
    }

    fn followed(angles: &[(f64, f64, f64, f64)], systems: usize) -> Vec<Followed> {
        let one = |(i, &(az, el, turned, sigma)): (usize, &(f64, f64, f64, f64))| Followed {
            before: unit(az, el),
            now: unit(az + 3.0 * turned, el + 2.0 * turned),
            constellation: Constellation::ALL[i % systems],
            sigma: Metres::new(sigma),
        };
        angles.iter().enumerate().map(one).collect()
    }

    /// H with clock columns.
    fn dense<const M: usize>(f: &[Followed], pick: fn(&Followed) -> Vector3<f64>) -> SMatrix<f64, 12, M> {
        SMatrix::from_fn(|row, j| if j < 3 { -pick(&f[row])[j] } else { f64::from(u8::from(f[row].constellation.index() == j - 3)) })
    }

    /// M of the whole normal equation two ways, and the covariance of the phase; none for what is badly conditioned. Satellites removed
    /// have no weight. Last, how far rounding may take them: the inverse loses the condition times the rounding of each of its sums (at most
    /// 12 x 6 terms), and what is multiplied by Sd loses its size more.
    fn whole<const M: usize>(f: &[Followed], removed: Set) -> Option<([SMatrix<f64, M, M>; 2], SMatrix<f64, M, M>, f64)> {
        let (h, h0) = (dense::<M>(f, |s| s.now), dense::<M>(f, |s| s.before));
        let w = SMatrix::<f64, 12, 12>::from_fn(|i, j| if i == j && removed >> i & 1 == 0 { f[i].sigma.m().powi(-2) } else { 0.0 });
        let normal = h.transpose() * w * h;
        // Not by cofactors: a closed inverse of four rows loses more than the condition.
        let p = normal.cholesky()?.inverse();
        let condition = normal.norm() * p.norm();
        if !(condition < 1e7) {
            return None;
        }
        let sd = p * h.transpose() * w;
        let lost = 72.0 * f64::EPSILON * condition * (1.0 + sd.norm());
        Some(([sd * h0, SMatrix::identity() - sd * (h - h0)], p, lost))
    }

    fn compare<const M: usize>(f: &[Followed], removed: Set) -> Result<(), TestCaseError> {
        let Some(([by_product, by_difference], p, lost)) = whole::<M>(f, removed) else {
            return Err(TestCaseError::reject("badly conditioned"));
        };
        prop_assert!((by_product - by_difference).amax() < lost);
        let downdated = Coast::new(f).unwrap().without(removed).unwrap();
        let m = by_difference.fixed_view::<3, 3>(0, 0);
        prop_assert!((downdated.carried - m).amax() < 2.0 * lost, "{}", (downdated.carried - m).amax());
        prop_assert!((downdated.added - p.fixed_view::<3, 3>(0, 0)).amax() < 2.0 * lost * (1.0 + p.amax()));
        Ok(())
    }

    proptest! {
        // Against the form with every clock in it.
        #[test]
        fn carried_and_added_are_those_of_the_whole_normal_equation(
            angles in proptest::collection::vec((0.0..360.0f64, 5.0..85.0f64, -1.0..1.0f64, 0.02..0.6f64), 12),
            removed in 0_u64..4096,
            systems in 1_usize..=3,
        ) {
            let f = followed(&angles, systems);
            let kept: Vec<_> = (0..12).filter(|i| removed >> i & 1 == 0).collect();
            let present = (0..systems).all(|c| kept.iter().any(|i| i % systems == c));
            prop_assume!(present && kept.len() >= 4 + systems);
            match systems {
                1 => compare::<4>(&f, removed)?,
                2 => compare::<5>(&f, removed)?,
                _ => compare::<6>(&f, removed)?,
            }
        }
    }

    /// Section 8, item 6, for a sky that no chance makes singular.
    #[test]
    fn the_two_forms_of_m_agree() {
        let angles: Vec<_> =
            (0..12).map(|i| (31.0 * f64::from(i), 8.0 + 6.5 * f64::from(i * 5 % 12), 0.3 * f64::from(i % 5) - 0.6, 0.05)).collect();
        for systems in 1..=3 {
            let f = followed(&angles, systems);
            let difference = match systems {
                1 => whole::<4>(&f, 0).map(|w| (w.0[0] - w.0[1]).amax()),
                2 => whole::<5>(&f, 0).map(|w| (w.0[0] - w.0[1]).amax()),
                _ => whole::<6>(&f, 0).map(|w| (w.0[0] - w.0[1]).amax()),
            };
            assert!(difference.unwrap() < 1e-12, "{systems}: {difference:?}");
        }
    }

    #[test]
    fn without_motion_the_error_stays_as_it_is() {
        let angles =
            [(0.0, 80.0, 0.0, 0.1), (80.0, 20.0, 0.0, 0.2), (150.0, 35.0, 0.0, 0.1), (220.0, 15.0, 0.0, 0.3), (300.0, 45.0, 0.0, 0.1)];
        let travel = Coast::new(&followed(&angles, 1)).unwrap().all().unwrap();
        assert!((travel.carried - Matrix3::identity()).amax() < 1e-12);
    }

    #[test]
    fn taking_all_of_a_constellation_takes_its_clock() {
        let angles: Vec<_> = (0..10).map(|i| (36.0 * f64::from(i) + 3.0, 20.0 + 6.0 * f64::from(i % 7), 0.5, 0.1)).collect();
        let both = followed(&angles, 2);
        let coast = Coast::new(&both).unwrap();
        let one: Vec<_> = both.iter().copied().filter(|f| f.constellation == Constellation::ALL[0]).collect();
        let alone = Coast::new(&one).unwrap().all().unwrap();
        let left = coast.without(coast.members(Constellation::ALL[1].index())).unwrap();
        // Differences of numbers of the size of the information, near 1e3, inverted.
        assert!((alone.carried - left.carried).amax() < 1e-11 && (alone.added - left.added).amax() < 1e-12);
    }

    #[test]
    fn what_is_left_must_determine_the_position() {
        let angles =
            [(0.0, 80.0, 0.1, 0.1), (80.0, 20.0, 0.1, 0.2), (150.0, 35.0, 0.1, 0.1), (220.0, 15.0, 0.1, 0.3), (300.0, 45.0, 0.1, 0.1)];
        let coast = Coast::new(&followed(&angles, 1)).unwrap();
        assert_eq!(coast.without(0b11), Err(Unavailable::TooFewSatellites { need: 4, have: 3 }));
        assert_eq!(coast.without(0b11111), Err(Unavailable::TooFewSatellites { need: 4, have: 0 }));
        let cone: Vec<_> = (0..6).map(|i| (60.0 * f64::from(i), 30.0, 0.0, 0.1)).collect();
        assert!(matches!(Coast::new(&followed(&cone, 1)).unwrap().all(), Err(Unavailable::Singular { .. })));
        let bad = Followed { sigma: Metres::new(f64::NAN), ..followed(&cone, 1)[0] };
        assert_eq!(Coast::new(&[bad]).unwrap_err().argument, "sigma_td_m");
    }
}
