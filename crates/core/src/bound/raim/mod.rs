//! Receiver autonomous integrity monitoring on least-squares residuals: the weighted slope method, one faulty satellite at a time.
//!
//! In the order of the flow: the geometry with its slopes, thresholds by redundancy, levels here; the test of residuals and the exclusion of
//! a satellite in [`exclusion`]. RAIM by solution separation is [`super::araim::single`].

pub mod exclusion;
#[cfg(test)]
mod tests;

pub use super::araim::single::Requirement;
use super::{Algorithm, NoLevels, Protection, Provenance, Ranges, Sight};
use crate::quantity::{Metres, Unavailable};
use crate::solution::wls::{Normal, Row, WeightedSight, weighted_row};
use crate::special::float::{hypot, sqrt};
use crate::special::gamma::chi_square_factor;
use crate::special::noncentral::noncentrality;
use crate::special::{one_sided_factor, two_sided_factor};
use nalgebra::{Matrix3, Vector3};

/// Document of the published form; provenance *standard*.
pub const SOURCE: &str = "Brown and Chin 1997, threshold and protection radius by chi-square; weights as Walter and Enge 1995; RTCA DO-229, appendix on fault detection (inferred: the text was not read)";
/// What the levels add to it; provenance *ours*.
pub const NOISE_SOURCE: &str =
    "navbound, docs/methods/raim.md: the noise of the position is added to the published level, which leaves it out (ours)";

/// What the levels are.
pub const PROTECTION: Protection = Protection {
    id: "raim-slope",
    title: "RAIM by slopes of the residuals",
    function: "navbound.raim.protection_levels",
    source: SOURCE,
    provenance: Provenance::Inferred,
    covers: "one satellite of any size of fault",
    assumes: "errors of ranges without a fault are normal, independent and no larger than their sigmas; the noise of the position is added (ours)",
    integrity: true,
};

/// Most satellites of one epoch.
pub const MOST_SATELLITES: usize = 64;
/// Share of its weight below which a satellite's residual is determined by the others not at all: its fault cannot be seen.
const ESSENTIAL: f64 = 1e-9;
/// A satellite that moves the position by less than this a metre moves it by rounding alone \[1\].
const UNMOVED: f64 = 1e-9;

/// Protection levels of one epoch, the noise of the position in them; infinite where a fault cannot be detected.
pub type Levels = super::Levels<Detail>;

/// What RAIM says beside its levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detail {
    /// The published form: the largest slope times the bias that the test misses, no noise.
    pub hpl_slope: Metres,
    /// Likewise.
    pub vpl_slope: Metres,
    /// Standard deviation of the position, east, north, up.
    pub sigma: [Metres; 3],
    /// Ranges beyond the unknowns.
    pub redundancy: usize,
}

/// What a redundancy and a requirement give for every geometry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Factors {
    /// Root of the weighted sum of squared residuals above which there is a fault.
    pub threshold: f64,
    /// Root of the non-centrality that stays below the threshold with the risk of a missed detection.
    pub missed_bias: f64,
}

impl Factors {
    /// Of a test with this many ranges beyond the unknowns.
    ///
    /// ```text
    /// T^2     the chi-square variable exceeds it with the risk of a false alarm
    /// lambda  the chi-square variable of this non-centrality is at most T^2 with the risk of a missed detection
    /// ```
    pub fn new(requirement: &Requirement, redundancy: usize) -> Self {
        let dof = redundancy as f64;
        let square = chi_square_factor(dof, requirement.false_alarm.q());
        Self { threshold: sqrt(square), missed_bias: sqrt(noncentrality(dof, square, requirement.missed_detection.q())) }
    }
}

/// Detection, exclusion and levels, epoch after epoch. No heap; made once for a requirement.
#[derive(Debug, Clone)]
pub struct Monitor {
    requirement: Requirement,
    /// Multipliers of the position's noise: with a fault, and without one.
    noise: [f64; 2],
    factors: [Option<Factors>; MOST_SATELLITES],
    epoch: Epoch,
}

/// The geometry at hand.
#[derive(Debug, Clone)]
struct Epoch {
    count: usize,
    redundancy: usize,
    normal: Normal,
    covariance: Matrix3<f64>,
    rows: [Row; MOST_SATELLITES],
    /// How far the position moves for a metre in each range.
    gain: [Vector3<f64>; MOST_SATELLITES],
    /// Weighted square that a metre in each range leaves in the residuals \[1/m²\].
    left: [f64; MOST_SATELLITES],
}

impl Default for Epoch {
    fn default() -> Self {
        Self {
            count: 0,
            redundancy: 0,
            normal: Normal::default(),
            covariance: Matrix3::zeros(),
            rows: [Row::default(); MOST_SATELLITES],
            gain: [Vector3::zeros(); MOST_SATELLITES],
            left: [0.0; MOST_SATELLITES],
        }
    }
}

