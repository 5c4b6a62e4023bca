//! Position, velocity and clock of a satellite from tabulated orbits and clocks.
//!
//! Source: polynomial interpolation of equally spaced positions as the IGS recommends for its products (Neville's scheme, order 10),
//! clocks linear between their records, periodic relativity by IS-GPS-200 20.3.3.3.3.1 (-2 r.v / c²); provenance: standard.

use super::broadcast::{EARTH_RATE, SatelliteState};
use crate::frame::EcefPosition;
use crate::quantity::{GpsTime, Unavailable};
use crate::signal::SPEED_OF_LIGHT_MPS;
use crate::special::float::sin_cos;
use nalgebra::Vector3;

/// Nodes of the interpolating polynomial: order 10. At 15 min the error inside a day is below a centimetre, at its ends a few.
pub const NODES: usize = 11;

/// A tabulated position of a satellite's mass centre, Earth-fixed axes of that instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrbitNode {
    /// When.
    pub time: GpsTime,
    /// Where.
    pub position: EcefPosition,
}

/// A tabulated satellite clock, without the periodic relativity of an eccentric orbit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockNode {
    /// When.
    pub time: GpsTime,
    /// Satellite clock minus system time \[s\].
    pub bias_s: f64,
}

/// State at a GPS time: position by a polynomial through the eleven nearest nodes, clock by a line between the two around it.
///
/// Both tables are sorted by time. The velocity is the polynomial's derivative; the polynomial is laid in axes that do not turn.
///
/// # Errors
/// [`Unavailable::Invalid`]: the time lies outside the orbit's nodes, these have a hole, or no two clock records at most
/// `longest_clock_gap_s` apart are around it. Nothing is extrapolated.
pub fn state(orbit: &[OrbitNode], clock: &[ClockNode], longest_clock_gap_s: f64, time: GpsTime) -> Result<SatelliteState, Unavailable> {
    let (position, inertial) = position(nodes(orbit, time)?, time);
    let (bias, drift) = clock_at(clock, longest_clock_gap_s, time)?;
    let c2 = SPEED_OF_LIGHT_MPS * SPEED_OF_LIGHT_MPS;
    Ok(SatelliteState {
        position: EcefPosition::from_vector(position),
        velocity_mps: inertial - EARTH_RATE * Vector3::new(-position.y, position.x, 0.0),
        clock_s: bias - 2.0 * position.dot(&inertial) / c2,
        clock_drift: drift,
    })
}

/// The eleven nodes nearest to a time that lies between the first and the last.
fn nodes(orbit: &[OrbitNode], time: GpsTime) -> Result<&[OrbitNode], Unavailable> {
    let beyond = |seconds: f64| Unavailable::Invalid {
        field: "time",
        value: seconds,
        unit: "s",
        domain: "[0, s) from the first orbit node to the last",
    };
    let (Some(first), Some(last)) = (orbit.first(), orbit.last()) else { return Err(beyond(f64::NAN)) };
    if !(first.time <= time && time <= last.time) || orbit.len() < NODES {
        return Err(beyond(time.seconds_since(first.time)));
    }
    let after = orbit.partition_point(|n| n.time <= time);
    let from = after.saturating_sub(NODES / 2 + usize::from(nearer_before(orbit, after, time))).min(orbit.len() - NODES);
    let nearest = &orbit[from..from + NODES];
    let gaps = nearest.windows(2).map(|w| w[1].time.seconds_since(w[0].time));
    let (least, most) = gaps.fold((f64::INFINITY, 0.0_f64), |(least, most), gap| (least.min(gap), most.max(gap)));
    if !(least > 0.0 && most < 1.5 * least) {
        return Err(Unavailable::Invalid { field: "orbit gap", value: most, unit: "s", domain: "one step of the table" });
    }
    Ok(nearest)
}

/// Whether the node before a time is nearer than the one after it: an odd number of nodes is centred on the nearer.
fn nearer_before(orbit: &[OrbitNode], after: usize, time: GpsTime) -> bool {
    match (after.checked_sub(1).and_then(|k| orbit.get(k)), orbit.get(after)) {
        (Some(before), Some(later)) => time.seconds_since(before.time) <= later.time.seconds_since(time),
        _ => true,
    }
}

/// Position and velocity at `time` in axes that stand still and agree with the Earth-fixed ones at that instant.
///
/// ```text
/// P[i..j](0) = (x_j P[i..j-1] - x_i P[i+1..j]) / (x_j - x_i)       Neville, x counted from the time requested
/// ```
fn position(nodes: &[OrbitNode], time: GpsTime) -> (Vector3<f64>, Vector3<f64>) {
    let (mut x, mut p, mut v) = ([0.0; NODES], [Vector3::zeros(); NODES], [Vector3::zeros(); NODES]);
    for (k, node) in nodes.iter().enumerate().take(NODES) {
        x[k] = node.time.seconds_since(time);
        let (s, c) = sin_cos(EARTH_RATE * x[k]);
        let q = node.position.vector();
        p[k] = Vector3::new(c * q.x - s * q.y, s * q.x + c * q.y, q.z);
    }
    for order in 1..NODES {
        for i in 0..NODES - order {
            let (a, b) = (x[i], x[i + order]);
            v[i] = (p[i + 1] - p[i] + v[i] * b - v[i + 1] * a) / (b - a);
            p[i] = (p[i] * b - p[i + 1] * a) / (b - a);
        }
    }
    (p[0], v[0])
}

/// Clock and its rate between two records.
fn clock_at(clock: &[ClockNode], longest_gap_s: f64, time: GpsTime) -> Result<(f64, f64), Unavailable> {
    let after = clock.partition_point(|n| n.time <= time);
    let gap_of = |a: &ClockNode, b: &ClockNode| b.time.seconds_since(a.time);
    let pair = after.checked_sub(1).and_then(|k| clock.get(k)).zip(clock.get(after));
    match (pair, after.checked_sub(1).and_then(|k| clock.get(k))) {
        (Some((a, b)), _) if gap_of(a, b) <= longest_gap_s => {
            let drift = (b.bias_s - a.bias_s) / gap_of(a, b);
            Ok((a.bias_s + drift * time.seconds_since(a.time), drift))
        }
        // The very last record needs no neighbour; its rate is that before it.
        (None, Some(last)) if last.time == time && after >= 2 && gap_of(&clock[after - 2], last) <= longest_gap_s => {
            Ok((last.bias_s, (last.bias_s - clock[after - 2].bias_s) / gap_of(&clock[after - 2], last)))
        }
        (pair, _) => {
            let value = pair.map_or(f64::NAN, |(a, b)| gap_of(a, b));
            Err(Unavailable::Invalid { field: "clock gap", value, unit: "s", domain: "one step of the clock table" })
        }
    }
}

#[cfg(test)]
#[path = "precise_tests.rs"]
mod tests;
