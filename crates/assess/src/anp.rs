//! Actual navigation performance of many epochs, on all cores.
//!
//! Matrices come flat and row by row, as Python holds them: four numbers a horizontal covariance, nine a spatial one \[m²\]; means
//! two or three numbers \[m\]; risks one number an epoch.

use crate::parallel;
use navbound_core::bound::anp::{accept, radius_law, radius_m};
use navbound_core::quantity::OutOfDomain;
use navbound_core::special::radius::{AtRadius, CentredRadius};

/// What an epoch's argument was refused for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Refused {
    /// Which epoch, from 0.
    pub index: usize,
    /// What was wrong with it.
    pub refusal: OutOfDomain,
}

/// Epochs a thread takes at a time; below it a second thread costs more than it brings.
const CHUNK: usize = 1024;
/// Covariances abreast: two vector registers of four doubles, or one of eight.
const LANES: usize = 8;

/// Results of every epoch, or the first refusal.
///
/// # Errors
/// [`Refused`], with the smallest index of all that are refused.
pub fn each<T: Copy + Default + Send>(n: usize, item: impl Fn(usize) -> Result<T, OutOfDomain> + Sync) -> Result<Vec<T>, Refused> {
    chunks(n, |first, out| {
        for (offset, place) in out.iter_mut().enumerate() {
            let index = first + offset;
            *place = item(index).map_err(|refusal| Refused { index, refusal })?;
        }
        Ok(())
    })
}

fn chunks<T: Copy + Default + Send>(n: usize, fill: impl Fn(usize, &mut [T]) -> Result<(), Refused> + Sync) -> Result<Vec<T>, Refused> {
    let mut out = vec![T::default(); n];
    let refused = parallel::fill(&mut out, CHUNK, fill).into_iter().find_map(Result::err);
    refused.map_or(Ok(out), Err)
}

/// One symmetric matrix out of a flat array: 2 x 2 or 3 x 3.
///
/// # Errors
/// [`OutOfDomain`] when it is not symmetric to 1e-9 of its largest element, or not finite.
fn upper<const D: usize>(flat: &[f64], index: usize, argument: &'static str) -> Result<[f64; 6], OutOfDomain> {
    let v = |i: usize, j: usize| flat[(index * D + i) * D + j];
    let refuse = |value, domain| Err(OutOfDomain { argument, value, unit: "m²", domain });
    let (mut largest, mut skew): (f64, f64) = (0.0, 0.0);
    for i in 0..D {
        for j in 0..D {
            if !v(i, j).is_finite() {
                return refuse(v(i, j), "(-inf, inf): every element finite");
            }
            largest = largest.max(v(i, j).abs());
            skew = skew.max((v(i, j) - v(j, i)).abs());
        }
    }
    if skew > 1e-9 * largest {
        return refuse(skew, "[0, 1e-9] of the largest element for the asymmetry");
    }
    let mean = |i: usize, j: usize| if D > j { 0.5 * (v(i, j) + v(j, i)) } else { 0.0 };
    Ok([v(0, 0), mean(0, 1), v(1, 1), mean(0, 2), mean(1, 2), if D > 2 { v(2, 2) } else { 0.0 }])
}

fn mean_of<const D: usize>(flat: Option<&[f64]>, index: usize) -> [f64; 3] {
    let mut mean = [0.0; 3];
    if let Some(flat) = flat {
        mean[..D].copy_from_slice(&flat[index * D..(index + 1) * D]);
    }
    mean
}

fn checked_risk(risk: f64) -> Result<f64, OutOfDomain> {
    navbound_core::quantity::Risk::new(risk).map(navbound_core::quantity::Risk::q)
}

/// Names of the arguments of a dimension, as Python calls them.
const fn names<const D: usize>() -> [&'static str; 2] {
    if D == 2 { ["covariance_en_m2", "mean_en_m"] } else { ["covariance_enu_m2", "mean_enu_m"] }
}

/// Radii \[m\] of circles (`D` = 2) or spheres (`D` = 3) that the errors leave with their risks.
///
/// # Errors
/// [`Refused`]: a matrix that is no covariance, a mean that is not finite, a risk outside (0, 1).
pub fn radii_m<const D: usize>(covariance_m2: &[f64], mean_m: Option<&[f64]>, risk: &[f64]) -> Result<Vec<f64>, Refused> {
    let one_risk = risk.first().filter(|q| mean_m.is_none() && risk.iter().all(|r| r == *q));
    if let Some(prepared) = one_risk.and_then(|q| CentredRadius::new(*q)) {
        return chunks(risk.len(), |first, out| centred_chunk::<D>(&prepared, covariance_m2, first, out));
    }
    each(risk.len(), |i| {
        let covariance = upper::<D>(covariance_m2, i, names::<D>()[0])?;
        radius_m(covariance, mean_of::<D>(mean_m, i), checked_risk(risk[i])?, names::<D>())
    })
}

/// Zero mean, one risk: eight covariances abreast. The last group is filled up with points, whose radius is zero.
fn centred_chunk<const D: usize>(prepared: &CentredRadius, covariance_m2: &[f64], first: usize, out: &mut [f64]) -> Result<(), Refused> {
    for (group, places) in out.chunks_mut(LANES).enumerate() {
        let mut lanes = [[0.0; LANES]; 6];
        for l in 0..places.len() {
            let index = first + group * LANES + l;
            let accepted = upper::<D>(covariance_m2, index, names::<D>()[0]).and_then(|u| accept(u, names::<D>()[0]));
            for (lane, value) in lanes.iter_mut().zip(accepted.map_err(|refusal| Refused { index, refusal })?) {
                lane[l] = value;
            }
        }
        let radii: [f64; LANES] = prepared.radii(&lanes);
        places.copy_from_slice(&radii[..places.len()]);
    }
    Ok(())
}

/// The law of the error's length at the given radii \[m\]: inside, outside, density \[1/m\].
///
/// # Errors
/// As [`radii_m`]; a radius that is negative or not finite.
pub fn laws<const D: usize>(covariance_m2: &[f64], mean_m: Option<&[f64]>, radius_m: &[f64]) -> Result<Vec<[f64; 3]>, Refused> {
    each(radius_m.len(), |i| {
        let covariance = upper::<D>(covariance_m2, i, names::<D>()[0])?;
        let law = radius_law(covariance, mean_of::<D>(mean_m, i), names::<D>())?;
        if !(radius_m[i] >= 0.0 && radius_m[i] < 1e140) {
            return Err(OutOfDomain { argument: "radius_m", value: radius_m[i], unit: "m", domain: "[0, 1e140)" });
        }
        let AtRadius { inside, outside, density } = law.at(radius_m[i]);
        Ok([inside, outside, density])
    })
}

/// The upper triangle of every matrix, checked for symmetry only; for functions that take one epoch at a time.
///
/// # Errors
/// [`OutOfDomain`] as [`radii_m`] for the matrix.
pub fn triangle<const D: usize>(covariance_m2: &[f64], index: usize) -> Result<[f64; 6], OutOfDomain> {
    upper::<D>(covariance_m2, index, names::<D>()[0])
}