impl Monitor {
    /// For a requirement.
    pub fn new(requirement: &Requirement) -> Self {
        let noise = [two_sided_factor(requirement.missed_detection.q()), one_sided_factor(0.5 * requirement.fault_free.q())];
        Self { requirement: *requirement, noise, factors: [None; MOST_SATELLITES], epoch: Epoch::default() }
    }

    /// Levels of detection.
    ///
    /// ```text
    /// slope_i = |s_i| / sqrt(Pi_ii)            s_i moves the position, Pi_ii = w_i (1 - leverage_i) shows in the residuals
    /// published:  PL = max_i slope_i sqrt(lambda)
    /// held:       PL = max(K_ff d, max_i slope_i sqrt(lambda) + K d)          K = Q^-1(P_MD / 2), K_ff = Q^-1(P_ff / 2)
    /// ```
    ///
    /// d is the standard deviation upwards, and sqrt(sigma_e^2 + sigma_n^2) in the horizontal. Below the bias sqrt(lambda) the error exceeds
    /// the held level with at most the risk of a missed detection, from there on the fault is missed with at most that risk.
    ///
    /// # Errors
    /// [`Unavailable`]: too few satellites, a geometry that does not determine the position, a number that is none.
    pub fn levels(&mut self, sights: &[impl Copy + Into<WeightedSight>]) -> Result<Levels, Unavailable> {
        self.levels_of(sights, &[])
    }

    /// The same with residuals for the test, where there are any.
    fn levels_of(&mut self, sights: &[impl Copy + Into<WeightedSight>], residuals_m: &[f64]) -> Result<Levels, Unavailable> {
        self.take(sights, residuals_m)?;
        let epoch = &self.epoch;
        let slopes = (0..epoch.count).fold([0.0; 2], |most, i| steeper(most, epoch.slope(i)));
        let variance = [0, 1, 2].map(|a| epoch.covariance[(a, a)]);
        let redundancy = epoch.redundancy;
        Ok(self.bound(&variance, slopes, redundancy))
    }

    /// Levels after the exclusion of any one satellite of the epoch whose levels are given.
    ///
    /// ```text
    /// without i:  s_j - s_i Pi_ij / Pi_ii,   Pi_jj - Pi_ij^2 / Pi_ii,   V + s_i s_i' / Pi_ii          Pi_ij = -w_i coupling_ij
    /// ```
    ///
    /// Never below those of detection; infinite where exclusion is not possible. `detection` is what [`Self::levels`] gave last.
    pub fn after_exclusion(&mut self, detection: &Levels) -> super::Levels {
        let mut worst = super::Levels { hpl: detection.hpl, vpl: detection.vpl, detail: () };
        for i in 0..self.epoch.count {
            // One that moves nothing is the only one of its clock: without it all stays as it is.
            if self.epoch.gain[i].iter().all(|metres| metres.abs() <= UNMOVED) {
                continue;
            }
            let (hpl, vpl) = self.without(i);
            worst = super::Levels { hpl: larger(worst.hpl, hpl), vpl: worst.vpl.zip(vpl).map(|(a, b)| larger(a, b)), detail: () };
        }
        worst
    }

    /// Levels without one satellite that moves the position.
    fn without(&mut self, i: usize) -> (Metres, Option<Metres>) {
        let epoch = &self.epoch;
        let (row, left) = (&epoch.rows[i], epoch.left[i]);
        if epoch.redundancy < 2 || left <= ESSENTIAL * row.weight {
            return (Metres::new(f64::INFINITY), Some(Metres::new(f64::INFINITY)));
        }
        let mut slopes = [0.0; 2];
        for j in (0..epoch.count).filter(|j| *j != i) {
            let shared = -row.weight * epoch.normal.coupling(&epoch.covariance, row, &epoch.rows[j]);
            let gain = epoch.gain[j] - epoch.gain[i] * (shared / left);
            slopes = steeper(slopes, slope(&gain, epoch.left[j] - shared * shared / left, epoch.rows[j].weight));
        }
        let variance = [0, 1, 2].map(|a| epoch.covariance[(a, a)] + epoch.gain[i][a] * epoch.gain[i][a] / left);
        let redundancy = epoch.redundancy - 1;
        let levels = self.bound(&variance, slopes, redundancy);
        (levels.hpl, levels.vpl)
    }

