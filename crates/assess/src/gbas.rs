//! GBAS protection levels of many skies.

use crate::parallel;
use navbound_core::bound::Sight;
use navbound_core::bound::gbas::aided::Tracked;
use navbound_core::bound::gbas::bias::Ordering;
use navbound_core::bound::gbas::levels::{self, Levels, Settings};
use navbound_core::bound::gbas::noise::{self, Coloured};
use navbound_core::bound::gbas::range::RangeError;
use navbound_core::bound::gbas::snapshot::{Form, Snapshot};
use navbound_core::frame::{Covariance, Enu};
use navbound_core::geometry::Direction;
use navbound_core::quantity::{Metres, OutOfDomain, Radians, Unavailable};
use navbound_core::signal::Constellation;
use navbound_core::spec::gbas::ErrorModel;
use navbound_path::AtIndex;

/// Skies in one task of the pool.
const SKIES_PER_TASK: usize = 32;

/// Satellites of many skies, one row a sky and one column a satellite; both angles NaN for one that is not used.
#[derive(Debug, Clone, Copy)]
pub struct Skies<'a> {
    /// Azimuth \[rad\].
    pub az_rad: &'a [f64],
    /// Elevation \[rad\].
    pub el_rad: &'a [f64],
    /// Standard deviation of each range \[m\].
    pub sigma_m: &'a [f64],
    /// The same when one reference receiver is faulty \[m\].
    pub sigma_h1_m: &'a [f64],
    /// Constellation of each column.
    pub constellation: &'a [Constellation],
}

/// What levels are requested; each array has one item a sky.
#[derive(Debug, Clone, Copy)]
pub struct Request<'a> {
    /// Largest nominal bias of a range \[m\].
    pub bias_m: &'a [f64],
    /// Covariance with an inertial system, nine numbers \[m²\].
    pub aided_m2: Option<&'a [f64]>,
    /// B-values \[m\], receivers by satellites a sky.
    pub b_values_m: Option<&'a [f64]>,
    /// The rest; its bias is replaced by each sky's.
    pub settings: Settings,
}

/// One sky's answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// Levels.
    pub levels: Levels,
    /// Accuracy, 95 %.
    pub accuracy: Metres,
    /// Covariance used: the aided one, or the solution's.
    pub covariance: Covariance<Enu>,
    /// Deviations of the solution: larger axis, root of the trace, and larger axis with a receiver faulty.
    pub deviations: [Metres; 3],
    /// Gain of the bias: exact, root sum of squares, sum.
    pub gains: [f64; 3],
    /// Largest horizontal effect of a metre in one range.
    pub worst_projection: f64,
}

impl Skies<'_> {
    /// How many skies.
    pub fn len(&self) -> usize {
        self.az_rad.len().checked_div(self.constellation.len()).unwrap_or(0)
    }
    /// None.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Ranges of a sky with their columns.
    ///
    /// # Errors
    /// [`AtIndex`] with the place in the arrays.
    pub fn ranges(&self, sky: usize) -> Result<Vec<(usize, Sight)>, AtIndex> {
        let width = self.constellation.len();
        let used = (0..width).filter(|c| !(self.az_rad[sky * width + c].is_nan() && self.el_rad[sky * width + c].is_nan()));
        used.map(|column| {
            let index = sky * width + column;
            self.range(index, self.constellation[column]).map(|r| (column, r)).map_err(|error| AtIndex { index, error })
        })
        .collect()
    }

    fn range(&self, index: usize, constellation: Constellation) -> Result<Sight, OutOfDomain> {
        let direction = Direction::new(Radians::new(self.az_rad[index]), Radians::new(self.el_rad[index]))?;
        Sight::corrected(direction.unit(), constellation, Metres::new(self.sigma_m[index]), Metres::new(self.sigma_h1_m[index]))
    }
}

/// Levels of every sky.
///
/// # Errors
/// [`AtIndex`] for the first number outside its domain, counted through all rows.
pub fn protection_levels(skies: &Skies<'_>, request: &Request<'_>) -> Result<Vec<Counted>, AtIndex> {
    parallel::try_map(skies.len(), SKIES_PER_TASK, |sky| one(skies, request, sky))
}

