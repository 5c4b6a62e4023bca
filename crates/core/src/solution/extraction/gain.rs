//! What the Error Extraction filter does to noise, in closed form, and the beta that follows.
//!
//! Provenance: ours (residues of the transfer functions; `docs/methods/error-extraction.md`). The paper states one number, beta = 1.2 at
//! rho = 0.98, from a table we do not hold.

use crate::quantity::OutOfDomain;
use crate::special::float::{cos, exp, exp_m1, ln, sqrt};
use crate::special::root::falling_root;

/// Share of var(u) that an autocorrelation may leave undetermined by being short.
const MOST_LEFT_OUT: f64 = 0.01;

pub(super) fn check_rho(rho: f64) -> Result<(), OutOfDomain> {
    if rho > 0.0 && rho < 1.0 { Ok(()) } else { Err(OutOfDomain { argument: "rho", value: rho, unit: "1", domain: "(0, 1)" }) }
}

pub(super) fn check_period(period_s: f64) -> Result<(), OutOfDomain> {
    if period_s > 0.0 && period_s.is_finite() {
        Ok(())
    } else {
        Err(OutOfDomain { argument: "period_s", value: period_s, unit: "s", domain: "(0, inf)" })
    }
}

/// var(u) / var(xi) for white position errors: 2 (3 + rho) / (1 + rho)^3.
///
/// # Errors
/// [`OutOfDomain`] unless `0 < rho < 1`.
pub fn white(rho: f64) -> Result<f64, OutOfDomain> {
    check_rho(rho)?;
    Ok(2.0 * (3.0 + rho) / cube(1.0 + rho))
}

/// Gain of the filter at half the sampling rate: (2 / (1 + rho))^2.
///
/// # Errors
/// [`OutOfDomain`] unless `0 < rho < 1`.
pub fn nyquist(rho: f64) -> Result<f64, OutOfDomain> {
    check_rho(rho)?;
    Ok(4.0 / ((1.0 + rho) * (1.0 + rho)))
}

/// sd(u) for one metre per second of white velocity noise: T / sqrt(2 (1 - rho^2)) \[s\].
///
/// # Errors
/// [`OutOfDomain`] unless `0 < rho < 1` and the period is positive.
pub fn velocity_s(rho: f64, period_s: f64) -> Result<f64, OutOfDomain> {
    check_rho(rho)?;
    check_period(period_s)?;
    Ok(period_s / sqrt(2.0 * (1.0 - rho) * (1.0 + rho)))
}

/// var(u) / var(xi) for a first-order Gauss-Markov error of correlation time tau; tau = 0 is white.
///
/// ```text
/// R = 2 (1 - phi)(3 + rho - phi - 3 phi rho) / ((1 + rho)^3 (1 - phi rho)^2),    phi = exp(-T/tau)
/// ```
///
/// # Errors
/// [`OutOfDomain`] unless `0 < rho < 1`, the period is positive and tau is not negative.
pub fn gauss_markov(rho: f64, period_s: f64, tau_s: f64) -> Result<f64, OutOfDomain> {
    let phi = memory(rho, period_s, tau_s)?;
    let forgotten = -exp_m1(-period_s / tau_s);
    let common = 1.0 - phi * rho;
    Ok(2.0 * forgotten * (3.0 + rho - phi - 3.0 * phi * rho) / (cube(1.0 + rho) * common * common))
}

/// var(corrected) / var(xi) for white position errors: (1 - rho)(rho^2 + 4 rho + 5) / (1 + rho)^3.
///
/// # Errors
/// [`OutOfDomain`] unless `0 < rho < 1`.
pub fn corrected_white(rho: f64) -> Result<f64, OutOfDomain> {
    check_rho(rho)?;
    Ok((1.0 - rho) * (rho * rho + 4.0 * rho + 5.0) / cube(1.0 + rho))
}

/// var(corrected) / var(xi) for a first-order Gauss-Markov error; above 1 where the filter makes matters worse.
///
/// # Errors
/// As [`gauss_markov`].
pub fn corrected_gauss_markov(rho: f64, period_s: f64, tau_s: f64) -> Result<f64, OutOfDomain> {
    let p = memory(rho, period_s, tau_s)?;
    let (r2, r3, r4) = (rho * rho, cube(rho), rho * cube(rho));
    let terms = p * p * (r4 + 4.0 * r3 + 5.0 * r2) - p * (2.0 * r3 + 4.0 * r2 - 2.0 * rho - 4.0) - r2 - 4.0 * rho - 5.0;
    let common = p * rho - 1.0;
    Ok((rho - 1.0) * terms / (cube(1.0 + rho) * common * common))
}

