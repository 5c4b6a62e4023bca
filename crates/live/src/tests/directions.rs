//! Positions that do not go where the reported track leads, in each of the formats.

use super::*;
use navbound_formats::receiver::position::Kind;

/// Of a source that flies 70 m/s to the east by its positions, with a drift to the north.
#[derive(Clone, Copy)]
struct Flight {
    seconds: u32,
    track_deg: Option<f64>,
    drift_mps: f64,
}

impl Flight {
    const fn new(track_deg: f64) -> Self {
        Self { seconds: 200, track_deg: Some(track_deg), drift_mps: 0.0 }
    }

    /// Latitude and longitude \[deg\].
    fn place(&self, k: u32) -> [f64; 2] {
        let (east_m, north_m) = (70.0 * f64::from(k), self.drift_mps * f64::from(k));
        [40.0 + (north_m / 6.371e6).to_degrees(), 5.0 + (east_m / 6.371e6 / 40.0_f64.to_radians().cos()).to_degrees()]
    }

    fn json(&self, k: u32) -> String {
        let [lat, lon] = self.place(k).map(f64::to_radians);
        let track = self.track_deg.map_or_else(String::new, |deg| format!(",\"ground_track_rad\":{}", deg.to_radians()));
        line("d", f64::from(k), &format!(",\"est_lat_rad\":{lat},\"est_lon_rad\":{lon},\"sigma_m\":3.0,\"ground_speed_mps\":70.0{track}"))
    }

    fn readsb(&self, k: u32, more: &str) -> String {
        let [lat, lon] = self.place(k);
        let track = self.track_deg.map_or_else(String::new, |deg| format!(",\"track\":{deg:.1}"));
        let now = 1_731_000_000 + k;
        format!(
            "{{\"now\":{now}.0,\"hex\":\"4ca123\",\"type\":\"adsb_icao\",\"seen_pos\":0.0,\"lat\":{lat:.6},\"lon\":{lon:.6},\"gs\":136.1{track},\"nic\":8,\"nac_p\":9,\"sil\":3{more}}}\n"
        )
    }

    fn nmea(&self, k: u32) -> String {
        let angle = |deg: f64| format!("{:02}{:08.5}", deg.trunc(), 60.0 * deg.fract());
        let [lat, lon] = self.place(k).map(angle);
        let time = format!("{:02}{:02}{:02}.00", 12 + k / 3600, k / 60 % 60, k % 60);
        let track = self.track_deg.map_or_else(String::new, |deg| format!("{deg:.1}"));
        [
            format!("GPGGA,{time},{lat},N,0{lon},E,1,08,1.0,100.0,M,47.0,M,,"),
            format!("GPGST,{time},3.0,3.0,3.0,0.0,3.0,3.0,5.0"),
            format!("GPRMC,{time},A,{lat},N,0{lon},E,136.07,{track},221126,,,A"),
        ]
        .map(|body| format!("${body}*{:02X}\r\n", body.bytes().fold(0, |sum, byte| sum ^ byte)))
        .concat()
    }

    fn judged(&self, format: Format, text: impl Fn(u32) -> String) -> Vec<EpochOut> {
        let base = settings();
        let judge = judge::Settings { method: Alerting::of("anp-circle").unwrap(), ..base.judge };
        let (mut lane, mut all) = (Lane::new(Settings { judge, format, ..base }).unwrap(), Vec::new());
        for k in 0..self.seconds {
            // What is written down and read again goes on alike.
            if k % 37 == 20 {
                let snapshot = lane.snapshot(0, 0);
                lane = Lane::restore(lane.settings.clone(), &snapshot).unwrap().0;
                assert_eq!(lane.snapshot(0, 0), snapshot);
            }
            lane.step(&Input::Chunk { arrival: None, bytes: text(k).as_bytes() }, &mut all);
        }
        lane.step(&Input::End { arrival: None }, &mut all);
        all.iter().filter_map(|output| if let Output::Epoch(epoch) = output { Some(*epoch) } else { None }).collect()
    }

