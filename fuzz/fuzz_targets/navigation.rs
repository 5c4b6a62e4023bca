//! RINEX navigation: no panic, and every record that is kept describes an orbit.
#![no_main]

use libfuzzer_sys::fuzz_target;
use navbound_core::geometry::broadcast::state;
use navbound_formats::rinex::read_navigation;
use navbound_fuzz::within_budget;

fuzz_target!(|bytes: &[u8]| {
    let Ok(n) = within_budget(bytes, read_navigation) else { return };
    for e in &n.ephemerides {
        assert!(state(e, e.orbit_time).is_ok());
    }
});
