//! Elementary functions, the same bits with and without an operating system.
//!
//! Square root and rounding are exact operations, so the processor's and the software's agree to the bit and the fast one is used
//! where it exists. Transcendental functions always come from `libm`: a platform's own would change the last digits.

#[inline(always)]
pub(crate) fn sqrt(x: f64) -> f64 {
    #[cfg(any(feature = "std", test))]
    return x.sqrt();
    #[cfg(not(any(feature = "std", test)))]
    return libm::sqrt(x);
}

/// `x`, but not below `low` nor above `high`. NaN where the limits cross or one of them is NaN: `f64::clamp` panics there.
#[inline(always)]
pub(crate) fn within(x: f64, low: f64, high: f64) -> f64 {
    if !(low <= high) {
        f64::NAN
    } else if x < low {
        low
    } else if x > high {
        high
    } else {
        x
    }
}

pub(crate) use libm::{
    acos, asin, atan2, cos, erfc, exp, expm1 as exp_m1, hypot, lgamma as ln_gamma, log as ln, log1p as ln_1p, sin, sincos as sin_cos, tan,
};
