//! Almanacs: no panic, and every satellite that is kept has an orbit.
#![no_main]

use libfuzzer_sys::fuzz_target;
use navbound_core::geometry::Orbit;
use navbound_core::quantity::GpsTime;
use navbound_formats::almanac::{read, reference};
use navbound_fuzz::within_budget;

fuzz_target!(|bytes: &[u8]| {
    let Ok(entries) = within_budget(bytes, read) else { return };
    for e in entries {
        assert!(Orbit::new(e.elements).is_ok());
        assert!(reference(e.week, e.time_of_week_s, Some(GpsTime::default())).is_some());
    }
});
