//! Tail and density of the standard normal law for several numbers abreast.
//!
//! A fixed number of operations and no data-dependent branch, so that the compiler can use vector registers; every operation is elementwise
//! and none is joined with another, so one lane and eight give the same bits. Where one number is enough, [`super::normal`] is exact to
//! the last digit; here the relative error of the tail stays below 1e-13.

use super::normal::FRAC_1_SQRT_2PI;

/// Beyond this the tail (3e-316) is below the smallest normal number, and counts as zero.
const FARTHEST: f64 = 37.5;
/// Where t below is zero.
const CENTRE: f64 = 4.0;
/// (x + 4) Q(x) exp(x²/2) as a polynomial of t = (x - 4)/(x + 4), through its values at the Chebyshev points of 0 <= x <= 38 worked out with 50
/// digits: relative error 8e-15 (ours).
const SCALED_TAIL: [f64; 19] = [
    0.755_285_130_415_750_6,
    -0.607_896_641_971_879_3,
    0.387_137_400_742_364_4,
    -0.186_521_857_961_246_98,
    0.060_396_574_886_597_88,
    -0.007_540_188_917_447_299,
    -0.003_479_692_314_562_791_6,
    0.001_630_817_808_752_624_9,
    0.000_133_343_908_297_078_46,
    -0.000_231_090_453_990_703_5,
    -1.905_924_260_737_426e-6,
    3.512_679_551_005_458e-5,
    7.068_665_042_901_254e-7,
    -5.877_374_507_085_926e-6,
    -6.026_542_052_760_077e-7,
    9.611_288_963_435_631e-7,
    2.262_496_955_094_734_7e-7,
    -1.090_462_898_892_683_6e-7,
    -4.216_838_742_997_344_4e-8,
];

/// Q(x) and phi(x) of each x; every x below zero is taken as zero.
#[inline(always)]
pub(crate) fn tails<const L: usize>(x: &[f64; L]) -> ([f64; L], [f64; L]) {
    let (mut tail, mut density) = ([0.0; L], [0.0; L]);
    for l in 0..L {
        let x_l = x[l].clamp(0.0, FARTHEST);
        let inverse = 1.0 / (x_l + CENTRE);
        let t = (x_l - CENTRE) * inverse;
        let mut scaled = SCALED_TAIL[18];
        for k in (0..18).rev() {
            scaled = scaled * t + SCALED_TAIL[k];
        }
        let bell = exp_of_negative(-0.5 * x_l * x_l);
        // A comparison the compiler turns into a mask; NaN stays NaN through `clamp`.
        let near = if x[l] > FARTHEST { 0.0 } else { 1.0 };
        tail[l] = near * bell * scaled * inverse;
        density[l] = near * bell * FRAC_1_SQRT_2PI;
    }
    (tail, density)
}

/// exp(y) for -708 <= y <= 0, relative error 1e-15: 2^n exp(r), r within half of ln 2, and the series of exp to r^13.
#[inline(always)]
pub(crate) fn exp_of_negative(y: f64) -> f64 {
    /// 1.5 * 2^52: adding it rounds to an integer, which then stands in the last bits.
    const ROUNDER: f64 = 6_755_399_441_055_744.0;
    /// ln 2 in two parts, the first with zeros at its end, so that its product with n is exact (fdlibm).
    const LN_2: [f64; 2] = [0.693_147_180_369_123_8, 1.908_214_929_270_587_7e-10];
    const EXPONENT_OF_ONE: u64 = 1023 << 52;
    let rounded = y * core::f64::consts::LOG2_E + ROUNDER;
    let n = rounded - ROUNDER;
    let r = (y - n * LN_2[0]) - n * LN_2[1];
    let mut series = 1.0 / 6_227_020_800.0;
    for inverse in [
        1.0 / 479_001_600.0,
        1.0 / 39_916_800.0,
        1.0 / 3_628_800.0,
        1.0 / 362_880.0,
        1.0 / 40_320.0,
        1.0 / 5_040.0,
        1.0 / 720.0,
        1.0 / 120.0,
        1.0 / 24.0,
        1.0 / 6.0,
        0.5,
        1.0,
        1.0,
    ] {
        series = series * r + inverse;
    }
    series * f64::from_bits((rounded.to_bits() << 52).wrapping_add(EXPONENT_OF_ONE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::special::normal::{density, tail};

    /// The square of x carries half a unit in its last place, which its exponential multiplies by x²/2, and the tail compared with one in
    /// x / sqrt 2, which counts twice.
    #[test]
    fn the_exact_tail_and_density_are_met_to_thirteen_digits() {
        for k in 0..3750 {
            let x = 0.01 * f64::from(k);
            let ([q], [phi]) = tails(&[x]);
            assert!((q / tail(x) - 1.0).abs() <= 1.6e-14 + 1.8e-16 * x * x, "Q({x}) = {q}");
            assert!((phi / density(x) - 1.0).abs() <= 2e-15 + 1.2e-16 * x * x, "phi({x}) = {phi}");
        }
    }

    #[test]
    fn lanes_do_not_see_each_other() {
        let x: [f64; 8] = core::array::from_fn(|l| 0.7 * l as f64 - 1.0);
        let (q, phi) = tails(&x);
        for l in 0..8 {
            let ([one], [bell]) = tails(&[x[l]]);
            assert_eq!((q[l].to_bits(), phi[l].to_bits()), (one.to_bits(), bell.to_bits()));
        }
    }

    #[test]
    fn the_ends_are_a_half_and_nothing_and_no_number_stays_none() {
        let ([left, right, far, nan], _) = tails(&[-3.0, 0.0, 1e300, f64::NAN]);
        // Relative error of the polynomial.
        assert!((left - 0.5).abs() <= 1e-14 && left == right);
        assert!(far == 0.0 && nan.is_nan());
    }
}
