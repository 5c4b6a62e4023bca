//! Loops over [`navbound_core::judge`]: the errors of every row of an epoch table.

use crate::bounds::Columns;
use navbound_core::judge::{Errors, Known};
use navbound_core::quantity::Radians;
use rayon::prelude::*;

/// Rows in one task of the pool.
const ROWS_PER_TASK: usize = 4096;

/// Columns of the navigation error, `nse_e_m`, `nse_n_m`, `nse_u_m`; a NaN is an absent value.
pub type Errs<'a> = [Option<&'a [f64]>; 3];

/// Errors of every row.
pub fn errors(columns: &Columns<'_>, nse_m: Errs<'_>) -> Vec<Errors> {
    (0..columns.len).into_par_iter().with_min_len(ROWS_PER_TASK).map(|row| Errors::of(&known(columns, nse_m, row))).collect()
}

fn known(columns: &Columns<'_>, [east, north, up]: Errs<'_>, row: usize) -> Known {
    let at = |column: Option<&[f64]>| column.and_then(|c| c.get(row)).copied().filter(|v| !v.is_nan());
    Known {
        nse_en_m: at(east).zip(at(north)).map(|(e, n)| [e, n]),
        nse_u_m: at(up),
        fte_m: at(columns.fte_m),
        fte_v_m: at(columns.fte_v_m),
        course: at(columns.course_rad).map(Radians::new),
        path_angle: at(columns.path_angle_rad).map(Radians::new),
        covariance: columns.covariance(row),
    }
}