/// Satellites used, and the answer.
pub type Counted = (usize, Result<Answer, Unavailable>);

fn one(skies: &Skies<'_>, request: &Request<'_>, sky: usize) -> Result<Counted, AtIndex> {
    let at = |error| AtIndex { index: sky, error };
    let ranges = skies.ranges(sky)?;
    let aided = request.aided_m2.map(|all| covariance(all, sky)).transpose().map_err(at)?;
    let bias = size_of_bias(request.bias_m[sky]).map_err(at)?;
    let settings = Settings { bias, ..request.settings };
    let plain: Vec<Sight> = ranges.iter().map(|r| r.1).collect();
    let answer = Snapshot::new(&plain).map(|snapshot| {
        let shift = request.b_values_m.map_or(Metres::new(0.0), |all| shift(all, skies, sky, &ranges, &snapshot));
        let levels = levels::levels(&snapshot, aided.as_ref(), shift, &settings);
        let covariance = aided.unwrap_or(*snapshot.covariance());
        Answer {
            levels,
            accuracy: levels::accuracy(Form::Major.deviation(&covariance), levels.detail.bias),
            covariance,
            deviations: [
                Form::Major.deviation(snapshot.covariance()),
                Form::Norm.deviation(snapshot.covariance()),
                Form::Major.deviation(snapshot.receiver_faulty()),
            ],
            gains: [Ordering::Exact, Ordering::Rss, Ordering::Sum].map(|o| snapshot.bias_gain(o)),
            worst_projection: snapshot.worst_projection(),
        }
    });
    Ok((plain.len(), answer))
}

/// The largest effect of one receiver's B-values.
fn shift(all: &[f64], skies: &Skies<'_>, sky: usize, ranges: &[(usize, Sight)], snapshot: &Snapshot) -> Metres {
    let width = skies.constellation.len();
    let each = all.len() / skies.len();
    let of_receiver = |b: &[f64]| {
        let values = ranges.iter().map(|(column, _)| Metres::new(b[*column]));
        levels::receiver_shift(snapshot.responses().iter().zip(values))
    };
    let shifts = all[sky * each..(sky + 1) * each].chunks(width).map(of_receiver);
    shifts.fold(Metres::new(0.0), |a, b| if b > a { b } else { a })
}

/// A size of the nominal bias.
///
/// # Errors
/// [`OutOfDomain`] unless finite and not negative.
pub fn size_of_bias(bias_m: f64) -> Result<Metres, OutOfDomain> {
    if !(bias_m >= 0.0 && bias_m.is_finite()) {
        return Err(OutOfDomain { argument: "bias_m", value: bias_m, unit: "m", domain: "[0, inf)" });
    }
    Ok(Metres::new(bias_m))
}

/// The covariance of one sky among nine numbers each.
///
/// # Errors
/// As [`Covariance::from_rows`].
pub fn covariance(all: &[f64], sky: usize) -> Result<Covariance<Enu>, OutOfDomain> {
    let mut rows = [0.0; 9];
    rows.copy_from_slice(&all[9 * sky..9 * sky + 9]);
    Covariance::from_rows(rows)
}

/// A satellite as an inertial system is aided by it: noise of ground and aircraft coloured by multipath, troposphere and ionosphere white.
///
/// # Errors
/// [`OutOfDomain`]: an elevation or a time constant.
pub fn tracked(model: &ErrorModel, form: noise::Form, direction: &Direction, constellation: Constellation) -> Result<Tracked, OutOfDomain> {
    let error = RangeError::new(model, direction.elevation())?;
    let multipath = Coloured::new(Metres::new(error.ground.m().hypot(error.airborne.m())), model.multipath_s, form)?;
    let white = Metres::new(error.troposphere.m().hypot(error.ionosphere.m()));
    Ok(Tracked { unit: direction.unit(), constellation, multipath, white })
}
