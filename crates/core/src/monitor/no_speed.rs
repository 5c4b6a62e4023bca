//! Numbers of a speed over the ground that are no speed: what a program writes where it knows none, and what nothing flies at.

/// Fastest speed over the ground that the motion of positions may have \[m/s\]. Provenance: ours.
pub const FASTEST_MPS: f64 = 400.0;
/// Nothing that flies on wings is faster over the ground \[m/s\]. Provenance: ours.
pub const IMPOSSIBLE_MPS: f64 = 1000.0;
/// Numbers, in the unit in which they are written, by which programs write "not known" (all nines, all bits of a field, those of two bytes in
/// hundredths), where they are faster than [`FASTEST_MPS`]. The larger ones are impossible by themselves. Provenance: ours.
const STAND_INS: [f64; 5] = [999.0, 999.9, 1022.0, 1023.0, 655.35];
/// The same in every unit: no length of a velocity is below zero. Provenance: ours.
pub const BELOW_ANY: f64 = -1.0;
/// Share of such a number by which another one may be it, written with other digits.
const SAME: f64 = 1e-6;

/// Whether a number is no speed; `unit_mps` is the unit in which it is written \[m/s\].
#[must_use]
pub fn is_no_speed(written: f64, unit_mps: f64) -> bool {
    let speed_mps = written * unit_mps;
    let of_program = || STAND_INS.iter().any(|each| (written - each).abs() < SAME * each);
    speed_mps > IMPOSSIBLE_MPS || (speed_mps > FASTEST_MPS && of_program()) || written == BELOW_ANY
}

/// A speed over the ground that a live source states; none where its number is no speed, or below zero \[m/s\].
#[must_use]
pub fn stated_mps(written: f64, unit_mps: f64) -> Option<f64> {
    (written >= 0.0 && !is_no_speed(written, unit_mps)).then_some(written * unit_mps)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::KNOT_MPS;

    #[test]
    fn what_programs_write_is_no_speed_and_what_flies_is_one() {
        for written in [-1.0, 655.35, 999.0, 999.9, 1022.0, 1023.0, 1000.1, 65535.0, f64::INFINITY] {
            assert!(is_no_speed(written, 1.0), "{written}");
        }
        for written in [0.0, -0.5, -2.0, 399.0, 655.0, 700.0, 998.0, 1000.0, f64::NAN] {
            assert!(!is_no_speed(written, 1.0), "{written}");
        }
        assert!(is_no_speed(1023.0, KNOT_MPS) && !is_no_speed(655.35, KNOT_MPS) && is_no_speed(-1.0, KNOT_MPS));
    }
}
