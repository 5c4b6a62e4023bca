//! Accuracies of sentences: GST, GBS and `PUBX,00`.

use super::sentence::Sentence;
use super::{no_better, uncorrelated};

/// Of several accuracies of one epoch the worst.
pub(super) fn worst(accuracies: impl Iterator<Item = [f64; 6]>) -> Option<[f64; 6]> {
    accuracies.reduce(|one, other| no_better(one, Some(other)).0)
}

/// Largest ratio of the ellipse's axis to the deviations: a 95 % axis of two equal deviations is 1.73 of their root sum (standard), with a margin
/// for rounding (ours) \[1\].
const ELLIPSE: f64 = 3.0;

/// From GST: deviations along the axes, and the turn of the ellipse. Its axes are scaled to the deviations: the standard calls them standard
/// deviations, some makers write 95 % axes.
pub(super) fn covariance(gst: &Sentence<'_>) -> Option<[f64; 6]> {
    let [lat, lon, alt] = [gst.number(6)?, gst.number(7)?, gst.number(8)?];
    let [ee, _, nn, _, _, uu] = uncorrelated(lon, lat, alt);
    // An ellipse beyond any scale of the deviations is another statement, and the worse one.
    let scale = gst.number(3).filter(|major| *major > ELLIPSE * libm::sqrt(ee + nn));
    let [ee, nn, uu] = scale.map_or([ee, nn, uu], |major| [ee.max(major * major), nn.max(major * major), uu]);
    let en = gst.number(3).zip(gst.number(4)).zip(gst.number(5)).map_or(0.0, |((major, minor), orient)| {
        let (sum, turn) = (major * major + minor * minor, orient.to_radians());
        if sum > 0.0 { (ee + nn) * (major * major - minor * minor) / sum * libm::sin(turn) * libm::cos(turn) } else { 0.0 }
    });
    Some([ee, en, nn, 0.0, 0.0, uu])
}

/// From GBS: expected errors of latitude, longitude, altitude.
pub(super) fn expected_errors(gbs: &Sentence<'_>) -> Option<[f64; 6]> {
    Some(uncorrelated(gbs.number(3)?, gbs.number(2)?, gbs.number(4)?))
}

/// From Garmin's `PGRME`: errors of the plane and of the height, of which it states no share. Each counts as a standard deviation, that of the
/// plane along each axis: careful for every share from 39 % on. Provenance: ours.
pub(super) fn of_no_share(pgrme: &Sentence<'_>) -> Option<[f64; 6]> {
    let in_metres = |at: usize| pgrme.get(at + 1).is_none_or(|unit| matches!(unit, b"M" | b""));
    let size_m = |at: usize| pgrme.number(at).filter(|size| *size > 0.0 && in_metres(at));
    // The third is the error in space.
    let [h_m, in_space_m] = [size_m(1), size_m(5)];
    let h_m = h_m.or(in_space_m)?;
    Some(uncorrelated(h_m, h_m, size_m(3).or(in_space_m).unwrap_or(h_m)))
}

/// From `PUBX,00`: hAcc, the root of both horizontal variances together, and vAcc.
pub(super) fn circle(pubx: &Sentence<'_>) -> Option<[f64; 6]> {
    let (h_m, v_m) = (pubx.number(9)?, pubx.number(10)?);
    let axis_m = h_m * core::f64::consts::FRAC_1_SQRT_2;
    Some(uncorrelated(axis_m, axis_m, v_m))
}
