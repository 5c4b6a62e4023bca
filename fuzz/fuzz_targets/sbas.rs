//! Recorded augmentation messages: no panic.
#![no_main]

use libfuzzer_sys::fuzz_target;
use navbound_formats::sbas::{Tag, read};

fuzz_target!(|bytes: &[u8]| {
    let _ = read(bytes, None);
    let _ = read(bytes, Some(Tag::End));
});
