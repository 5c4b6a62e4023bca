use super::*;
use crate::special::float::{cos, sin};

/// Azimuth and elevation of a usual sky \[deg\].
const SKY: [(f64, f64); 9] =
    [(20.0, 65.0), (75.0, 22.0), (110.0, 48.0), (160.0, 12.0), (205.0, 71.0), (250.0, 33.0), (290.0, 15.0), (330.0, 40.0), (355.0, 8.0)];
const STEP_S: f64 = 30.0;
const CODE_SIGMA_M: f64 = 2.0;

fn phase(k: usize, less_phase_m: f64, track: u32, lost: bool) -> Heard {
    Heard { satellite: gps(k), less_phase_m, diverges: true, track, lost }
}

fn at(seconds: f64) -> GpsTime {
    GpsTime::default().plus_seconds(seconds)
}

fn gps(k: usize) -> SatelliteId {
    SatelliteId { constellation: Constellation::Gps, number: k as u8 + 1 }
}

/// Satellites go on by 30 degrees of azimuth an hour.
fn unit(k: usize, seconds: f64) -> Vector3<f64> {
    let (azimuth, elevation) = ((SKY[k].0 + seconds / 120.0).to_radians(), SKY[k].1.to_radians());
    Vector3::new(cos(elevation) * sin(azimuth), cos(elevation) * cos(azimuth), sin(elevation))
}

/// Noise of the code, the same in every run: a sum of four even draws, of the stated deviation.
fn noise(state: &mut u64) -> f64 {
    let mut even = || {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 40) as f64 / f64::from(1 << 24) - 0.5
    };
    (even() + even() + even() + even()) * 3.0_f64.sqrt() * CODE_SIGMA_M
}

/// What a satellite's code has beside its phase at a time, and whether a loss of lock is flagged; `None` where it is not heard.
type Beside<'a> = &'a dyn Fn(usize, f64) -> Option<(f64, bool)>;

/// What is reported of two hours at an epoch every 30 s with the first `n` satellites, beginning at `from`.
fn reported(n: usize, beside: Beside<'_>) -> Vec<Option<Vector3<f64>>> {
    reported_by(n, beside, true)
}

/// The same by a receiver of one phase, or of two.
fn reported_by(n: usize, beside: Beside<'_>, diverges: bool) -> Vec<Option<Vector3<f64>>> {
    let (mut codes, mut state) = (CodesAgainstPhases::new(STEP_S), 7);
    let epoch = |e: usize| {
        let t = e as f64 * STEP_S;
        let heard: Vec<usize> = (0..n).filter(|k| beside(*k, t).is_some()).collect();
        for k in &heard {
            let (beside, lost) = beside(*k, t).unwrap();
            // Any ambiguity.
            let phase = phase(*k, 1e6 * *k as f64 + beside + noise(&mut state), 1, lost);
            codes.hear(at(t), &Heard { diverges, ..phase });
        }
        let compared = |k: usize| Compared { satellite: gps(k), unit: unit(k, t), weight: 1.0 / (CODE_SIGMA_M * CODE_SIGMA_M) };
        codes.judge(at(t), heard.into_iter().map(compared))
    };
    (0..240).map(epoch).collect()
}

/// Codes that lead the position by `way` times what a time says.
fn led(way: Vector3<f64>, much: impl Fn(f64) -> f64) -> impl Fn(usize, f64) -> Option<(f64, bool)> {
    move |k, t| Some((-unit(k, t).dot(&way) * much(t), false))
}

fn first(reported: &[Option<Vector3<f64>>]) -> Option<f64> {
    Some(reported.iter().position(Option::is_some)? as f64 * STEP_S)
}

const EAST: Vector3<f64> = Vector3::new(1.0, 0.0, 0.0);

#[test]
fn codes_that_nothing_leads_off_are_not_doubted() {
    assert_eq!(first(&reported(9, &|_, _| Some((0.0, false)))), None);
    assert_eq!(first(&reported(6, &|_, _| Some((0.0, false)))), None);
}

