//! Where which RNP is in force, and which track should be on which path.

use crate::position::TrackId;
use crate::settings::Course;
use navbound_core::quantity::Metres;
use std::collections::BTreeMap;

/// An area in which an RNP is in force. Its sides are straight in latitude and longitude.
#[derive(Debug, Clone, PartialEq)]
pub struct Zone {
    /// RNP value \[m\].
    pub rnp: Metres,
    /// Corners: latitude and longitude \[rad\]. No side crosses the meridian of 180 degrees.
    pub corners_rad: Vec<(f64, f64)>,
}

impl Zone {
    /// Whether a position is inside: a line to the north crosses an odd number of sides.
    fn holds(&self, lat_rad: f64, lon_rad: f64) -> bool {
        let ends = self.corners_rad.iter().zip(self.corners_rad.iter().cycle().skip(1));
        let crossed = ends.filter(|((lat_a, lon_a), (lat_b, lon_b))| {
            let spans = (*lon_a <= lon_rad) != (*lon_b <= lon_rad);
            spans && lat_rad < lat_a + (lon_rad - lon_a) / (lon_b - lon_a) * (lat_b - lat_a)
        });
        crossed.count() % 2 == 1
    }
}

/// What is assigned to a track.
#[derive(Debug, Clone, Default)]
pub struct Assigned {
    /// Where it should be.
    pub path: Option<Course>,
    /// RNP value in force for it \[m\].
    pub rnp: Option<Metres>,
}

/// RNP by area and by track. Nothing of it: the settings' value holds everywhere.
#[derive(Debug, Clone, Default)]
pub struct Table {
    /// Areas.
    pub zones: Vec<Zone>,
    /// Tracks.
    pub tracks: BTreeMap<TrackId, Assigned>,
}

impl Table {
    /// The RNP in force for a track at a place: the track's own, else the smallest of the areas that hold it.
    pub(crate) fn rnp(&self, id: TrackId, place: Option<(f64, f64)>) -> Option<Metres> {
        let own = self.tracks.get(&id).and_then(|assigned| assigned.rnp);
        own.or_else(|| {
            let (lat_rad, lon_rad) = place?;
            let holding = self.zones.iter().filter(|zone| zone.holds(lat_rad, lon_rad));
            holding.map(|zone| zone.rnp).min_by(|a, b| a.m().total_cmp(&b.m()))
        })
    }

    /// The path of a track.
    pub(crate) fn path(&self, id: TrackId) -> Option<&Course> {
        self.tracks.get(&id)?.path.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(least: f64, most: f64, rnp_m: f64) -> Zone {
        Zone { rnp: Metres::new(rnp_m), corners_rad: vec![(least, least), (least, most), (most, most), (most, least)] }
    }

    #[test]
    fn the_smallest_rnp_of_the_areas_that_hold_a_place_is_in_force() {
        let id = TrackId::new("4ca123").unwrap();
        let mut table = Table { zones: vec![square(0.1, 0.5, 1852.0), square(0.2, 0.3, 555.6)], tracks: BTreeMap::new() };
        let at = |table: &Table, lat, lon| table.rnp(id, Some((lat, lon))).map(Metres::m);
        assert_eq!(at(&table, 0.25, 0.25), Some(555.6));
        assert_eq!((at(&table, 0.4, 0.25), at(&table, 0.25, 0.4)), (Some(1852.0), Some(1852.0)));
        assert_eq!((at(&table, 0.6, 0.25), at(&table, 0.25, 0.05), table.rnp(id, None)), (None, None, None));
        table.tracks.insert(id, Assigned { path: None, rnp: Some(Metres::new(926.0)) });
        assert_eq!((at(&table, 0.25, 0.25), table.rnp(id, None).map(Metres::m)), (Some(926.0), Some(926.0)));
    }

    #[test]
    fn a_corner_that_points_inwards_is_outside() {
        let notch = Zone { rnp: Metres::new(185.2), corners_rad: vec![(0.0, 0.0), (0.0, 0.4), (0.4, 0.4), (0.1, 0.2), (0.4, 0.0)] };
        assert!(notch.holds(0.05, 0.2) && notch.holds(0.3, 0.37) && !notch.holds(0.2, 0.2));
    }
}
