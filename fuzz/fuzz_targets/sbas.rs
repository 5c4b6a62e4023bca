//! Recorded augmentation messages: no panic.
#![no_main]

use libfuzzer_sys::fuzz_target;
use navbound_formats::sbas::{Tag, read};
use navbound_fuzz::within_budget;

fuzz_target!(|bytes: &[u8]| {
    let _ = within_budget(bytes, |bytes| read(bytes, None));
    let _ = read(bytes, Some(Tag::End));
});
