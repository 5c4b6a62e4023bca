//! Gauss-Legendre quadrature on panels.

/// Positive nodes and weights of the 32-point rule (`oracle/anp_tables.py` prints them; a test compares).
#[rustfmt::skip]
const GAUSS_32: [(f64, f64); 16] = [
    (0.04830766568773832, 0.0965400885147278),
    (0.1444719615827965, 0.09563872007927486),
    (0.23928736225213706, 0.09384439908080457),
    (0.33186860228212767, 0.09117387869576389),
    (0.42135127613063533, 0.08765209300440381),
    (0.5068999089322294, 0.08331192422694675),
    (0.5877157572407623, 0.07819389578707031),
    (0.6630442669302152, 0.0723457941088485),
    (0.7321821187402897, 0.06582222277636185),
    (0.7944837959679424, 0.058684093478535544),
    (0.84936761373257, 0.050998059262376175),
    (0.8963211557660521, 0.04283589802222668),
    (0.9349060759377397, 0.03427386291302143),
    (0.9647622555875064, 0.02539206530926206),
    (0.9856115115452684, 0.01627439473090567),
    (0.9972638618494816, 0.007018610009470096),
];

/// Integral of a vector-valued function over `[lo, hi]`, cut into equal panels of 32 nodes each. An empty interval gives zero.
pub(crate) fn integrate<const K: usize>(lo: f64, hi: f64, panels: usize, mut f: impl FnMut(f64) -> [f64; K]) -> [f64; K] {
    let mut sum = [0.0; K];
    let half = 0.5 * (hi - lo) / panels as f64;
    if !(half > 0.0) {
        return sum;
    }
    for panel in 0..panels {
        let centre = lo + half * (2 * panel + 1) as f64;
        for (node, weight) in GAUSS_32 {
            for x in [centre - half * node, centre + half * node] {
                for (total, value) in sum.iter_mut().zip(f(x)) {
                    *total += half * weight * value;
                }
            }
        }
    }
    sum
}

/// Integral over `[lo, hi]` with a panel boundary at every break inside, so that each panel sees a smooth function.
///
/// `breaks` may come in any order, outside the interval or NaN; such entries are passed over. Pieces longer than `longest` are cut.
pub(crate) fn integrate_broken<const K: usize, const B: usize>(
    lo: f64,
    hi: f64,
    mut breaks: [f64; B],
    longest: f64,
    mut f: impl FnMut(f64) -> [f64; K],
) -> [f64; K] {
    breaks.sort_unstable_by(f64::total_cmp);
    let mut sum = [0.0; K];
    let mut from = lo;
    for to in breaks.into_iter().filter(|b| *b > lo && *b < hi).chain([hi]) {
        let panels = ((to - from) / longest).clamp(0.0, 63.0) as usize + 1;
        for (total, value) in sum.iter_mut().zip(integrate(from, to, panels, &mut f)) {
            *total += value;
        }
        from = to;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_up_to_the_degree_of_the_rule_are_exact() {
        for degree in 0..=63 {
            let [integral] = integrate(0.0, 1.0, 1, |x: f64| [x.powi(degree)]);
            // 64 products of up to 63 factors: a few dozen roundings.
            assert!((integral * f64::from(degree + 1) - 1.0).abs() < 64.0 * f64::EPSILON, "degree {degree}: {integral}");
        }
    }

    #[test]
    fn a_kink_at_a_break_costs_nothing() {
        let [integral] = integrate_broken(-1.0, 2.0, [0.25, f64::NAN, -9.0], 1.0, |x| [(x - 0.25).abs()]);
        let exact = 0.5 * (1.25 * 1.25 + 1.75 * 1.75);
        assert!((integral - exact).abs() < 1e-14, "{integral}");
    }

    #[test]
    fn an_empty_interval_has_no_integral() {
        assert_eq!(integrate(1.0, 1.0, 2, |_| [1.0]), [0.0]);
        assert_eq!(integrate(2.0, 1.0, 2, |_| [1.0]), [0.0]);
    }
}
