//! Weighted normal equations of ranges at a known altitude, whose error all ranges share.

use super::pair::SINE_LEAST;
use super::{RangeModel, Sight};
use crate::frame::{Covariance, Enu};
use crate::quantity::{Metres, OutOfDomain};
use crate::special::float::sqrt;
use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

/// Sums over the ranges, from which the inverse of `R = D + sigma_h^2 w w'` follows without a matrix of its size (Sherman, Morrison).
///
/// | here                | with rows h_i (east, north), w_i (up), residuals z_i, weights 1 / sigma_i^2 |
/// |---------------------|------------------------------------------------------------------------------|
/// | `hh`, `hw`, `ww`    | sums of h h', h w, w w                                                       |
/// | `hz`, `wz`, `zz`    | sums of h z, w z, z z                                                        |
#[derive(Debug, Clone, Copy)]
pub(super) struct Normal {
    hh: Matrix2<f64>,
    hw: Vector2<f64>,
    ww: f64,
    hz: Vector2<f64>,
    wz: f64,
    zz: f64,
}

/// What the sums determine.
#[derive(Debug, Clone, Copy)]
pub(super) struct Solved {
    /// Step east, north \[m\].
    pub step: Vector2<f64>,
    /// Covariance of the navigation error with the altitude as it was given.
    pub covariance: Covariance<Enu>,
    /// Residuals in their own metric, before the step.
    pub chi_square: f64,
    /// Sine of the inclusion angle of two equal ranges; less than that for any others.
    pub sine: f64,
}

impl Normal {
    pub(super) fn new() -> Self {
        Self { hh: Matrix2::zeros(), hw: Vector2::zeros(), ww: 0.0, hz: Vector2::zeros(), wz: 0.0, zz: 0.0 }
    }

    pub(super) fn add(&mut self, unit: &Vector3<f64>, residual: f64, sigma: f64) {
        let weight = 1.0 / (sigma * sigma);
        let (h, w) = (Vector2::new(unit.x, unit.y), unit.z);
        self.hh += weight * h * h.transpose();
        self.hw += weight * w * h;
        self.ww += weight * w * w;
        self.hz += weight * residual * h;
        self.wz += weight * w * residual;
        self.zz += weight * residual * residual;
    }

    /// ```text
    /// k = sigma_h^2 / (1 + sigma_h^2 ww)      N = hh - k hw hw'      step = N^-1 (hz - k wz hw)
    /// C = N^-1,  cov(horizontal, up) = -k C hw,  var(up) = sigma_h^2
    /// ```
    ///
    /// `None` where the stations and the aircraft lie in one line.
    pub(super) fn solve(&self, sigma_h: f64) -> Option<Solved> {
        let k = sigma_h * sigma_h / (1.0 + sigma_h * sigma_h * self.ww);
        let n = self.hh - k * self.hw * self.hw.transpose();
        let sine = sqrt(n.determinant().max(0.0)) / (0.5 * n.trace());
        if !(sine >= SINE_LEAST) {
            return None;
        }
        let c = n.try_inverse()?;
        let up = -k * (c * self.hw);
        let covariance = Covariance::claim_symmetric(Matrix3::new(c.m11, c.m12, up.x, c.m12, c.m22, up.y, up.x, up.y, sigma_h * sigma_h));
        Some(Solved { step: c * (self.hz - k * self.wz * self.hw), covariance, chi_square: self.zz - k * self.wz * self.wz, sine })
    }
}

/// Covariance that all stations in view together would give \[m²\]; `None` where they do not determine a position.
///
/// # Errors
/// [`OutOfDomain`] unless the altitude error is a length and the slant ranges have a standard deviation.
pub fn all_in_view<'a>(
    sights: impl Iterator<Item = &'a Sight>,
    range: &RangeModel,
    sigma_altitude: Metres,
) -> Result<Option<Covariance<Enu>>, OutOfDomain> {
    let sigma_h = sigma_altitude.m();
    if !(sigma_h >= 0.0 && sigma_h.is_finite()) {
        return Err(OutOfDomain { argument: "sigma_altitude_m", value: sigma_h, unit: "m", domain: "[0, inf)" });
    }
    let mut normal = Normal::new();
    for sight in sights {
        normal.add(&sight.unit, 0.0, range.sigma(sight.slant)?.m());
    }
    Ok(normal.solve(sigma_h).map(|s| s.covariance))
}