/// beta = sd(xi) / sd(u) from a ratio of variances.
pub fn beta(variance_gain: f64) -> f64 {
    1.0 / sqrt(variance_gain)
}

/// var(u) / var(xi) from the autocorrelation of the position error at lags 0, T, 2T, ..., whose first value is its variance.
///
/// ```text
/// R = sum over k of c_k r_k / r_0,    c_0 = 2 (3 + rho)/(1 + rho)^3,    c_k = (B |k| - A) rho^|k|
/// B = (1 - rho)^2 / (rho^2 (1 + rho)^2),    A = (1 - rho)(1 + 4 rho + rho^2) / (rho^2 (1 + rho)^3)
/// ```
///
/// c is the autocorrelation of the impulse response; its double zero at zero frequency fixes A and B.
///
/// # Errors
/// [`OutOfDomain`] for a `rho` outside (0, 1), a value that is not finite, a variance that is not positive, lags too few to determine R
/// to 1 %, or values that are no autocorrelation (R not positive).
pub fn from_autocorrelation(rho: f64, autocorrelation_m2: &[f64]) -> Result<f64, OutOfDomain> {
    let wrong = |value, unit, domain| OutOfDomain { argument: "autocorrelation_m2", value, unit, domain };
    let c0 = white(rho)?;
    let Some((&variance, rest)) = autocorrelation_m2.split_first() else { return Err(wrong(0.0, "lags", "at least lag 0")) };
    if let Some(&value) = autocorrelation_m2.iter().find(|v| !v.is_finite()) {
        return Err(wrong(value, "m²", "finite numbers"));
    }
    if !(variance > 0.0) {
        return Err(wrong(variance, "m²", "a positive variance at lag 0"));
    }
    let (mut total, mut decay, mut k) = (c0, 1.0, 0.0);
    let [a, b] = [(1.0 - rho) * (1.0 + 4.0 * rho + rho * rho) / (rho * rho * cube(1.0 + rho)), slope(rho)];
    for value in rest {
        k += 1.0;
        decay *= rho;
        total += 2.0 * (b * k - a) * decay * value / variance;
    }
    // The lags beyond the last, if the error were fully correlated there: sum of 2 (A + B k) rho^k.
    let left_out = 2.0 * decay * rho * ((a + b * (k + 1.0)) / (1.0 - rho) + b * rho / ((1.0 - rho) * (1.0 - rho)));
    if !(total > 0.0) {
        return Err(wrong(total, "var(u)/var(xi)", "an autocorrelation, whose gain is positive"));
    }
    if !(left_out <= MOST_LEFT_OUT * total) {
        return Err(wrong(k, "lags", "enough lags to determine the gain to 1 %"));
    }
    Ok(total)
}

/// var(u) / var(xi) from a one-sided spectral density of the position error at increasing frequencies, by the trapezoid rule.
///
/// ```text
/// R = int |H|^2 S df / int S df,    |H|^2 = ((2 - 2 cos a) / (1 - 2 rho cos a + rho^2))^2,    a = 2 pi f T
/// ```
///
/// # Errors
/// [`OutOfDomain`] for a `rho` or period outside its domain, fewer than two points, frequencies that do not increase from 0 or more to
/// half the sampling rate or less, a density that is negative or not finite, or no power at all.
pub fn from_spectrum(rho: f64, period_s: f64, points: impl Iterator<Item = [f64; 2]>) -> Result<f64, OutOfDomain> {
    check_rho(rho)?;
    check_period(period_s)?;
    let highest = 0.5 / period_s;
    let (mut last, mut power, mut passed): (Option<[f64; 3]>, f64, f64) = (None, 0.0, 0.0);
    for [f, density] in points {
        let above = last.is_none_or(|[before, ..]| f > before);
        // Half the sampling rate, to the rounding of whoever laid out the grid.
        if !(f >= 0.0 && f <= highest * (1.0 + 1e-9) && above) {
            return Err(OutOfDomain {
                argument: "frequency_hz",
                value: f,
                unit: "Hz",
                domain: "increasing frequencies in [0, 1 / (2 period_s)]",
            });
        }
        if !(density >= 0.0 && density.is_finite()) {
            return Err(OutOfDomain { argument: "density_m2_per_hz", value: density, unit: "m²/Hz", domain: "[0, inf)" });
        }
        let out = density * power_gain(rho, core::f64::consts::TAU * f * period_s);
        if let Some([before, density_before, out_before]) = last {
            power += 0.5 * (f - before) * (density + density_before);
            passed += 0.5 * (f - before) * (out + out_before);
        }
        last = Some([f, density, out]);
    }
    if !(power > 0.0 && passed > 0.0) {
        let domain = "at least two frequencies, with power above zero frequency";
        return Err(OutOfDomain { argument: "density_m2_per_hz", value: power, unit: "m²", domain });
    }
    Ok(passed / power)
}

