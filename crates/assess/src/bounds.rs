//! Any method of [`navbound_core::bound::METHODS`] over the columns of an epoch table.

use crate::parallel;
use navbound_core::bound::{Bound, Method};
use navbound_core::frame::{Covariance, Enu};
use navbound_core::judge::Sample;
use navbound_core::quantity::{GpsTime, Metres, Radians, Reason, Risk, Status, Unavailable};

/// Epochs in one task of the pool: enough work (above 0.1 ms) to be worth the hand-over.
const EPOCHS_PER_TASK: usize = 1024;

/// Columns of the epoch table that methods read, all of one length. A NaN is an absent value; an absent column is absent everywhere.
#[derive(Debug, Clone, Copy, Default)]
pub struct Columns<'a> {
    /// Number of epochs.
    pub len: usize,
    /// `course_rad`.
    pub course_rad: Option<&'a [f64]>,
    /// `path_angle_rad`.
    pub path_angle_rad: Option<&'a [f64]>,
    /// `fte_m`, positive right of the path.
    pub fte_m: Option<&'a [f64]>,
    /// `fte_v_m`, positive above the path. Absent with a lateral offset present, the offset is taken in the horizontal plane.
    pub fte_v_m: Option<&'a [f64]>,
    /// `rnp_m`.
    pub rnp_m: Option<&'a [f64]>,
    /// `cov_ee_m2`, `cov_en_m2`, `cov_nn_m2`, `cov_eu_m2`, `cov_nu_m2`, `cov_uu_m2`; the last three absent for horizontal data.
    pub covariance_m2: [Option<&'a [f64]>; 6],
}

impl Columns<'_> {
    /// What the columns say of one row, at no time and of no status.
    pub(crate) fn sample(&self, row: usize) -> Sample {
        Sample {
            time: GpsTime::default(),
            status: Status::Ok,
            course: at(self.course_rad, row).map(Radians::new),
            path_angle: at(self.path_angle_rad, row).map(Radians::new),
            fte_m: at(self.fte_m, row),
            fte_v_m: at(self.fte_v_m, row),
            covariance: self.covariance(row),
            nse_en_m: None,
            nse_u_m: None,
            rnp: at(self.rnp_m, row).map(Metres::new),
            hpl: None,
        }
    }

    fn covariance(&self, row: usize) -> Option<Covariance<Enu>> {
        let mut upper = [0.0; 6];
        for (slot, column) in upper.iter_mut().zip(self.covariance_m2) {
            // Horizontal data have no vertical columns: an unknown variance is NaN, so that a 3-D method refuses instead of taking 0.
            *slot = column.and_then(|c| c.get(row)).copied().unwrap_or(f64::NAN);
        }
        upper[..3].iter().all(|v| !v.is_nan()).then(|| Covariance::from_upper(upper))
    }
}

/// The number of a row; a NaN is an absent value.
pub(crate) fn at(column: Option<&[f64]>, row: usize) -> Option<f64> {
    column.and_then(|c| c.get(row)).copied().filter(|v| !v.is_nan())
}

/// One method's bounds, row by row.
#[derive(Debug, Clone)]
pub struct BoundColumn {
    /// Bounds \[m\], NaN exactly where `reason` is not zero.
    pub bound_m: Vec<f64>,
    /// 0 where there is a bound, otherwise 1 + index into `reasons`.
    pub reason: Vec<u32>,
    /// Distinct reasons, in order of first appearance.
    pub reasons: Vec<Refused>,
}

/// Why a row has no bound.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refused {
    /// Its entry in the list; a wrong input (a negative variance) is another one than an absent value.
    pub reason: Reason,
    /// In words, with the number found.
    pub words: String,
}

/// Bounds of every row by one method at one risk, on all cores. The result does not depend on their number.
pub fn bounds(columns: &Columns<'_>, method: &'static Method, risk: Risk) -> BoundColumn {
    let results: Vec<Result<f64, Unavailable>> = parallel::map(columns.len, EPOCHS_PER_TASK, |row| {
        Bound::of(method, &columns.sample(row).epoch(), risk).map(|bound| bound.length().m())
    });
    let mut reasons: Vec<Refused> = Vec::new();
    let mut reason = Vec::with_capacity(results.len());
    let mut bound_m = Vec::with_capacity(results.len());
    for result in results {
        match result {
            Ok(value) => {
                bound_m.push(value);
                reason.push(0);
            }
            Err(why) => {
                bound_m.push(f64::NAN);
                reason.push(reason_code(&mut reasons, &why));
            }
        }
    }
    BoundColumn { bound_m, reason, reasons }
}

/// 1 + the place of a reason in the list, which gets it where it is new.
pub(crate) fn reason_code(reasons: &mut Vec<Refused>, why: &Unavailable) -> u32 {
    let refused = Refused { reason: why.reason(), words: why.to_string() };
    let index = reasons.iter().position(|known| *known == refused).unwrap_or_else(|| {
        reasons.push(refused);
        reasons.len() - 1
    });
    u32::try_from(index).unwrap_or(u32::MAX - 1) + 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use navbound_core::bound::{Bounded, Promises, Provenance};

    const ECHO: Method = Method {
        id: "echo",
        title: "the offset itself",
        source: "this test",
        provenance: Provenance::Ours,
        bounds: Bounded::LateralTse,
        assumes: "",
        promises: Promises { scales_with_length: true, ignores_north: true, monotone_in_risk: true, conservative: false, may_alert: false },
        bound: |epoch, _| {
            let east = epoch.offset_for("echo")?.vector().x;
            if !(east >= 0.0) {
                return Err(Unavailable::Invalid { field: "fte_m", value: east, unit: "m", domain: "[0, inf)" });
            }
            Ok(Metres::new(east))
        },
    };

    #[test]
    fn rows_without_a_value_keep_their_reason() {
        let fte = [3.0, f64::NAN, -2.0, f64::NAN];
        let north = [0.0; 4];
        let columns = Columns { len: 4, fte_m: Some(&fte), course_rad: Some(&north), ..Columns::default() };
        let column = bounds(&columns, &ECHO, Risk::ACCURACY);
        assert_eq!(column.bound_m[0], 3.0);
        assert_eq!(column.reason, [0, 1, 2, 1]);
        assert_eq!(column.reasons.iter().map(|r| r.reason).collect::<Vec<_>>(), [Reason::MissingField, Reason::InvalidNumber]);
        assert!(column.bound_m[1..].iter().all(|b| b.is_nan()));
        assert!(column.reasons[1].words.contains("-2 [m]"), "{}", column.reasons[1].words);
    }
}