    /// Reasons in each format, each once in its order, and the first epoch that has one.
    fn reasons(&self) -> [(Vec<&'static str>, Option<usize>); 3] {
        let nmea = Format::Receiver(Kind::Nmea);
        [
            self.judged(Format::Json, |k| self.json(k)),
            self.judged(Format::Readsb, |k| self.readsb(k, "")),
            self.judged(nmea, |k| self.nmea(k)),
        ]
        .map(|epochs| {
            assert_eq!(epochs.len(), self.seconds as usize);
            let mut reasons: Vec<_> = epochs.iter().filter_map(|epoch| epoch.reason.map(Reason::id)).collect();
            reasons.dedup();
            (reasons, epochs.iter().position(|epoch| epoch.reason.is_some()))
        })
    }
}

const CONTRADICTS: [&str; 1] = ["direction_contradicts"];

#[test]
fn positions_that_go_another_way_than_their_track_are_not_believed() {
    for (reasons, first) in Flight::new(90.0).reasons() {
        assert_eq!((reasons, first), (vec![], None));
    }
    for track_deg in [0.0, 180.0, 270.0] {
        for (reasons, first) in Flight::new(track_deg).reasons() {
            assert_eq!(reasons, CONTRADICTS, "{track_deg}");
            assert!(first.is_some_and(|first| (55..=125).contains(&first)), "{track_deg}: {first:?}");
        }
    }
    // Nothing is compared with what is not stated.
    for (reasons, _) in (Flight { track_deg: None, ..Flight::new(0.0) }).reasons() {
        assert!(reasons.is_empty());
    }
}

#[test]
fn positions_that_drift_slowly_are_not_believed_after_minutes() {
    for (drift_mps, shows) in [(5.0, true), (1.4, false)] {
        for (reasons, first) in (Flight { seconds: 1100, drift_mps, ..Flight::new(90.0) }).reasons() {
            assert_eq!(reasons, if shows { &CONTRADICTS[..] } else { &[] }, "{drift_mps}");
            assert!(first.is_none_or(|first| first > 500), "{first:?}");
        }
    }
}

/// A track that multilateration measured is none that the aircraft states.
#[test]
fn the_track_of_others_is_not_compared() {
    let flight = Flight::new(0.0);
    for list in ["mlat", "tisb"] {
        let epochs = flight.judged(Format::Readsb, |k| flight.readsb(k, &format!(",\"{list}\":[\"track\"]")));
        assert!(epochs.iter().all(|epoch| epoch.reason.is_none()), "{list}");
    }
}

/// On its way for two minutes, and beside it under a speed and a track that are repeated: what was added up and what was passed over is kept.
#[test]
fn a_track_that_is_restored_anywhere_is_judged_alike() {
    let (right, aside) = (Flight { seconds: 480, ..Flight::new(90.0) }, Flight { drift_mps: 40.0, ..Flight::new(90.0) });
    let text = |k: u32| {
        let [lat, lon] = right.place(k).map(f64::to_radians);
        let [away, _] = aside.place(k.saturating_sub(130)).map(f64::to_radians);
        let changes = if (60..70).contains(&k) { f64::from(k) * 1e-4 } else { 0.0 };
        let more = format!(",\"sigma_m\":3.0,\"ground_speed_mps\":70.0,\"ground_track_rad\":{}", 90_f64.to_radians() + changes);
        line("d", f64::from(k), &format!(",\"est_lat_rad\":{},\"est_lon_rad\":{lon}{more}", lat + away - 40_f64.to_radians()))
    };
    let inputs: Vec<_> = (0..right.seconds).map(|k| Input::Chunk { arrival: None, bytes: text(k).as_bytes() }.to_bytes()).collect();
    let of = || {
        let base = settings();
        Settings { judge: judge::Settings { method: Alerting::of("anp-circle").unwrap(), ..base.judge }, ..base }
    };
    let expected = judged(&mut Lane::new(of()).unwrap(), &inputs);
    let epochs = epochs_of(&Output::all(&expected).unwrap(), "d");
    let first = epochs.iter().position(|epoch| epoch.reason == Some(Reason::DirectionContradicts));
    assert!(first.is_some_and(|first| first > 300), "three minutes are passed over: {first:?}");
    let mut first = Lane::new(of()).unwrap();
    let mut bytes = Vec::new();
    for cut in 0..inputs.len() {
        if cut % 5 == 3 || cut % 60 < 3 {
            let mut second = Lane::restore(of(), &first.snapshot(0, 0)).unwrap().0;
            assert!([bytes.clone(), judged(&mut second, &inputs[cut..])].concat() == expected, "cut at {cut}");
        }
        bytes.extend(judged(&mut first, &inputs[cut..=cut]));
    }
}

/// It begins anew as the motion does, where its clock is set back for good.
#[test]
fn a_track_that_begins_anew_is_believed_anew() {
    let flight = Flight { seconds: 700, ..Flight::new(0.0) };
    let text = |k: u32| {
        if k < 200 {
            return flight.json(k);
        }
        let (right, earlier) = (Flight::new(90.0), format!("\"time_ns\":{}", T0_NS - 7_200_000_000_000 + i64::from(k) * 1_000_000_000));
        right.json(k).replace(&format!("\"time_ns\":{}", T0_NS + i64::from(k) * 1_000_000_000), &earlier)
    };
    let epochs = flight.judged(Format::Json, text);
    assert_eq!(epochs[190].reason, Some(Reason::DirectionContradicts));
    let last = epochs.last().unwrap();
    assert_eq!((last.reason, last.status), (None, Status::Ok));
}
