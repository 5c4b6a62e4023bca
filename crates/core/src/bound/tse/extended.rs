//! The same law with one assumption more or less: random flight technical error, mixtures, heavy tails, a biased overbound, curved legs.

use super::lateral::{Deviation, exact};
use crate::quantity::{Metres, OutOfDomain, Risk};
use crate::special::float::{ln, sqrt};
use crate::special::folded::{FoldedQuantile, two_tails};
use crate::special::normal::density;
use crate::special::root::falling_root;
use crate::special::student::StudentT;
use crate::special::two_sided_factor;

/// Above this many degrees of freedom a Student law is taken as the caller's mistake for a normal one.
pub const MAX_DEGREES_OF_FREEDOM: f64 = 1e6;
/// How far the weights of a mixture may be from one together.
const WEIGHT_ROUNDING: f64 = 1e-12;
/// The bracket of a mixture is widened by this share: its ends carry the rounding of the components.
const BRACKET_MARGIN: f64 = 1e-12;

/// A flight technical error known only by its law, and its companions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RandomFte {
    /// Mean of the flight technical error, signed.
    pub mean_fte: Metres,
    /// Its standard deviation.
    pub sigma_fte: Metres,
    /// Standard deviation of the navigation system error across the path.
    pub sigma_nse: Metres,
    /// Standard deviation of the path definition error.
    pub sigma_pde: Metres,
    /// Correlation of flight technical and navigation system error. A coupled autopilot follows the estimate, so slow navigation errors
    /// stand in the true track with the opposite sign.
    pub correlation: f64,
}

impl RandomFte {
    /// The total deviation:
    ///
    /// ```text
    /// sigma^2 = sigma_fte^2 + sigma_nse^2 + sigma_pde^2 + 2 rho sigma_fte sigma_nse
    /// ```
    ///
    /// # Errors
    /// [`OutOfDomain`] for a negative deviation, a number that is not finite, or a correlation outside [-1, 1].
    pub fn total(&self) -> Result<Deviation, OutOfDomain> {
        for (argument, sigma) in [("sigma_fte_m", self.sigma_fte), ("sigma_nse_m", self.sigma_nse), ("sigma_pde_m", self.sigma_pde)] {
            non_negative(argument, sigma)?;
        }
        let rho = self.correlation;
        if !(rho.abs() <= 1.0) {
            return Err(OutOfDomain { argument: "correlation", value: rho, unit: "1", domain: "[-1, 1]" });
        }
        let (fte, nse, pde) = (self.sigma_fte.m(), self.sigma_nse.m(), self.sigma_pde.m());
        let variance = fte * fte + nse * nse + pde * pde + 2.0 * rho * fte * nse;
        Deviation::new(self.mean_fte, Metres::new(sqrt(variance.max(0.0))))
    }
}

/// Root sum square: K(q) times the total deviation, whatever the mean \[m\]. A figure of a population of flights, not of the flight at hand.
///
/// # Errors
/// As [`RandomFte::total`].
pub fn rssm(parts: &RandomFte, risk: Risk) -> Result<Metres, OutOfDomain> {
    Ok(Metres::new(two_sided_factor(risk.q()) * parts.total()?.sigma().m()))
}

/// Exact bound for a navigation error whose law lies between two normal laws shifted by `bias` either way: T = bias + exact \[m\].
///
/// # Errors
/// [`OutOfDomain`] unless `bias >= 0` and finite.
pub fn paired_overbound(deviation: Deviation, bias: Metres, risk: Risk) -> Result<Metres, OutOfDomain> {
    let bias = non_negative("bias_m", bias)?;
    Ok(Metres::new(bias + exact(deviation, risk).m()))
}

/// Exact bound where the navigation error follows Student's law with `nu` degrees of freedom \[m\]. The deviation's sigma is the law's
/// *scale*; its standard deviation is scale * sqrt(nu / (nu - 2)).
///
/// # Errors
/// [`OutOfDomain`] unless 1 <= nu <= 1e6, and for a risk so small that the law's tail at the bound leaves the range of a double (about
/// 1e-260 at six degrees of freedom, 1e-150 at one).
pub fn student_t(deviation: Deviation, nu: f64, risk: Risk) -> Result<Metres, OutOfDomain> {
    if !(1.0..=MAX_DEGREES_OF_FREEDOM).contains(&nu) {
        return Err(OutOfDomain { argument: "degrees_of_freedom", value: nu, unit: "1", domain: "[1, 1e6]" });
    }
    let (fte, scale) = (deviation.fte().m().abs(), deviation.sigma().m());
    if scale == 0.0 {
        return Ok(Metres::new(fte));
    }
    let (law, ratio) = (StudentT::new(nu), fte / scale);
    let excess = law.excess(ratio, risk.q());
    // Where density or square leave the range the root is a number of no meaning, and shorter than the bound.
    if !((law.risk(ratio, excess) / risk.q() - 1.0).abs() <= SAME_RISK) {
        return Err(OutOfDomain { argument: "risk", value: risk.q(), unit: "1", domain: "risks whose Student bound a double holds" });
    }
    Ok(Metres::new(fte + excess * scale))
}