/// Samples after which the answer to a step stays below a share of it.
///
/// ```text
/// rho^k (1 - k (1 - rho)/rho): undershoot at k = rho/(1 - rho) - 1/ln(rho), monotone from there
/// ```
///
/// # Errors
/// [`OutOfDomain`] unless `0 < rho < 1` and `0 < share <= 0.1`: above that the undershoot itself is within the share.
pub fn settling_samples(rho: f64, share: f64) -> Result<u32, OutOfDomain> {
    check_rho(rho)?;
    if !(share > 0.0 && share <= 0.1) {
        return Err(OutOfDomain { argument: "share", value: share, unit: "1", domain: "(0, 0.1]" });
    }
    let (ln_rho, per_sample) = (ln(rho), (1.0 - rho) / rho);
    let below = |k: f64| exp(k * ln_rho) * (k * per_sample - 1.0) - share;
    let deepest = 1.0 / per_sample - 1.0 / ln_rho;
    // rho^k k per_sample falls below any share in (0, 0.1] within 60 - 2 ln(share) time constants.
    let far = deepest + (60.0 - 2.0 * ln(share)) / -ln_rho;
    let k = falling_root(deepest, far, deepest, |k| (below(k), f64::NAN));
    Ok(libm::ceil(k) as u32)
}

fn slope(rho: f64) -> f64 {
    let ratio = (1.0 - rho) / (rho * (1.0 + rho));
    ratio * ratio
}

fn power_gain(rho: f64, angle: f64) -> f64 {
    let c = cos(angle);
    let amplitude = (2.0 - 2.0 * c) / (1.0 - 2.0 * rho * c + rho * rho);
    amplitude * amplitude
}

fn memory(rho: f64, period_s: f64, tau_s: f64) -> Result<f64, OutOfDomain> {
    check_rho(rho)?;
    check_period(period_s)?;
    if !(tau_s >= 0.0 && tau_s.is_finite()) {
        return Err(OutOfDomain { argument: "tau_s", value: tau_s, unit: "s", domain: "[0, inf)" });
    }
    Ok(exp(-period_s / tau_s))
}

