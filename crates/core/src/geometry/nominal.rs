//! Nominal constellations, as data.
//!
//! - GPS: the 24 nominal slots of the GPS Standard Positioning Service performance standard, and the 27 that come of splitting its three
//!   expandable ones (standard; the first in our specification too, the second confirmed by an independent table). The published epoch is
//!   1993-07-01; here the right ascensions count from Greenwich at the reference instant, so the sky of a date is typical of GPS and not
//!   that day's.
//! - Galileo: 24 satellites in medium orbits (Walker 24/3/1, 29599.8 km, 56 deg; standard: Galileo OS service definition; phases ours).
//! - BeiDou-3: 24 satellites in medium orbits (Walker 24/3/1, 27906.1 km, 55 deg), three in inclined geosynchronous orbits and three
//!   geostationary at 80, 110.5 and 140 deg E (standard: BDS open service documents; phases of the first two kinds ours).

use super::Elements;
use crate::quantity::{Metres, Radians};
use crate::signal::{Constellation, SatelliteId};

/// A place in a nominal constellation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slot {
    /// Who holds it.
    pub satellite: SatelliteId,
    /// Its orbit.
    pub elements: Elements,
}

/// GPS: 24 slots in six planes.
pub const GPS: [Slot; 24] = gps();
/// GPS: the 24 slots with B1, D2 and F2 each split into a fore and an aft one.
pub const GPS_EXPANDED: [Slot; 27] = gps_expanded();
/// Galileo: 24 satellites in three planes.
pub const GALILEO: [Slot; 24] = galileo();
/// BeiDou-3: 24 medium, 3 inclined geosynchronous, 3 geostationary.
pub const BEIDOU: [Slot; 30] = beidou();

/// Right ascension of planes A to F \[deg\].
const GPS_NODES: [f64; 6] = [272.847, 332.847, 32.847, 92.847, 152.847, 212.847];
/// Arguments of latitude, four a plane \[deg\].
const GPS_LATITUDES: [[f64; 4]; 6] = [
    [268.126, 161.786, 11.676, 41.806],
    [80.956, 173.336, 309.976, 204.376],
    [111.876, 11.796, 339.666, 241.556],
    [135.226, 265.446, 35.156, 167.356],
    [197.046, 302.596, 66.066, 333.686],
    [238.886, 345.226, 105.206, 135.346],
];
/// Index of an expandable slot, and the arguments of latitude of its fore and aft halves \[deg\]: B1, D2, F2.
const GPS_SPLIT: [(usize, [f64; 2]); 3] = [(4, [94.916, 66.356]), (13, [282.676, 257.976]), (21, [0.456, 334.016])];
const GPS_AXIS: Metres = Metres::new(26_559_800.0);
const GALILEO_AXIS: Metres = Metres::new(29_599_800.0);
const MEDIUM_AXIS: Metres = Metres::new(27_906_100.0);
/// Radius of an orbit of one sidereal day.
const SYNCHRONOUS_AXIS: Metres = Metres::new(42_164_200.0);
const INCLINATION: Radians = Radians::degrees(55.0);
const GALILEO_INCLINATION: Radians = Radians::degrees(56.0);
/// Longitude where the inclined satellites cross the equator northwards, standard: 118 deg E.
const INCLINED_CROSSING: f64 = 118.0;
const STATIONARY_LONGITUDES: [f64; 3] = [80.0, 110.5, 140.0];

const fn slot(constellation: Constellation, index: usize, axis: Metres, tilt: Radians, node_deg: f64, latitude_deg: f64) -> Slot {
    Slot {
        satellite: SatelliteId { constellation, number: index as u8 + 1 },
        elements: Elements::circular(axis, tilt, Radians::degrees(node_deg), Radians::degrees(latitude_deg)),
    }
}

const fn gps() -> [Slot; 24] {
    let mut slots = [slot(Constellation::Gps, 0, GPS_AXIS, INCLINATION, 0.0, 0.0); 24];
    let mut i = 0;
    while i < 24 {
        slots[i] = slot(Constellation::Gps, i, GPS_AXIS, INCLINATION, GPS_NODES[i / 4], GPS_LATITUDES[i / 4][i % 4]);
        i += 1;
    }
    slots
}

const fn gps_expanded() -> [Slot; 27] {
    let mut slots = [slot(Constellation::Gps, 0, GPS_AXIS, INCLINATION, 0.0, 0.0); 27];
    let (mut i, mut filled, mut split) = (0, 0, 0);
    while i < 24 {
        let node = GPS_NODES[i / 4];
        if split < GPS_SPLIT.len() && GPS_SPLIT[split].0 == i {
            let [fore, aft] = GPS_SPLIT[split].1;
            slots[filled] = slot(Constellation::Gps, filled, GPS_AXIS, INCLINATION, node, fore);
            slots[filled + 1] = slot(Constellation::Gps, filled + 1, GPS_AXIS, INCLINATION, node, aft);
            (filled, split) = (filled + 2, split + 1);
        } else {
            slots[filled] = slot(Constellation::Gps, filled, GPS_AXIS, INCLINATION, node, GPS_LATITUDES[i / 4][i % 4]);
            filled += 1;
        }
        i += 1;
    }
    slots
}

