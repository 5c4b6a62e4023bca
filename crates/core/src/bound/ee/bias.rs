//! The bias part: what a bias of at most mu in every range does to the position.

use super::Both;
use crate::quantity::{Metres, OutOfDomain};
use crate::special::float::{hypot, sqrt};
use nalgebra::Vector3;

/// Largest bias of a range, as the paper has it \[m\] (printed; quoted as a position bias in another place of it).
pub const MU_MOST_M: f64 = 1.125;
/// The paper's allowance for weights (printed). It is not one: see [`dop`].
pub const ALPHA: f64 = 1.1;

fn check_bias(argument: &'static str, value: f64, unit: &'static str) -> Result<(), OutOfDomain> {
    if value >= 0.0 && value.is_finite() { Ok(()) } else { Err(OutOfDomain { argument, value, unit, domain: "[0, inf)" }) }
}

/// The published bound of the worst bias, from dilutions of precision.
///
/// ```text
/// alpha mu sqrt(N) xDOP                                                         Vassilev 2012, eq. 7
/// ```
///
/// By Cauchy and Schwarz it holds with alpha = 1 for a solution with equal weights.
///
/// # Valid
/// alpha = 1.1 does not cover weighted solutions: of random geometries with mixed UDRE and GIVE, 1.3 to 2.4 % exceed it in the vertical, by a
/// factor of up to 1.55. [`exact`] is the worst bias itself.
///
/// # Errors
/// [`OutOfDomain`] for a negative or infinite number, or fewer than four satellites.
pub fn dop(hdop: f64, vdop: f64, n_sv: usize, mu: Metres, alpha: f64) -> Result<Both, OutOfDomain> {
    check_bias("hdop", hdop, "1")?;
    check_bias("vdop", vdop, "1")?;
    check_bias("mu_most_m", mu.m(), "m")?;
    check_bias("alpha", alpha, "1")?;
    if n_sv < 4 {
        return Err(OutOfDomain { argument: "n_sv", value: n_sv as f64, unit: "1", domain: "[4, inf)" });
    }
    let scale = alpha * mu.m() * sqrt(n_sv as f64);
    Ok(Both::new(scale * hdop, scale * vdop))
}

/// The worst bias itself, from the rows `s_i` of the solution: how far the position moves for one metre in range i.
///
/// ```text
/// vertical    mu sum |s_Ui|
/// horizontal  max over t of mu sum |cos t s_Ei + sin t s_Ni|
/// ```
///
/// The horizontal maximum is a corner of the polygon whose edges are the rows: the sum of all rows, each with the sign it has towards that
/// corner. Signs change only across a row, so every corner is an end of a row's edge.
///
/// # Errors
/// [`OutOfDomain`] for a bias that is negative or not finite.
pub fn exact(rows: impl Iterator<Item = Vector3<f64>> + Clone, mu: Metres) -> Result<Both, OutOfDomain> {
    check_bias("mu_most_m", mu.m(), "m")?;
    let vertical: f64 = rows.clone().map(|s| s.z.abs()).sum();
    let mut farthest: f64 = 0.0;
    for edge in rows.clone() {
        // One end of the edge; the other is an end of the edge before it, or opposite to one.
        let (mut east, mut north) = (0.0, 0.0);
        for s in rows.clone() {
            let across = edge.x * s.y - edge.y * s.x;
            let along = edge.x * s.x + edge.y * s.y;
            // Rows in line with the edge go with it; they belong to the same edge of the polygon.
            let sign = if across > 0.0 || (across == 0.0 && along > 0.0) { 1.0 } else { -1.0 };
            east += sign * s.x;
            north += sign * s.y;
        }
        let length = hypot(east, north);
        if length > farthest {
            farthest = length;
        }
    }
    Ok(Both::new(mu.m() * farthest, mu.m() * vertical))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(pairs: &[[f64; 2]]) -> impl Iterator<Item = Vector3<f64>> + Clone {
        pairs.iter().map(|p| Vector3::new(p[0], p[1], 0.5))
    }

    #[test]
    fn the_farthest_corner_is_right_in_every_direction() {
        let cases: [&[[f64; 2]]; 5] = [
            &[[1.0, 0.0], [0.0, 1.0]],
            &[[0.3, 0.1], [-0.6, -0.2], [0.1, 0.9]],
            &[[0.2, -0.7], [-0.4, 0.5], [0.6, 0.1], [0.3, 0.3], [-0.1, -0.9]],
            &[[1.0, 0.5], [2.0, 1.0], [-3.0, -1.5]],
            &[[0.0, 0.0], [0.4, -0.2]],
        ];
        for pairs in cases {
            let largest = exact(rows(pairs), Metres::new(1.0)).unwrap();
            let scan = (0..36_000)
                .map(|i| f64::from(i) * core::f64::consts::PI / 36_000.0)
                .map(|t| pairs.iter().map(|p| (t.cos() * p[0] + t.sin() * p[1]).abs()).sum::<f64>());
            let scanned = scan.fold(0.0, f64::max);
            // A scan falls short by at most 1 - cos of half its step: 1e-9.
            assert!(largest.horizontal.m() >= scanned - 1e-15 && largest.horizontal.m() <= scanned * (1.0 + 2e-9), "{largest:?} {scanned}");
            assert!((largest.vertical.m() - 0.5 * pairs.len() as f64).abs() < 1e-15);
        }
    }

    #[test]
    fn equal_weights_never_exceed_the_published_form_without_its_allowance() {
        let pairs = [[0.2, -0.7], [-0.4, 0.5], [0.6, 0.1], [0.3, 0.3], [-0.1, -0.9]];
        let squares = |k: usize| pairs.iter().map(|p| p[k] * p[k]).sum::<f64>();
        let hdop = (squares(0) + squares(1)).sqrt();
        let published = dop(hdop, (5.0_f64 * 0.25).sqrt(), 5, Metres::new(1.125), 1.0).unwrap();
        let worst = exact(rows(&pairs), Metres::new(1.125)).unwrap();
        assert!(worst.horizontal <= published.horizontal);
        // Rows of equal size reach it.
        assert!((worst.vertical.m() - published.vertical.m()).abs() < 1e-12);
    }

    #[test]
    fn wrong_numbers_are_refused_by_name() {
        let mu = Metres::new(1.0);
        assert_eq!(dop(f64::NAN, 1.0, 5, mu, 1.1).unwrap_err().argument, "hdop");
        assert_eq!(dop(1.0, -1.0, 5, mu, 1.1).unwrap_err().argument, "vdop");
        assert_eq!(dop(1.0, 1.0, 3, mu, 1.1).unwrap_err().argument, "n_sv");
        assert_eq!(dop(1.0, 1.0, 5, Metres::new(f64::INFINITY), 1.1).unwrap_err().argument, "mu_most_m");
        assert_eq!(exact(rows(&[]), Metres::new(-1.0)).unwrap_err().argument, "mu_most_m");
    }
}