#[test]
fn a_step_is_named_at_once_to_its_end_across_renewals() {
    let step = led(EAST, |t| if (1800.0..5400.0).contains(&t) { 100.0 } else { 0.0 });
    let reported = reported(9, &step);
    for (e, shift) in reported.iter().enumerate() {
        let there = (60..180).contains(&e);
        assert_eq!(shift.is_some(), there, "{e} {shift:?}");
        // Six renewals each keep the noise of one epoch: sqrt(7) of two codes, and five deviations.
        assert!(shift.is_none_or(|s| (s - 100.0 * EAST).norm() < 5.0 * 7.0_f64.sqrt() * 4.0), "{e} {shift:?}");
    }
}

#[test]
fn a_ramp_is_named_and_followed() {
    let ramp = led(EAST, |t| 0.3 * (t - 1800.0).max(0.0));
    let reported = reported(9, &ramp);
    let from = first(&reported).unwrap();
    // 600 s of it are 180 m; 40 m are beyond each limit of this sky.
    assert!((1830.0..=1800.0 + 40.0 / 0.3).contains(&from), "{from}");
    let last = reported[239].unwrap();
    assert!(reported[from as usize / 30..].iter().all(Option::is_some) && (last.x - 0.3 * 5370.0).abs() < 60.0, "{last:?}");
}

#[test]
fn a_ramp_below_the_limit_over_the_age_of_a_reference_is_not_seen() {
    let slow = LEAST_M / RENEWED_S;
    assert_eq!(first(&reported(9, &led(EAST, |t| 0.5 * slow * t))), None);
    assert!(first(&reported(9, &led(EAST, |t| 3.0 * slow * t))).is_some());
}

#[test]
fn milliseconds_of_the_receivers_clock_are_no_shift() {
    let jumps = |_: usize, t: f64| Some((299_792.458 * (t / 700.0).floor(), false));
    assert_eq!(first(&reported(9, &jumps)), None);
    // Nor do they hide one.
    let step = led(EAST, |t| if t >= 1800.0 { 100.0 } else { 0.0 });
    let both = |k: usize, t: f64| Some((step(k, t)?.0 + jumps(k, t)?.0, false));
    assert_eq!(first(&reported(9, &both)), Some(1800.0));
}

#[test]
fn slips_of_two_satellites_are_left_out_and_those_of_more_state_nothing() {
    for slipped in 1..=5 {
        let slips = move |k: usize, t: f64| Some((if k < slipped && t >= 1800.0 { 60.0 + 37.0 * (k * k) as f64 } else { 0.0 }, false));
        assert_eq!(first(&reported(9, &slips)), None, "{slipped}");
    }
    let step = led(EAST, |t| if t >= 1800.0 { 100.0 } else { 0.0 });
    let both = |k: usize, t: f64| Some((step(k, t)?.0 + if k < 2 && t >= 1800.0 { 60.0 + 97.0 * k as f64 } else { 0.0 }, false));
    assert_eq!(first(&reported_by(9, &both, false)), Some(1800.0));
}

#[test]
fn the_divergence_of_a_storm_is_no_shift() {
    // Twice 10 TECU of zenith within ten minutes, each way in turn, mapped to elevations (0.16 m a TECU on L1).
    let storm = |k: usize, t: f64| {
        let zenith = 2.0 * 0.16 * 10.0 * (t / 600.0 * core::f64::consts::PI / 2.0).sin();
        Some((zenith / (0.1 + 0.9 * sin(SKY[k].1.to_radians())).max(0.35), false))
    };
    assert_eq!(first(&reported(9, &storm)), None);
}

