//! The infinite geodesic through two points.

use crate::earth::{MEAN_RADIUS_M, full_turn, inverse};
use crate::{Foot, Place};
use geographiclib_rs::{Geodesic, GeodesicLine, geodesic_capability as caps};
use navbound_core::frame::LatLon;
use navbound_core::quantity::{Metres, OutOfDomain, Radians};

/// The foot is found when a step along the line is shorter than this \[m\]: a tenth of what the angles resolve in two steps.
const SETTLED_M: f64 = 1e-7;
/// The furthest a foot may be; beyond a quarter of the Earth there are two of them \[m\].
const REACH_M: f64 = 5.0e6;
const CAPABILITIES: u64 = caps::LATITUDE | caps::LONGITUDE | caps::AZIMUTH | caps::DISTANCE_IN;

/// An infinite geodesic: a runway centreline, or one leg extended both ways.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    first: LatLon,
    length: Metres,
    geodesic: GeodesicLine,
}

impl Line {
    /// The line through two points, from the first towards the second.
    ///
    /// # Errors
    /// [`OutOfDomain`] for points less than 1 mm apart: they give no direction.
    pub fn through(first: LatLon, second: LatLon) -> Result<Self, OutOfDomain> {
        let between = inverse(&first, &second);
        if !(between.distance.m() >= 1e-3) {
            return Err(OutOfDomain {
                argument: "distance between points",
                value: between.distance.m(),
                unit: "m",
                domain: "[0.001, inf)",
            });
        }
        Ok(Self { length: between.distance, ..Self::from_azimuth(first, between.departure)? })
    }

    /// The line from a point in a direction; its length is infinite.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a course that is not finite.
    pub fn from_azimuth(first: LatLon, course: Radians) -> Result<Self, OutOfDomain> {
        if !course.rad().is_finite() {
            return Err(OutOfDomain { argument: "course_rad", value: course.rad(), unit: "rad", domain: "finite angles" });
        }
        let (lat, lon, azimuth) = (first.lat().rad().to_degrees(), first.lon().rad().to_degrees(), course.rad().to_degrees());
        let geodesic = GeodesicLine::new(&Geodesic::wgs84(), lat, lon, azimuth, Some(CAPABILITIES), None, None);
        Ok(Self { first, length: Metres::new(f64::INFINITY), geodesic })
    }

    /// Distance between the two points; infinite for a line given by a direction.
    pub fn length(&self) -> Metres {
        self.length
    }

    /// The line at a signed distance from its first point.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a distance that is not finite.
    pub fn at(&self, along: Metres) -> Result<Place, OutOfDomain> {
        if !along.m().is_finite() {
            return Err(OutOfDomain { argument: "along_m", value: along.m(), unit: "m", domain: "finite distances" });
        }
        let (_, lat, lon, azimuth, ..) = self.geodesic._gen_position(false, along.m(), CAPABILITIES);
        let point = LatLon::new(Radians::degrees(lat), Radians::degrees(lon))?;
        Ok(Place { point, course: full_turn(azimuth.to_radians()), curvature_per_m: 0.0, leg: 0 })
    }

    /// The foot of a position on the line.
    ///
    /// From a first guess the foot moves by the spherical triangle's near side, `R atan(tan(s/R) cos(angle))`, until the step vanishes.
    /// The ellipsoid changes each step by a few 1e-3 of (s/R)^2, so two or three suffice near the line and about six at 2000 km.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a position further than 5000 km from the first point or from the line.
    pub fn project(&self, position: &LatLon) -> Result<Foot, OutOfDomain> {
        self.project_near(position, self.first_guess(position)?)
    }

    /// The same, from a known neighbourhood of the foot.
    pub(crate) fn project_near(&self, position: &LatLon, guess: Metres) -> Result<Foot, OutOfDomain> {
        let mut along = guess.m();
        for _ in 0..20 {
            let place = self.at(Metres::new(along))?;
            let (ahead, right) = offset_from(&place, position)?;
            if ahead.abs() <= SETTLED_M {
                return Ok(Foot {
                    along: Metres::new(along + ahead),
                    cross: Metres::new(right),
                    course: place.course,
                    point: place.point,
                    leg: 0,
                });
            }
            along += ahead;
        }
        Err(too_far(along))
    }

    fn first_guess(&self, position: &LatLon) -> Result<Metres, OutOfDomain> {
        let start = self.at(Metres::new(0.0))?;
        Ok(Metres::new(offset_from(&start, position)?.0))
    }
}

/// How far the foot lies ahead of a place by the spherical right triangle, and the side of the position from that place.
fn offset_from(place: &Place, position: &LatLon) -> Result<(f64, f64), OutOfDomain> {
    let between = inverse(&place.point, position);
    let s = between.distance.m();
    if !(s <= REACH_M) {
        return Err(too_far(s));
    }
    let (sin, cos) = (between.departure.rad() - place.course.rad()).sin_cos();
    let arc = s / MEAN_RADIUS_M;
    Ok((MEAN_RADIUS_M * (arc.sin() * cos).atan2(arc.cos()), s * sin))
}

fn too_far(value: f64) -> OutOfDomain {
    OutOfDomain { argument: "distance from the path", value, unit: "m", domain: "[0, 5e6]" }
}
