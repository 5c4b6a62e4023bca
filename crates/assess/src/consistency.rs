//! Whether the filter is as good as it says: simulated flights through it, sample by sample, judged against their truth.

use crate::error::navigation_error;
use crate::fusion::{Driver, Plan};
use crate::parallel;
use nalgebra::{Matrix3, Vector3};
use navbound_core::bound::anp::{circle, sphere};
use navbound_core::frame::{Geodetic, LatLon, radii};
use navbound_core::monitor::separation::Verdict;
use navbound_core::quantity::{GpsTime, Metres, OutOfDomain, Radians, Risk};
use navbound_core::solution::ins::{Attitude, Beside, Fusion, Innovations, Kind, Mode, NavState, Settings, Solution, StartSigma};
use navbound_simulate::{Motion, Sensing};

/// What a flight's results say of the filter, after the time that is left out.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Score {
    /// Results judged.
    pub n: u64,
    /// Sum of e' V^-1 e.
    pub sum_nees: f64,
    /// Results inside the 95 % circle and the 95 % sphere.
    pub n_circle: u64,
    /// See [`Score::n_circle`].
    pub n_sphere: u64,
    /// Sums of squared errors east, north, up, and of their variances \[m²\].
    pub sum_square_m2: [f64; 3],
    /// See [`Score::sum_square_m2`].
    pub sum_variance_m2: [f64; 3],
    /// Results in each mode: coasting, VOR/DME, DME/DME, satellites, aligning.
    pub n_mode: [u64; 5],
    /// Results after a stop.
    pub n_stopped: u64,
}

impl Score {
    /// Root mean squares of the errors, and of the deviations that the filter stated, east, north, up \[m\].
    pub fn rms_m(&self) -> [[f64; 3]; 2] {
        let n = self.n as f64;
        [self.sum_square_m2, self.sum_variance_m2].map(|sums| [0, 1, 2].map(|k| (sums[k] / n).sqrt()))
    }
}

/// A flight judged.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Judged {
    /// The solution.
    pub main: Score,
    /// The filter without satellites beside it, where one runs.
    pub beside: Score,
    /// Of the ranges, or of the positions solved from them in the loose form: mean squared innovation, lag-one correlation, how many were
    /// used and gated.
    pub ranges: [f64; 4],
    /// Largest memory of those innovations, in standard deviations; NaN where there were too few.
    pub memory_most: f64,
    /// Whether both filters agree.
    pub agreement: Agreement,
}

/// How far both filters were from each other.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Agreement {
    /// Instants compared.
    pub n: u64,
    /// Sum of the squared normalised differences, two degrees of freedom each, and the largest.
    pub sum_square: f64,
    /// See [`Agreement::sum_square`].
    pub most: f64,
    /// Times that they were said to disagree.
    pub n_raised: u64,
}

/// How flights are run and judged.
#[derive(Debug, Clone, Copy)]
pub struct Trial {
    /// Of the filter.
    pub settings: Settings,
    /// Standard deviations of the start, of which the true start errors are drawn.
    pub sigma: StartSigma,
    /// Results and updates.
    pub plan: Plan,
    /// Time from the begin that is not judged \[s\].
    pub skip_s: f64,
}

/// Flights `first ..` of a scenario, one for each row of standard normal numbers (position, velocity, misalignment: the start errors in
/// standard deviations), on all cores. Each depends on scenario, seed, number and row only; no samples are kept.
///
/// # Errors
/// [`OutOfDomain`] as [`Sensing::flight`] and [`Fusion::new`], of the first flight that fails.
pub fn flights(sensing: &Sensing, seed: u64, first: u64, starts: &[[f64; 9]], trial: &Trial) -> Result<Vec<Judged>, OutOfDomain> {
    let numbered: Vec<_> = (first..).zip(starts).collect();
    parallel::try_map(numbered.len(), 1, |k| flight(sensing, seed, numbered[k].0, numbered[k].1, trial))
}