#[test]
fn with_five_satellites_nothing_is_named_and_what_stands_stays() {
    assert_eq!(first(&reported(5, &led(EAST, |t| if t >= 1800.0 { 100.0 } else { 0.0 }))), None);
    let step = led(EAST, |t| if t >= 1800.0 { 100.0 } else { 0.0 });
    let fewer = |k: usize, t: f64| (k < 5 || t < 3600.0).then(|| step(k, t)).flatten();
    assert!(reported(9, &fewer)[60..].iter().all(Option::is_some));
}

#[test]
fn it_begins_anew_where_fewer_than_five_phases_are_unbroken() {
    let step = led(EAST, |t| if t >= 1800.0 { 100.0 } else { 0.0 });
    let lost = |k: usize, t: f64| Some((step(k, t)?.0, t == 3600.0 && k >= 4));
    let reported = reported(9, &lost);
    // Until codes are compared again the lead stands.
    assert!(reported[60..=120].iter().all(Option::is_some) && reported[121..].iter().all(Option::is_none));
}

#[test]
fn a_gap_another_measurement_and_no_phase_break_an_arc() {
    let led_off = |epochs: &[(f64, f64, u32)]| -> Vec<bool> {
        let mut codes = CodesAgainstPhases::new(1.0);
        let epoch = |(t, less, track): &(f64, f64, u32)| {
            (0..9).for_each(|k| codes.hear(at(*t), &phase(k, less * unit(k, *t).x, *track, false)));
            codes.judge(at(*t), (0..9).map(|k| Compared { satellite: gps(k), unit: unit(k, *t), weight: 1.0 })).is_some()
        };
        epochs.iter().map(epoch).collect()
    };
    assert_eq!(led_off(&[(0.0, 0.0, 1), (60.0, -100.0, 1)]), [false, true]);
    assert_eq!(led_off(&[(60.0, -100.0, 1), (121.0, 0.0, 1), (122.0, 100.0, 1)]), [false, false, true]);
    assert_eq!(led_off(&[(122.0, 100.0, 1), (123.0, 100.0, 2), (124.0, 0.0, 2)]), [false, false, true]);
    assert_eq!(led_off(&[(124.0, 0.0, 2), (125.0, f64::NAN, 2), (126.0, 200.0, 2), (127.0, 0.0, 2)]), [false, false, false, true]);
    // Time that runs backwards.
    assert_eq!(led_off(&[(127.0, 0.0, 2), (100.0, 100.0, 2)]), [false, false]);
}

/// A standing lead whose satellites lose their phase one after another, each within ten minutes.
#[test]
fn a_lead_stands_while_phases_are_lost_in_turn() {
    let step = led(EAST, |t| if (1800.0..5400.0).contains(&t) { 100.0 } else { 0.0 });
    let in_turn = |k: usize, t: f64| Some((step(k, t)?.0, (t / STEP_S) as usize % 9 == k));
    for (e, shift) in reported(9, &in_turn).iter().enumerate() {
        assert_eq!(shift.is_some(), (60..180).contains(&e), "{e} {shift:?}");
    }
}

#[test]
fn phases_that_are_lost_in_turn_lead_nothing_off() {
    for each in [1, 2, 3] {
        let in_turn = |k: usize, t: f64| Some((0.0, (t / STEP_S) as usize * each % 9 / each == k / each));
        assert_eq!(first(&reported(9, &in_turn)), None, "{each}");
    }
}

