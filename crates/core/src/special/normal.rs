//! The standard normal law: density, tail, logarithm of the tail, quantiles.

use super::float::{erfc, exp, ln, sqrt};
use core::f64::consts::{FRAC_1_SQRT_2, PI, SQRT_2};

/// 1 / sqrt(2 pi).
pub const FRAC_1_SQRT_2PI: f64 = 0.398_942_280_401_432_7;

/// Standard normal density phi(x).
#[inline]
pub fn density(x: f64) -> f64 {
    FRAC_1_SQRT_2PI * exp(-0.5 * x * x)
}

/// Upper tail Q(x) = 1 - Phi(x), with full relative accuracy for large x.
///
/// ```text
/// Q(x) = erfc(x / sqrt 2) / 2
/// ```
#[inline]
pub fn tail(x: f64) -> f64 {
    0.5 * erfc(x * FRAC_1_SQRT_2)
}

/// ln Q(x), finite where Q itself underflows (x above 38).
///
/// Above x = 25 the tail is taken from its continued fraction, Q(x) = phi(x) / (x + 1/(x + 2/(x + ...))), whose twelve terms leave
/// less than 1e-18 relative there.
pub fn ln_tail(x: f64) -> f64 {
    if x < 25.0 {
        return ln(tail(x));
    }
    let mut fraction = x;
    for k in (1..=12).rev() {
        fraction = x + f64::from(k) / fraction;
    }
    -0.5 * x * x - 0.5 * ln(2.0 * PI) - ln(fraction)
}

/// One-sided factor z(q) = Q^-1(q): the standard normal exceeds it with risk q.
///
/// Wichura's rational approximation AS 241 (relative error 1e-16 of the central quantile) on the smaller tail, then one Halley step on
/// the logarithm of the tail, which removes what is left in the last digits. NaN unless 0 < q < 1.
pub fn one_sided_factor(q: f64) -> f64 {
    if !(q > 0.0 && q < 1.0) {
        return f64::NAN;
    }
    if q > 0.5 {
        return -lower_risk_factor(1.0 - q);
    }
    lower_risk_factor(q)
}

/// Two-sided factor K(q) = Q^-1(q/2): |standard normal| exceeds it with risk q. 1.959963984540054 at 0.05.
pub fn two_sided_factor(q: f64) -> f64 {
    one_sided_factor(0.5 * q)
}

fn lower_risk_factor(q: f64) -> f64 {
    if q == 0.5 {
        return 0.0;
    }
    let start = wichura(q);
    // Halley on ln(Q(x)/q); its derivatives are -h and -(h^2 - x h) with the hazard h = phi/Q.
    let t = tail(start);
    let h = density(start) / t;
    let f = ln(t / q);
    let second = h * (start - h);
    start + 2.0 * f * h / (2.0 * h * h - f * second)
}