/// How far the risk at a bound may be from the one requested: 1e-6 is far above its rounding, and far below what any figure here shows.
const SAME_RISK: f64 = 1e-6;

/// One hypothesis of a mixture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Component {
    /// Its weight; all weights together are one.
    pub weight: f64,
    /// Its normal error.
    pub deviation: Deviation,
}

/// Exact bound of a mixture of normal errors \[m\]:
///
/// ```text
/// sum_i w_i [Q((T - fte_i) / sigma_i) + Q((T + fte_i) / sigma_i)] = q
/// ```
///
/// The root lies between the smallest and the largest bound of the components: at the smallest every component's risk is at least q,
/// at the largest at most q.
///
/// # Errors
/// [`OutOfDomain`] unless the weights are not negative and sum to one within 1e-12.
pub fn mixture(components: &[Component], risk: Risk) -> Result<Metres, OutOfDomain> {
    let total: f64 = components.iter().map(|c| c.weight).sum();
    if let Some(bad) = components.iter().find(|c| !(c.weight >= 0.0)) {
        return Err(OutOfDomain { argument: "weight", value: bad.weight, unit: "1", domain: "[0, 1]" });
    }
    if !((total - 1.0).abs() <= WEIGHT_ROUNDING) {
        return Err(OutOfDomain { argument: "weight", value: total, unit: "1", domain: "weights that sum to 1 within 1e-12" });
    }
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    let law = FoldedQuantile::new(risk);
    for c in components.iter().filter(|c| c.weight > 0.0) {
        let bound = exact(c.deviation, risk).m();
        (low, high) = (low.min(bound), high.max(bound));
    }
    let f = |bound: f64| mixture_risk(components, bound, law.risk());
    Ok(Metres::new(falling_root(low * (1.0 - BRACKET_MARGIN), high * (1.0 + BRACKET_MARGIN), high, f)))
}

/// ln(risk / q) of a mixture at a bound, and its slope.
fn mixture_risk(components: &[Component], bound: f64, q: f64) -> (f64, f64) {
    let (mut risk, mut slope) = (0.0, 0.0);
    for c in components {
        let (fte, sigma) = (c.deviation.fte().m(), c.deviation.sigma().m());
        let Some((t, m)) = c.deviation.in_deviations(bound) else {
            risk += if fte.abs() <= bound { 0.0 } else { c.weight };
            continue;
        };
        risk += c.weight * two_tails(t, m);
        slope -= c.weight * (density(t - m) + density(t + m)) / sigma;
    }
    (ln(risk / q), slope / risk)
}

/// Flight technical error on a curved leg, with the second-order bias of the curvature \[m\]:
///
/// ```text
/// |fte| + (sigma_along^2 + along^2) / (2 R)
/// ```
///
/// taken at the closest point of the leg. Always added, however small: leaving it out below a threshold would make the bound jump.
///
/// # Errors
/// [`OutOfDomain`] unless R > 0, sigma_along >= 0 and all are finite.
pub fn rf_fte(fte: Metres, along: Metres, sigma_along: Metres, radius: Metres) -> Result<Metres, OutOfDomain> {
    let lateral = Deviation::new(fte, sigma_along)?;
    if !along.m().is_finite() {
        return Err(OutOfDomain { argument: "along_m", value: along.m(), unit: "m", domain: "(-inf, inf)" });
    }
    if !(radius.m() > 0.0 && radius.m().is_finite()) {
        return Err(OutOfDomain { argument: "radius_m", value: radius.m(), unit: "m", domain: "(0, inf)" });
    }
    let second_order = (sigma_along.m() * sigma_along.m() + along.m() * along.m()) / (2.0 * radius.m());
    Ok(Metres::new(lateral.fte().m().abs() + second_order))
}

fn non_negative(argument: &'static str, length: Metres) -> Result<f64, OutOfDomain> {
    if !(length.m() >= 0.0 && length.m().is_finite()) {
        return Err(OutOfDomain { argument, value: length.m(), unit: "m", domain: "[0, inf)" });
    }
    Ok(length.m())
}