/// Fourteen satellites, four of which slip without a flag before they are led off.
#[test]
fn of_many_satellites_several_that_slip_are_left_out() {
    let sky = |k: usize, t: f64| -> Vector3<f64> {
        let mut turned = unit(k % 9, t + 5400.0 * f64::from(u8::from(k >= 9)));
        turned.z = turned.z.max(0.1);
        turned.normalize()
    };
    let (mut codes, mut state) = (CodesAgainstPhases::new(STEP_S), 7);
    let named: Vec<bool> = (0..20)
        .map(|e| {
            let t = f64::from(e) * STEP_S;
            for k in 0..14 {
                let slip = if k < 4 && e >= 8 { 40.0 + 31.0 * (k * k) as f64 } else { 0.0 };
                let beside = if e >= 10 { -60.0 * sky(k, t).x } else { 0.0 };
                codes.hear(at(t), &phase(k, slip + beside + noise(&mut state), 1, false));
            }
            let compared = |k: usize| Compared { satellite: gps(k), unit: sky(k, t), weight: 1.0 / (CODE_SIGMA_M * CODE_SIGMA_M) };
            codes.judge(at(t), (0..14).map(compared)).is_some()
        })
        .collect();
    assert_eq!(named, (0..20).map(|e| e >= 10).collect::<Vec<_>>());
    assert_eq!(codes.comparisons().n_compared, 19);
}

/// Epochs 90 s apart, as far as their receiver flags no loss of lock; of 330 s none is compared with another.
#[test]
fn sparse_epochs_are_compared_by_their_own_interval() {
    for (interval_s, compared) in [(90.0, true), (300.0, true), (330.0, false)] {
        let mut codes = CodesAgainstPhases::new(interval_s);
        let named: Vec<bool> = (0..6)
            .map(|e| {
                let t = interval_s * f64::from(e);
                (0..9).for_each(|k| codes.hear(at(t), &phase(k, if e >= 3 { -60.0 * unit(k, t).x } else { 0.0 }, 1, false)));
                codes.judge(at(t), (0..9).map(|k| Compared { satellite: gps(k), unit: unit(k, t), weight: 1.0 })).is_some()
            })
            .collect();
        assert_eq!(named, (0..6).map(|e| compared && e >= 3).collect::<Vec<_>>(), "{interval_s}");
        assert_eq!(codes.comparisons().n_compared > 0, compared);
    }
}

/// One satellite that rises under an active sun: 31 mm/s, as at a station of 2002. Nothing leads the position off.
#[test]
fn a_satellite_whose_code_and_phase_diverge_leads_nothing_off() {
    for k in [1, 3, 6, 8] {
        let rising =
            move |each: usize, t: f64| Some((if each == k { -0.031 * t.rem_euclid(900.0) } else { -0.004 * t.rem_euclid(900.0) }, false));
        assert_eq!(first(&reported(9, &rising)), None, "{k}");
    }
}

/// A ramp of 0.7 m/s, an epoch every 300 s and one missing: with the lead of the references the directions that have turned since fit no shift.
#[test]
fn a_lead_stands_until_codes_are_compared_again() {
    let mut codes = CodesAgainstPhases::new(300.0);
    let named: Vec<bool> = (0..24)
        .filter(|e| *e != 8)
        .map(|e| {
            let t = f64::from(e) * 300.0;
            let lead_m = 0.7 * (t - 2000.0).max(0.0);
            (0..9).for_each(|k| codes.hear(at(t), &phase(k, -lead_m * unit(k, t).x, 1, false)));
            codes.judge(at(t), (0..9).map(|k| Compared { satellite: gps(k), unit: unit(k, t), weight: 1.0 })).is_some()
        })
        .collect();
    assert!(named[..7].iter().all(|each| !each) && named[7..].iter().all(|each| *each), "{named:?}");
}

/// That hardly any phase went on while a lead stood is counted.
#[test]
fn a_lead_of_which_no_phase_went_on_is_counted() {
    let mut codes = CodesAgainstPhases::new(STEP_S);
    for e in 0..9 {
        let t = f64::from(e) * STEP_S;
        (0..9).for_each(|k| codes.hear(at(t), &phase(k, if e >= 3 { -60.0 * unit(k, t).x } else { 0.0 }, 1, e == 6)));
        codes.judge(at(t), (0..9).map(|k| Compared { satellite: gps(k), unit: unit(k, t), weight: 1.0 }));
    }
    assert_eq!((codes.comparisons().n_compared, codes.comparisons().n_dropped), (7, 1));
}
