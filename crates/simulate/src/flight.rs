//! One flight: the aircraft steered by a navigation that is wrong, both set down as epochs.
//!
//! Where the navigation comes from is the caller's: drawn from the covariance of the geometry ([`fly`]), or worked out by a filter from
//! sensors ([`fly_by`]).

use crate::aircraft::{Aircraft, Deviation, STEPS};
use crate::outlook::{Instant, Outlook, lateral_fault_m, right_of};
use crate::philox::{Sensor, Stream};
use crate::sensors::PathFlown;
use nalgebra::Vector3;
use navbound_core::frame::{Covariance, Displacement, Enu, Geodetic};
use navbound_core::monitor::judgement::{Decision, Reason, Reasons, Source, Status};
use navbound_core::quantity::{Metres, OutOfDomain, Radians, Unavailable};
use navbound_core::solution::ins::Mode;
use navbound_path::Line;

/// One epoch of a flight. Numbers of an estimate that does not exist are NaN.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlownEpoch {
    /// GPS time \[ns\].
    pub time_ns: i64,
    /// True position: latitude, longitude \[rad\], height \[m\].
    pub truth: [f64; 3],
    /// Estimated position, likewise.
    pub estimate: [f64; 3],
    /// Claimed covariance: ee, en, nn, eu, nu, uu \[m²\].
    pub covariance_m2: [f64; 6],
    /// The point of the path that the estimate belongs to (the planned one where there is no estimate), likewise.
    pub path: [f64; 3],
    /// Course there \[rad\].
    pub course_rad: f64,
    /// Path angle there \[rad\].
    pub path_angle_rad: f64,
    /// Distance along the path there \[m\].
    pub along_m: f64,
    /// Index of the leg there.
    pub leg: u32,
    /// Index of the phase.
    pub phase: u32,
    /// RNP value in force \[m\].
    pub rnp_m: f64,
    /// Speed over the ground \[m/s\].
    pub ground_speed_mps: f64,
    /// Flight technical error across and above the path \[m\].
    pub fte_m: [f64; 2],
    /// Navigation system error east, north, up \[m\].
    pub nse_enu_m: [f64; 3],
    /// Satellites in the solution.
    pub n_sv: u32,
    /// Dilutions of precision, horizontal and vertical.
    pub dop: [f64; 2],
    /// Why there is no estimate.
    pub reason: Option<Unavailable>,
    /// What keeps the position of a filter; `None` without one.
    pub mode: Option<Mode>,
    /// Measurements that a filter threw away in the last second.
    pub n_gated: u32,
    /// Horizontal distance between the filter with satellites and the one without, and how far they may be \[m\].
    pub separation_m: Option<[f64; 2]>,
    /// What the innovations of the ranges remember, in standard deviations.
    pub memory: Option<f64>,
    /// Why the estimate is not to be relied on though there is one.
    pub doubt: Option<Doubt>,
    /// What became of the epoch by the judge of filtered positions; `None` without a filter.
    pub decision: Option<Decision>,
    /// What a filter says of its measurements and its inertial unit; `None` without one.
    pub inside: Option<Inside>,
}

/// What a filter says of its measurements and its inertial unit at a second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inside {
    /// Largest innovation of the last second over its gate, of the ranges, the stations and the altimeter; `None` where none was examined.
    pub innovations: [Option<f64>; 3],
    /// Biases of the gyroscopes \[rad/s\] and the accelerometers \[m/s²\] on the axes of the body; `None` without a solution.
    pub biases: Option<[Vector3<f64>; 2]>,
    /// Their standard deviations.
    pub sigma_biases: Option<[Vector3<f64>; 2]>,
}

/// A contradiction of which nobody knows which side is right.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Doubt {
    /// The filter with satellites and the one without disagree, and satellites keep the position or were lost before.
    Filters,
    /// Without satellites, several stations at once have been left out for a while: they or the inertial unit are wrong.
    Stations,
}

/// What the navigation says at an instant, and how wrong it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Navigated {
    /// True minus estimated position, east, north, up \[m\]; the last one where there is no estimate.
    pub error_enu_m: Vector3<f64>,
    /// What it claims of that error, or why there is no estimate.
    pub covariance: Result<Covariance<Enu>, Unavailable>,
    /// Satellites in use.
    pub n_sv: u32,
    /// Dilutions of precision, horizontal and vertical.
    pub dop: [f64; 2],
    /// As in [`FlownEpoch`].
    pub mode: Option<Mode>,
    /// As in [`FlownEpoch`].
    pub n_gated: u32,
    /// As in [`FlownEpoch`].
    pub separation_m: Option<[f64; 2]>,
    /// As in [`FlownEpoch`].
    pub memory: Option<f64>,
    /// As in [`FlownEpoch`].
    pub doubt: Option<Doubt>,
    /// As in [`FlownEpoch`].
    pub decision: Option<Decision>,
    /// As in [`FlownEpoch`].
    pub inside: Option<Inside>,
}

