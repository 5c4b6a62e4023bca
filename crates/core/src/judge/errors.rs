//! Errors of an epoch along the axes of its path, and the deviation of the navigation error across it.

use crate::bound::tse::{axes, project};
use crate::frame::{Covariance, Displacement, Enu};
use crate::quantity::{Metres, Radians};
use crate::special::float::{hypot, sin_cos};

/// What is known of an epoch; an unknown part is `None`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Known {
    /// Navigation system error east and north \[m\].
    pub nse_en_m: Option<[f64; 2]>,
    /// The same upwards \[m\].
    pub nse_u_m: Option<f64>,
    /// Flight technical error, positive right of the path \[m\].
    pub fte_m: Option<f64>,
    /// The same above the path \[m\].
    pub fte_v_m: Option<f64>,
    /// Course.
    pub course: Option<Radians>,
    /// Angle of the path, positive upwards.
    pub path_angle: Option<Radians>,
    /// Covariance of the navigation error; a variance that is not known is NaN.
    pub covariance: Option<Covariance<Enu>>,
}

/// Errors along the axes of the path; `None` where a part that they need is unknown.
///
/// ```text
/// along = t . nse        t = (sin chi, cos chi)
/// cross = n . nse        n = (cos chi, -sin chi), positive right
/// tse   = fte + cross
/// tse_v = fte_v + up - tan(angle) along      above a sloping path an error along the course is one of height
/// sigma_cross^2 = n' C n                     0 where rounding leaves it negative
/// ```
///
/// Provenance: ours; the projection is that of the bounds ([`project`]).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Errors {
    /// Horizontal length of the navigation error \[m\].
    pub horizontal_m: Option<f64>,
    /// Its length in space \[m\].
    pub spatial_m: Option<f64>,
    /// Along the course \[m\].
    pub along_m: Option<f64>,
    /// Across it, positive right \[m\].
    pub cross_m: Option<f64>,
    /// Total system error across the path \[m\].
    pub tse_m: Option<f64>,
    /// The same above the path \[m\].
    pub tse_v_m: Option<f64>,
    /// Standard deviation of the navigation error across the path \[m\]; `None` too for what is no covariance.
    pub sigma_cross_m: Option<f64>,
}

impl Errors {
    /// Of one epoch.
    pub fn of(known: &Known) -> Self {
        let horizontal_m = known.nse_en_m.map(|[east, north]| hypot(east, north));
        let course = known.course.and_then(|course| axes(course).ok());
        let along_cross = known.nse_en_m.zip(course).map(|([east, north], (t, n))| [t.x * east + t.y * north, n.x * east + n.y * north]);
        let (along_m, cross_m) = (along_cross.map(|a| a[0]), along_cross.map(|a| a[1]));
        Self {
            horizontal_m,
            spatial_m: horizontal_m.zip(known.nse_u_m).map(|(level, up)| hypot(level, up)),
            along_m,
            cross_m,
            tse_m: known.fte_m.zip(cross_m).map(|(fte, cross)| fte + cross),
            tse_v_m: known.total_above(along_m),
            sigma_cross_m: known.sigma_cross().map(Metres::m),
        }
    }
}

impl Known {
    fn total_above(&self, along_m: Option<f64>) -> Option<f64> {
        let (sine, cosine) = sin_cos(self.path_angle?.rad());
        Some(self.fte_v_m? + self.nse_u_m? - sine / cosine * along_m?)
    }

    fn sigma_cross(&self) -> Option<Metres> {
        let at_path = Displacement::new(Metres::new(0.0), Metres::new(0.0), Metres::new(0.0));
        project(&at_path, &self.covariance?, self.course?).ok().map(|lateral| lateral.deviation.sigma())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_along_the_course_alone_has_no_deviation_across_at_any_course() {
        for step in 0..100_000 {
            let course = core::f64::consts::TAU * f64::from(step) / 100_000.0;
            let (s, c) = sin_cos(course);
            let covariance = Covariance::from_upper([100.0 * s * s, 100.0 * s * c, 100.0 * c * c, f64::NAN, f64::NAN, f64::NAN]);
            let known = Known { course: Some(Radians::new(course)), covariance: Some(covariance), ..Known::default() };
            // Three products of 100 rounded once each leave at most 1e-14 of it; its root is 1e-6.
            assert!(Errors::of(&known).sigma_cross_m.is_some_and(|sigma| sigma <= 1e-6), "{course}");
        }
    }

    #[test]
    fn an_unknown_part_takes_away_what_needs_it_and_nothing_else() {
        let whole = Known {
            nse_en_m: Some([3.0, 4.0]),
            nse_u_m: Some(12.0),
            fte_m: Some(10.0),
            fte_v_m: Some(-2.0),
            course: Some(Radians::new(0.0)),
            path_angle: Some(Radians::new(0.0)),
            covariance: Some(Covariance::from_upper([9.0, 0.0, 4.0, 0.0, 0.0, 1.0])),
        };
        let all = Errors::of(&whole);
        let expected = [Some(5.0), Some(13.0), Some(4.0), Some(3.0), Some(13.0), Some(10.0), Some(3.0)];
        assert_eq!([all.horizontal_m, all.spatial_m, all.along_m, all.cross_m, all.tse_m, all.tse_v_m, all.sigma_cross_m], expected);
        let without_course = Errors::of(&Known { course: None, ..whole });
        assert_eq!(without_course, Errors { horizontal_m: Some(5.0), spatial_m: Some(13.0), ..Errors::default() });
        let not_a_covariance = Known { covariance: Some(Covariance::from_upper([1.0, 5.0, 1.0, 0.0, 0.0, 1.0])), ..whole };
        assert_eq!(Errors::of(&not_a_covariance).sigma_cross_m, None);
    }
}