fn cube(x: f64) -> f64 {
    x * x * x
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Autocorrelation of the impulse response, summed: an independent way to every gain.
    fn by_impulse_response(rho: f64, autocorrelation: impl Fn(usize) -> f64) -> f64 {
        let n = 4000;
        let h: Vec<f64> = (0..n).map(|k| rho.powi(k) * if k == 0 { 1.0 } else { step(rho, k) - step(rho, k - 1) / rho }).collect();
        let mut sum = 0.0;
        for lag in 0..3000 {
            let c: f64 = h.iter().zip(&h[lag..]).map(|(a, b)| a * b).sum();
            sum += if lag == 0 { 1.0 } else { 2.0 } * c * autocorrelation(lag);
        }
        sum
    }
    /// Answer to a step, without its decay.
    fn step(rho: f64, k: i32) -> f64 {
        1.0 - f64::from(k) * (1.0 - rho) / rho
    }

    #[test]
    fn closed_forms_are_those_of_the_impulse_response() {
        for rho in [0.9, 0.98, 0.99] {
            let white_sum = by_impulse_response(rho, |lag| if lag == 0 { 1.0 } else { 0.0 });
            assert!((white(rho).unwrap() - white_sum).abs() < 1e-12);
            for tau in [2.0, 30.0, 600.0] {
                let r = |lag: usize| (-(lag as f64) / tau).exp();
                let (sum, closed) = (by_impulse_response(rho, r), gauss_markov(rho, 1.0, tau).unwrap());
                assert!((sum / closed - 1.0).abs() < 1e-9, "{rho} {tau}: {sum} {closed}");
                let lags: Vec<f64> = (0..3000).map(|k| 4.0 * r(k)).collect();
                let measured = from_autocorrelation(rho, &lags).unwrap();
                assert!((measured / closed - 1.0).abs() < 1e-9, "{rho} {tau}: {measured} {closed}");
            }
        }
    }

    /// Power of a first-order process seen at period T: (1 - phi^2) / (1 - 2 phi cos a + phi^2), up to a factor.
    #[test]
    fn the_spectrum_gives_what_the_correlation_gives() {
        let (rho, period, tau) = (0.98, 0.5, 20.0);
        let phi = f64::exp(-period / tau);
        let n = 200_000;
        let points = (0..=n).map(|i| {
            let f = f64::from(i) / (2.0 * period * f64::from(n));
            [f, 3.0 / (1.0 - 2.0 * phi * (core::f64::consts::TAU * f * period).cos() + phi * phi)]
        });
        let gain = from_spectrum(rho, period, points).unwrap();
        // The trapezoid of a smooth periodic function is exact to rounding.
        assert!((gain / gauss_markov(rho, period, tau).unwrap() - 1.0).abs() < 1e-9);
    }

    #[test]
    fn raw_error_is_extracted_and_corrected_part() {
        // xi = u + corrected; for errors faster than any filter the corrected part vanishes as rho -> 1, for slow ones u does.
        assert!(corrected_white(0.999_999).unwrap() < 2e-6);
        assert!(gauss_markov(0.5, 1.0, 1e9).unwrap() < 1e-8);
        assert!((corrected_gauss_markov(0.5, 1.0, 1e9).unwrap() - 1.0).abs() < 1e-7);
        // No correlation at all is white.
        assert!((corrected_gauss_markov(0.98, 1.0, 0.0).unwrap() - corrected_white(0.98).unwrap()).abs() < 1e-15);
        assert!((gauss_markov(0.98, 1.0, 0.0).unwrap() - white(0.98).unwrap()).abs() < 1e-15);
    }

    /// The counts of the specification, section 1.2.
    #[test]
    fn steps_settle_in_the_known_number_of_samples() {
        for (rho, five, one) in [(0.95, 82, 123), (0.98, 206, 311), (0.99, 413, 625), (0.995, 827, 1251)] {
            assert_eq!((settling_samples(rho, 0.05).unwrap(), settling_samples(rho, 0.01).unwrap()), (five, one), "{rho}");
        }
        for rho in [1e-3_f64, 0.3, 0.7] {
            let k = settling_samples(rho, 0.01).unwrap() as i32;
            let answer = |k: i32| (rho.powi(k) * step(rho, k)).abs();
            assert!(answer(k) <= 0.01 && answer(k - 1) >= 0.01, "{rho} {k}");
        }
    }

    #[test]
    fn short_and_impossible_autocorrelations_are_refused() {
        let slow: Vec<f64> = (0..50).map(|k| (-f64::from(k) / 300.0).exp()).collect();
        assert!(from_autocorrelation(0.98, &slow).unwrap_err().domain.contains("enough lags"));
        assert!(from_autocorrelation(0.98, &[1.0; 3000]).unwrap_err().domain.contains("positive"));
        for bad in [&[][..], &[0.0], &[f64::NAN], &[1.0, f64::INFINITY]] {
            assert_eq!(from_autocorrelation(0.98, bad).unwrap_err().argument, "autocorrelation_m2");
        }
        assert_eq!(from_spectrum(0.98, 1.0, [[0.0, 1.0], [0.6, 1.0]].into_iter()).unwrap_err().argument, "frequency_hz");
        assert_eq!(from_spectrum(0.98, 1.0, [[0.0, 1.0], [0.4, -1.0]].into_iter()).unwrap_err().argument, "density_m2_per_hz");
        assert_eq!(from_spectrum(0.98, 1.0, core::iter::empty()).unwrap_err().argument, "density_m2_per_hz");
        assert_eq!(gauss_markov(0.98, 1.0, -1.0).unwrap_err().argument, "tau_s");
        assert_eq!(velocity_s(0.98, -1.0).unwrap_err().argument, "period_s");
        assert_eq!(settling_samples(0.98, 0.5).unwrap_err().argument, "share");
    }
}
