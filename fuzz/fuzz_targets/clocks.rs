//! RINEX clocks: no panic, and times in order.
#![no_main]

use libfuzzer_sys::fuzz_target;
use navbound_formats::rinex::read_clocks;
use navbound_fuzz::within_budget;

fuzz_target!(|bytes: &[u8]| {
    let Ok(p) = within_budget(bytes, read_clocks) else { return };
    for nodes in p.clocks.values() {
        assert!(nodes.windows(2).all(|w| w[0].time < w[1].time));
    }
    let _ = p.clock_step_s();
});