fn flight(sensing: &Sensing, seed: u64, number: u64, normals: &[f64; 9], trial: &Trial) -> Result<Judged, OutOfDomain> {
    let trajectory = sensing.trajectory(seed, number)?;
    let mut sensed = sensing.flight(&trajectory, seed, number)?;
    let begin = sensed.begin();
    let start = wrong_start(
        NavState::new(begin, &sensed.now().position, sensed.now().velocity_ned_mps, &attitude(sensed.now()))?,
        normals,
        &trial.sigma,
    )?;
    let mut driver = Driver::new(Box::new(Fusion::new(start, &trial.sigma, trial.settings)?), trial.plan);
    let (mut judged, mut verdict) = (Judged { memory_most: f64::NAN, ..Judged::default() }, Verdict::new(trial.settings.separation));
    while let Some(step) = sensed.advance()? {
        if step.delivered {
            driver.sample(&step.imu);
        }
        driver.aid(sensed.aiding());
        let Some(time) = driver.output_is_due(step.imu.time) else { continue };
        if time.seconds_since(begin) >= trial.skip_s {
            judged.main.add(driver.filter.solution(time).as_ref(), &step.truth.position)?;
            if let Some(beside) = &driver.filter.beside(time) {
                judged.beside.add(Some(&beside.solution), &step.truth.position)?;
                judged.agreement.add(&mut verdict, time, beside)?;
            }
            judged.memory_most = judged.memory_most.max(ranges(&driver.filter).memory(time).abs());
        }
    }
    let ranges = ranges(&driver.filter);
    judged.ranges = [ranges.mean_square(), ranges.lag_one(), ranges.n_used as f64, ranges.n_gated as f64];
    Ok(judged)
}

/// The innovations that satellites leave: of their ranges, or in the loose form of the positions solved from them.
fn ranges(filter: &Fusion) -> &Innovations {
    let ranges = filter.innovations(Kind::Range);
    if ranges.n_used > 0 { ranges } else { filter.innovations(Kind::FixPosition) }
}

impl Agreement {
    fn add(&mut self, verdict: &mut Verdict, time: GpsTime, beside: &Beside) -> Result<(), OutOfDomain> {
        let before = verdict.disagree();
        if let Some(separation) = verdict.judge(time, &beside.difference, &beside.covariance, &beside.solution.covariance)? {
            self.n += 1;
            self.sum_square += separation.square;
            self.most = self.most.max(separation.square);
        }
        self.n_raised += u64::from(verdict.disagree() && !before);
        Ok(())
    }
}

pub(crate) fn attitude(motion: &Motion) -> Attitude {
    let [roll, pitch, heading] = motion.roll_pitch_yaw_rad().map(Radians::new);
    Attitude { roll, pitch, heading }
}

/// The true start with errors of the deviations: estimate minus truth, `C_estimated = (1 - [phi x]) C`.
pub(crate) fn wrong_start(truth: NavState, normals: &[f64; 9], sigma: &StartSigma) -> Result<NavState, OutOfDomain> {
    let position = truth.position()?;
    let r = radii(position.point.lat());
    let (lat, h) = (position.point.lat().rad(), position.height.m());
    let ned: [f64; 3] = core::array::from_fn(|k| normals[k] * sigma.position[k].m());
    let lat_wrong = lat + ned[0] / (r.meridian.m() + h);
    let lon_wrong = position.point.lon().rad() + ned[1] / ((r.prime_vertical.m() + h) * lat.cos());
    let point = LatLon::new(Radians::new(lat_wrong), Radians::new(lon_wrong))?;
    let velocity = truth.velocity_ned_mps() + Vector3::new(normals[3], normals[4], normals[5]) * sigma.velocity_mps;
    let phi = Vector3::from_fn(|k, _| normals[6 + k] * sigma.attitude[k].rad());
    let c = (Matrix3::identity() - phi.cross_matrix()) * truth.ned_from_body();
    let attitude = Attitude {
        roll: Radians::new(c[(2, 1)].atan2(c[(2, 2)])),
        pitch: Radians::new((-c[(2, 0)]).clamp(-1.0, 1.0).asin()),
        heading: Radians::new(c[(1, 0)].atan2(c[(0, 0)])),
    };
    NavState::new(truth.time, &Geodetic { point, height: Metres::new(h - ned[2]) }, velocity, &attitude)
}

impl Score {
    fn add(&mut self, solution: Option<&Solution>, truth: &Geodetic) -> Result<(), OutOfDomain> {
        let Some(s) = solution else {
            self.n_stopped += 1;
            return Ok(());
        };
        let error = navigation_error(&s.state.position()?, truth);
        let (e, v) = (error.vector(), s.covariance.matrix());
        self.n += 1;
        self.sum_nees += v.cholesky().map_or(f64::NAN, |c| e.dot(&c.solve(e)));
        self.n_circle += u64::from(e.xy().norm() <= circle(&s.covariance, None, Risk::ACCURACY)?.m());
        self.n_sphere += u64::from(e.norm() <= sphere(&s.covariance, None, Risk::ACCURACY)?.m());
        for k in 0..3 {
            self.sum_square_m2[k] += e[k] * e[k];
            self.sum_variance_m2[k] += v[(k, k)];
        }
        let mode = match s.mode {
            Mode::Coasting => 0,
            Mode::VorDme => 1,
            Mode::DmeDme => 2,
            Mode::Gnss => 3,
            Mode::Aligning => 4,
        };
        self.n_mode[mode] += 1;
        Ok(())
    }
}
