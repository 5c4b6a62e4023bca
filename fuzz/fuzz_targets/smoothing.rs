//! Carrier smoothing: any codes, phases and times give a code that is as measured or within the slip limit of it.
#![no_main]

use libfuzzer_sys::fuzz_target;
use navbound_core::quantity::{GpsTime, Metres};
use navbound_core::signal::Carrier;
use navbound_core::signal::smoothing::{Channel, PhasePair, Smoothing, divergence_free};

fuzz_target!(|input: (f64, Vec<(i64, f64, f64, f64, bool)>)| {
    let how = Smoothing::over(input.0);
    let (mut channel, mut pair) = (Channel::default(), PhasePair::default());
    for (time, code, first, second, lost) in input.1 {
        let time = GpsTime::from_nanoseconds(time);
        let slipped = pair.slipped(time, Metres::new(first - second));
        let phase = divergence_free((Carrier::L1, Metres::new(first)), (Carrier::L2, Metres::new(second)));
        let smoothed = channel.smoothed(&how, time, Metres::new(code), phase, lost || slipped).m();
        if code.is_finite() {
            assert!((smoothed - code).abs() <= how.slip.m() * (1.0 + 1e-9), "{smoothed} {code}");
        } else {
            assert!(!smoothed.is_finite());
        }
    }
});
