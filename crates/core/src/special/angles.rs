//! Angles of several directions abreast: no branch that depends on the data, so that the compiler can use vector registers.
//! One lane and four give the same bits because every operation is elementwise.

use core::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// Coefficients of atan(u) = u - u^3 P(u^2) for |u| up to 7/16, error below 1 unit in the last place (Sun Microsystems, fdlibm).
const ATAN: [f64; 11] = [
    0.333_333_333_333_329_3,
    -0.199_999_999_998_764_83,
    0.142_857_142_725_034_66,
    -0.111_111_104_054_623_56,
    0.090_908_871_334_365_07,
    -0.076_918_762_050_448_3,
    0.066_610_731_373_875_31,
    -0.058_335_701_337_905_735,
    0.049_768_779_946_159_324,
    -0.036_531_572_744_216_916,
    0.016_285_820_115_365_782,
];
/// tan(pi/8): above it an eighth of a turn is taken off first.
const EIGHTH: f64 = core::f64::consts::SQRT_2 - 1.0;
/// Angles of the points (x, y), in \[-pi, pi\], to a few units in the last place; NaN at (0, 0).
#[inline(always)]
pub(crate) fn atan2<const L: usize>(y: &[f64; L], x: &[f64; L]) -> [f64; L] {
    let (mut u, mut sum, mut angle) = ([0.0; L], [ATAN[10]; L], [0.0; L]);
    for l in 0..L {
        let (ay, ax) = (y[l].abs(), x[l].abs());
        let (less, more) = (if ay < ax { ay } else { ax }, if ay > ax { ay } else { ax });
        // atan(t) = pi/4 + atan((t - 1) / (t + 1)) keeps the argument below tan(pi/8).
        let far = less > EIGHTH * more;
        // What is no number stays none through the comparisons.
        u[l] = if far { less - more } else { less } / if far { less + more } else { more } + 0.0 * (x[l] + y[l]);
        angle[l] = if far { FRAC_PI_4 } else { 0.0 };
    }
    for c in ATAN[..10].iter().rev() {
        for l in 0..L {
            sum[l] = sum[l] * (u[l] * u[l]) + c;
        }
    }
    for l in 0..L {
        let first = angle[l] + (u[l] - u[l] * (u[l] * u[l]) * sum[l]);
        let quarter = if y[l].abs() > x[l].abs() { FRAC_PI_2 - first } else { first };
        let half = if x[l] < 0.0 { PI - quarter } else { quarter };
        angle[l] = if y[l] < 0.0 { -half } else { half };
    }
    angle
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn angles_are_those_of_the_library(y in -10.0..10.0f64, x in -10.0..10.0f64) {
            let angles = atan2(&[y, -y, x, 0.0], &[x, x, -y, y]);
            for (angles, want) in angles.into_iter().zip([y.atan2(x), (-y).atan2(x), x.atan2(-y), 0.0_f64.atan2(y)]) {
                // Two units in the last place of pi.
                prop_assert!((angles - want).abs() < 1e-15, "{angles} {want}");
            }
        }

        #[test]
        fn lanes_do_not_know_of_each_other(y in -1.0..1.0f64, x in -1.0..1.0f64) {
            prop_assert_eq!(atan2(&[0.3, y, -0.1, 9.0], &[x, x, 0.2, 1.0])[1], atan2(&[y], &[x])[0]);
        }
    }

    #[test]
    fn axes_and_no_direction() {
        assert_eq!(atan2(&[0.0, 1.0, 0.0, -1.0], &[1.0, 0.0, -1.0, 0.0]), [0.0, FRAC_PI_2, PI, -FRAC_PI_2]);
        assert!(atan2(&[0.0], &[0.0])[0].is_nan());
        assert!(atan2(&[f64::NAN], &[1.0])[0].is_nan());
    }
}
