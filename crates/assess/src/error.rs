//! Navigation error of recorded positions against a truth.

use navbound_core::frame::LatLon;
use navbound_core::frame::{Displacement, Enu, Geodetic, radii};
use navbound_core::quantity::Metres;
use navbound_core::quantity::{OutOfDomain, Radians};
use std::f64::consts::{PI, TAU};

/// Navigation system error: true minus estimated position, east, north, up at the estimate.
///
/// ```text
/// e = (lon - lon_est) (R_N + h) cos lat_est      n = (lat - lat_est) (R_M + h)      u = h_true - h
/// ```
///
/// The radii are those of the estimate; the longitude difference is taken the short way round. Provenance: standard.
///
/// # Valid
/// For errors that are small against the Earth's radius: the second-order term is e^2 tan(lat) / 2R, 1 mm at 100 m and 50 degrees.
pub fn navigation_error(estimate: &Geodetic, truth: &Geodetic) -> Displacement<Enu> {
    let (est, tru) = (estimate.point, truth.point);
    let r = radii(est.lat());
    let h = estimate.height.m();
    let mut dlon = (tru.lon().rad() - est.lon().rad()).rem_euclid(TAU);
    if dlon > PI {
        dlon -= TAU;
    }
    let east = dlon * (r.prime_vertical.m() + h) * est.lat().rad().cos();
    let north = (tru.lat().rad() - est.lat().rad()) * (r.meridian.m() + h);
    Displacement::new(Metres::new(east), Metres::new(north), Metres::new(truth.height.m() - h))
}

/// The same for many epochs, `[lat_rad, lon_rad, h_m]` each; NaN where either position holds a NaN.
///
/// # Errors
/// [`OutOfDomain`] with the index of the first finite position that is no place on the Earth.
pub fn navigation_errors(estimates: &[[f64; 3]], truths: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, (usize, OutOfDomain)> {
    let pair = |(index, (e, t)): (usize, (&[f64; 3], &[f64; 3]))| {
        if e.iter().chain(t).any(|v| v.is_nan()) {
            return Ok([f64::NAN; 3]);
        }
        let both = geodetic(e).and_then(|e| Ok((e, geodetic(t)?)));
        both.map(|(e, t)| (*navigation_error(&e, &t).vector()).into()).map_err(|refusal| (index, refusal))
    };
    estimates.iter().zip(truths).enumerate().map(pair).collect()
}

fn geodetic([lat, lon, h]: &[f64; 3]) -> Result<Geodetic, OutOfDomain> {
    Ok(Geodetic { point: LatLon::new(Radians::new(*lat), Radians::new(*lon))?, height: Metres::new(*h) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use navbound_core::frame::ecef_from_geodetic;

    /// Against the Cartesian difference turned into local axes; 2nd-order terms of 20 m are 0.1 mm at 60 degrees.
    #[test]
    fn the_error_is_true_minus_estimated_in_local_metres() {
        for (lat, lon) in [(0.6, 2.3), (-1.0, -3.1), (0.0, 0.0)] {
            let est = [lat, lon, 90.0];
            let tru = [lat + 2e-6, lon - 3e-6, 95.0];
            let error = navigation_errors(&[est], &[tru]).unwrap()[0];
            let (e, t) = (geodetic(&est).unwrap(), geodetic(&tru).unwrap());
            let direct = ecef_from_geodetic(&t).minus(&ecef_from_geodetic(&e)).to_enu(&e.point);
            for i in 0..3 {
                assert!((error[i] - direct.vector()[i]).abs() < 2e-4, "{error:?} {:?}", direct.vector());
            }
        }
    }

    #[test]
    fn the_date_line_is_no_wall() {
        let error = navigation_errors(&[[0.0, PI - 1e-6, 0.0]], &[[0.0, -PI + 1e-6, 0.0]]).unwrap()[0];
        // 2e-6 rad on the equator of 6378137 m.
        assert!((error[0] - 12.756_274).abs() < 1e-6, "{error:?}");
    }

    #[test]
    fn an_unknown_truth_gives_an_unknown_error_and_a_wrong_one_is_refused() {
        assert!(navigation_errors(&[[0.0; 3]], &[[f64::NAN, 0.0, 0.0]]).unwrap()[0][1].is_nan());
        assert_eq!(navigation_errors(&[[0.0; 3], [2.0, 0.0, 0.0]], &[[0.0; 3]; 2]).unwrap_err().0, 1);
    }
}