    /// Take up an epoch.
    fn take(&mut self, sights: &[impl Copy + Into<WeightedSight>], residuals_m: &[f64]) -> Result<(), Unavailable> {
        if sights.len() > MOST_SATELLITES {
            let (value, domain) = (sights.len() as f64, "at most 64 satellites");
            return Err(Unavailable::Invalid { field: "n_sv", value, unit: "1", domain });
        }
        let epoch = &mut self.epoch;
        epoch.count = sights.len();
        for (i, (row, sight)) in epoch.rows.iter_mut().zip(sights).enumerate() {
            *row = Row { residual: residuals_m.get(i).copied().unwrap_or(0.0), ..weighted_row((*sight).into()) };
            checked(row)?;
        }
        let rows = &epoch.rows[..epoch.count];
        epoch.normal = Normal::new(rows.iter().copied())?;
        epoch.covariance = *epoch.normal.covariance()?.matrix();
        epoch.redundancy = rows.len() - 3 - epoch.normal.clocks();
        for (i, row) in rows.iter().enumerate() {
            epoch.gain[i] = epoch.normal.response(&epoch.covariance, row);
            epoch.left[i] = row.weight * (1.0 - epoch.normal.leverage(&epoch.covariance, row));
        }
        Ok(())
    }

    fn factors(&mut self, redundancy: usize) -> Factors {
        let work_out = || Factors::new(&self.requirement, redundancy);
        match self.factors.get_mut(redundancy) {
            Some(known) => *known.get_or_insert_with(work_out),
            None => work_out(),
        }
    }

    fn bound(&mut self, variance: &[f64; 3], slopes: [f64; 2], redundancy: usize) -> Levels {
        let sigma = variance.map(sqrt);
        let missed = if redundancy > 0 { self.factors(redundancy).missed_bias } else { f64::INFINITY };
        let [with_fault, without] = self.noise;
        let noise = [hypot(sigma[0], sigma[1]), sigma[2]];
        let published = [0, 1].map(|k| if redundancy > 0 { slopes[k] * missed } else { f64::INFINITY });
        let guaranteed = [0, 1].map(|k| Metres::new((published[k] + with_fault * noise[k]).max(without * noise[k])));
        let [hpl, vpl] = guaranteed;
        let [hpl_slope, vpl_slope] = published.map(Metres::new);
        Levels::of(hpl, vpl, Detail { hpl_slope, vpl_slope, sigma: sigma.map(Metres::new), redundancy })
    }
}

impl Algorithm for Monitor {
    const PROTECTION: Protection = PROTECTION;
    const RANGES: Ranges = Ranges::Receiver;
    const COLUMNS: &'static [&'static str] =
        &["hel_m", "vel_m", "hpl_slope_m", "vpl_slope_m", "sigma_e_m", "sigma_n_m", "sigma_u_m", "n_redundant"];
    type Settings = Requirement;
    /// Beside the levels of detection those after exclusion.
    type Detail = (Detail, super::Levels);

    fn usual() -> Requirement {
        Requirement::RAIM
    }

    fn new(requirement: &Requirement) -> Self {
        Self::new(requirement)
    }

    #[inline(always)]
    fn levels(&mut self, sights: &[Sight]) -> Result<super::Levels<Self::Detail>, NoLevels> {
        let Levels { hpl, vpl, detail } = self.levels_of(sights, &[])?;
        let after = self.after_exclusion(&Levels { hpl, vpl, detail });
        Ok(super::Levels { hpl, vpl, detail: (detail, after) })
    }

    fn number((detail, after): &Self::Detail, column: usize) -> f64 {
        let [e, n, u] = detail.sigma.map(Metres::m);
        let numbers = [after.hpl.m(), after.vpl_m(), detail.hpl_slope.m(), detail.vpl_slope.m(), e, n, u, detail.redundancy as f64];
        numbers.get(column).copied().unwrap_or(f64::NAN)
    }
}

impl Epoch {
    fn slope(&self, i: usize) -> [f64; 2] {
        slope(&self.gain[i], self.left[i], self.rows[i].weight)
    }
}

/// Error of the position for each unit of the root of the weighted sum of squares, horizontal and vertical \[m\].
fn slope(gain: &Vector3<f64>, left: f64, weight: f64) -> [f64; 2] {
    let moved = [hypot(gain.x, gain.y), gain.z.abs()];
    if left > ESSENTIAL * weight {
        return moved.map(|m| m / sqrt(left));
    }
    moved.map(|m| if m <= UNMOVED { 0.0 } else { f64::INFINITY })
}

fn steeper(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].max(b[0]), a[1].max(b[1])]
}

fn larger(a: Metres, b: Metres) -> Metres {
    if b > a { b } else { a }
}

fn checked(row: &Row) -> Result<(), Unavailable> {
    let length = row.unit.norm();
    if !((length - 1.0).abs() < 1e-3) {
        return Err(Unavailable::Invalid { field: "unit_enu", value: length, unit: "1", domain: "vectors of length one" });
    }
    if !(row.weight > 0.0 && row.weight < f64::INFINITY) {
        let sigma = 1.0 / sqrt(row.weight);
        return Err(Unavailable::Invalid { field: "sigma_m", value: sigma, unit: "m", domain: "(0, inf)" });
    }
    Ok(())
}
