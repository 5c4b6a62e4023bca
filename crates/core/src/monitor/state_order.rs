//! Does the most likely state only ever get worse as the error grows?

use super::state::{MAX_STATES, StateTable};
use crate::special::float::{ln, sqrt};

/// Crossings of all pairs of states, at most two each.
const MAX_CROSSINGS: usize = MAX_STATES * (MAX_STATES - 1);

/// True when the most likely state under the published densities never decreases with the error. Where it does, a wide state that
/// is no neighbour wins somewhere in between, or a narrow last state loses far outside: the posterior must not decide.
///
/// Between two neighbouring crossings of densities nothing changes order, so one point in each interval decides it exactly.
pub fn is_ordered(table: &StateTable) -> bool {
    let (mut points, n) = crossings(table);
    let points = &mut points[..n];
    points.sort_unstable_by(f64::total_cmp);
    let mut worst = 0;
    let mut below = 0.0;
    for &above in points.iter() {
        let here = most_likely(table, 0.5 * (below + above));
        if above > below && here < worst {
            return false;
        }
        if above > below {
            worst = here;
        }
        below = above;
    }
    most_likely(table, 2.0 * below + 1.0) >= worst
}

fn most_likely(table: &StateTable, x: f64) -> usize {
    let better = |best: usize, k: usize| if table.ln_likelihood(k, x) > table.ln_likelihood(best, x) { k } else { best };
    (1..table.n_states()).fold(0, better)
}

/// Where ln N(x; mu_i, sigma_i) = ln N(x; mu_j, sigma_j), x >= 0: a quadratic a x^2 + 2 h x + c = 0 for every pair.
fn crossings(table: &StateTable) -> ([f64; MAX_CROSSINGS], usize) {
    let (mean, sigma) = (table.mean_m(), table.sigma_m());
    let mut places = [0.0; MAX_CROSSINGS];
    let mut count = 0;
    let mut keep = |x: f64| {
        if x >= 0.0 && x.is_finite() {
            places[count] = x;
            count += 1;
        }
    };
    for i in 0..table.n_states() {
        for j in i + 1..table.n_states() {
            // In units of sigma_j, about mu_j: y = (x - mu_j) / sigma_j.
            let ratio = sigma[j] / sigma[i];
            let shift = (mean[j] - mean[i]) / sigma[i];
            let (a, h, c) = (ratio * ratio - 1.0, ratio * shift, shift * shift - 2.0 * ln(ratio));
            for y in roots(a, h, c) {
                keep(mean[j] + sigma[j] * y);
            }
        }
    }
    (places, count)
}

/// Roots of a y^2 + 2 h y + c, NaN where there is none; the form that does not cancel.
fn roots(a: f64, h: f64, c: f64) -> [f64; 2] {
    if a == 0.0 {
        return [-0.5 * c / h, f64::NAN];
    }
    let discriminant = h * h - a * c;
    if !(discriminant >= 0.0) {
        return [f64::NAN; 2];
    }
    let far = -(h + if h >= 0.0 { sqrt(discriminant) } else { -sqrt(discriminant) });
    [far / a, c / far]
}
