//! Solution files of our own: any numbers are refused or come back to the digits that are printed.
#![no_main]

use libfuzzer_sys::fuzz_target;
use navbound_core::quantity::GpsTime;
use navbound_formats::rtklib::{Solutions, read, write};

fuzz_target!(|rows: Vec<(i64, [f64; 3], [f64; 6], u8, u32)>| {
    let mut s = Solutions::default();
    for (time, [lat, lon, h], cov, quality, n_sv) in rows {
        s.time.push(GpsTime::from_nanoseconds(time));
        s.lat_rad.push(lat);
        s.lon_rad.push(lon);
        s.h_m.push(h);
        s.cov_m2.push(cov);
        s.quality.push(quality);
        s.n_sv.push(n_sv);
    }
    let Ok(text) = write(&s, "navbound") else { return };
    let again = read(&text).expect("our own file");
    assert!(again.refused.is_empty(), "{:?}", again.refused.first());
    assert_eq!((again.time, again.quality, again.n_sv), (s.time, s.quality, s.n_sv));
    for k in 0..s.lat_rad.len() {
        // Nine decimals of a degree, four of a metre: half a unit, and the rounding of a double.
        assert!((again.lat_rad[k] - s.lat_rad[k]).abs() <= 0.51e-9_f64.to_radians());
        let turns = (again.lon_rad[k] - s.lon_rad[k]) / core::f64::consts::TAU;
        assert!((turns - turns.round()).abs() * core::f64::consts::TAU <= 0.51e-9_f64.to_radians() + 2e-15);
        assert!((again.h_m[k] - s.h_m[k]).abs() <= 0.51e-4);
        for (a, b) in again.cov_m2[k].iter().zip(&s.cov_m2[k]) {
            let root = |c: f64| c.signum() * c.abs().sqrt();
            assert!((root(*a) - root(*b)).abs() <= 0.51e-4 + 4e-16 * root(*b).abs(), "{a} {b}");
        }
    }
});
