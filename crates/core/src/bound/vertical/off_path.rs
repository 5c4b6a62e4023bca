//! The error off a descending path, by deviations along track and up.

use crate::bound::tse::Deviation;
use crate::quantity::{Metres, OutOfDomain, Radians};
use crate::special::float::{sqrt, tan};
use crate::special::normal::tail;
use core::f64::consts::FRAC_PI_2;

/// Standard deviation of the height above the path at the true place.
///
/// ```text
/// h_true - H_p(s_true) = FTE_v + e_u + e_a tan a
/// sigma² = sigma_u² + tan²a sigma_a² + 2 rho sigma_u sigma_a tan a
/// ```
///
/// Errors are true minus estimated, along is forwards, the angle is positive for a descent: for a climb the last term changes its sign.
/// Provenance: re-derived.
///
/// # Errors
/// [`OutOfDomain`] for deviations outside \[0, inf), a correlation outside \[-1, 1\] or an angle outside (-pi/2, pi/2).
pub fn off_path_sigma(along: Metres, up: Metres, correlation: f64, descent: Radians) -> Result<Metres, OutOfDomain> {
    for (argument, value) in [("sigma_along_m", along.m()), ("sigma_up_m", up.m())] {
        if !(value >= 0.0 && value.is_finite()) {
            return Err(OutOfDomain { argument, value, unit: "m", domain: "[0, inf)" });
        }
    }
    if !(correlation.abs() <= 1.0) {
        return Err(OutOfDomain { argument: "correlation", value: correlation, unit: "1", domain: "[-1, 1]" });
    }
    if !(descent.rad().abs() < FRAC_PI_2) {
        return Err(OutOfDomain { argument: "angle_rad", value: descent.rad(), unit: "rad", domain: "(-pi/2, pi/2)" });
    }
    let (u, a) = (up.m(), tan(descent.rad()) * along.m());
    // (u + rho a)² + (1 - rho²) a²: no difference of large squares.
    let (level, rest) = (u + correlation * a, (1.0 - correlation) * (1.0 + correlation) * a * a);
    Ok(Metres::new(sqrt(level * level + rest)))
}

/// Probability that an aircraft is lower than a limit below its path: the part of the risk that obstacles make.
///
/// ```text
/// Q((limit + fte) / sigma)     fte positive above the path
/// ```
///
/// # Errors
/// [`OutOfDomain`] for a limit outside \[0, inf).
pub fn risk_below(deviation: Deviation, limit: Metres) -> Result<f64, OutOfDomain> {
    if !(limit.m() >= 0.0 && limit.m().is_finite()) {
        return Err(OutOfDomain { argument: "limit_m", value: limit.m(), unit: "m", domain: "[0, inf)" });
    }
    let left = limit.m() + deviation.fte().m();
    let sigma = deviation.sigma().m();
    if sigma > 0.0 {
        return Ok(tail(left / sigma));
    }
    Ok(if left < 0.0 { 1.0 } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn m(value: f64) -> Metres {
        Metres::new(value)
    }

    #[test]
    fn forwards_and_up_go_together_in_a_descent_and_against_each_other_in_a_climb() {
        let sigma = |correlation: f64, degrees: f64| off_path_sigma(m(40.0), m(8.0), correlation, Radians::degrees(degrees)).unwrap().m();
        let slope = 3.0_f64.to_radians().tan();
        let of = |sign: f64| (64.0 + 1600.0 * slope * slope + sign * 2.0 * 0.5 * 8.0 * 40.0 * slope).sqrt();
        assert!((sigma(0.5, 3.0) - of(1.0)).abs() < 1e-12 && (sigma(0.5, -3.0) - of(-1.0)).abs() < 1e-12);
        assert!((sigma(1.0, 3.0) - (8.0 + 40.0 * slope)).abs() < 1e-12);
        assert!((sigma(-1.0, 3.0) - (8.0 - 40.0 * slope)).abs() < 1e-12);
        assert_eq!(sigma(0.7, 0.0), 8.0);
    }

    #[test]
    fn below_is_one_tail() {
        let deviation = Deviation::new(m(5.0), m(10.0)).unwrap();
        // Q(2) = 0.02275013194817921.
        assert!((risk_below(deviation, m(15.0)).unwrap() - 0.022_750_131_948_179_21).abs() < 1e-15);
        let certain = |fte: f64| risk_below(Deviation::new(m(fte), m(0.0)).unwrap(), m(10.0)).unwrap();
        assert_eq!((certain(-11.0), certain(-10.0), certain(0.0)), (1.0, 0.0, 0.0));
        assert_eq!(risk_below(deviation, m(-1.0)).unwrap_err().argument, "limit_m");
    }

    #[test]
    fn numbers_outside_their_domain_are_named() {
        let named = |a: f64, u: f64, r: f64, g: f64| off_path_sigma(m(a), m(u), r, Radians::new(g)).unwrap_err().argument;
        assert_eq!(named(-1.0, 1.0, 0.0, 0.0), "sigma_along_m");
        assert_eq!(named(1.0, f64::NAN, 0.0, 0.0), "sigma_up_m");
        assert_eq!(named(1.0, 1.0, 1.1, 0.0), "correlation");
        assert_eq!(named(1.0, 1.0, 0.0, 2.0), "angle_rad");
    }
}