/// Wichura 1988, algorithm AS 241 (PPND16), for the upper tail q <= 1/2.
fn wichura(q: f64) -> f64 {
    const A: [f64; 8] = [
        3.387_132_872_796_366_5,
        1.331_416_678_917_843_8e2,
        1.971_590_950_306_551_3e3,
        1.373_169_376_550_946e4,
        4.592_195_393_154_987e4,
        6.726_577_092_700_87e4,
        3.343_057_558_358_813e4,
        2.509_080_928_730_122_7e3,
    ];
    const B: [f64; 8] = [
        1.0,
        4.231_333_070_160_091e1,
        6.871_870_074_920_579e2,
        5.394_196_021_424_751e3,
        2.121_379_430_158_659_7e4,
        3.930_789_580_009_271e4,
        2.872_908_573_572_194_3e4,
        5.226_495_278_852_854e3,
    ];
    const C: [f64; 8] = [
        1.423_437_110_749_683_5,
        4.630_337_846_156_546,
        5.769_497_221_460_691,
        3.647_848_324_763_204_5,
        1.270_458_252_452_368_4,
        2.417_807_251_774_506e-1,
        2.272_384_498_926_918_4e-2,
        7.745_450_142_783_414e-4,
    ];
    const D: [f64; 8] = [
        1.0,
        2.053_191_626_637_759,
        1.676_384_830_183_803_8,
        6.897_673_349_851e-1,
        1.481_039_764_274_800_8e-1,
        1.519_866_656_361_645_7e-2,
        5.475_938_084_995_345e-4,
        1.050_750_071_644_416_9e-9,
    ];
    const E: [f64; 8] = [
        6.657_904_643_501_103,
        5.463_784_911_164_114,
        1.784_826_539_917_291_3,
        2.965_605_718_285_048_7e-1,
        2.653_218_952_657_612_4e-2,
        1.242_660_947_388_078_4e-3,
        2.711_555_568_743_487_6e-5,
        2.010_334_399_292_288_1e-7,
    ];
    const F: [f64; 8] = [
        1.0,
        5.998_322_065_558_88e-1,
        1.369_298_809_227_358e-1,
        1.487_536_129_085_061_5e-2,
        7.868_691_311_456_133e-4,
        1.846_318_317_510_054_7e-5,
        1.421_511_758_316_446e-7,
        2.044_263_103_389_939_8e-15,
    ];
    let ratio = |n: &[f64; 8], d: &[f64; 8], x: f64| {
        let poly = |c: &[f64; 8]| c.iter().rev().fold(0.0, |sum, c| sum * x + c);
        poly(n) / poly(d)
    };
    let centred = 0.5 - q;
    if centred <= 0.425 {
        return centred * ratio(&A, &B, 0.180_625 - centred * centred);
    }
    let r = sqrt(-ln(q));
    if r <= 5.0 { ratio(&C, &D, r - 1.6) } else { ratio(&E, &F, r - 5.0) }
}

/// sqrt(2), for conversions between erfc's argument and the normal's.
pub const SQRT_TWO: f64 = SQRT_2;

#[cfg(test)]
mod tests {
    use super::*;

    /// K and z of the TSE specification, section 1.5 (50-digit arithmetic).
    #[test]
    fn factors_meet_the_fifty_digit_table() {
        for (q, two_sided, one_sided) in [
            (0.05, 1.959_963_984_540_054_2, 1.644_853_626_951_472_7),
            (1e-5, 4.417_173_413_469_022, 4.264_890_793_922_825),
            (0.5, 0.674_489_750_196_081_7, 0.0),
            (1e-12, 7.130_506_848_171_324, 7.034_483_825_301_132),
        ] {
            assert!((two_sided_factor(q) - two_sided).abs() <= 5e-16 * two_sided, "K({q}) = {}", two_sided_factor(q));
            assert!((one_sided_factor(q) - one_sided).abs() <= 5e-16 * one_sided, "z({q}) = {}", one_sided_factor(q));
        }
    }

    #[test]
    fn the_tail_of_a_factor_is_its_risk() {
        for k in 0..300 {
            let q = exp(-0.05 * f64::from(k)) * 0.499;
            let back = tail(one_sided_factor(q));
            // u^2 conditioning: an ulp of the factor moves the tail by u^2 ulps.
            let u = one_sided_factor(q);
            assert!((back / q - 1.0).abs() <= 4e-16 * (1.0 + u * u), "q = {q}: {back}");
        }
    }

    #[test]
    fn the_logarithm_joins_the_continued_fraction_smoothly() {
        for x in [24.0, 24.9, 25.0, 26.0, 37.0] {
            let direct = ln(tail(x));
            assert!((ln_tail(x) - direct).abs() <= 1e-13 * direct.abs(), "x = {x}");
        }
        assert!(ln_tail(1e4).is_finite());
    }

    #[test]
    fn outside_the_unit_interval_there_is_no_factor() {
        for q in [0.0, 1.0, -0.1, 2.0, f64::NAN] {
            assert!(one_sided_factor(q).is_nan());
        }
    }
}