/// A flight of a scenario with position errors drawn from the covariance of the geometry; the number chooses its random streams.
///
/// # Errors
/// [`OutOfDomain`] for a route that leaves the Earth's latitudes: beside a pole.
pub fn fly(outlook: &Outlook, seed: u64, number: u64) -> Result<Vec<FlownEpoch>, OutOfDomain> {
    let errors = navigation_errors(outlook, seed, number);
    let drawn = |(instant, error): (&Instant, &Vector3<f64>)| Navigated {
        error_enu_m: *error,
        covariance: instant.sky.covariance,
        n_sv: instant.sky.n_sv as u32,
        dop: instant.dop(),
        mode: None,
        n_gated: 0,
        separation_m: None,
        memory: None,
        doubt: None,
        decision: None,
        inside: None,
    };
    let navigated: Vec<_> = outlook.instants.iter().zip(&errors).map(drawn).collect();
    fly_by(outlook, seed, number, &navigated, PathFlown::Flown)
}

/// A flight steered by a navigation of the caller's, one item for each second of the outlook.
///
/// Flown, the guidance sees the estimate and leaves a technical error; planned, it leaves none and the estimate stays on the path.
///
/// # Errors
/// As [`fly`]; [`OutOfDomain`] for more or fewer items than seconds.
pub fn fly_by(outlook: &Outlook, seed: u64, number: u64, navigated: &[Navigated], path: PathFlown) -> Result<Vec<FlownEpoch>, OutOfDomain> {
    let (scenario, n) = (&outlook.scenario, outlook.instants.len());
    if navigated.len() != n {
        return Err(OutOfDomain { argument: "navigated", value: navigated.len() as f64, unit: "items", domain: "one for each second" });
    }
    let mut aircraft = Aircraft::new(&outlook.plan, scenario.guidance, scenario.gusts, seed, number);
    let mut epochs = Vec::with_capacity(n);
    for (i, instant) in outlook.instants.iter().enumerate() {
        let from = seen_error(instant, &navigated[i]);
        let deviation = if path == PathFlown::Planned { from } else { aircraft.deviation() };
        epochs.push(epoch(outlook, instant, deviation, &navigated[i])?);
        let next = (i + 1).min(n - 1);
        let to = seen_error(&outlook.instants[next], &navigated[next]);
        for step in 0..STEPS {
            let share = step as f64 / STEPS as f64;
            let error =
                Deviation { right_m: from.right_m + share * (to.right_m - from.right_m), up_m: from.up_m + share * (to.up_m - from.up_m) };
            aircraft.step(instant.time_s + share, error);
        }
    }
    Ok(epochs)
}

/// Errors (true minus estimated, east-north-up) with exactly the covariance of each epoch and a first-order Gauss-Markov course in time.
///
/// ```text
/// e = chol(V) w      w' = r w + sqrt(1 - r^2) n      r = exp(-1 s / tau)
/// ```
fn navigation_errors(outlook: &Outlook, seed: u64, number: u64) -> Vec<Vector3<f64>> {
    let mut stream = Stream::new(seed, number, Sensor::Navigation);
    let mut draw = || Vector3::new(stream.normal(), stream.normal(), stream.normal());
    let keep = (-1.0 / outlook.scenario.navigation.correlation_time_s).exp();
    let fresh = (1.0 - keep * keep).sqrt();
    let mut white = draw();
    let mut errors = Vec::with_capacity(outlook.instants.len());
    for instant in &outlook.instants {
        let fault = lateral_fault_m(&outlook.scenario.faults, instant.time_s);
        errors.push(instant.sky.factor * white + fault * right_of(instant.place.course));
        white = keep * white + fresh * draw();
    }
    errors
}

/// Largest error that the guidance is steered by \[m\]: it flies no differently for one that is larger.
const STEERED_MOST_M: f64 = 1e6;

