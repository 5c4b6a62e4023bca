//! Closed approximations of the exact radii, and the seed's formulas as printed.

use super::accept::{accepted_axes, components, upper};
use super::radial::flat;
use crate::frame::{Covariance, Displacement, Enu};
use crate::quantity::{Metres, OutOfDomain, Risk};
use crate::special::float::sqrt;
use crate::special::normal::one_sided_factor;
use crate::special::radius::wilson_hilferty;

/// These fits were made for 95 %.
fn only_95_percent(risk: Risk) -> Result<(), OutOfDomain> {
    if risk != Risk::ACCURACY {
        return Err(OutOfDomain { argument: "risk", value: risk.q(), unit: "1", domain: "{0.05}: the fit exists for 95 % only" });
    }
    Ok(())
}

/// Larger and smaller standard deviation of the horizontal error.
fn horizontal_sigmas(covariance: &Covariance<Enu>) -> Result<(f64, f64), OutOfDomain> {
    let ([major, minor, _], _) = accepted_axes(flat(upper(covariance.matrix())), "covariance")?;
    Ok((sqrt(major), sqrt(minor)))
}

/// 95 % circle by the published cubic, corrected \[m\].
///
/// ```text
/// r = sigma_minor / sigma_major     R = sigma_major (1.9625 + 0.4852 r^3)      Dai 2022, eq. 11 and 13
/// ```
///
/// # Deviation from the source
/// Eq. 7 names both axes major and eq. 12 divides the minor axis by the major one; as printed the radius grows without bound for a thin
/// ellipse. Read as major / minor both limits are met.
///
/// # Valid
/// Short of the exact radius for nearly every r: up to 0.87 %, near r = 0.804, where the circle holds 94.743 %.
///
/// # Errors
/// [`OutOfDomain`]: a covariance that is none, a risk that is not 0.05.
pub fn circle_fit(covariance: &Covariance<Enu>, risk: Risk) -> Result<Metres, OutOfDomain> {
    only_95_percent(risk)?;
    let (major, minor) = horizontal_sigmas(covariance)?;
    let r = if major > 0.0 { minor / major } else { 0.0 };
    Ok(Metres::new(major * (1.9625 + 0.4852 * r * r * r)))
}

/// 95 % circle by geodesy's cubic \[m\]: within -0.0042 and +0.0034 of the larger standard deviation.
///
/// ```text
/// R = sigma_major (1.960790 + 0.004071 r + 0.114276 r^2 + 0.371625 r^3)
/// ```
///
/// # Errors
/// As [`circle_fit`].
pub fn circle_geodesy(covariance: &Covariance<Enu>, risk: Risk) -> Result<Metres, OutOfDomain> {
    only_95_percent(risk)?;
    let (major, minor) = horizontal_sigmas(covariance)?;
    let r = if major > 0.0 { minor / major } else { 0.0 };
    Ok(Metres::new(major * (1.960_790 + r * (0.004_071 + r * (0.114_276 + r * 0.371_625)))))
}

/// The published cubic with the ratio as printed \[m\], an exhibit: at a ratio of two it is 2.9 times too long.
///
/// ```text
/// ratio = sigma_minor / sigma_major   k = 0.4852 / ratio^3 + 1.9625   R = k sigma_major      Dai 2022, eq. 11 to 13 as printed
/// ```
///
/// # Errors
/// As [`circle_fit`]; and a smaller standard deviation of zero, where the printed formula divides by it.
pub fn circle_fit_as_printed(covariance: &Covariance<Enu>, risk: Risk) -> Result<Metres, OutOfDomain> {
    only_95_percent(risk)?;
    let (major, minor) = horizontal_sigmas(covariance)?;
    if !(minor > 0.0) {
        let domain = "(0, inf) for its smaller eigenvalue: the printed formula divides by it";
        return Err(OutOfDomain { argument: "covariance", value: minor * minor, unit: "m²", domain });
    }
    let ratio = minor / major;
    Ok(Metres::new(major * (0.4852 / (ratio * ratio * ratio) + 1.9625)))
}

/// Sphere by Grubbs' use of Wilson and Hilferty's approximation, corrected \[m\].
///
/// ```text
/// T = sum(lambda + m^2)   v = 2 sum(lambda^2 + 2 lambda m^2)/T^2   R = sqrt(T) (z sqrt(v/9) + 1 - v/9)^(3/2)      Dai 2022, eq. 17
/// ```
///
/// # Deviation from the source
/// Eq. 17 multiplies the whole bracket by 1.65; the normal factor belongs to sqrt(v/9) alone, and is 1.6448536 at 5 %.
///
/// # Valid
/// Relative error over all axis ratios, zero mean: risk 0.5 +0.33 to +2.73 %; 0.05 -1.24 to +0.16 %; 0.01 -2.24 to +0.10 %;
/// 1e-5 -4.3 to +5.4 %.
///
/// # Errors
/// [`OutOfDomain`]: a covariance that is none, a mean that is not finite.
pub fn sphere_grubbs(covariance: &Covariance<Enu>, mean: Option<&Displacement<Enu>>, risk: Risk) -> Result<Metres, OutOfDomain> {
    let (variances, axes) = accepted_axes(upper(covariance.matrix()), "covariance")?;
    let mean = components(mean);
    if let Some(bad) = mean.iter().find(|m| !(m.abs() < 1e70)) {
        return Err(OutOfDomain { argument: "mean", value: *bad, unit: "m", domain: "(-1e70, 1e70)" });
    }
    let along = |j: usize| (0..3).map(|i| axes[i][j] * mean[i]).sum();
    Ok(Metres::new(wilson_hilferty(&variances, &[along(0), along(1), along(2)], one_sided_factor(risk.q()))))
}

/// Eq. 17 as printed \[m\], an exhibit: 17.5 to 34.1 % too long.
///
/// ```text
/// R = 1.65 sqrt(T) (sqrt(v/9) + 1 - v/9)^(3/2)
/// ```
///
/// # Errors
/// [`OutOfDomain`]: a covariance that is none, a risk that is not 0.05.
pub fn sphere_grubbs_as_printed(covariance: &Covariance<Enu>, risk: Risk) -> Result<Metres, OutOfDomain> {
    only_95_percent(risk)?;
    let (variances, _) = accepted_axes(upper(covariance.matrix()), "covariance")?;
    Ok(Metres::new(1.65 * wilson_hilferty(&variances, &[0.0; 3], 1.0)))
}
