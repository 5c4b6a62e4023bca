//! RINEX observations, plain and compact: no panic, and the table is whole.
#![no_main]

use libfuzzer_sys::fuzz_target;
use navbound_formats::rinex::read_observations;
use navbound_fuzz::within_budget;

fuzz_target!(|bytes: &[u8]| {
    let Ok(o) = within_budget(bytes, read_observations) else { return };
    for epoch in 0..o.n_epochs() {
        for satellite in o.satellites(epoch) {
            assert_eq!(o.values(satellite).len(), o.codes[o.satellite[satellite].constellation.index()].len());
        }
    }
});
