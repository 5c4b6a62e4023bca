//! The non-central chi-square law: how likely a test of residuals stays below its threshold in spite of a bias.

use super::float::{exp, ln, ln_gamma, sqrt};
use super::gamma::chi_square_head;
use super::root::{falling_root, scaled_while};

/// Beyond this there are more terms than a table of thresholds is worth.
const MOST_NONCENTRALITY: f64 = 1e6;
/// Half a non-centrality below which the law is the central one to the last digit.
const NONE: f64 = 1e-18;
/// Logarithm of the least term the sum starts from; smaller ones would be lost below the least double.
const LEAST_LN: f64 = -650.0;

/// Probability that a non-central chi-square variable is at most `x`, with full relative accuracy where it is small.
///
/// ```text
/// sum over j of e^-l l^j / j!  P(dof/2 + j, x/2)        l = noncentrality / 2        (standard)
/// P(a, y) = P(a + 1, y) + y^a e^-y / Gamma(a + 1)
/// ```
///
/// Summed from the large j down, where every term is added and none subtracted. NaN unless `dof > 0`, `x >= 0` and the non-centrality is in
/// [0, 1e6].
pub fn noncentral_head(dof: f64, noncentrality: f64, x: f64) -> f64 {
    if !((0.0..=MOST_NONCENTRALITY).contains(&noncentrality)) {
        return f64::NAN;
    }
    let (half, y, l) = (0.5 * dof, 0.5 * x, 0.5 * noncentrality);
    if l < NONE || !(y > 0.0 && y < f64::INFINITY && dof > 0.0) {
        return chi_square_head(dof, x);
    }
    let ln_step = |j: f64| (half + j) * ln(y) - y - ln_gamma(half + j + 1.0);
    let mut last = if l < 1e-3 { 5.0 } else { whole(l + 12.0 * sqrt(l) + 31.0) };
    while last > 1.0 && ln_step(last) < LEAST_LN {
        last = whole(0.9 * last);
    }
    let mut head = chi_square_head(2.0 * (half + last), x);
    let mut step = exp(ln_step(last));
    let mut weight = exp(last * ln(l) - l - ln_gamma(last + 1.0));
    let mut sum = weight * head;
    let mut j = last;
    while j > 0.0 {
        step *= (half + j) / y;
        weight *= j / l;
        j -= 1.0;
        head += step;
        sum += weight * head;
    }
    sum
}

fn whole(x: f64) -> f64 {
    x as u64 as f64
}

/// The non-centrality at which a chi-square variable stays at or below `x` with risk `q`; 0 where it does so no more often without any.
/// NaN unless `dof > 0`, `x >= 0` and `0 < q < 1`.
pub fn noncentrality(dof: f64, x: f64, q: f64) -> f64 {
    let central = chi_square_head(dof, x);
    if !(q > 0.0 && q < 1.0 && !central.is_nan()) {
        return f64::NAN;
    }
    if central <= q {
        return 0.0;
    }
    let high = scaled_while(x + dof, 2.0, |lambda| noncentral_head(dof, lambda, x) > q);
    // d head / d noncentrality = (head of two more degrees - head) / 2.
    let fall = |lambda: f64| {
        let head = noncentral_head(dof, lambda, x);
        (ln(head) - ln(q), 0.5 * (noncentral_head(dof + 2.0, lambda, x) / head - 1.0))
    };
    falling_root(0.0, high, 0.5 * high, fall)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// mpmath, 40 digits: the Poisson sum of regularised incomplete gamma functions.
    const HEADS: [(f64, f64, f64, f64); 9] = [
        (1.0, 50.0, 26.1, 0.024866581978271927),
        (2.0, 60.5, 29.83, 0.008352889181393543),
        (5.0, 1e-05, 3.0, 0.3000132390407152),
        (5.0, 90.0, 39.2, 0.0002466617827082951),
        (12.0, 130.25, 55.0, 2.2003961911391357e-06),
        (60.0, 300.0, 130.0, 5.830800199589944e-16),
        (3.5, 2.25, 0.01, 1.8955674995493707e-05),
        (4.0, 900.0, 36.0, 1.2281532650218977e-128),
        (7.0, 4000.0, 4500.0, 0.9999248076297073),
    ];

    #[test]
    fn heads_meet_forty_digit_values() {
        for (dof, lambda, x, head) in HEADS {
            let computed = noncentral_head(dof, lambda, x);
            // Logarithms of terms near -650 lose three digits.
            assert!((computed / head - 1.0).abs() <= 1e-12, "dof {dof}, lambda {lambda}, x {x}: {computed:e} for {head:e}");
        }
    }

    #[test]
    fn one_degree_is_a_normal_variable_in_an_interval() {
        for (bias, t) in [(0.0, 5.0), (0.3, 2.0), (7.0, 4.5), (20.0, 5.1)] {
            let interval = super::super::normal::tail(bias - t) - super::super::normal::tail(bias + t);
            let head = noncentral_head(1.0, bias * bias, t * t);
            assert!((head / interval - 1.0).abs() <= 1e-12, "{bias}, {t}: {head:e} for {interval:e}");
        }
    }

    #[test]
    fn the_noncentrality_gives_its_risk_back() {
        for dof in [1.0, 2.0, 5.0, 12.0, 60.0] {
            for q in [1e-9, 1e-3, 0.05, 0.5] {
                let x = super::super::gamma::chi_square_factor(dof, 3.33e-7);
                let back = noncentral_head(dof, noncentrality(dof, x, q), x);
                // The root is exact to one ulp of some 1e2, of which the logarithm of the risk changes by at most one half.
                assert!((back / q - 1.0).abs() <= 1e-12, "dof {dof}, q {q}: {back:e}");
            }
        }
    }

    #[test]
    fn outside_the_domain_there_is_no_number() {
        for (dof, lambda, x) in
            [(0.0, 1.0, 1.0), (2.0, -1.0, 1.0), (2.0, 1.0, -1.0), (2.0, f64::NAN, 1.0), (2.0, 1e7, 1.0), (f64::NAN, 1.0, 1.0)]
        {
            assert!(noncentral_head(dof, lambda, x).is_nan(), "{dof} {lambda} {x}");
        }
        assert!(noncentrality(2.0, 1.0, 0.0).is_nan() && noncentrality(-2.0, 1.0, 0.1).is_nan());
        assert_eq!(noncentrality(3.0, 0.1, 0.9), 0.0);
        assert_eq!(noncentral_head(3.0, 4.0, 0.0), 0.0);
        assert_eq!(noncentral_head(3.0, 4.0, f64::INFINITY), 1.0);
    }
}
