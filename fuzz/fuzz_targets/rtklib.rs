//! Solution files: no panic, and what was read can be written and read again.
#![no_main]

use libfuzzer_sys::fuzz_target;
use navbound_formats::rtklib::{read, write};
use navbound_fuzz::within_budget;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let Ok(s) = within_budget(bytes, |_| read(text)) else { return };
    if s.cov_m2.iter().flatten().all(|c| c.is_finite() && c.abs() < 1e12) {
        if let Ok(written) = write(&s, "navbound") {
            let again = read(&written).expect("our own file");
            assert_eq!((again.time, again.refused.len()), (s.time, 0));
        }
    }
});
