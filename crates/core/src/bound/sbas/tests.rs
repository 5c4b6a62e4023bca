use super::*;
use crate::frame::LatLon;
use crate::geometry::Direction;
use crate::geometry::atmosphere::klobuchar;
use crate::quantity::GpsTime;
use crate::signal::Klobuchar;

/// Towards every azimuth the delay times the obliquity is the broadcast model's along that direction, and overhead too.
#[test]
fn without_a_grid_the_slant_delay_is_that_of_the_broadcast_model() {
    let model = Klobuchar { alpha: [2.1e-8, 7.5e-9, -6e-8, 6e-8], beta: [1.2e5, -3.3e4, -2.6e5, 4.6e5] };
    let place = Geodetic { point: LatLon::new(Radians::new(0.8), Radians::new(0.3)).unwrap(), height: Metres::new(100.0) };
    let user = User::new(&place, Radians::new(0.05), Airborne::ACCURACY_A).unwrap();
    let mut service = Service::new(Use::EnRoute, Some(model));
    service.now = GpsTime::default().plus_seconds(50_000.0);
    for (azimuth_rad, elevation_rad) in [(0.3, 0.2), (2.0, 0.2), (4.0, 0.6), (5.5, 1.2), (1.0, 1.56)] {
        let (level, up) = (f64::cos(elevation_rad), f64::sin(elevation_rad));
        let unit = Vector3::new(level * f64::sin(azimuth_rad), level * f64::cos(azimuth_rad), up);
        let vertical = broadcast_vertical(&service, &user, &unit, elevation_rad).unwrap();
        let direction = Direction::new(Radians::new(azimuth_rad), Radians::new(elevation_rad)).unwrap();
        let slant_m = klobuchar(&model, &place, &direction, service.now).m();
        // The thin shell of 350 km, of an Earth of 6378.1363 km (DO-229 A.4.4.10.4).
        let ratio = 6378.1363 / (6378.1363 + 350.0) * level;
        let obliquity = 1.0 / (1.0 - ratio * ratio).sqrt();
        let expected_m = slant_m / obliquity;
        assert!((vertical.delay_m - expected_m).abs() < 1e-9 * expected_m, "{azimuth_rad} {elevation_rad}: {vertical:?} {expected_m}");
    }
    assert!(broadcast_vertical(&service, &user, &Vector3::z(), core::f64::consts::FRAC_PI_2).unwrap().delay_m > 0.0);
    service.used_for = Use::PrecisionApproach;
    assert!(broadcast_vertical(&service, &user, &Vector3::z(), core::f64::consts::FRAC_PI_2).is_none());
}