fn seen_error(instant: &Instant, navigated: &Navigated) -> Deviation {
    let error = &navigated.error_enu_m;
    let bounded = |x: f64| if x.is_nan() { 0.0 } else { x.clamp(-STEERED_MOST_M, STEERED_MOST_M) };
    Deviation { right_m: bounded(right_of(instant.place.course).dot(error)), up_m: bounded(error.z) }
}

fn epoch(outlook: &Outlook, instant: &Instant, deviation: Deviation, navigated: &Navigated) -> Result<FlownEpoch, OutOfDomain> {
    let demand = &instant.demand;
    let beside = Radians::new(instant.place.course.rad() + core::f64::consts::FRAC_PI_2);
    let point = Line::from_azimuth(instant.place.point, beside)?.at(Metres::new(deviation.right_m))?.point;
    let truth = Geodetic { point, height: Metres::new(demand.height_m + deviation.up_m) };
    let phase = outlook.plan.phase_at(demand.along_m);
    let mut epoch = FlownEpoch {
        time_ns: outlook.scenario.start_ns + (instant.time_s * 1e9) as i64,
        truth: numbers(&truth),
        estimate: [f64::NAN; 3],
        covariance_m2: [f64::NAN; 6],
        path: [instant.place.point.lat().rad(), instant.place.point.lon().rad(), demand.height_m],
        course_rad: instant.place.course.rad(),
        path_angle_rad: demand.slope.atan(),
        along_m: demand.along_m,
        leg: instant.place.leg as u32,
        phase: phase as u32,
        rnp_m: outlook.plan.phases()[phase].rnp.m(),
        ground_speed_mps: demand.speed_mps,
        fte_m: [f64::NAN; 2],
        nse_enu_m: [f64::NAN; 3],
        n_sv: navigated.n_sv,
        dop: navigated.dop,
        reason: navigated.covariance.as_ref().err().copied(),
        mode: navigated.mode,
        n_gated: navigated.n_gated,
        separation_m: navigated.separation_m,
        memory: navigated.memory,
        doubt: navigated.doubt,
        decision: navigated.decision,
        inside: navigated.inside,
    };
    // An estimate that belongs to no point of the path, or to none of the Earth, is none; the flight goes on.
    if epoch.estimate(outlook, instant, &truth, navigated).is_err() {
        (epoch.reason, epoch.mode, epoch.decision) = (Some(DIVERGED), None, Some(nothing(epoch.decision)));
    }
    Ok(epoch)
}

/// A decision about an estimate that turned out to be none.
fn nothing(decided: Option<Decision>) -> Decision {
    let reasons = decided.map_or(Reasons::NONE, |d| d.reasons).with(Reason::StateStale);
    Decision { status: Status::NotAvailable, reasons, source: Source::None, hpl_m: None, vpl_m: None, disputed: false }
}

/// Why an estimate that is too wrong is none.
const DIVERGED: Unavailable = Unavailable::Missing { method: "the navigation filter", field: "an estimate within 5000 km of the path" };

impl FlownEpoch {
    /// Adds what rests on the estimate, where there is one.
    fn estimate(&mut self, outlook: &Outlook, instant: &Instant, truth: &Geodetic, navigated: &Navigated) -> Result<(), OutOfDomain> {
        let (Ok(covariance), error) = (&navigated.covariance, &navigated.error_enu_m) else { return Ok(()) };
        let estimate = truth.moved(&Displacement::<Enu>::from_vector(-error))?;
        let foot = outlook.plan.route.project(&estimate.point, Some(Metres::new(instant.demand.along_m)))?;
        let path_height = instant.demand.height_m + instant.demand.slope * (foot.along.m() - instant.demand.along_m);
        let claim = outlook.scenario.navigation.claimed_sigma_scale;
        let v = covariance.matrix() * (claim * claim);
        self.estimate = numbers(&estimate);
        self.covariance_m2 = [v[(0, 0)], v[(0, 1)], v[(1, 1)], v[(0, 2)], v[(1, 2)], v[(2, 2)]];
        self.path = [foot.point.lat().rad(), foot.point.lon().rad(), path_height];
        self.course_rad = foot.course.rad();
        self.along_m = foot.along.m();
        self.leg = foot.leg as u32;
        self.fte_m = [foot.cross.m(), estimate.height.m() - path_height];
        self.nse_enu_m = [error.x, error.y, error.z];
        Ok(())
    }
}

fn numbers(position: &Geodetic) -> [f64; 3] {
    [position.point.lat().rad(), position.point.lon().rad(), position.height.m()]
}