/// Node and argument of latitude of a place in a Walker 24/3/1 \[deg\]: planes 120 deg apart, eight satellites 45 deg apart in each,
/// neighbours' phases 360/24 deg apart.
const fn walker(i: usize) -> (f64, f64) {
    let (plane, place) = ((i / 8) as f64, (i % 8) as f64);
    (120.0 * plane, 45.0 * place + 15.0 * plane)
}

const fn galileo() -> [Slot; 24] {
    let mut slots = [slot(Constellation::Galileo, 0, GALILEO_AXIS, GALILEO_INCLINATION, 0.0, 0.0); 24];
    let mut i = 0;
    while i < 24 {
        let (node, latitude) = walker(i);
        slots[i] = slot(Constellation::Galileo, i, GALILEO_AXIS, GALILEO_INCLINATION, node, latitude);
        i += 1;
    }
    slots
}

const fn beidou() -> [Slot; 30] {
    let mut slots = [slot(Constellation::BeiDou, 0, MEDIUM_AXIS, INCLINATION, 0.0, 0.0); 30];
    let mut i = 0;
    while i < 24 {
        let (node, latitude) = walker(i);
        slots[i] = slot(Constellation::BeiDou, i, MEDIUM_AXIS, INCLINATION, node, latitude);
        i += 1;
    }
    while i < 27 {
        // Node and phase 120 deg apart the opposite way: all three draw the same figure of eight over the crossing.
        let third = 120.0 * (i - 24) as f64;
        slots[i] = slot(Constellation::BeiDou, i, SYNCHRONOUS_AXIS, INCLINATION, INCLINED_CROSSING + third, 360.0 - third);
        i += 1;
    }
    while i < 30 {
        slots[i] = slot(Constellation::BeiDou, i, SYNCHRONOUS_AXIS, Radians::new(0.0), STATIONARY_LONGITUDES[i - 27], 0.0);
        i += 1;
    }
    slots
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::geodetic_from_ecef;
    use crate::geometry::Orbit;

    fn longitude_deg(slot: &Slot, seconds: f64) -> f64 {
        let position = Orbit::new(slot.elements).unwrap().position(seconds);
        geodetic_from_ecef(&position).unwrap().point.lon().rad().to_degrees()
    }

    #[test]
    fn inclined_satellites_cross_the_equator_at_the_same_longitude() {
        for slot in &BEIDOU[24..27] {
            // From the phase at the reference instant to the ascending node, at a sidereal day a turn.
            let to_node = (360.0 - slot.elements.mean_anomaly.rad().to_degrees()).rem_euclid(360.0) / 360.0 * 86_164.1;
            assert!((longitude_deg(slot, to_node) - INCLINED_CROSSING).abs() < 0.1);
        }
    }

    #[test]
    fn stationary_satellites_stay_over_their_longitude() {
        for (slot, longitude) in BEIDOU[27..].iter().zip(STATIONARY_LONGITUDES) {
            for hour in 0..24 {
                assert!((longitude_deg(slot, 3600.0 * f64::from(hour)) - longitude).abs() < 0.1);
            }
        }
    }

    /// Galileo's published ground track repeats after 10 sidereal days and 17 turns, oblateness included; without it the turn of the
    /// nominal axis is some seconds shorter (J2 turns node and perigee by some 1e-4 of the motion).
    #[test]
    fn galileo_turns_seventeen_times_in_ten_days() {
        let orbit = Orbit::new(GALILEO[0].elements).unwrap();
        let turn = 10.0 * 86_164.09 / 17.0;
        // A satellite at its node is near it again; north of the equator a little later, south of it a little earlier.
        let over_equator = |t: f64| orbit.position(t).vector().z;
        assert!(over_equator(turn - 10.0) < 0.0 && over_equator(turn + 10.0) > 0.0);
    }

    /// Each half of a split slot stays in its plane, within 15 degrees of the whole one and on either side of it.
    #[test]
    fn expanded_slots_stand_before_and_behind_those_they_replace() {
        let place = |s: &Slot| (s.elements.node.rad().to_degrees(), s.elements.mean_anomaly.rad().to_degrees());
        let turned = |x: f64| (x + 180.0).rem_euclid(360.0) - 180.0;
        let kept = GPS.iter().filter(|a| GPS_EXPANDED.iter().any(|b| place(a) == place(b))).count();
        assert_eq!(kept, 21);
        let mut replaced = 0;
        for (i, slot) in GPS.iter().enumerate().filter(|(_, a)| GPS_EXPANDED.iter().all(|b| place(a) != place(b))) {
            let (node, latitude) = place(slot);
            let near = GPS_EXPANDED.iter().map(place).filter(|p| p.0 == node).map(|p| turned(p.1 - latitude)).filter(|d| d.abs() < 18.0);
            let [fore, aft] = near.collect::<Vec<_>>().try_into().unwrap();
            assert!(fore > 5.0 && aft < -5.0 && fore - aft > 24.0 && fore - aft < 29.0, "slot {i}: {fore} {aft}");
            replaced += 1;
        }
        assert_eq!(replaced, 3);
    }

    #[test]
    fn numbers_are_unique_in_each_constellation() {
        for slots in [&GPS[..], &GPS_EXPANDED[..], &GALILEO[..], &BEIDOU[..]] {
            for (i, slot) in slots.iter().enumerate() {
                assert_eq!(usize::from(slot.satellite.number), i + 1);
            }
        }
    }
}
